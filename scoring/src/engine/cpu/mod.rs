//! The engine on CPU cores: per rotation q pruned forward transforms, one product, one inverse transform.
//!
//! G^(w) = sum_q U_q(w) conj(B_q(w)), B_q the transform of the ligand's knots weighted by d_j V_q(s_j). U holds
//! everything that does not turn: the receptor's transform, the lifted kernel, both windows' deconvolution and 1 /
//! volume.
//!
//! Turns that map the grid onto itself map its modes onto themselves, so one ligand transform serves four rotations, or
//! eight ([`GridTurn`]). With F the turn, B(w; F R) = B(F^-1 w; R): another reading of the same columns.

mod forward;
mod inverse;

pub(in crate::engine) use inverse::SIDE;

use super::columns::Reading;
use super::packed::{LANES, Packet, Packing};
use super::plan::Plan;
use crate::grid_turn::GridTurn;
use crate::transform::Real;
use crate::transform::pruned_type1::{Forward, ForwardWorkspace};
use crate::vectorized::vectorized;
use nalgebra::{UnitQuaternion, Vector3};
use num_complex::Complex;
use rustfft::Fft;
use std::sync::Arc;

/// Columns that go through the x transforms together.
pub(super) const COLUMNS: usize = 8;
/// Planes kz that go through the y transforms together: a cache line of the spectrum's rows.
pub(super) const PLANES: usize = 8;

/// Images that go through the products and inverse transforms together at the most: more would not share a column.
pub const TOGETHER: usize = 4;

/// A prepared correlation of one pair.
pub struct CpuEngine<T: Real> {
    pub(super) plan: Arc<Plan>,
    pub(super) forward: Forward<T>,
    pub(super) packing: Packing,
    /// U, packed.
    pub(super) spectra: Vec<Packet<T>>,
    /// d_j V_q(s_j): [knot][component].
    pub(super) weights: Vec<T>,
    /// Ligand knots relative to the ligand's centre, Å.
    pub(super) ligand: Vec<Vector3<f64>>,
    /// Place of the ligand's centre in its own block, and of the receptor's in its, Å.
    pub(super) block_center: [f64; 3],
    pub(super) receptor_center: [f64; 3],
    /// Where the columns are read, for each turn that maps the modes onto themselves.
    pub(super) readings: Arc<[Vec<Reading>]>,
    pub(super) inverse_x: Arc<dyn Fft<T>>,
    pub(super) inverse_y: Arc<dyn Fft<T>>,
    pub(super) inverse_z: Arc<dyn Fft<T>>,
    /// Singular values of the lifted axis in use, as shares of the largest.
    pub(super) singular: Vec<f64>,
}

/// Buffers of one rotation in flight; nothing is allocated after this.
pub struct Workspace<T> {
    forward: ForwardWorkspace<T>,
    points: Vec<[f64; 3]>,
    /// [column][kx], with room for a packet before and after.
    lines: Vec<Complex<T>>,
    /// The turned ligand's transform, packed like the engine's spectra.
    turned: Vec<Packet<T>>,
    /// Products of a column.
    sums: Vec<Packet<T>>,
    /// [image][column][x].
    product: Vec<Complex<T>>,
    scratch: Vec<Complex<T>>,
    /// [image][kz in block][x][y].
    planes: Vec<Complex<T>>,
    /// [image][x][pair of y][kz]: two rows' spectra as one, A + iB.
    rows: Vec<Complex<T>>,
    /// Images that go through together, at the most.
    images: usize,
    /// Scores, (nx, ny, nz) row-major.
    pub grid: Vec<T>,
    /// Largest score of each row (x, y).
    pub row_best: Vec<T>,
}

impl<T: Real> CpuEngine<T> {
    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Rank q of the lifted axis in use.
    pub fn rank(&self) -> usize {
        self.forward.components()
    }

    /// All singular values of the lifted axis as shares of the largest.
    pub fn singular(&self) -> &[f64] {
        &self.singular
    }

