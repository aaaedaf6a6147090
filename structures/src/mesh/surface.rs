//! Samples of a surface, as dense as one asks.

use rayon::prelude::*;

use crate::mesh::solid::Solid;
use crate::mesh::triangle_mesh::doubled_normal;
use crate::mesh::triangle_tree::centroid;
use crate::vector::{add, along, norm, scale, subtract};

/// A point that stands for a small piece of the surface.
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
            let reach = corners
                .iter()
                .map(|&corner| norm(subtract(corner, middle)))
                .fold(0.0, f64::max);
            if reach <= spacing {
                visit(SurfaceSample {
                    point: middle,
                    normal,
                    area,
                });
                continue;
            }
            if skip(middle, reach) {
                continue;
            }
            stack.extend(halved(corners).map(|half| (half, 0.5 * area)));
        }
    }

    /// Calls `search` with each of the clusters that the surface is searched by, in parallel, and puts together in
    /// turn what it returns.
    ///
    /// They are clusters of triangles in the order of [`samples_of`](Self::samples_of).
    pub(crate) fn search<T: Send>(&self, search: impl Fn(Searched<'_>) -> T + Sync) -> Vec<T> {
        self.tree()
            .blocks((self.sampled_triangles() / BLOCKS).clamp(1, LARGEST_BLOCK))
            .into_par_iter()
            .map(|block| search(Searched { solid: self, block }))
            .collect()
    }
}

/// Blocks that a surface is searched by, about, and triangles in one of them at most.
const BLOCKS: usize = 64;
const LARGEST_BLOCK: usize = 512;

/// A block of the surface.
pub(crate) struct Searched<'a> {
    solid: &'a Solid,
    block: usize,
}

impl Searched<'_> {
    /// The samples of its triangles, as by [`Solid::samples_of`], where whole clusters are left out for which
    /// `skip` says so; `visit` gets the number of the triangle, too.
    pub fn samples(
        &self,
        spacing: f64,
        mut skip: impl FnMut([f64; 3], f64) -> bool,
        mut visit: impl FnMut(usize, SurfaceSample),
    ) {
        self.solid.tree().visit_below(self.block, |cluster, first| {
            // Rounding of the radius must not leave out what is not meant.
            if cluster.radius > spacing && skip(cluster.center, cluster.radius * (1.0 + 1e-9)) {
                return false;
            }
            let Some(triangles) = cluster.leaf else {
                return true;
            };
            for triangle in first..first + triangles.len() {
                self.solid
                    .samples_of(triangle, spacing, &mut skip, |sample| {
                        visit(triangle, sample)
                    });
            }
            false
        });
    }
}

/// The two halves of a triangle, cut at its longest side.
fn halved(corners: [[f64; 3]; 3]) -> [[[f64; 3]; 3]; 2] {
    let [a, b, c] = turned_to_longest(corners);
    let halved = scale(add(a, b), 0.5);
    [[a, halved, c], [halved, b, c]]
}

/// The corners in the same order, the longest side first.
fn turned_to_longest([a, b, c]: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let squared = |p: [f64; 3], q: [f64; 3]| {
        let side = subtract(p, q);
        side[0] * side[0] + side[1] * side[1] + side[2] * side[2]
    };
    let (ab, bc, ca) = (squared(a, b), squared(b, c), squared(c, a));
    if ab >= bc && ab >= ca {
        [a, b, c]
    } else if bc >= ca {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Cuts the surface within `reach` of `point` into pieces no larger than `radius` about their middle.
///
/// Calls `visit` with the middle and area of each. Whole clusters of triangles count as one piece where they are small
/// enough.
pub(crate) fn surface_pieces(
    solid: &Solid,
    point: [f64; 3],
    reach: f64,
    radius: f64,
    mut visit: impl FnMut([f64; 3], f64),
) {
    let mut stack = Vec::new();
    solid.tree().visit(|cluster| {
        if norm(subtract(cluster.center, point)) - cluster.radius > reach {
            return false;
        }
        if cluster.radius <= radius {
            visit(cluster.center, cluster.area);
            return false;
        }
        let Some(triangles) = cluster.leaf else {
            return true;
        };
        for &corners in triangles {
            stack.push((corners, 0.5 * norm(doubled_normal(corners))));
            while let Some((corners, area)) = stack.pop() {
                let middle = centroid(corners);
                let own = corners
                    .iter()
                    .map(|&corner| norm(subtract(corner, middle)))
                    .fold(0.0, f64::max);
                if norm(subtract(middle, point)) - own > reach {
                    continue;
                }
                if own <= radius {
                    visit(middle, area);
                    continue;
                }
                let [a, b, c] = turned_to_longest(corners);
                let halved = scale(add(a, b), 0.5);
                // Doubles are no finer, whatever was requested.
                if halved == a || halved == b {
                    visit(middle, area);
                    continue;
                }
                stack.push(([a, halved, c], 0.5 * area));
                stack.push(([halved, b, c], 0.5 * area));
            }
        }
        false
    });
}

/// Samples of one triangle that bound nothing, after which only every so many are looked at.
const PATIENCE: usize = 32;

/// Looks at samples of one triangle, in turn. Where many in a row bound nothing, most of those that follow are
/// taken to bound nothing either.
#[derive(Default)]
pub(crate) struct Probe {
    idle: usize,
}

impl Probe {
    /// Whether the solid lies under a sample, at steps from `reach` / 2^40 to `reach` / 2^5.
    pub fn is_under(&mut self, solid: &Solid, sample: &SurfaceSample, reach: f64) -> bool {
        let passes = self.idle > PATIENCE && !self.idle.is_multiple_of(PATIENCE);
        let found = !passes && is_along(solid, sample, -reach, 1);
        self.idle = if found { 0 } else { self.idle + 1 };
        found
    }
}

/// Whether the solid lies on either side of a sample, at fewer such steps.
pub(crate) fn is_beside(solid: &Solid, sample: &SurfaceSample, reach: f64) -> bool {
    is_along(solid, sample, -reach, 3) || is_along(solid, sample, reach, 3)
}

fn is_along(solid: &Solid, sample: &SurfaceSample, reach: f64, stride: usize) -> bool {
    (1..=8).step_by(stride).any(|step| {
        let share = 0.5f64.powi(5 * step);
        solid.is_inside(along(sample.point, share * reach, sample.normal))
    })
}
