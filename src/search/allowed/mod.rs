//! Translations that distance restraints allow, at each rotation of a search.
//!
//! At a rotation R a restraint of two atoms x and y to a distance of `upper` holds if the translation t is in the ball
//! about x - R y of that radius. So a restraint is a union of balls of the grid, and a given number of restraints have to
//! hold at a voxel. Peaks are searched among those voxels alone: all poses that a run keeps can satisfy the restraints.
//!
//! # Radius of a ball
//!
//! - Sets of atoms are split into clumps of at most 4 Å about their middles, whose radii add to the ball's.
//! - The effective distance of n pairs is up to n^(1/6) times below the shortest. 64 pairs are allowed for: of larger
//!   sets only those in contact are near.
//! - A pose may be between the samples: half a voxel's diagonal from a translation, and at half of the covering radius
//!   from a rotation. The latter moves an atom by that angle times its distance from the ligand's centre. This is
//!   about the middle of the possible range; poses beyond it are found from the next sample.
//!
//! Lower bounds are left to the pose term. A membrane excludes a slab of translations ([`slab`]).

mod balls;
mod lanes;
mod region;
mod slab;

pub(crate) use region::Region;

use balls::Ball;
use knotdock_scoring::engine::{CpuEngine, Plan};
use knotdock_scoring::grid_turn::GridTurn;
use knotdock_scoring::terms::pose::{DistanceRestraints, Membrane};
use knotdock_structures::Knots;
use nalgebra::{UnitQuaternion, Vector3};
use slab::Slab;

/// Restraints on the translations of a docking.
#[derive(Clone, Copy)]
pub struct SearchRestraints<'a> {
    /// Restraints on distances between the knots.
    pub restraints: &'a DistanceRestraints,
    /// A membrane that one side stays out of.
    pub membrane: Option<&'a Membrane>,
    /// Knots of receptor and ligand.
    pub knots: [&'a Knots; 2],
}

/// Restraints as balls of translations, and a membrane as a slab of them.
#[derive(Clone, Debug)]
pub(crate) struct Allowed {
    /// The balls of each restraint, restraints of one ball first.
    restraints: Vec<Vec<Ball>>,
    /// Number of restraints that have to hold.
    needed: usize,
    membrane: Option<slab::Membrane>,
}

impl Allowed {
    /// The restraints for a plan's grid and rotations that leave `step` radians between a pose and the nearest of them;
    /// `None` without any.
    pub fn new(restraints: SearchRestraints, plan: &Plan, step: f64) -> Option<Self> {
        let SearchRestraints {
            restraints,
            membrane,
            knots,
        } = restraints;
        if restraints.list.is_empty() && membrane.is_none() {
            return None;
        }
        let centers = [plan.receptor_center(), plan.ligand_center()];
        let between = 0.5 * 3f64.sqrt() * plan.spacing();
        let list = restraints.list.iter();
        let mut restraints_of: Vec<Vec<Ball>> = list
            .map(|restraint| balls::of_restraint(restraint, knots, centers, (between, step)))
            .collect();
        restraints_of.sort_by_key(|balls| balls.len() != 1);
        let place = |membrane| slab::Membrane::new(membrane, knots, centers, (between, step));
        Some(Self {
            restraints: restraints_of,
            needed: restraints.needed,
            membrane: membrane.map(place),
        })
    }

    /// Prepares the regions of an engine's grids.
    pub fn regions<'a>(&'a self, engine: &'a CpuEngine) -> Regions<'a> {
        Regions {
            allowed: self,
            plan: engine.plan(),
            axes: GridTurn::ALL.map(|turn| Axes::of(engine, turn)),
        }
    }
}

/// Makes the regions of an engine's grids.
pub(crate) struct Regions<'a> {
    allowed: &'a Allowed,
    plan: &'a Plan,
    /// Of the grid after each turn, by its place in [`GridTurn::ALL`].
    axes: [Axes; GridTurn::ALL.len()],
}

impl Regions<'_> {
    /// The voxels of the grid at a rotation, the image of one by `turn`, at which enough restraints can hold.
    pub fn at(&self, rotation: &UnitQuaternion<f64>, turn: GridTurn, region: &mut Region) {
        let Self {
            allowed,
            plan,
            axes,
        } = self;
        let axes = &axes[turn.index()];
        region.begin(axes.counts, axes.firsts, allowed.needed);
        let (frame, matrix) = (plan.frame(), rotation.to_rotation_matrix());
        for balls in &allowed.restraints {
            region.add(balls.iter().map(|ball| {
                let center = frame * (ball.receptor - matrix * ball.ligand);
                (axes.place(&center), ball.radius / plan.spacing())
            }));
        }
        let slab = allowed.membrane.as_ref().map(|membrane| {
            let (normal, bounds) = membrane.at(&matrix);
            let along_axes = frame * normal;
            Slab::new(
                along_axes * plan.spacing(),
                bounds,
                along_axes.dot(&Vector3::from(axes.lows)),
            )
        });
        region.close(slab);
    }
}

/// Coordinates of the voxels of a periodic grid: their indices in the order of their coordinates.
struct Axes {
    counts: [usize; 3],
    /// Index of the voxel with the lowest coordinate on each axis.
    firsts: [usize; 3],
    /// That coordinate along the grid's axis, Å.
    lows: [f64; 3],
    spacing: f64,
}

impl Axes {
    fn of(engine: &CpuEngine, turn: GridTurn) -> Self {
        let plan = engine.plan();
        let counts = plan.size();
        let strides = [counts[1] * counts[2], counts[2], 1];
        let (mut firsts, mut lows) = ([0; 3], [0.0; 3]);
        for axis in 0..3 {
            let place = |index: usize| {
                let along_file = engine.position_after(turn, index * strides[axis]);
                (plan.frame() * along_file)[axis]
            };
            let lowest = (0..counts[axis]).map(|index| (place(index), index));
            let lowest = lowest.min_by(|a, b| a.0.total_cmp(&b.0));
            (lows[axis], firsts[axis]) = lowest.unwrap_or_default();
        }
        Self {
            counts,
            firsts,
            lows,
            spacing: plan.spacing(),
        }
    }

    /// A place along the grid's axes in voxels from the lowest one.
    fn place(&self, x: &Vector3<f64>) -> [f64; 3] {
        [0, 1, 2].map(|axis| (x[axis] - self.lows[axis]) / self.spacing)
    }
}

#[cfg(test)]
mod tests;