    /// U of one column and component with kx rising.
    #[cfg(feature = "gpu")]
    pub(super) fn spectrum(
        &self,
        column: usize,
        component: usize,
    ) -> impl Iterator<Item = Complex<T>> + '_ {
        let packets = &self.spectra[self.packing.range(column, self.rank())];
        let (up, down) = packets.split_at(packets.len() / 2);
        let value = move |half: &[Packet<T>], k: usize| {
            half[k / LANES * self.rank() + component].get(k % LANES)
        };
        let side = self.plan.modes().columns[column].kx_max as usize;
        let falling = (1..=side).rev().map(move |k| value(down, k));
        falling.chain((0..=side).map(move |k| value(up, k)))
    }

    /// Turns that map the grid onto itself: the half-turns, and quarter turns where the box allows.
    pub fn turns(&self) -> &'static [GridTurn] {
        &GridTurn::ALL[..self.readings.len()]
    }

    /// Buffers for one rotation at a time.
    pub fn workspace(&self) -> Workspace<T> {
        self.workspace_of(1)
    }

    /// Buffers for so many images of a rotation together, [`TOGETHER`] at most.
    pub fn workspace_of(&self, images: usize) -> Workspace<T> {
        let images = images.clamp(1, TOGETHER);
        let [nx, ny, nz] = self.plan.modes().size;
        let zero = Complex::new(T::zero(), T::zero());
        let scratch = self
            .inverse_x
            .get_inplace_scratch_len()
            .max(self.inverse_y.get_inplace_scratch_len())
            .max(self.inverse_z.get_inplace_scratch_len());
        Workspace {
            forward: self.forward.workspace(),
            points: vec![[0.0; 3]; self.ligand.len()],
            lines: vec![zero; COLUMNS * self.forward.line_length() + 2 * LANES],
            turned: vec![Packet::zero(); self.spectra.len()],
            sums: vec![Packet::zero(); 2 * (nx / 2).div_ceil(LANES)],
            product: vec![zero; images * 2 * SIDE * nx],
            scratch: vec![zero; scratch],
            planes: vec![zero; images * PLANES * nx * ny],
            rows: vec![zero; images * nx * ny / 2 * nz],
            images,
            grid: vec![T::zero(); nx * ny * nz],
            row_best: vec![T::zero(); nx * ny],
        }
    }

    /// Position of the ligand's centre relative to the receptor's for a voxel of the grid that `turn` gave, in Å, in the
    /// box centred on the receptor, along the axes of the receptor's file.
    pub fn position_after(&self, turn: GridTurn, voxel: usize) -> Vector3<f64> {
        let [_, ny, nz] = self.plan.modes().size;
        let index = [voxel / (ny * nz), voxel / nz % ny, voxel % nz];
        // The block turns with the ligand in it.
        let block_center = turn.apply(self.block_center);
        let along_grid = Vector3::from([0, 1, 2].map(|axis| {
            let length = self.plan.modes().lengths[axis];
            let t = index[axis] as f64 * self.plan.spacing() + block_center[axis]
                - self.receptor_center[axis];
            t - length * (t / length + 0.5).floor()
        }));
        self.plan.frame().inverse() * along_grid
    }

    /// [`Self::position_after`] no turn.
    pub fn position(&self, voxel: usize) -> Vector3<f64> {
        self.position_after(GridTurn::NONE, voxel)
    }

    /// G over all translations at one rotation, into `work.grid`, and each row's best into `work.row_best`.
    pub fn correlate(&self, rotation: &UnitQuaternion<f64>, work: &mut Workspace<T>) {
        self.transform_ligand(rotation, work);
        self.correlate_turned(GridTurn::NONE, work);
    }

    /// Turns the ligand: its transform at `rotation`, which [`Self::correlate_each`] then reads for each turn of the grid.
    pub fn transform_ligand(&self, rotation: &UnitQuaternion<f64>, work: &mut Workspace<T>) {
        vectorized(
            #[inline(always)]
            || {
                self.spread(rotation, work);
                for component in 0..self.rank() {
                    self.forward.planes(component, &mut work.forward);
                    self.columns(component, work);
                }
            },
        );
    }

    /// G over all translations at the rotation last turned to, followed by each of `turns`, which must be of
    /// [`Self::turns`]. One after the other is in `work.grid`, with each row's best in `work.row_best`, when `visit` is
    /// called with its place among `turns`.
    pub fn correlate_each(
        &self,
        turns: &[GridTurn],
        work: &mut Workspace<T>,
        mut visit: impl FnMut(usize, &mut Workspace<T>),
    ) {
        let together = work.images;
        for (group, turns) in turns.chunks(together).enumerate() {
            vectorized(
                #[inline(always)]
                || self.multiply(turns, work),
            );
            for image in 0..turns.len() {
                vectorized(
                    #[inline(always)]
                    || self.rows_to_grid(image, work),
                );
                visit(group * together + image, work);
            }
        }
    }

    /// [`Self::correlate_each`] of one turn.
    pub fn correlate_turned(&self, turn: GridTurn, work: &mut Workspace<T>) {
        self.correlate_each(&[turn], work, |_, _| ());
    }

    /// Time in seconds of each stage of one rotation and its images: spreading, forward planes, forward columns (these
    /// three serve all images), product with the inverse along x and y, and rows (both for one image).
    pub fn stage_seconds(
        &self,
        rotation: &UnitQuaternion<f64>,
        work: &mut Workspace<T>,
    ) -> [f64; 5] {
        let mut last = std::time::Instant::now();
        let mut lap = || {
            let now = std::time::Instant::now();
            let seconds = now.duration_since(last).as_secs_f64();
            last = now;
            seconds
        };
        vectorized(
            #[inline(always)]
            || self.spread(rotation, work),
        );
        let spread = lap();
        let (mut planes, mut columns) = (0.0, 0.0);
        for component in 0..self.rank() {
            vectorized(
                #[inline(always)]
                || self.forward.planes(component, &mut work.forward),
            );
            planes += lap();
            vectorized(
                #[inline(always)]
                || self.columns(component, work),
            );
            columns += lap();
        }
        let (mut product, mut rows) = (0.0, 0.0);
        let count = self.turns().len();
        for turns in self.turns().chunks(work.images) {
            vectorized(
                #[inline(always)]
                || self.multiply(turns, work),
            );
            product += lap() / count as f64;
            for image in 0..turns.len() {
                vectorized(
                    #[inline(always)]
                    || self.rows_to_grid(image, work),
                );
            }
            rows += lap() / count as f64;
        }
        [spread, planes, columns, product, rows]
    }
}
