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
//! theorem): the segments in which triangles of the other solid cross it, and the pieces of its sides that are
//! inside. With p the first corner, a piece from u to v counts as the triangle p, u, v. So sides through p count nothing.
//! On the third side an exit from the other solid at c counts as the piece from the side's beginning to c, an entry as
//! minus that. If the end of the side is inside, it counts as an exit. No pieces are put in order, and no polygon is made.
//!
//! One corner of each connected part of a surface is tested for being inside. From there sides lead to all others. Both
//! ends of a side that nothing crosses are inside or both are not; else the crossing next to an end decides.
//!
//! # Degenerate poses
//!
//! All this needs signs that rounding cannot change. If a pair of triangles has others, as flush faces have, the second
//! solid is moved by a small part of its size and the sums are made again. The bound covers that.

use crate::mesh::contact::{Place, SurfacePairs};
use crate::mesh::exact_solid::{Branch, ExactSolid};
use crate::mesh::triangle_mesh::doubled_normal;
use crate::mesh::triangle_pair::{End, Relation, Triangle, relation};
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
    crossings: Vec<Crossings>,
    /// Of each side of each triangle: one more than the place of its crossings, zero if there are none.
    places: Vec<u32>,
    /// Of each corner: whether it is inside the other solid.
    inside: Vec<bool>,
}

/// First and last crossing of a side through the other surface: the share of the side before it, and whether the side
/// leaves the other solid there.
#[derive(Debug)]
struct Crossings {
    /// Number of the side: three times its triangle's, and its own.
    side: usize,
    first: (f64, bool),
    last: (f64, bool),
}

/// A piece of the boundary of a triangle's part in the other solid.
#[derive(Debug)]
struct Cut {
    /// The solid whose triangle it is.
    side: usize,
    triangle: Triangle,
    piece: [[f64; 3]; 2],
    /// -1 if the piece runs the other way, or counts as taken away.
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

    /// Adds a triangle: of its three sides the third one, from beginning to end.
    fn add_whole(&mut self, triangle: &Triangle) {
        let [a, b, c] = *triangle;
        let middle = scale(add(a, add(b, c)), 1.0 / 3.0);
        self.add_part(doubled_normal(*triangle), 0.5, a, middle);
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
        let (sides, cuts) = (&mut self.sides, &mut self.cuts);
        for (side, solid) in sides.iter_mut().zip(solids) {
            side.begin(solid);
        }
        cuts.clear();
        let mut generic = true;
        self.pairs.visit(
            [a, b],
            place,
            || 0.0,
            |pair| {
                match relation(&pair[0].1, &pair[1].1, place.delta) {
                    Relation::Apart => {}
                    Relation::Open => generic = false,
                    Relation::Cross(ends) => {
                        let normals = pair.map(|(_, triangle)| doubled_normal(*triangle));
                        let [from, to] = ends.map(|end| end.point);
                        let ahead = dot(cross(normals[0], normals[1]), subtract(to, from));
                        for (side, (sign, (_, triangle))) in
                            [1.0, -1.0].into_iter().zip(pair).enumerate()
                        {
                            cuts.push(Cut {
                                side,
                                triangle: *triangle,
                                piece: [from, to],
                                sign: sign * ahead.signum(),
                            });
                        }
                        for end in ends {
                            let side = usize::from(end.of_second);
                            let (number, triangle) = pair[side];
                            sides[side].cross(*number, &end);
                            if end.side == 1 {
                                cuts.push(Cut {
                                    side,
                                    triangle: *triangle,
                                    piece: [triangle[1], end.point],
                                    sign: if end.leaves { 1.0 } else { -1.0 },
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
            sums[cut.side].add(&cut.triangle, cut.piece, cut.sign);
        }
        sides[0].find_inside(solids[0], |corner| b.is_inside(place.back(corner)));
        sides[1].find_inside(solids[1], |corner| a.is_inside(place.apply(corner)));
        for (number, triangle) in a.triangles() {
            if sides[0].ends_inside(solids[0], *number) {
                sums[0].add_whole(triangle);
            }
        }
        for (number, triangle) in b.triangles() {
            if sides[1].ends_inside(solids[1], *number) {
                sums[1].add_whole(&place.moved(*triangle));
            }
        }
        Some(sums)
    }
}

impl Side {
    fn begin(&mut self, solid: &ExactSolid) {
        for crossings in self.crossings.drain(..) {
            self.places[crossings.side] = 0;
        }
        // All zero: a solid of another size may follow.
        self.places.resize(3 * solid.corners.len(), 0);
    }

    /// Notes that a side of a triangle crosses the other surface.
    fn cross(&mut self, triangle: usize, end: &End) {
        let side = 3 * triangle + end.side;
        let here = (end.share, end.leaves);
        match self.places[side].checked_sub(1) {
            Some(place) => {
                let known = &mut self.crossings[place as usize];
                if end.share < known.first.0 {
                    known.first = here;
                }
                if end.share > known.last.0 {
                    known.last = here;
                }
            }
            None => {
                let (first, last) = (here, here);
                self.crossings.push(Crossings { side, first, last });
                self.places[side] = self.crossings.len() as u32;
            }
        }
    }

    /// Finds which corners are inside the other solid, to whose `is_inside` those of the roots are given.
    fn find_inside(&mut self, solid: &ExactSolid, is_inside: impl Fn([f64; 3]) -> bool) {
        let positions = solid.solid.mesh().positions();
        self.inside.clear();
        self.inside.resize(positions.len(), false);
        for Branch { to, from } in &solid.forest {
            let inside = match from {
                None => is_inside(positions[*to as usize]),
                Some((corner, run)) => match self.places[run.side()].checked_sub(1) {
                    None => self.inside[*corner as usize],
                    Some(place) => {
                        let crossings = &self.crossings[place as usize];
                        match run.is_forward() {
                            true => !crossings.last.1,
                            false => crossings.first.1,
                        }
                    }
                },
            };
            self.inside[*to as usize] = inside;
        }
    }

    /// Whether the third side of a triangle ends inside the other solid.
    fn ends_inside(&self, solid: &ExactSolid, triangle: usize) -> bool {
        self.inside[solid.corners[triangle][2] as usize]
    }
}
