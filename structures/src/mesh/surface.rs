//! Samples of a surface, of any density.

use rayon::prelude::*;

use crate::mesh::solid::Solid;
use crate::mesh::triangle_mesh::{centroid, doubled_normal};
use crate::mesh::triangle_tree::reach;
use crate::vector::{add, along, distance, norm, scale, squared_distance};

/// A point that represents a small piece of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceSample {
    /// The middle of the piece.
    pub point: [f64; 3],
    /// Unit outward normal.
    pub normal: [f64; 3],
    /// Area of the piece.
    pub area: f64,
}

impl Solid {
    /// Number of triangles that have samples; see [`samples_of`](Self::samples_of).
    pub fn sampled_triangles(&self) -> usize {
        self.tree().triangles().len()
    }

    /// Samples of one triangle, none of whose points is farther than `spacing` from a sample, in the solid's
    /// coordinates.
    ///
    /// The triangle is halved at its longest side until its pieces are small enough, which suits needles too.
    ///
    /// A piece about `point` is left out whole if `skip(point, reach)` says true: a bound over many samples at the
    /// price of one. `reach` is no less than the distance of any of its points.
    pub fn samples_of(
        &self,
        triangle: usize,
        spacing: f64,
        mut skip: impl FnMut([f64; 3], f64) -> bool,
        mut visit: impl FnMut(SurfaceSample),
    ) {
        let corners = self.tree().triangles()[triangle];
        let normal = doubled_normal(corners);
        let doubled_area = norm(normal);
        let normal = scale(normal, 1.0 / doubled_area);
        let mut stack = vec![(corners, 0.5 * doubled_area)];
        while let Some((corners, area)) = stack.pop() {
            let middle = centroid(corners);
            let own = reach(&corners, middle);
            if own <= spacing {
                visit(SurfaceSample {
                    point: middle,
                    normal,
                    area,
                });
                continue;
            }
            if skip(middle, own) {
                continue;
            }
            stack.extend(halved(corners).map(|half| (half, 0.5 * area)));
        }
    }

    /// Calls `search` with each block of the surface, in parallel, and returns the results in order: that of the
    /// triangles of [`samples_of`](Self::samples_of).
    pub(crate) fn search<T: Send>(&self, search: impl Fn(SurfaceBlock<'_>) -> T + Sync) -> Vec<T> {
        self.tree()
            .blocks((self.sampled_triangles() / BLOCKS).clamp(1, LARGEST_BLOCK))
            .into_par_iter()
            .map(|block| search(SurfaceBlock { solid: self, block }))
            .collect()
    }
}

/// Blocks that a surface is searched by, about, and triangles in one of them at most.
const BLOCKS: usize = 64;
const LARGEST_BLOCK: usize = 512;

pub(crate) struct SurfaceBlock<'a> {
    solid: &'a Solid,
    block: usize,
}

impl SurfaceBlock<'_> {
    /// The samples of its triangles, as by [`Solid::samples_of`]; `skip` may leave out whole clusters, and `visit` gets
    /// the number of the triangle, too.
    pub fn samples(
        &self,
        spacing: f64,
        mut skip: impl FnMut([f64; 3], f64) -> bool,
        mut visit: impl FnMut(usize, SurfaceSample),
    ) {
        let tree = self.solid.tree();
        tree.visit(self.block, |cluster| {
            // Rounding of the radius must not leave out what is not meant.
            if cluster.radius > spacing && skip(cluster.center, cluster.radius * (1.0 + 1e-9)) {
                return false;
            }
            let Some(triangles) = tree.leaf(cluster) else {
                return true;
            };
            for triangle in (cluster.first as usize..).take(triangles.len()) {
                let visit = |sample| visit(triangle, sample);
                self.solid.samples_of(triangle, spacing, &mut skip, visit);
            }
            false
        });
    }
}

/// The two halves of a triangle, cut at its longest side: from the side's beginning to its middle, and on to its end.
fn halved([a, b, c]: [[f64; 3]; 3]) -> [[[f64; 3]; 3]; 2] {
    let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| squared_distance(p, q));
    // The first of sides that are as long as each other, whatever their last digits.
    let longest = (1.0 - 1e-9) * ab.max(bc).max(ca);
    let [a, b, c] = if ab >= longest {
        [a, b, c]
    } else if bc >= longest {
        [b, c, a]
    } else {
        [c, a, b]
    };
    let middle = scale(add(a, b), 0.5);
    [[a, middle, c], [middle, b, c]]
}

/// Cuts the surface `within` a length of `point` into pieces no larger than `radius` about their middle.
///
/// Calls `visit` with the middle and area of each. Clusters of triangles that are small enough count as one piece.
pub(crate) fn surface_pieces(
    solid: &Solid,
    point: [f64; 3],
    within: f64,
    radius: f64,
    mut visit: impl FnMut([f64; 3], f64),
) {
    let mut stack = Vec::new();
    let tree = solid.tree();
    tree.visit(0, |cluster| {
        if distance(cluster.center, point) - cluster.radius > within {
            return false;
        }
        if cluster.radius <= radius {
            visit(cluster.center, cluster.area);
            return false;
        }
        let Some(triangles) = tree.leaf(cluster) else {
            return true;
        };
        for &corners in triangles {
            stack.push((corners, 0.5 * norm(doubled_normal(corners))));
            while let Some((corners, area)) = stack.pop() {
                let middle = centroid(corners);
                let own = reach(&corners, middle);
                if distance(middle, point) - own > within {
                    continue;
                }
                if own <= radius {
                    visit(middle, area);
                    continue;
                }
                let halves = halved(corners);
                let [[a, half, _], [_, b, _]] = halves;
                // Doubles are no finer, whatever was requested.
                if half == a || half == b {
                    visit(middle, area);
                    continue;
                }
                stack.extend(halves.map(|half| (half, 0.5 * area)));
            }
        }
        false
    });
}

/// Samples of one triangle that bound nothing after which only one in this many is looked at.
const PATIENCE: usize = 32;

/// Looks at samples of one triangle, in turn. After many that bound nothing, most of those that follow are taken to bound
/// nothing either.
#[derive(Default)]
pub(crate) struct Probe {
    idle: usize,
}

impl Probe {
    /// Whether the solid is under a sample, at steps from `reach` / 2^40 to `reach` / 2^5.
    pub fn is_under(&mut self, solid: &Solid, sample: &SurfaceSample, reach: f64) -> bool {
        let passes = self.idle > PATIENCE && !self.idle.is_multiple_of(PATIENCE);
        let found = !passes && is_along(solid, sample, -reach, 1);
        self.idle = if found { 0 } else { self.idle + 1 };
        found
    }
}

/// Whether the solid is on either side of a sample, at fewer such steps.
pub(crate) fn is_beside(solid: &Solid, sample: &SurfaceSample, reach: f64) -> bool {
    is_along(solid, sample, -reach, 3) || is_along(solid, sample, reach, 3)
}

fn is_along(solid: &Solid, sample: &SurfaceSample, reach: f64, stride: usize) -> bool {
    (1..=8).step_by(stride).any(|step| {
        let share = 0.5f64.powi(5 * step);
        solid.is_inside(along(sample.point, share * reach, sample.normal))
    })
}
