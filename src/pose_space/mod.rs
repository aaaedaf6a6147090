//! The poses that a run may have: free ones, rings (Cn), and two rings about each other (Dn).
//!
//! All that differs between the three is in [`PoseSpace`]. It holds the rotations to sample, the voxels that count,
//! how a pose is refined, and which copies a pose stands for. [`Arrangement`](arrangement::Arrangement) is the part
//! of it that the options alone decide.

pub mod arrangement;
pub(crate) mod axes;
pub(crate) mod refine;
mod ring;
pub(crate) mod rotations;
mod voxel_filter;

use axes::{axes_radius, axis_set};
use knotdock_scoring::engine::{CpuEngine, Plan, PlanError};
use knotdock_scoring::exact_sum::ExactSum;
use knotdock_scoring::grid_turn::GridTurn;
use knotdock_scoring::potential_grid::PotentialGrid;
use knotdock_scoring::se3::Pose;
use knotdock_scoring::so3::{covering_radius, rotation_set, set_name, spiral_set};
use knotdock_scoring::symmetry::{RingAxis, Symmetry};
use knotdock_structures::Knots;
use nalgebra::{Unit, UnitQuaternion, Vector3};
use refine::{AscentLimits, RefinedPose, printed};
use rotations::RotationSample;
use voxel_filter::VoxelFilter;

/// The poses that a run searches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PoseSpace {
    /// A ligand at any orientation and place.
    Free,
    /// Copies of one molecule about an axis, which may be any.
    Cyclic(Symmetry),
    /// Two rings of copies, about axes across the molecule's own.
    Dihedral(Symmetry, RingAxis),
}

impl PoseSpace {
    /// The space of a symmetry; `axis` is that of the molecule's own ring, of Dn.
    pub fn new(symmetry: Option<Symmetry>, axis: Option<RingAxis>) -> Self {
        match (symmetry, axis) {
            (None, _) => Self::Free,
            (Some(symmetry), None) => Self::Cyclic(symmetry),
            (Some(symmetry), Some(axis)) => Self::Dihedral(symmetry, axis),
        }
    }

    fn symmetry(&self) -> Option<Symmetry> {
        match self {
            Self::Free => None,
            Self::Cyclic(symmetry) | Self::Dihedral(symmetry, _) => Some(*symmetry),
        }
    }

    fn axis(&self) -> Option<&RingAxis> {
        match self {
            Self::Dihedral(_, axis) => Some(axis),
            _ => None,
        }
    }

    /// Rotations that share a transform of the ligand: they differ by turns of the grid.
    pub fn images(&self, plan: &Plan) -> usize {
        match self {
            Self::Free => GridTurn::of(plan.modes()).len(),
            // A ring's rotation that is turned forms no ring.
            _ => 1,
        }
    }

    /// The plan on the grid that serves the space best: turned to fit the receptor, if any rotation is searched.
    pub fn grid_of(&self, plan: Plan, receptor: &Knots) -> Result<Plan, PlanError> {
        match self {
            Self::Free => plan.fitted(receptor),
            // Voxels of rings are found by planes along the file's axes.
            _ => Ok(plan),
        }
    }

    /// `count` rotations (one per axis of a ring), and `fine` of a finer set, for a plan's grid.
    pub fn rotations(&self, plan: &Plan, (count, fine): (usize, Option<usize>)) -> RotationSample {
        let images = self.images(plan);
        let of_axes = |symmetry: Symmetry, axes: Vec<Unit<Vector3<f64>>>, name, covering_radius| {
            RotationSample {
                coarse: axes.iter().map(|axis| symmetry.rotation(axis)).collect(),
                fine: Vec::new(),
                images,
                name,
                covering_radius,
            }
        };
        match self {
            Self::Free => {
                // Sets are closed under turns of the grid, and rotations are of the files.
                let back = plan.frame().inverse();
                let of_files = |set: Vec<UnitQuaternion<f64>>| -> Vec<_> {
                    set.into_iter().map(|rotation| back * rotation).collect()
                };
                let coarse = rotation_set(count);
                RotationSample {
                    covering_radius: covering_radius(&coarse),
                    coarse: of_files(coarse),
                    fine: of_files(fine.map_or_else(Vec::new, spiral_set)),
                    images,
                    name: set_name(count),
                }
            }
            Self::Cyclic(symmetry) => {
                let axes = axis_set(count);
                let radius = axes_radius(&axes);
                of_axes(*symmetry, axes, "axes over a half sphere", radius)
            }
            Self::Dihedral(symmetry, axis) => of_axes(
                *symmetry,
                axis.across(count),
                "axes across the ring's own",
                axis.half_step(count),
            ),
        }
    }

