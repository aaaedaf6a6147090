//! Preparing the engine on CPU cores: everything that does not turn, for a rank of the lifted axis.

use super::columns::Reading;
use super::cpu::CpuEngine;
use super::packed::{LANES, Packet, Packing, packets_of_half};
use super::plan::Plan;
use super::receptor_spectra::{Factors, ReceptorSpectra};
use crate::grid_turn::GridTurn;
use crate::transform::Real;
use crate::transform::pruned_type1::Forward;
use knotdock_structures::Knots;
use nalgebra::Vector3;
use num_complex::Complex;
use std::sync::Arc;

impl<T: Real> CpuEngine<T> {
    /// Prepares the engine at a rank of the lifted axis (1 to `receptor.full_rank()`).
    pub fn new(
        plan: Arc<Plan>,
        receptor: &ReceptorSpectra<T>,
        ligand: &Knots,
        rank: usize,
    ) -> Self {
        let factors = receptor.factor(plan.modes());
        Self::with_factors(plan, receptor, &factors, ligand, rank)
    }

    /// As [`Self::new`], with factors that are at hand.
    pub fn with_factors(
        plan: Arc<Plan>,
        receptor: &ReceptorSpectra<T>,
        factors: &Factors,
        ligand: &Knots,
        rank: usize,
    ) -> Self {
        let modes = Arc::clone(plan.modes());
        let rank = rank.clamp(1, receptor.full_rank());
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
        let mut values = Vec::new();
        for (index, column) in modes.columns.iter().enumerate() {
            let outer = factors[1][column.ky.unsigned_abs() as usize]
                * factors[2][column.kz as usize]
                / modes.volume();
            let range = packing.range(index, rank);
            let half = packets_of_half(column);
            for q in 0..rank {
                values.clear();
                values.extend((-column.kx_max..=column.kx_max).enumerate().map(|(i, k)| {
                    let mut sum = zero;
                    for (b, spectrum) in receptor.spectra.iter().enumerate() {
                        sum = sum + spectrum[column.start + i].scale(T::of(combination[(b, q)]));
                    }
                    let factor = outer * factors[0][k.unsigned_abs() as usize];
                    sum.scale(T::of(factor))
                }));
                let (up, down) = spectra[range.clone()].split_at_mut(half * rank);
                let side = column.kx_max as usize;
                for k in 0..=side {
                    up[k / LANES * rank + q].set(k % LANES, values[side + k]);
                    down[k / LANES * rank + q].set(k % LANES, values[side - k]);
                }
            }
        }
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
            receptor_center: receptor.center,
            readings: readings.collect(),
            inverse_x: T::inverse_fft(modes.size[0]),
            inverse_y: T::inverse_fft(modes.size[1]),
            inverse_z: T::inverse_fft(modes.size[2]),
            singular: singular.iter().map(|value| value / largest).collect(),
            plan,
        }
    }

    /// The engine that [`Self::with_factors`] makes at a lower rank, to the bit: its first components are these.
    #[must_use]
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
}

/// The transform of the ligand, which may lie anyhow within its radius.
pub(super) fn ligand_forward<T: Real>(plan: &Plan, rank: usize) -> Forward<T> {
    let modes = plan.modes();
    let extent = [0, 1, 2]
        .map(|axis| plan.ligand_radius() * plan.fine()[axis] as f64 / modes.lengths[axis] + 0.5);
    Forward::new(Arc::clone(modes), plan.fine(), plan.width(), extent, rank)
}
