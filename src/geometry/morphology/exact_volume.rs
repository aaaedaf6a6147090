//! Volumes of results between two bounds, from the exact depth of a mesh.
//!
//! # Proof
//!
//! Let D be the depth in a closed mesh A: the distance to its boundary, above zero inside and below outside. It changes
//! by the length between two points at most, and so do sums with a constant, and the largest and smallest of several.
//! With B a union of balls (b, s) and copies M A of the mesh, with D(M^-1 x) = D_M(x):
//!
//! | set | its points |
//! |---|---|
//! | A + B | f(x) >= 0 for f the largest of D(x - b) + s |
//! | A - B | f(t) >= 0 for f the smallest of D(t + b) - s |
//! | product | f(x) >= 0 for f the largest of D_M(x) |
//! | quotient | f(x) >= 0 for f the smallest of D_M(x) |
//!
//! A mesh B is in the balls of radius s + eps and holds those of radius s, which gives f a lower and an upper bound.
//! A cell, a cube with corners within q of its middle c, is in the set if f(c) >= q, and outside if f(c) < -q. Other
//! cells are cut in eight, down to a finest size. In such a one the ball of radius |f(c)| about c is in the set, or
//! outside. Parts shown inside give the least volume, parts not shown outside the largest.
//!
//! The opening (A - B) + B is known by the cells of A - B. If f(t) >= 0 at a point t, the ball of radius f(t) about it
//! is in A - B, so the balls (t + b, s + f(t)) are in the opening. (Of several copies only those are searched that
//! decide within q of the middle t of a cell; the radius is then q at most.) The cells that may meet A - B are in the balls of
//! radius q about their middles, so the balls (t + b, s + q) hold the opening. So does A. The closing is the complement
//! of the opening of A's complement by -B: A + B is the complement of the points t where no ball (t - b, s) meets A.
//!
//! Unions also are in the half space n x <= c of each direction n, c being the farthest coordinate of their parts. The
//! distance from its face bounds f from above, which spares a search of all parts where flat faces touch.
//!
//! All bounds hold up to the rounding of doubles.

use std::f64::consts::{PI, SQRT_2};

use knotdock_scoring::se3::Pose;
use knotdock_structures::ball_solid::BallSolid;
use knotdock_structures::mesh::Solid;
use knotdock_structures::sampling::Ball;
use knotdock_structures::sampling::ball_tree::BallTree;
use nalgebra::{UnitQuaternion, Vector3};
use rayon::prelude::*;

use crate::geometry::bracket::{Bracket, bounds};

/// Bounds of a volume, in the cube of the file's unit.
pub type VolumeBounds = [f64; 2];

/// Copies of a mesh, each grown by a margin, and united or intersected.
pub struct Copies<'a> {
    solid: &'a Solid,
    /// Origin of points, in the frame of the files.
    origin: [f64; 3],
    copies: Vec<PlacedCopy>,
    united: bool,
    /// Half spaces n x <= c, n of length one, that hold the set of united copies.
    half_spaces: Vec<(Vector3<f64>, f64)>,
}

/// The points x at which the depth at R^-1 (x - shift) plus the margin is zero or more; the margin is between two.
struct PlacedCopy {
    inverse: UnitQuaternion<f64>,
    shift: Vector3<f64>,
    margin: [f64; 2],
}

impl PlacedCopy {
    fn shifted(shift: [f64; 3], margin: [f64; 2]) -> Self {
        Self {
            inverse: UnitQuaternion::identity(),
            shift: shift.into(),
            margin,
        }
    }
}

/// A copy that may decide at a cell, by its number, and an upper bound of its function at the middle.
type Candidate = (u32, f64);

impl<'a> Copies<'a> {
    fn new(solid: &'a Solid, origin: [f64; 3], copies: Vec<PlacedCopy>, united: bool) -> Self {
        let mut copies = Self {
            solid,
            origin,
            copies,
            united,
            half_spaces: Vec::new(),
        };
        // One copy is searched as fast.
        if united && copies.copies.len() > 1 {
            let unit = solid.frame().unit;
            let still = |copy: &PlacedCopy| copy.inverse == UnitQuaternion::identity();
            let are_still = copies.copies.iter().all(still);
            let half_space = |normal: Vector3<f64>| {
                let of_all = are_still.then(|| support(solid, normal));
                let farthest = copies.copies.iter().map(|copy| {
                    let support =
                        unit * of_all.unwrap_or_else(|| support(solid, copy.inverse * normal));
                    support + normal.dot(&copy.shift) + copy.margin[1]
                });
                (normal, farthest.fold(f64::NEG_INFINITY, f64::max))
            };
            copies.half_spaces = directions().into_par_iter().map(half_space).collect();
        }
        copies
    }