    /// Largest rotation in radians between a pose and the nearest sampled one, for a set of this covering radius.
    ///
    /// A copy in a ring turns by up to twice as much as the axis.
    pub fn step(&self, covering_radius: f64) -> f64 {
        match self {
            Self::Free => covering_radius,
            _ => 2.0 * covering_radius,
        }
    }

    /// The filter of the voxels that count; `None` if all do.
    pub(crate) fn voxel_filter(&self, engine: &CpuEngine) -> Option<VoxelFilter> {
        match self {
            Self::Free => None,
            _ => Some(VoxelFilter::new(engine, self.axis().copied())),
        }
    }

    /// Whether the grid's poses are in the space as they are. Rings are between its points.
    pub fn is_on_grid(&self) -> bool {
        matches!(self, Self::Free)
    }

    /// The pose of the space that is nearest to one of the grid.
    pub fn nearest(&self, pose: &Pose) -> Pose {
        match self {
            Self::Free => *pose,
            Self::Cyclic(symmetry) => symmetry.nearest(pose),
            Self::Dihedral(_, axis) => axis.nearest(pose),
        }
    }

    /// Refines a pose of the grid by the fast path's values; `score` is the grid's value there.
    pub(crate) fn refined(
        &self,
        field: &PotentialGrid,
        center: Vector3<f64>,
        (pose, score): (&Pose, f64),
        limits: &AscentLimits,
    ) -> RefinedPose {
        let Some(symmetry) = self.symmetry() else {
            let gradient = |pose: &Pose| field.gradient(pose);
            let moved = refine::rigid_body(center);
            let (top, higher) = refine::maximize(*pose, center, limits, gradient, moved);
            return RefinedPose::best_of((printed(pose), score), Some((printed(&top), higher)));
        };
        let start = self.nearest(pose);
        let (top, score) = ring::maximum((symmetry, self.axis()), field, center, start, limits);
        RefinedPose {
            start: printed(&start),
            // Rounding adds up over the steps.
            pose: printed(&self.nearest(&top)),
            score,
            refined: true,
        }
    }

    /// Exact score between copies that are no neighbours, for each pair of neighbours; `None` if all are.
    pub fn other_copies(&self, scorer: &ExactSum, pose: &Pose) -> Option<f64> {
        ring::other_copies(self.symmetry()?, scorer, pose)
    }

    /// The equivalents of a pose of the space.
    pub(crate) fn equivalents(&self) -> Equivalents {
        match self {
            Self::Free => Equivalents::None,
            Self::Cyclic(_) => Equivalents::Inverse,
            Self::Dihedral(_, axis) => Equivalents::Rotated(axis.turns().collect()),
        }
    }

    /// The word for `count` samples.
    pub fn sampled(&self, count: usize) -> String {
        match self.symmetry() {
            Some(symmetry) => format!("axes of {symmetry}"),
            None if count == 1 => "rotation".to_owned(),
            None => "rotations".to_owned(),
        }
    }
}

/// Poses that describe the same complex as a pose M.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Equivalents {
    /// No others.
    None,
    /// Its inverse: a ring with its copies counted the other way.
    Inverse,
    /// M after a rotation of the body onto itself: a second ring with its copies counted from another one.
    Rotated(Vec<Pose>),
}

impl Equivalents {
    /// The pose and all its equivalents, itself first.
    pub fn of(&self, pose: &Pose) -> impl Iterator<Item = Pose> {
        let (inverse, rotations) = match self {
            Self::None => (None, &[] as &[Pose]),
            Self::Inverse => (Some(pose.inverse()), &[] as &[Pose]),
            Self::Rotated(rotations) => (None, &rotations[..]),
        };
        let rotated = rotations.iter().map(|rotation| pose.after(rotation));
        std::iter::once(*pose).chain(inverse).chain(rotated)
    }
}
