//! The engine on CPU cores: per rotation q pruned forward transforms, one product, one inverse transform.
//!
//! G^(w) = sum_q U_q(w) conj(B_q(w)), B_q the transform of the ligand's knots weighted by d_j V_q(s_j). U holds
//! everything that does not turn: the receptor's transform, the lifted kernel, both windows' deconvolution and 1 /
//! volume.
//!
//! Turns that map the grid onto itself map its modes onto themselves, so one ligand transform serves four rotations, or
//! eight ([`GridTurn`]). With F the turn, B(w; F R) = B(F^-1 w; R): another reading of the same columns.

mod inverse;
mod transforms;

pub(in crate::engine) use inverse::{SIDE, slab_length};
pub(in crate::engine) use transforms::{Transforms, ligand_forward};

use super::plan::Plan;
use super::receptor_spectra::{Factors, ReceptorSpectra};
use crate::grid_turn::GridTurn;
use crate::peaks::{Rows, ScoreGrid};
use crate::precision::{InPrecision, Precision, in_precision, of_precision};
use knotdock_structures::Knots;
use nalgebra::{UnitQuaternion, Vector3};
use std::sync::Arc;
use transforms::Buffers;

/// Columns that go through the x transforms together.
pub(super) const COLUMNS: usize = 8;

/// Images that go through the products and inverse transforms together at the most: more would not share a column.
pub const TOGETHER: usize = 4;

/// A prepared correlation of one pair.
pub struct CpuEngine(pub(super) InPrecision<Transforms<f32>, Transforms<f64>>);

/// Buffers of one rotation in flight; nothing is allocated after this.
pub struct Workspace {
    buffers: InPrecision<Buffers<f32>, Buffers<f64>>,
    /// Images that go through together, at the most.
    images: usize,
    /// Scores of all translations.
    pub scores: ScoreGrid,
}

/// Calls a method of an engine's transforms with a workspace's buffers and grid, which are of the same precision.
macro_rules! on_buffers {
    ($engine:expr, $work:expr, ($transforms:ident, $buffers:ident, $grid:ident) => $result:expr) => {
        match (&$engine.0, &mut $work.buffers, &mut $work.scores.0) {
            (
                InPrecision::Single($transforms),
                InPrecision::Single($buffers),
                InPrecision::Single($grid),
            ) => $result,
            (
                InPrecision::Double($transforms),
                InPrecision::Double($buffers),
                InPrecision::Double($grid),
            ) => $result,
            _ => unreachable!("the workspace is of an engine of another precision"),
        }
    };
}

impl CpuEngine {
    /// Prepares the engine at a rank of the lifted axis (1 to `receptor.full_rank()`), in the precision of the spectra.
    pub fn new(plan: Arc<Plan>, receptor: &ReceptorSpectra, ligand: &Knots, rank: usize) -> Self {
        let factors = receptor.factor(plan.modes());
        Self::with_factors(plan, receptor, &factors, ligand, rank)
    }

    /// As [`Self::new`], with factors that are at hand.
    pub(super) fn with_factors(
        plan: Arc<Plan>,
        receptor: &ReceptorSpectra,
        factors: &Factors,
        ligand: &Knots,
        rank: usize,
    ) -> Self {
        let rank = rank.clamp(1, receptor.full_rank());
        Self(in_precision!(&receptor.spectra, spectra => {
            Transforms::new(plan, spectra, receptor.center, factors, ligand, rank)
        }))
    }

    /// The engine that [`Self::new`] makes at a lower rank, to the bit: its first components are these.
    #[must_use]
    pub fn truncated(&self, rank: usize) -> Self {
        Self(in_precision!(&self.0, transforms => transforms.truncated(rank)))
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        of_precision!(&self.0, transforms => &transforms.plan)
    }

    /// Floating-point type of its transforms.
    pub fn precision(&self) -> Precision {
        self.0.precision()
    }

    /// Rank q of the lifted axis in use.
    pub fn rank(&self) -> usize {
        of_precision!(&self.0, transforms => transforms.rank())
    }

    /// All singular values of the lifted axis as shares of the largest.
    pub fn singular(&self) -> &[f64] {
        of_precision!(&self.0, transforms => &transforms.singular)
    }

