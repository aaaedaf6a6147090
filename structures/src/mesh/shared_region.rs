//! The region that two solids share at a pose: its volume, and how that changes as the second solid moves.
//!
//! The surface of the region consists of the parts of either surface in the other solid. With x a point and n the outward
//! normal of a surface, and integrals over these parts,
//!
//! ```text
//! volume = (sum over both of  integral of x . n dA) / 3
//! slope by a translation of the second solid = integral of n dA over its part in the first
//! slope by a turn of it about the origin     = integral of x x n dA over the same
//! ```
//!
//! A triangle's part in the other solid is a plane region. Its area and first moment are sums over its boundary (Green's
//! theorem): the segments in which triangles of the other solid cross it, and the pieces of its own sides that are
//! inside. With p the first corner, a piece from u to v counts as the triangle p, u, v. So sides through p count nothing.
//! On the third side an exit from the other solid at c counts as the piece from the side's beginning to c, an entry as
//! minus that. If the end of the side is inside, it counts as an exit. No pieces are put in order, and no polygon is made.
//!
//! Corners that are joined by a side that nothing crosses are both inside or both outside, so one inside test serves many.
//!
//! # Degenerate poses
//!
//! All this needs signs that rounding cannot change. If a pair of triangles has others, as flush faces have, the second
//! solid is moved by a small part of its size and the sums are made again. The bound covers that.

use crate::mesh::contact::{ExactSolid, Place, Relation, SurfacePairs, Triangle, relation};
use crate::mesh::repair::edges::Sets;
use crate::mesh::triangle_mesh::doubled_normal;
use crate::motion::Motion;
use crate::vector::{add, along, cross, dot, norm, scale, subtract};

/// Volume of the region that two solids share, with its slopes, in the unit of the first one's file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SharedRegion {
    /// The volume.
    pub volume: f64,
    /// The volume differs from the true one by no more than this.
    pub bound: f64,
    /// Slope of the volume by a translation of the second solid.
    pub by_shift: [f64; 3],
    /// Slope of the volume by a turn of the second solid about the first one's origin, in radians.
    pub by_turn: [f64; 3],
}

/// Buffers for [`SharedRegion`]s, kept from one pose to the next.
#[derive(Debug, Default)]
pub struct SharedRegions {
    pairs: SurfacePairs,
    cuts: Vec<Cut>,
    sides: [Side; 2],
}

/// Buffers of one solid.
#[derive(Debug, Default)]
struct Side {
    /// Triangles near the other solid, numbered, in the first solid's coordinates.
    near: Vec<(usize, Triangle)>,
    /// Of each triangle that has an area: which of its sides are crossed, a bit each.
    crossed: Vec<u8>,
    /// Corners that are inside or outside together.
    sets: Sets,
    /// Of each set by its root: whether it is inside; `None` before that is known.
    inside: Vec<Option<bool>>,
}

/// Where a triangle crosses another: the segment in the first, directed so that the other solid is to its left.
#[derive(Debug)]
struct Cut {
    /// The solid whose triangle is cut.
    side: usize,
    triangle: Triangle,
    from: [f64; 3],
    to: [f64; 3],
    sign: f64,
}

/// Steps by which the second solid is moved if a pose is degenerate, in the sizes of the solids.
const STEPS: [f64; 4] = [0.0, 1e-11, 1e-9, 1e-7];
/// A direction that no face is likely to have.
const AWAY: [f64; 3] = [0.5408, -0.3123, 0.7810];

/// Integrals over part of a surface.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// Of x . n.
    volume: f64,
    /// Of n.
    normal: [f64; 3],
    /// Of x x n.
    turn: [f64; 3],
}

impl Sums {
    /// Adds the triangle of the first corner and a piece of the plane's boundary, times a sign.
    fn add(&mut self, triangle: &Triangle, [from, to]: [[f64; 3]; 2], sign: f64) {
        let [corner, ..] = *triangle;
        let doubled = doubled_normal(*triangle);
        let normal = scale(doubled, 1.0 / norm(doubled));
        let (u, v) = (subtract(from, corner), subtract(to, corner));
        let area = 0.5 * sign * dot(normal, cross(u, v));
        let middle = along(corner, 1.0 / 3.0, add(u, v));
        self.add_part(normal, area, corner, middle);
    }

    fn add_part(&mut self, normal: [f64; 3], area: f64, on_plane: [f64; 3], middle: [f64; 3]) {
        self.volume += area * dot(normal, on_plane);
        self.normal = along(self.normal, area, normal);
        self.turn = along(self.turn, area, cross(middle, normal));
    }
}

