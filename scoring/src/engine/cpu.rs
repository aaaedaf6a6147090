//! The engine on CPU cores: per rotation q pruned forward transforms, one product, one inverse transform.
//!
//! G^(w) = sum_q U_q(w) conj(B_q(w)), B_q the transform of the ligand's knots weighted by d_j V_q(s_j). U holds
//! everything that does not turn: the receptor's transform, the lifted kernel, both windows' deconvolution and 1 /
//! volume.
//!
//! A half-turn about a grid axis maps the modes onto themselves, so one ligand transform serves four rotations. With F
//! the half-turn, B(w; F R) = B(F w; R): a mirrored or conjugated reading of the same columns. Columns are multiplied
//! and transformed back along x while they lie in the first-level cache.

use super::columns::Reading;
use super::packed::{LANES, Packet, Packing, reversed};
use super::plan::Plan;
use crate::se3::HalfTurn;
use crate::transform::Real;
use crate::transform::modes::place;
use crate::transform::pruned_type1::{Forward, ForwardWorkspace};
use crate::vectorized::vectorized;
use nalgebra::{UnitQuaternion, Vector3};
use num_complex::Complex;
use rustfft::Fft;
use std::sync::{Arc, OnceLock};

/// Columns that go through the x transforms together.
pub(super) const COLUMNS: usize = 8;
/// Planes kz that go through the y transforms together: a cache line of the spectrum's rows.
pub(super) const PLANES: usize = 8;

/// A prepared correlation of one pair.
pub struct CpuEngine<T: Real> {
    pub(super) plan: Arc<Plan>,
    pub(super) forward: Forward<T>,
    pub(super) packing: Packing,
    /// U, packed.
    pub(super) spectra: Vec<Packet<T>>,
    /// U with kx falling in each column, made when a half-turn first asks for it.
    pub(super) reversed: OnceLock<Vec<Packet<T>>>,
    /// d_j V_q(s_j): [knot][component].
    pub(super) weights: Vec<T>,
    /// Ligand knots relative to the ligand's centre, Å.
    pub(super) ligand: Vec<Vector3<f64>>,
    /// Place of the ligand's centre in its own block, and of the receptor's in its, Å.
    pub(super) block_center: [f64; 3],
    pub(super) receptor_center: [f64; 3],
    /// For each column the one with -ky.
    pub(super) mirrors: Vec<u32>,
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
    lines: Vec<Complex<T>>,
    /// The turned ligand's transform, packed like the engine's spectra.
    turned: Vec<Packet<T>>,
    /// One column with kx rising, and what fills its last packet.
    column: Vec<Complex<T>>,
    product: Vec<Complex<T>>,
    scratch: Vec<Complex<T>>,
    /// [kz in block][x][y].
    planes: Vec<Complex<T>>,
    /// [x][pair of y][kz]: two rows' spectra as one, A + iB.
    rows: Vec<Complex<T>>,
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