    /// The points at most `distance` from A, or, below zero, those of A at least that deep.
    pub fn offset(a: &'a Solid, distance: f64) -> Self {
        let copy = PlacedCopy::shifted([0.0; 3], [distance; 2]);
        Self::new(a, a.frame().origin, vec![copy], true)
    }

    /// A + B; `mesh` is B if it is a mesh.
    pub fn sum(a: &'a Solid, b: &BallSolid, mesh: Option<&Solid>) -> Self {
        let mut sum = Self::grown(a, b, |point| point, 0.0);
        if let Some(mesh) = mesh {
            let [unit, other] = [a, mesh].map(|solid| solid.frame().unit);
            for (normal, farthest) in &mut sum.half_spaces {
                *farthest = unit * support(a, *normal) + other * support(mesh, *normal);
            }
        }
        sum
    }

    /// A + (-R B), with `offset` >= 0 added to each radius of B's balls.
    pub fn obstacle(a: &'a Solid, b: &BallSolid, rotation: &Pose, offset: f64) -> Self {
        let turn = rotation.rotation;
        Self::grown(a, b, |point| (turn * -Vector3::from(point)).into(), offset)
    }

    /// A + B for a solid B whose points `place` moves.
    fn grown(
        a: &'a Solid,
        b: &BallSolid,
        place: impl Fn([f64; 3]) -> [f64; 3],
        offset: f64,
    ) -> Self {
        let (origin, other) = (a.frame().origin, place(b.origin()));
        let grown = b.inner().iter().map(|ball| {
            let radius = ball.radius + offset;
            PlacedCopy::shifted(place(ball.center), [radius, radius + b.epsilon()])
        });
        let origin = [0, 1, 2].map(|axis| origin[axis] + other[axis]);
        Self::new(a, origin, grown.collect(), true)
    }

    /// A - B.
    pub fn difference(a: &'a Solid, b: &BallSolid) -> Self {
        let (origin, other) = (a.frame().origin, b.origin());
        let shrunk = b.inner().iter().map(|ball| {
            let margin = [-ball.radius - b.epsilon(), -ball.radius];
            PlacedCopy::shifted(ball.center.map(|part| -part), margin)
        });
        let origin = [0, 1, 2].map(|axis| origin[axis] - other[axis]);
        Self::new(a, origin, shrunk.collect(), false)
    }

    /// A in at least one pose, united as the product.
    pub fn product(a: &'a Solid, poses: &[Pose]) -> Self {
        Self::moved(a, poses, true)
    }

    /// A in at least one pose, intersected as the quotient.
    pub fn quotient(a: &'a Solid, poses: &[Pose]) -> Self {
        Self::moved(a, poses, false)
    }

    fn moved(a: &'a Solid, poses: &[Pose], united: bool) -> Self {
        let center = a.frame().origin;
        let origin = poses.first().map_or(center, |pose| pose.apply(center));
        let moved = poses.iter().map(|pose| {
            let place = pose.apply(center);
            PlacedCopy {
                inverse: pose.rotation.inverse(),
                shift: [0, 1, 2].map(|axis| place[axis] - origin[axis]).into(),
                margin: [0.0; 2],
            }
        });
        Self::new(a, origin, moved.collect(), united)
    }

    /// Bounds of the volume within the box of `result`, which holds the set.
    pub fn volume(&self, result: &Bracket, per_axis: usize) -> VolumeBounds {
        let Some(mut cube) = Cube::around(result.bounds()) else {
            return [0.0; 2];
        };
        for axis in 0..3 {
            cube.center[axis] += result.origin[axis] - self.origin[axis];
        }
        volume(&self.cells(&cube, budget(per_axis)))
    }

    /// Cells of the set in a cube, about `budget` of them open.
    fn cells(&self, cube: &Cube, budget: usize) -> Vec<Cell> {
        let field = |cell: &Cube, candidates: &[Candidate], is_finest: bool| {
            self.bounds(cell, candidates, is_finest)
        };
        explored(cube, &self.all(), budget, &field)
    }

    /// All copies as candidates.
    fn all(&self) -> Vec<Candidate> {
        let numbers = (0..).zip(&self.copies);
        numbers.map(|(number, _)| (number, f64::INFINITY)).collect()
    }

