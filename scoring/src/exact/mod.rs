//! The exact score: the pair sum over all knots in f64, with its gradient over the six degrees of freedom.
//!
//! O(ligand knots x receptor knots within reach): receptor knots are in compact blocks of eight, and of the blocks within
//! reach of a ligand knot only the knots within reach are summed. Kernels come from tables over distance
//! that follow the ranking kernel to about 1e-9 of its largest value; `unfiltered` evaluates B&I's own kernel directly.
//! Lengths in Å; positions are taken relative to the middles of the two sets, so that large file coordinates cost no
//! digits. Sums run in one fixed order.

// Loops over lanes index several arrays at once: as iterators they read worse and vectorise no better.
#![allow(clippy::needless_range_loop)]

mod gradient;
mod score;
mod tables;
#[cfg(test)]
mod tests;

use crate::blocks::Blocks;
use crate::kernel::RankingKernel;
pub use crate::rigid_move::{PoseGradient, center};
use crate::se3::Pose;
use crate::terms::effect::{ActiveTerm, Effect};
use knotdock_structures::Knots;
use knotdock_structures::knots::KnotsError;
use nalgebra::{Rotation3, Vector3};
use tables::{PairTables, PairTerm};

/// The exact score of one pose by term.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScoreTerms {
    /// The score: the sum of its terms.
    pub score: f64,
    /// The weighted terms by effect (`Effect as usize`); shape is G of the ranking kernel.
    pub terms: [f64; Effect::ALL.len()],
}

/// The parts of shape's term at one pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShapeParts {
    /// Unweighted slices at rho = 0, r0, 2 r0.
    pub slices: [f64; 3],
    /// G of B&I's own kernel, without low-pass.
    pub unfiltered: f64,
}

/// The exact score of one pose and its parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExactScore {
    /// The score: the sum of its terms.
    pub score: f64,
    /// The weighted terms by effect (`Effect as usize`); shape is G of the ranking kernel.
    pub terms: [f64; Effect::ALL.len()],
    /// Shape's unweighted slices at rho = 0, r0, 2 r0.
    pub slices: [f64; 3],
    /// G of B&I's own kernel, without low-pass.
    pub unfiltered: f64,
}

impl ExactScore {
    /// The score by term with the parts of shape.
    pub(crate) fn of(by_term: ScoreTerms, shape: ShapeParts) -> Self {
        Self {
            score: by_term.score,
            terms: by_term.terms,
            slices: shape.slices,
            unfiltered: shape.unfiltered,
        }
    }
}

/// A pair of knot sets prepared for exact scoring.
pub struct ExactScorer {
    kernel: RankingKernel,
    tables: PairTables,
    receptor: Blocks,
    /// The receptor's knots, in the order of its blocks.
    knots: Vec<ReceptorKnot>,
    /// Terms beside shape.
    effects: Vec<PairTerm>,
    receptor_center: Vector3<f64>,
    ligand: Vec<LigandKnot>,
    ligand_center: Vector3<f64>,
    /// Largest radius sum and twice the offset, Å: B&I's own kernel is 0 from there on.
    unfiltered_reach: f64,
}

#[derive(Clone, Copy)]
struct ReceptorKnot {
    weight: f64,
    /// Radius class.
    class: u32,
}

#[derive(Clone, Copy)]
struct LigandKnot {
    /// Relative to the ligand's centre, in Å.
    position: Vector3<f64>,
    weight: f64,
    class: usize,
}

impl ExactScorer {
    /// Prepares two sets of knots for shape alone.
    ///
    /// # Errors
    /// [`KnotsError`] when a set is not usable.
    pub fn new(
        kernel: &RankingKernel,
        receptor: &Knots,
        ligand: &Knots,
    ) -> Result<Self, KnotsError> {
        Self::with_effects(kernel, receptor, ligand, &[])
    }

    /// Memory of the tables in bytes, for each distinct sum of a receptor's and a ligand's radius.
    pub fn bytes_a_radius_sum(kernel: &RankingKernel) -> u64 {
        tables::bytes_of(kernel)
    }

    /// Prepares two sets of knots for shape and further terms, whose kernels must have passed the filter of `kernel`.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_effects(
        kernel: &RankingKernel,
        receptor: &Knots,
        ligand: &Knots,
        effects: &[ActiveTerm],
    ) -> Result<Self, KnotsError> {
        receptor.check()?;
        ligand.check()?;
        let receptor_center = center(receptor);
        let ligand_center = center(ligand);
        let (receptor_radii, receptor_class) = receptor.radius_classes();
        let (ligand_radii, ligand_class) = ligand.radius_classes();
        let points: Vec<Vector3<f64>> = receptor
            .centers
            .iter()
            .map(|&x| Vector3::from(x) - receptor_center)
            .collect();
        let largest = |radii: &[f64]| radii.iter().copied().fold(0.0, f64::max);
        let tables = PairTables::new(kernel, &receptor_radii, &ligand_radii);
        let unfiltered_reach =
            largest(&receptor_radii) + largest(&ligand_radii) + kernel.options().slice_offsets()[2];
        let blocks = Blocks::within(&points, kernel.reach().max(unfiltered_reach));
        Ok(Self {
            effects: effects
                .iter()
                .map(|active| PairTerm::new(active, &tables, &blocks))
                .collect(),
            tables,
            knots: blocks.arranged(|index| ReceptorKnot {
                weight: receptor.weights[index],
                class: receptor_class[index] as u32,
            }),
            receptor: blocks,
            receptor_center,
            ligand: (0..ligand.len())
                .map(|j| LigandKnot {
                    position: Vector3::from(ligand.centers[j]) - ligand_center,
                    weight: ligand.weights[j],
                    class: ligand_class[j],
                })
                .collect(),
            ligand_center,
            unfiltered_reach,
            kernel: kernel.clone(),
        })
    }

    /// The ranking kernel in use.
    pub fn kernel(&self) -> &RankingKernel {
        &self.kernel
    }

    /// Centre of the ligand in its own file frame, about which torques are taken, in Å.
    pub fn ligand_center(&self) -> Vector3<f64> {
        self.ligand_center
    }

    /// Rotation of a pose, and the ligand's centre there relative to the receptor's: differences of large file
    /// coordinates are taken first, so an offset of 1e6 Å costs no digits here.
    fn placed(&self, pose: &Pose) -> (Rotation3<f64>, Vector3<f64>) {
        debug_assert!(
            pose.translation.iter().all(|x| x.is_finite()) && pose.rotation.norm().is_finite(),
            "a pose must be finite"
        );
        let rotation = pose.rotation.to_rotation_matrix();
        let center = rotation * self.ligand_center + pose.translation - self.receptor_center;
        (rotation, center)
    }
}