    /// U of one column and component with kx rising; what fills the last packet follows.
    #[cfg(feature = "gpu")]
    pub(super) fn spectrum(
        &self,
        column: usize,
        component: usize,
    ) -> impl Iterator<Item = Complex<T>> + '_ {
        let packets = &self.spectra[self.packing.range(column, self.rank())];
        let packets = packets[component..].iter().step_by(self.rank());
        packets.flat_map(|packet| (0..LANES).map(|lane| packet.get(lane)))
    }

    /// Buffers for one rotation at a time.
    pub fn workspace(&self) -> Workspace<T> {
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
            lines: vec![zero; COLUMNS * self.rank() * self.forward.line_length()],
            turned: vec![Packet::zero(); self.spectra.len()],
            column: vec![zero; nx.next_multiple_of(LANES)],
            product: vec![zero; COLUMNS * nx],
            scratch: vec![zero; scratch],
            planes: vec![zero; PLANES * nx * ny],
            rows: vec![zero; nx * ny / 2 * nz],
            grid: vec![T::zero(); nx * ny * nz],
            row_best: vec![T::zero(); nx * ny],
        }
    }

    /// Position of the ligand's centre relative to the receptor's for a voxel of the grid that `half_turn` gave, in Å,
    /// in the box centred on the receptor.
    pub fn position_after(&self, half_turn: HalfTurn, voxel: usize) -> Vector3<f64> {
        let [_, ny, nz] = self.plan.modes().size;
        let index = [voxel / (ny * nz), voxel / nz % ny, voxel % nz];
        // The block turns with the ligand in it.
        let signs = half_turn.signs();
        Vector3::from([0, 1, 2].map(|axis| {
            let length = self.plan.modes().lengths[axis];
            let t = index[axis] as f64 * self.plan.spacing()
                + signs[axis] * self.block_center[axis]
                - self.receptor_center[axis];
            t - length * (t / length + 0.5).floor()
        }))
    }

    /// [`Self::position_after`] no half-turn.
    pub fn position(&self, voxel: usize) -> Vector3<f64> {
        self.position_after(HalfTurn::None, voxel)
    }

    /// G over all translations at one rotation, into `work.grid`, and each row's best into `work.row_best`.
    pub fn correlate(&self, rotation: &UnitQuaternion<f64>, work: &mut Workspace<T>) {
        self.transform_ligand(rotation, work);
        self.correlate_turned(HalfTurn::None, work);
    }

    /// Turns the ligand: its transform at `rotation`, which [`Self::correlate_turned`] then reads for each half-turn.
    pub fn transform_ligand(&self, rotation: &UnitQuaternion<f64>, work: &mut Workspace<T>) {
        vectorized(
            #[inline(always)]
            || {
                self.spread(rotation, work);
                self.forward.planes(&mut work.forward);
                self.columns(work);
            },
        );
    }

    /// G over all translations at the rotation last turned to, followed by `half_turn`: into `work.grid`, and each
    /// row's best into `work.row_best`.
    pub fn correlate_turned(&self, half_turn: HalfTurn, work: &mut Workspace<T>) {
        vectorized(
            #[inline(always)]
            || {
                self.multiply(half_turn, work);
                self.rows_to_grid(work);
            },
        );
    }

    /// Time in seconds of each stage of one rotation: spreading, forward planes, forward columns (these three serve all
    /// four half-turns), product with the inverse along x and y, and rows.
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
        vectorized(
            #[inline(always)]
            || self.forward.planes(&mut work.forward),
        );
        let planes = lap();
        vectorized(
            #[inline(always)]
            || self.columns(work),
        );
        let columns = lap();
        vectorized(
            #[inline(always)]
            || self.multiply(HalfTurn::X, work),
        );
        let product = lap();
        vectorized(
            #[inline(always)]
            || self.rows_to_grid(work),
        );
        [spread, planes, columns, product, lap()]
    }

    #[inline(always)]
    fn spread(&self, rotation: &UnitQuaternion<f64>, work: &mut Workspace<T>) {
        let matrix = rotation.to_rotation_matrix();
        for (point, y) in work.points.iter_mut().zip(&self.ligand) {
            *point = (matrix * y).into();
        }
        self.forward
            .spread(&work.points, &self.weights, &mut work.forward);
    }

    /// Forward along x, column by column: completes the ligand's transform.
    #[inline(always)]
    fn columns(&self, work: &mut Workspace<T>) {
        let modes = self.plan.modes();
        let mx = self.forward.line_length();
        let rank = self.rank();
        for start in (0..modes.columns.len()).step_by(COLUMNS) {
            let end = (start + COLUMNS).min(modes.columns.len());
            self.forward
                .columns(start..end, &mut work.forward, &mut work.lines);
            for (index, column) in modes.columns[start..end].iter().enumerate() {
                let (side, length) = (column.kx_max as usize, column.len());
                let turned = &mut work.turned[self.packing.range(start + index, rank)];
                for q in 0..rank {
                    let line = &work.lines[(index * rank + q) * mx..(index * rank + q + 1) * mx];
                    work.column[..side].copy_from_slice(&line[mx - side..]);
                    work.column[side..length].copy_from_slice(&line[..=side]);
                    work.column[length..].fill(Complex::new(T::zero(), T::zero()));
                    let packets = work.column.chunks_exact(LANES);
                    for (packet, values) in turned[q..].iter_mut().step_by(rank).zip(packets) {
                        *packet = Packet::of(values);
                    }
                }
            }
        }
    }

    /// Products of columns and their inverse along x; then y for each block of planes.
    #[inline(always)]
    fn multiply(&self, half_turn: HalfTurn, work: &mut Workspace<T>) {
        let half = self.plan.modes().size[2] / 2 + 1;
        let reading = Reading::after(half_turn);
        let spectra = if reading.reversed {
            let modes = self.plan.modes();
            self.reversed
                .get_or_init(|| reversed(modes, &self.packing, self.rank(), &self.spectra))
        } else {
            &self.spectra
        };
        for block in (0..half).step_by(PLANES) {
            let depth = PLANES.min(half - block);
            for level in 0..depth {
                self.plane((reading, spectra), block + level, level, work);
            }
            self.pair_rows(block, depth, work);
        }
    }

    /// Plane kz of the product, transformed along x and y, into `work.planes` at `level`.
    #[inline(always)]
    fn plane(
        &self,
        read: (Reading, &[Packet<T>]),
        kz: usize,
        level: usize,
        work: &mut Workspace<T>,
    ) {
        let modes = self.plan.modes();
        let [nx, ny, _] = modes.size;
        let plane = &mut work.planes[level * nx * ny..(level + 1) * nx * ny];
        plane.fill(Complex::new(T::zero(), T::zero()));
        let Some(range) = modes.planes.get(kz) else {
            return;
        };
        for start in range.clone().step_by(COLUMNS) {
            let end = (start + COLUMNS).min(range.end);
            let products = &mut work.product[..(end - start) * nx];
            for (column, product) in (start..end).zip(products.chunks_exact_mut(nx)) {
                self.multiply_column(read, column, &work.turned, &mut work.column, product);
            }
            self.inverse_x
                .process_with_scratch(products, &mut work.scratch);
            // Columns side by side in y make each write a run.
            let first = place(modes.columns[start].ky, ny);
            let count = end - start;
            if place(modes.columns[end - 1].ky, ny) == first + count - 1 {
                for (x, row) in plane.chunks_exact_mut(ny).enumerate() {
                    for (index, value) in row[first..first + count].iter_mut().enumerate() {
                        *value = products[index * nx + x];
                    }
                }
            } else {
                for (column, product) in modes.columns[start..end]
                    .iter()
                    .zip(products.chunks_exact(nx))
                {
                    let y = place(column.ky, ny);
                    for (row, value) in plane.chunks_exact_mut(ny).zip(product) {
                        row[y] = *value;
                    }
                }
            }
        }
        self.inverse_y
            .process_with_scratch(plane, &mut work.scratch);
    }

    /// sum_q U_q conj(B_q) of one column, U as the reading wants it.
    #[inline(always)]
    fn multiply_column(
        &self,
        (reading, spectra): (Reading, &[Packet<T>]),
        index: usize,
        turned: &[Packet<T>],
        sums: &mut [Complex<T>],
        product: &mut [Complex<T>],
    ) {
        let twin = if reading.mirrored {
            self.mirrors[index] as usize
        } else {
            index
        };
        let rank = self.rank();
        let pair = [
            &spectra[self.packing.range(index, rank)],
            &turned[self.packing.range(twin, rank)],
        ];
        let side = self.plan.modes().columns[index].kx_max as usize;
        reading.multiply(rank, side, pair, sums, product);
    }

    /// Joins the rows of `depth` planes from kz = `block` on in pairs.
    #[inline(always)]
    fn pair_rows(&self, block: usize, depth: usize, work: &mut Workspace<T>) {
        let [nx, ny, nz] = self.plan.modes().size;
        for (pair, row) in work.rows.chunks_exact_mut(nz).enumerate() {
            for level in 0..depth {
                let at = level * nx * ny + 2 * pair;
                let (a, b) = (work.planes[at], work.planes[at + 1]);
                let kz = block + level;
                // A + iB at kz, and A* + iB* at -kz; the mean of a real row is real, and the Nyquist plane is empty.
                if kz == 0 {
                    row[0] = Complex::new(a.re, b.re);
                } else {
                    row[kz] = Complex::new(a.re - b.im, a.im + b.re);
                    row[nz - kz] = Complex::new(a.re + b.im, b.re - a.im);
                }
            }
        }
    }

    /// Rows: complex to real along z, two at a time, and the best of each row.
    #[inline(always)]
    fn rows_to_grid(&self, work: &mut Workspace<T>) {
        let [_, ny, nz] = self.plan.modes().size;
        let planes = work
            .rows
            .chunks_exact_mut(ny / 2 * nz)
            .zip(work.grid.chunks_exact_mut(ny * nz))
            .zip(work.row_best.chunks_exact_mut(ny));
        for ((pairs, grid), best) in planes {
            self.inverse_z
                .process_with_scratch(pairs, &mut work.scratch);
            for ((pair, rows), best) in pairs
                .chunks_exact(nz)
                .zip(grid.chunks_exact_mut(2 * nz))
                .zip(best.chunks_exact_mut(2))
            {
                let (even, odd) = rows.split_at_mut(nz);
                for ((value, even), odd) in pair.iter().zip(even.iter_mut()).zip(odd.iter_mut()) {
                    *even = value.re;
                    *odd = value.im;
                }
                best[0] = largest(even);
                best[1] = largest(odd);
            }
        }
    }
}

/// Largest of some values, in lanes so that it vectorises.
#[inline(always)]
fn largest<T: Real>(values: &[T]) -> T {
    let mut lanes = [T::neg_infinity(); 16];
    let chunks = values.chunks_exact(16);
    let rest = chunks.remainder();
    for chunk in chunks {
        for lane in 0..16 {
            lanes[lane] = if chunk[lane] > lanes[lane] {
                chunk[lane]
            } else {
                lanes[lane]
            };
        }
    }
    lanes
        .iter()
        .chain(rest)
        .fold(T::neg_infinity(), |a, &b| if b > a { b } else { a })
}