    /// Bounds of the function of one copy at a point; of its negative where copies are intersected, since the
    /// complement of their intersection is the union of their complements.
    fn bounds_of(&self, copy: u32, point: [f64; 3]) -> [f64; 2] {
        let copy = &self.copies[copy as usize];
        let unit = self.solid.frame().unit;
        let place: [f64; 3] = (copy.inverse * (Vector3::from(point) - copy.shift)).into();
        let [low, high] = self.solid.depth_bounds(place.map(|part| part / unit));
        let [low, high] = [low * unit + copy.margin[0], high * unit + copy.margin[1]];
        match self.united {
            true => [low, high],
            false => [-high, -low],
        }
    }

    /// Bounds of the function at the middle of a cell, and the copies that decide at any point of it.
    ///
    /// `candidates` come by falling bounds. If the largest function is q above one at the middle, or zero is, that
    /// one decides at no point of the cell.
    fn bounds(
        &self,
        cell: &Cube,
        candidates: &[Candidate],
        is_finest: bool,
    ) -> ([f64; 2], Vec<Candidate>) {
        let reach = cell.reach();
        let ahead = self
            .half_spaces
            .iter()
            .map(|(normal, farthest)| farthest - normal.dot(&Vector3::from(cell.center)));
        let ceiling = ahead.fold(f64::INFINITY, f64::min);
        let mut best = [f64::NEG_INFINITY; 2];
        let mut kept = Vec::new();
        let mut left = MAX_SEARCHED;
        for &(copy, most) in candidates {
            let needed = match is_finest {
                true => best[0],
                false => (best[0] - 2.0 * reach).max(-reach),
            };
            let most = most.min(ceiling);
            if most < needed || (is_finest && best[0] >= ceiling - 0.01 * reach) {
                best[1] = best[1].max(most);
                break;
            }
            if left == 0 && most.is_finite() {
                best[1] = best[1].max(most);
                kept.push((copy, most));
                continue;
            }
            left = left.saturating_sub(1);
            let [low, high] = self.bounds_of(copy, cell.center);
            let high = high.min(ceiling);
            best = [best[0].max(low), best[1].max(high)];
            kept.push((copy, high));
            if best[0] > reach {
                break;
            }
        }
        kept.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        match self.united {
            true => (best, kept),
            false => ([-best[1], -best[0]], kept),
        }
    }
}

/// Most copies whose depth is computed at one point; the others are taken at their bounds.
const MAX_SEARCHED: usize = 8;

/// Farthest coordinate of a mesh along a direction of length one, in its own unit.
fn support(solid: &Solid, normal: Vector3<f64>) -> f64 {
    let along = solid
        .mesh()
        .positions()
        .iter()
        .map(|&point| normal.dot(&Vector3::from(point)));
    along.fold(f64::NEG_INFINITY, f64::max)
}

/// The 26 directions to the faces, edges and corners of a cube.
fn directions() -> Vec<Vector3<f64>> {
    let all = (0..27u32).map(|number| {
        let [x, y, z] = [number % 3, number / 3 % 3, number / 9].map(|part| f64::from(part) - 1.0);
        Vector3::new(x, y, z)
    });
    all.filter_map(|direction| direction.try_normalize(0.5))
        .collect()
}

/// About the most balls that an opening or closing is known by.
const MAX_BALLS: usize = 1 << 15;
/// This many times more, and its volume has no bound.
const TOO_MANY: usize = 32;

/// Bounds of the volume of the opening of A by B.
pub fn opened_volume(a: &Solid, b: &BallSolid, per_axis: usize) -> VolumeBounds {
    let largest = b
        .inner()
        .iter()
        .max_by(|a, b| a.radius.total_cmp(&b.radius));
    let cube = of_mesh(a);
    // A translation that keeps B in A takes the largest ball's centre into the box of A.
    let around = Cube {
        center: largest.map_or([0.0; 3], |ball| ball.center.map(|part| -part)),
        ..cube
    };
    let copies = Copies::difference(a, b);
    let found = both(&around, b, 1.0, per_axis, |cube, budget| {
        copies.cells(cube, budget)
    });
    let Some([inner, outer]) = found else {
        return [0.0, f64::INFINITY];
    };
    let unit = a.frame().unit;
    let field = |cell: &Cube, _: &[Candidate], _: bool| {
        let reach = cell.reach();
        // Beyond these limits no more is known of the cell.
        let low = -inner.distance_within(cell.center, -1.01 * reach, reach);
        let mut high = -outer.distance_within(cell.center, 0.0, 2.0 * reach);
        if high >= -reach {
            let [_, depth] = a.depth_bounds(cell.center.map(|part| part / unit));
            high = high.max(low).min(depth * unit);
        }
        ([low, high], Vec::new())
    };
    volume(&explored(&cube, &[], budget(per_axis) / 4, &field))
}

