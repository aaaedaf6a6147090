//! Nesting of closed surfaces.
//!
//! A surface is within another if its bounding box is and all points that are looked at are: its outermost vertices
//! and the middles of some of its triangles. A point on the other surface itself says nothing, so that bodies and
//! cavities may touch the walls about them.

use std::sync::OnceLock;

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use rayon::prelude::*;

use crate::mesh::error::MeshErrorKind;
use crate::mesh::repair::bounded_surface::Surface;
use crate::mesh::triangle_mesh::Mesh;
use crate::mesh::triangle_tree::{TriangleTree, centroid};
use crate::mesh::winding::encloses;

/// Middles of triangles that are looked at, about, beside the outermost vertices.
const MIDDLES: usize = 8;

/// Most pairs of surfaces of which one may lie within the other, by their boxes: 2,000 shells like an onion's, or any
/// number of parts side by side in one.
pub(in crate::mesh) const MAX_PAIRS: usize = 2_000_000;

/// The surfaces about each one, in rising order.
///
/// # Errors
/// [`MeshErrorKind::Nested`] for more than [`MAX_PAIRS`]: each takes a look at two surfaces.
pub(in crate::mesh) fn containers(
    mesh: &Mesh,
    surfaces: &[Surface],
) -> Result<Vec<Vec<usize>>, MeshErrorKind> {
    if surfaces.len() < 2 {
        return Ok(vec![Vec::new(); surfaces.len()]);
    }
    let boxes: Vec<Aabb> = surfaces
        .iter()
        .map(|one| Aabb::new(Vector::from_array(one.low), Vector::from_array(one.high)))
        .collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    let (mut pairs, mut looked) = (0, 0);
    let mut by_box = Vec::with_capacity(surfaces.len());
    for (index, own) in surfaces.iter().enumerate() {
        let corner = Vector::from_array(own.low);
        let corner = Aabb::new(corner, corner);
        let mut about: Vec<usize> = tree
            .intersect_aabb(&corner)
            .map(|other| other as usize)
            .inspect(|_| looked += 1)
            .filter(|&other| other != index && surfaces[other].can_hold(own))
            .collect();
        about.sort_unstable();
        pairs += about.len();
        if pairs > MAX_PAIRS || looked > 100 * MAX_PAIRS {
            return Err(MeshErrorKind::Nested {
                surfaces: surfaces.len(),
            });
        }
        by_box.push(about);
    }
    let trees: Vec<OnceLock<TriangleTree>> = surfaces.iter().map(|_| OnceLock::new()).collect();
    let containers = by_box
        .into_par_iter()
        .enumerate()
        .map(|(index, mut about)| {
            let own = &surfaces[index];
            about.retain(|&other| {
                let outer = trees[other].get_or_init(|| {
                    let triangles = surfaces[other].triangles.iter();
                    TriangleTree::of(
                        triangles
                            .map(|&t| mesh.triangles[t as usize])
                            .filter(|&triangle| !mesh.is_sliver(triangle))
                            .map(|triangle| mesh.corners(triangle))
                            .collect(),
                    )
                });
                let earlier = match (own.is_inward(), surfaces[other].is_inward()) {
                    // Of two that coincide, the wall of a cavity is about what fills it.
                    (false, true) => true,
                    (true, false) => false,
                    _ => other < index,
                };
                is_within(mesh, own, outer).unwrap_or(earlier)
            });
            about
        })
        .collect();
    Ok(containers)
}

/// Whether a surface lies within another; none where it lies on it all over.
fn is_within(mesh: &Mesh, inner: &Surface, outer: &TriangleTree) -> Option<bool> {
    let middle = |&triangle: &u32| centroid(mesh.corners(mesh.triangles[triangle as usize]));
    let count = inner.triangles.len();
    let step = count.div_ceil(MIDDLES).max(1);
    let some = inner.triangles.iter().step_by(step).map(middle);
    let mut found = None;
    for point in inner.outermost.iter().copied().chain(some) {
        match encloses(outer, point) {
            Some(false) => return Some(false),
            within => found = found.or(within),
        }
    }
    found.or_else(|| {
        let mut all = inner.triangles.iter().map(middle);
        all.find_map(|point| encloses(outer, point))
    })
}