impl SharedRegions {
    /// The region that two solids share. `motion` takes coordinates about the second one's origin to those about the
    /// first one's, with at most `rounding` of error, in the unit of the files. `None` if the solids are degenerate
    /// wherever the second one is moved.
    pub fn at(
        &mut self,
        solids: [&ExactSolid; 2],
        motion: &Motion,
        rounding: f64,
    ) -> Option<SharedRegion> {
        let unit = solids[0].solid.frame().unit;
        let size = unit + solids[1].solid.frame().unit;
        STEPS.iter().find_map(|step| {
            let moved = motion.shifted(scale(AWAY, step * size));
            let place = Place::new(solids.map(|solid| &solid.solid), &moved, rounding);
            let sums = self.sums(solids, &place)?;
            let [a, b] = sums;
            let square = unit * unit;
            // A step moves the volume by no more than itself times the area of either surface.
            let area = solids[0]
                .area
                .min(solids[1].area * place.ratio * place.ratio);
            Some(SharedRegion {
                volume: ((a.volume + b.volume) / 3.0).max(0.0) * square * unit,
                bound: area * square * (step * size + 16.0 * place.delta * unit),
                by_shift: scale(b.normal, square),
                by_turn: scale(b.turn, square * unit),
            })
        })
    }

    /// The sums over both surfaces; `None` at a degenerate pose.
    fn sums(&mut self, solids: [&ExactSolid; 2], place: &Place) -> Option<[Sums; 2]> {
        let [a, b] = solids.map(|solid| &solid.solid);
        let boxes = [a, b].map(|solid| {
            let half = solid.half_sides();
            (half.map(|side| -side), half)
        });
        let [first, second] = &mut self.sides;
        first.begin(solids[0]);
        second.begin(solids[1]);
        a.visit(
            |node| place.near([node, &boxes[1]], 0.0),
            |&triangle| first.near.push(triangle),
        );
        b.visit(
            |node| place.near([&boxes[0], node], 0.0),
            |&(number, triangle)| second.near.push((number, place.moved(triangle))),
        );
        let (cuts, mut generic) = (&mut self.cuts, true);
        cuts.clear();
        self.pairs.visit(
            [a, b],
            place,
            || 0.0,
            |[(i, one), (j, other)]| {
                match relation(one, other, place.delta) {
                    Relation::Apart => {}
                    Relation::Open => generic = false,
                    Relation::Cross(ends) => {
                        let [from, to] = [ends[0].point, ends[1].point];
                        let ahead = dot(
                            cross(doubled_normal(*one), doubled_normal(*other)),
                            subtract(to, from),
                        );
                        let sign = ahead.signum();
                        let cut = |side, triangle, sign| Cut {
                            side,
                            triangle,
                            from,
                            to,
                            sign,
                        };
                        cuts.push(cut(0, *one, sign));
                        cuts.push(cut(1, *other, -sign));
                        for end in ends {
                            let (side, number, triangle) = match end.of_second {
                                false => (&mut *first, *i, one),
                                true => (&mut *second, *j, other),
                            };
                            side.crossed[number] |= 1 << end.side;
                            if end.side == 1 {
                                let sign = if end.leaves { 1.0 } else { -1.0 };
                                cuts.push(Cut {
                                    side: usize::from(end.of_second),
                                    triangle: *triangle,
                                    from: triangle[1],
                                    to: end.point,
                                    sign,
                                });
                            }
                        }
                    }
                }
                generic
            },
        );
        if !generic {
            return None;
        }
        let mut sums = [Sums::default(); 2];
        for cut in cuts {
            sums[cut.side].add(&cut.triangle, [cut.from, cut.to], cut.sign);
        }
        first.add_whole(
            solids[0],
            |corner| b.is_inside(place.back(corner)),
            &mut sums[0],
        );
        second.add_whole(solids[1], |corner| a.is_inside(corner), &mut sums[1]);
        Some(sums)
    }
}

impl Side {
    fn begin(&mut self, solid: &ExactSolid) {
        self.near.clear();
        self.crossed.clear();
        self.crossed.resize(solid.corners.len(), 0);
    }

    /// Adds the third sides that end inside the other solid, to whose `is_inside` corners are given.
    fn add_whole(
        &mut self,
        solid: &ExactSolid,
        is_inside: impl Fn([f64; 3]) -> bool,
        sums: &mut Sums,
    ) {
        let count = solid.solid.mesh().positions().len();
        self.sets.reset(count);
        self.inside.clear();
        self.inside.resize(count, None);
        for (number, _) in &self.near {
            let corners = solid.corners[*number];
            for side in 0..3 {
                if self.crossed[*number] & (1 << side) == 0 {
                    let [from, to] = [corners[side], corners[(side + 1) % 3]];
                    self.sets.join(from as usize, to as usize);
                }
            }
        }
        for (number, triangle) in &self.near {
            let root = self.sets.root(solid.corners[*number][2] as usize);
            let inside = *self.inside[root].get_or_insert_with(|| is_inside(triangle[2]));
            if inside {
                sums.add(triangle, [triangle[1], triangle[2]], 1.0);
            }
        }
    }
}