/// Bounds of the volume of the closing of A by B.
pub fn closed_volume(a: &Solid, b: &BallSolid, per_axis: usize) -> VolumeBounds {
    // Half spaces are closed, so a closing is in the box of A. A ball that takes a point of it from the closing has its
    // centre t - b at most s from there.
    let cube = of_mesh(a);
    let (low, high) = bounds(b.inner());
    let away = (0..3).map(|axis| high[axis].max(-low[axis]));
    let around = Cube {
        half: cube.half + away.fold(0.0, f64::max) + b.epsilon(),
        ..cube
    };
    let copies = Copies::sum(a, b, None);
    let found = both(&around, b, -1.0, per_axis, |cube, budget| {
        let field = |cell: &Cube, candidates: &[Candidate], is_finest: bool| {
            let (bounds, kept) = copies.bounds(cell, candidates, is_finest);
            ([-bounds[1], -bounds[0]], kept)
        };
        explored(cube, &copies.all(), budget, &field)
    });
    let Some([inner, outer]) = found else {
        return [0.0, f64::INFINITY];
    };
    let unit = a.frame().unit;
    let field = |cell: &Cube, _: &[Candidate], _: bool| {
        let [depth, _] = a.depth_bounds(cell.center.map(|part| part / unit));
        let reach = cell.reach();
        let low = outer.distance_within(cell.center, 0.0, 2.0 * reach);
        let high = inner.distance_within(cell.center, -1.01 * reach, reach);
        ([low.max(depth * unit), high], Vec::new())
    };
    volume(&explored(&cube, &[], budget(per_axis) / 4, &field))
}

/// Balls that are in the sum of a set and the balls of B, times `sign`, and balls that hold it; the set is known by the
/// cells of a cube, as many as [`MAX_BALLS`] allows.
fn both(
    cube: &Cube,
    b: &BallSolid,
    sign: f64,
    per_axis: usize,
    cells: impl Fn(&Cube, usize) -> Vec<Cell>,
) -> Option<[BallTree; 2]> {
    let found = cells(
        cube,
        budget(per_axis).min(MAX_BALLS / b.inner().len().max(1)),
    );
    if found.len() * b.inner().len() > TOO_MANY * MAX_BALLS {
        return None;
    }
    let sums = |radius: &dyn Fn(&Cell) -> Option<f64>| -> BallTree {
        let balls = found.iter().filter_map(|cell| Some((cell, radius(cell)?)));
        let balls: Vec<Ball> = balls
            .flat_map(|(cell, radius)| {
                b.inner().iter().map(move |ball| Ball {
                    center: [0, 1, 2].map(|axis| cell.cube.center[axis] + sign * ball.center[axis]),
                    radius: ball.radius + radius,
                })
            })
            .collect();
        BallTree::new(&balls)
    };
    Some([
        sums(&|cell| {
            // Farther away copies may decide that do not in the cell.
            let most = match b.inner().len() {
                1 => f64::INFINITY,
                _ => cell.cube.reach(),
            };
            (cell.bounds[0] >= 0.0).then_some(cell.bounds[0].min(most))
        }),
        sums(&|cell| Some(cell.cube.reach() + b.epsilon())),
    ])
}

/// About the most open cells, which grow as an area does: 256 for each square of a grid of `per_axis` nodes an axis.
fn budget(per_axis: usize) -> usize {
    256 * per_axis.clamp(2, 256).pow(2)
}

/// A cube by its middle and half of its edge.
#[derive(Clone, Copy, Debug)]
struct Cube {
    center: [f64; 3],
    half: f64,
}

/// How much wider a cube is than its box: middles of cells are then seldom on faces along the axes.
const WIDER: f64 = 1.0137;

impl Cube {
    /// The cube about a box; `None` for the box around nothing.
    fn around((low, high): ([f64; 3], [f64; 3])) -> Option<Self> {
        let half = (0..3).map(|axis| 0.5 * (high[axis] - low[axis]));
        let half = WIDER * half.fold(f64::NEG_INFINITY, f64::max);
        (half > 0.0 && half.is_finite()).then(|| Self {
            center: [0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis])),
            half,
        })
    }

    /// Half the diagonal, rounded up.
    fn reach(&self) -> f64 {
        3f64.sqrt() * self.half * (1.0 + 1e-9)
    }

    fn eighths(&self) -> [Self; 8] {
        let half = 0.5 * self.half;
        std::array::from_fn(|corner| Self {
            center: [0, 1, 2].map(|axis| {
                let is_high = corner >> axis & 1 == 1;
                self.center[axis] + if is_high { half } else { -half }
            }),
            half,
        })
    }
}

