//! The transforms of a pair in one floating-point type: everything that does not turn, for a rank of the lifted axis,
//! and the turned ligand's transform.

use super::COLUMNS;
use super::inverse::{SIDE, slab_length};
use crate::engine::columns::Reading;
use crate::engine::packed::{LANES, Packet, Packing, packets_of_half};
use crate::engine::plan::Plan;
use crate::engine::receptor_spectra::{Factors, SpectrumList};
use crate::grid_turn::GridTurn;
use crate::transform::Real;
use crate::transform::modes::Column;
use crate::transform::pruned_type1::{Forward, ForwardWorkspace};
use crate::vectorized::vectorize;
use knotdock_structures::Knots;
use nalgebra::{UnitQuaternion, Vector3};
use num_complex::Complex;
use rayon::prelude::*;
use rustfft::Fft;
use std::sync::Arc;

/// The transforms of one pair.
pub(in crate::engine) struct Transforms<T: Real> {
    pub(in crate::engine) plan: Arc<Plan>,
    pub(in crate::engine) forward: Forward<T>,
    pub(in crate::engine) packing: Packing,
    /// U, packed.
    pub(in crate::engine) spectra: Vec<Packet<T>>,
    /// d_j V_q(s_j): [knot][component].
    pub(in crate::engine) weights: Vec<T>,
    /// Ligand knots relative to the ligand's centre, Å.
    pub(in crate::engine) ligand: Vec<Vector3<f64>>,
    /// Place of the ligand's centre in its own block, and of the receptor's in its, Å.
    pub(in crate::engine) block_center: [f64; 3],
    pub(in crate::engine) receptor_center: [f64; 3],
    /// Sources of the columns, for each turn that maps the modes onto themselves.
    pub(in crate::engine) readings: Arc<[Vec<Reading>]>,
    pub(super) inverse_x: Arc<dyn Fft<T>>,
    pub(super) inverse_y: Arc<dyn Fft<T>>,
    pub(super) inverse_z: Arc<dyn Fft<T>>,
    /// Singular values of the lifted axis in use, as shares of the largest.
    pub(in crate::engine) singular: Vec<f64>,
}

/// Buffers of one rotation in flight.
pub(in crate::engine) struct Buffers<T> {
    pub forward: ForwardWorkspace<T>,
    pub points: Vec<[f64; 3]>,
    /// [column][kx], with room for a packet before and after.
    pub lines: Vec<Complex<T>>,
    /// The turned ligand's transform, packed like the engine's spectra.
    pub turned: Vec<Packet<T>>,
    /// Products of a column.
    pub sums: Vec<Packet<T>>,
    /// [image][column][x].
    pub product: Vec<Complex<T>>,
    pub scratch: Vec<Complex<T>>,
    /// [image][x][column].
    pub slabs: Vec<Complex<T>>,
    /// [kz][y] of one x.
    pub along_y: Vec<Complex<T>>,
    /// [pair of y][kz] of one x: two rows' spectra as one, A + iB.
    pub rows: Vec<Complex<T>>,
}