    /// Turns that map the grid onto itself: the half-turns, and quarter turns where the box allows.
    pub fn turns(&self) -> &'static [GridTurn] {
        GridTurn::of(self.plan().modes())
    }

    /// Buffers for one rotation at a time.
    pub fn workspace(&self) -> Workspace {
        self.workspace_of(1)
    }

    /// Buffers for a number of images of a rotation together, `TOGETHER` at most.
    pub fn workspace_of(&self, images: usize) -> Workspace {
        let images = images.clamp(1, TOGETHER);
        let size = self.plan().size();
        Workspace {
            buffers: in_precision!(&self.0, transforms => transforms.buffers(images)),
            images,
            scores: ScoreGrid(in_precision!(&self.0, _ => Rows::new(size))),
        }
    }

    /// Position of the ligand's centre relative to the receptor's, in Å along the axes of the receptor's file, for a voxel
    /// of the grid that `turn` gave.
    pub fn position_after(&self, turn: GridTurn, voxel: usize) -> Vector3<f64> {
        of_precision!(&self.0, transforms => transforms.position_after(turn, voxel))
    }

    /// [`Self::position_after`] no turn.
    pub fn position(&self, voxel: usize) -> Vector3<f64> {
        self.position_after(GridTurn::NONE, voxel)
    }

    /// G over all translations at one rotation, into `work.scores`.
    pub fn correlate(&self, rotation: &UnitQuaternion<f64>, work: &mut Workspace) {
        self.transform_ligand(rotation, work);
        self.correlate_turned(GridTurn::NONE, work);
    }

    /// Turns the ligand: its transform at `rotation`, which [`Self::correlate_each`] then reads for each turn of the grid.
    pub fn transform_ligand(&self, rotation: &UnitQuaternion<f64>, work: &mut Workspace) {
        on_buffers!(self, work, (transforms, buffers, _grid) => {
            transforms.transform_ligand(rotation, buffers)
        });
    }

    /// G over all translations at the rotation last turned to, followed by each of `turns`, which must be of
    /// [`Self::turns`]. `visit` gets one grid after the other, with its place among `turns`.
    pub fn correlate_each(
        &self,
        turns: &[GridTurn],
        work: &mut Workspace,
        visit: &mut dyn FnMut(usize, &mut ScoreGrid),
    ) {
        let together = work.images;
        for (group, turns) in turns.chunks(together).enumerate() {
            on_buffers!(self, work, (transforms, buffers, _grid) => {
                transforms.products(turns, buffers)
            });
            for image in 0..turns.len() {
                on_buffers!(self, work, (transforms, buffers, grid) => {
                    transforms.image(image, buffers, grid)
                });
                visit(group * together + image, &mut work.scores);
            }
        }
    }

    /// [`Self::correlate_each`] of one turn.
    pub fn correlate_turned(&self, turn: GridTurn, work: &mut Workspace) {
        self.correlate_each(&[turn], work, &mut |_, _| ());
    }

    /// Seconds of each stage of a rotation: spreading, forward planes, forward columns (these three serve all images); then
    /// for one image the product with the inverse along x, and that along y and z.
    pub fn stage_seconds(&self, rotation: &UnitQuaternion<f64>, work: &mut Workspace) -> [f64; 5] {
        let mut last = std::time::Instant::now();
        let mut lap = || {
            let now = std::time::Instant::now();
            let seconds = now.duration_since(last).as_secs_f64();
            last = now;
            seconds
        };
        let mut seconds = [0.0; 5];
        on_buffers!(self, work, (transforms, buffers, grid) => {
            transforms.spread(rotation, buffers);
            seconds[0] = lap();
            for component in 0..transforms.rank() {
                transforms.planes(component, buffers);
                seconds[1] += lap();
                transforms.columns(component, buffers);
                seconds[2] += lap();
            }
            let count = self.turns().len() as f64;
            for turns in self.turns().chunks(work.images) {
                transforms.products(turns, buffers);
                seconds[3] += lap() / count;
                for image in 0..turns.len() {
                    transforms.image(image, buffers, grid);
                }
                seconds[4] += lap() / count;
            }
        });
        seconds
    }
}