/// The cube about a mesh, in its frame's place and the file's unit.
fn of_mesh(solid: &Solid) -> Cube {
    let half = solid.half_sides().into_iter().fold(0.0, f64::max);
    Cube {
        center: [0.0; 3],
        half: WIDER * half * solid.frame().unit,
    }
}

/// A cell that is in a set or may meet it.
struct Cell {
    cube: Cube,
    /// Bounds of the set's function at the middle.
    bounds: [f64; 2],
}

impl Cell {
    fn is_in(&self) -> bool {
        self.bounds[0] >= self.cube.reach()
    }
}

/// Levels of an octree from the bottom that one thread visits.
const TOGETHER: u32 = 3;

/// The cells of a cube that are in a set, as large as they show it, and the finest that may meet it.
fn cells<F>(cube: &Cube, candidates: Vec<Candidate>, halvings: u32, field: &F) -> Vec<Cell>
where
    F: Fn(&Cube, &[Candidate], bool) -> ([f64; 2], Vec<Candidate>) + Sync,
{
    let (bounds, mut kept) = field(cube, &candidates, halvings == 0);
    drop(candidates);
    let reach = cube.reach();
    if bounds[1] < -reach {
        return Vec::new();
    }
    if bounds[0] >= reach || halvings == 0 {
        return vec![Cell {
            cube: *cube,
            bounds,
        }];
    }
    // The middle of an eighth is half of the reach away.
    kept.iter_mut().for_each(|(_, most)| *most += 0.5 * reach);
    let below = |cube: &Cube| cells(cube, kept.clone(), halvings - 1, field);
    match halvings > TOGETHER {
        true => {
            let parts: Vec<Vec<Cell>> = cube.eighths().par_iter().map(below).collect();
            parts.into_iter().flatten().collect()
        }
        false => cube.eighths().iter().flat_map(below).collect(),
    }
}

/// Halvings of the first search, which finds the box of a set and how large its boundary is.
const COARSE: u32 = 5;
/// Most halvings of a cube.
const FINEST: u32 = 12;

/// The cells of a set within a cube, of which about `budget` are open.
fn explored<F>(cube: &Cube, candidates: &[Candidate], budget: usize, field: &F) -> Vec<Cell>
where
    F: Fn(&Cube, &[Candidate], bool) -> ([f64; 2], Vec<Candidate>) + Sync,
{
    let mut edge = 2.0 * cube.half / f64::from(1u32 << COARSE);
    let mut found = cells(cube, candidates.to_vec(), COARSE, field);
    loop {
        let open = found.iter().filter(|cell| !cell.is_in()).count();
        let corners = found.iter().map(|cell| Ball {
            center: cell.cube.center,
            radius: cell.cube.half,
        });
        let Some(mut within) = Cube::around(bounds(&corners.collect::<Vec<_>>())) else {
            return found;
        };
        if open == 0 || 4 * open > budget {
            return found;
        }
        // Cells of half the edge are four times as many on a surface.
        edge *= (open as f64 / budget as f64).sqrt().max(0.125);
        let halvings = (2.0 * within.half / edge).log2().ceil().max(0.0) as u32;
        if halvings > FINEST {
            return found;
        }
        within.half = 0.5 * edge * f64::from(1u32 << halvings);
        found = cells(&within, candidates.to_vec(), halvings, field);
    }
}

/// Bounds of the volume of a set with these cells.
fn volume(cells: &[Cell]) -> VolumeBounds {
    let mut bounds = [0.0; 2];
    for cell in cells {
        let whole = (2.0 * cell.cube.half).powi(3);
        let [low, high] = cell.bounds;
        bounds[0] += match cell.is_in() {
            true => whole,
            false => in_cube(low, cell.cube.half),
        };
        bounds[1] += whole - in_cube(-high, cell.cube.half);
    }
    bounds
}

/// Volume that a ball and a cube about one middle share, at least; zero for radii below zero.
fn in_cube(radius: f64, half: f64) -> f64 {
    // Beyond this radius the caps outside of the faces overlap.
    let radius = radius.clamp(0.0, SQRT_2 * half);
    let cap = (radius - half).max(0.0);
    4.0 / 3.0 * PI * radius.powi(3) - 2.0 * PI * cap * cap * (3.0 * radius - cap)
}
