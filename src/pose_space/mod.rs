//! The poses that a run may have: free ones, rings (Cn), and two rings about each other (Dn).
//!
//! All that differs between the three is in [`PoseSpace`]. It holds the rotations to sample, the voxels that count,
//! how a pose is refined, and which copies a pose stands for. [`Arrangement`](arrangement::Arrangement) is the part
//! of it that the options alone decide.

pub mod arrangement;
pub mod axes;
pub mod equivalents;
pub mod refine;
mod ring;
pub mod rotations;
mod voxel_filter;

use axes::{axes_radius, axis_set};
use equivalents::Equivalents;
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
            // A ring's rotation that is turned forms no ring.
            Self::Cyclic(_) | Self::Dihedral(..) => 1,
            Self::Free => GridTurn::of(plan.modes()).len(),
        }
    }

    /// The plan on the grid that serves the space best: turned to fit the receptor, where any rotation is searched.
    ///
    /// # Errors
    /// [`PlanError`] where a grid is too large.
    pub fn grid_of(&self, plan: Plan, receptor: &Knots) -> Result<Plan, PlanError> {
        match self {
            Self::Free => plan.fitted(receptor),
            // Voxels of rings are found by planes along the file's axes.
            Self::Cyclic(_) | Self::Dihedral(..) => Ok(plan),
        }
    }

    /// `count` rotations, of rings one an axis, and `fine` of a finer set, for a plan's grid.
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

    /// The filter of the voxels that count; `None` where all do.
    pub(crate) fn voxel_filter(&self, engine: &CpuEngine) -> Option<VoxelFilter> {
        match self {
            Self::Free => None,
            _ => Some(VoxelFilter::new(engine, self.axis().copied())),
        }
    }

    /// Whether the grid's poses are in the space as they are. Rings lie between its points.
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
            let top = refine::rigid_body_maximum(field, center, pose, limits);
            let (top, higher) = top;
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

    /// Exact score between copies that are no neighbours, for each pair of neighbours; `None` where all are.
    pub fn other_copies(&self, scorer: &ExactSum, pose: &Pose) -> Option<f64> {
        ring::other_copies(self.symmetry()?, scorer, pose)
    }

    /// Poses that are one with a pose of the space.
    pub fn equivalents(&self) -> Equivalents {
        match self {
            Self::Free => Equivalents::None,
            Self::Cyclic(_) => Equivalents::Inverse,
            Self::Dihedral(_, axis) => Equivalents::Rotated(axis.turns().collect()),
        }
    }

    /// What is sampled, as text calls `count` of it.
    pub fn sampled(&self, count: usize) -> String {
        match self.symmetry() {
            Some(symmetry) => format!("axes of {symmetry}"),
            None if count == 1 => "rotation".to_owned(),
            None => "rotations".to_owned(),
        }
    }
}