impl<T: Real> Transforms<T> {
    /// Prepares the transforms at a rank of the lifted axis, from the receptor's spectra, its middle in the box (Å) and
    /// their factors.
    pub fn new(
        plan: Arc<Plan>,
        spectra_of: &SpectrumList<T>,
        receptor_center: [f64; 3],
        factors: &Factors,
        ligand: &Knots,
        rank: usize,
    ) -> Self {
        let modes = Arc::clone(plan.modes());
        let Factors {
            combination,
            coefficients,
            singular,
        } = factors;
        let forward = ligand_forward::<T>(&plan, rank);
        let factors: [Vec<f64>; 3] = [0, 1, 2].map(|axis| {
            (0..=modes.size[axis] as i32 / 2)
                .map(|k| forward.deconvolution(axis, k))
                .collect()
        });
        let zero = Complex::new(T::zero(), T::zero());
        let packing = Packing::new(&modes);
        let mut spectra = vec![Packet::zero(); rank * packing.count()];
        let mut rest = spectra.as_mut_slice();
        let columns = modes.columns.iter().enumerate().map(|(index, column)| {
            let count = packing.range(index, rank).len();
            let (own, others) = std::mem::take(&mut rest).split_at_mut(count);
            rest = others;
            (column, own)
        });
        let columns: Vec<_> = columns.collect();
        let fill = |values: &mut Vec<Complex<T>>,
                    (column, packets): (&Column, &mut [Packet<T>])| {
            let outer = factors[1][column.ky.unsigned_abs() as usize]
                * factors[2][column.kz as usize]
                / modes.volume();
            let (up, down) = packets.split_at_mut(packets_of_half(column) * rank);
            let side = column.kx_max as usize;
            for q in 0..rank {
                values.clear();
                values.resize(2 * side + 1, zero);
                for (b, spectrum) in spectra_of.iter().enumerate() {
                    let share = T::of(combination[(b, q)]);
                    for (sum, value) in values.iter_mut().zip(&spectrum[column.start..]) {
                        *sum = *sum + value.scale(share);
                    }
                }
                for (value, k) in values.iter_mut().zip(-column.kx_max..) {
                    *value = value.scale(T::of(outer * factors[0][k.unsigned_abs() as usize]));
                }
                for k in 0..=side {
                    up[k / LANES * rank + q].set(k % LANES, values[side + k]);
                    down[k / LANES * rank + q].set(k % LANES, values[side - k]);
                }
            }
        };
        columns.into_par_iter().for_each_init(Vec::new, fill);
        let weights = (0..ligand.len())
            .flat_map(|j| (0..rank).map(move |q| (j, q)))
            .map(|(j, q)| T::of(coefficients[(j, q)]))
            .collect();
        let scale = forward.cells_per_length();
        let center = forward.center();
        let readings = GridTurn::of(&modes)
            .iter()
            .map(|&turn| Reading::after(turn, &modes));
        let largest = singular
            .first()
            .copied()
            .unwrap_or(1.0)
            .max(f64::MIN_POSITIVE);
        Self {
            forward,
            packing,
            spectra,
            weights,
            ligand: ligand
                .centers
                .iter()
                .map(|&y| Vector3::from(y) - plan.ligand_center())
                .collect(),
            block_center: [0, 1, 2].map(|axis| center[axis] / scale[axis]),
            receptor_center,
            readings: readings.collect(),
            inverse_x: T::inverse_fft(modes.size[0]),
            inverse_y: T::inverse_fft(modes.size[1]),
            inverse_z: T::inverse_fft(modes.size[2]),
            singular: singular.iter().map(|value| value / largest).collect(),
            plan,
        }
    }

    /// The transforms that [`Self::new`] prepares at a lower rank, to the bit: their first components are these.
    pub fn truncated(&self, rank: usize) -> Self {
        let full = self.rank();
        let rank = rank.clamp(1, full);
        let mut spectra = Vec::with_capacity(rank * self.packing.count());
        for components in self.spectra.chunks_exact(full) {
            spectra.extend_from_slice(&components[..rank]);
        }
        let weights = self.weights.chunks_exact(full);
        Self {
            plan: Arc::clone(&self.plan),
            forward: ligand_forward::<T>(&self.plan, rank),
            packing: self.packing.clone(),
            spectra,
            weights: weights
                .flat_map(|components| &components[..rank])
                .copied()
                .collect(),
            ligand: self.ligand.clone(),
            readings: Arc::clone(&self.readings),
            inverse_x: Arc::clone(&self.inverse_x),
            inverse_y: Arc::clone(&self.inverse_y),
            inverse_z: Arc::clone(&self.inverse_z),
            singular: self.singular.clone(),
            ..*self
        }
    }

    /// Rank q of the lifted axis in use.
    pub fn rank(&self) -> usize {
        self.forward.components()
    }

    /// U of one column and component with kx rising.
    #[cfg(feature = "gpu")]
    pub fn spectrum(
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

    /// Buffers for a number of images of a rotation together.
    pub fn buffers(&self, images: usize) -> Buffers<T> {
        let [nx, ny, nz] = self.plan.modes().size;
        let zero = Complex::new(T::zero(), T::zero());
        let scratch = self
            .inverse_x
            .get_inplace_scratch_len()
            .max(self.inverse_y.get_inplace_scratch_len())
            .max(self.inverse_z.get_inplace_scratch_len());
        Buffers {
            forward: self.forward.workspace(),
            points: vec![[0.0; 3]; self.ligand.len()],
            lines: vec![zero; COLUMNS * self.forward.line_length() + 2 * LANES],
            turned: vec![Packet::zero(); self.spectra.len()],
            sums: vec![Packet::zero(); 2 * (nx / 2).div_ceil(LANES)],
            product: vec![zero; images * 2 * SIDE * nx],
            scratch: vec![zero; scratch],
            slabs: vec![zero; images * nx * slab_length(self.plan.modes())],
            along_y: vec![zero; self.plan.modes().planes.len() * ny],
            rows: vec![zero; ny / 2 * nz],
        }
    }

    /// [`super::CpuEngine::position_after`].
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

    /// The ligand's transform at a rotation.
    pub fn transform_ligand(&self, rotation: &UnitQuaternion<f64>, work: &mut Buffers<T>) {
        self.spread(rotation, work);
        for component in 0..self.rank() {
            self.planes(component, work);
            self.columns(component, work);
        }
    }

    /// Spreads the turned ligand.
    pub fn spread(&self, rotation: &UnitQuaternion<f64>, work: &mut Buffers<T>) {
        let matrix = (self.plan.frame() * rotation).to_rotation_matrix();
        for (point, y) in work.points.iter_mut().zip(&self.ligand) {
            *point = (matrix * y).into();
        }
        let (points, weights) = (&work.points, &self.weights);
        vectorize!(self.forward.spread(points, weights, &mut work.forward));
    }

    /// Forward along z and y: a component of the ligand's transform.
    pub fn planes(&self, component: usize, work: &mut Buffers<T>) {
        vectorize!(self.forward.planes(component, &mut work.forward));
    }

    /// Forward along x, column by column: completes a component of the ligand's transform.
    pub fn columns(&self, component: usize, work: &mut Buffers<T>) {
        vectorize!(self.columns_inline(component, work));
    }

    #[inline(always)]
    fn columns_inline(&self, component: usize, work: &mut Buffers<T>) {
        let modes = self.plan.modes();
        let mx = self.forward.line_length();
        let rank = self.rank();
        for start in (0..modes.columns.len()).step_by(COLUMNS) {
            let end = (start + COLUMNS).min(modes.columns.len());
            self.forward
                .columns(start..end, &mut work.forward, &mut work.lines[LANES..]);
            for (index, column) in modes.columns[start..end].iter().enumerate() {
                let turned = &mut work.turned[self.packing.range(start + index, rank)];
                let (up, down) = turned.split_at_mut(packets_of_half(column) * rank);
                let zero = LANES + index * mx;
                let own = up[component..].iter_mut().step_by(rank);
                for (packet, values) in own.zip(work.lines[zero..].chunks_exact(LANES)) {
                    if let Ok(values) = values.try_into() {
                        *packet = Packet::of(values);
                    }
                }
                // Place mx is that of kx = 0 again and holds the next line's first value.
                let own = down[component..].iter_mut().step_by(rank);
                let falling = work.lines[..=zero + mx].rchunks_exact(LANES);
                for (packet, values) in own.zip(falling) {
                    if let Ok(values) = values.try_into() {
                        *packet = Packet::reversed(values);
                    }
                }
                down[component].set(0, work.lines[zero]);
            }
        }
    }
}

/// The transform of the ligand at any rotation within its radius.
pub(in crate::engine) fn ligand_forward<T: Real>(plan: &Plan, rank: usize) -> Forward<T> {
    let modes = plan.modes();
    let extent = [0, 1, 2]
        .map(|axis| plan.ligand_radius() * plan.fine()[axis] as f64 / modes.lengths[axis] + 0.5);
    Forward::new(Arc::clone(modes), plan.fine(), plan.width(), extent, rank)
}
