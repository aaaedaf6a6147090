//! The receptor's side of a correlation: its transform with the lifted kernel folded in, and the compression of the lifted axis.

use super::plan::Plan;
use crate::lifted_axis::Fold;
use crate::transform::Real;
use crate::transform::modes::ModeSet;
use crate::transform::nfft::Forward;
use crate::transform::truncation::Selection;
use knotdock_structures::Knots;
use nalgebra::{DMatrix, SymmetricEigen, Vector3};
use num_complex::Complex;
use std::sync::Arc;

/// The receptor's side, uncompressed: `H[basis function][mode]`, and the ligand's basis values.
#[derive(Clone)]
pub struct Folded<T> {
    pub(super) spectra: Vec<Vec<Complex<T>>>,
    /// d_j v_b(s_j): (knots, basis functions).
    pub(super) ligand: DMatrix<f64>,
    pub(super) center: [f64; 3],
}

impl<T: Real> Folded<T> {
    /// Transforms the receptor and folds the lifted kernel into it.
    pub fn new(plan: &Plan, receptor: &Knots, ligand: &Knots, fold: Fold) -> Self {
        let modes = &plan.modes;
        let (receptor_size, ligand_size) = plan.basis.sizes(&plan.axis);
        let fine = plan.fine;
        let extent = [0, 1, 2]
            .map(|axis| plan.receptor_extent[axis] * fine[axis] as f64 / modes.lengths[axis] + 0.5);
        let forward = Forward::<T>::new(Arc::clone(modes), fine, plan.width, extent, 1);
        let mut work = forward.workspace();
        let points: Vec<[f64; 3]> = receptor
            .centers
            .iter()
            .map(|&x| (Vector3::from(x) - plan.receptor_center).into())
            .collect();
        let zero = Complex::new(T::zero(), T::zero());
        let mut spectra = vec![vec![zero; modes.count]; ligand_size];
        let mut field = vec![zero; modes.count];
        for a in 0..receptor_size {
            let mut inside = Vec::new();
            let mut weights = Vec::new();
            for (i, &radius) in receptor.radii.iter().enumerate() {
                let value =
                    plan.basis.receptor_value(&plan.axis, a, radius) * receptor.weights[i].re;
                if value != 0.0 {
                    inside.push(points[i]);
                    weights.push(T::of(value));
                }
            }
            forward.transform(&inside, &weights, &mut work, &mut field);
            for (b, spectrum) in spectra.iter_mut().enumerate() {
                let Some(table) = plan.coupling(fold, (a, b)) else {
                    continue;
                };
                modes.for_each(|mode, w, _| {
                    let length = (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]).sqrt();
                    let factor = T::of(table.value(length)[0]);
                    spectrum[mode] = spectrum[mode] + field[mode].scale(factor);
                });
            }
        }
        let ligand = DMatrix::from_fn(ligand.len(), ligand_size, |j, b| {
            ligand.weights[j].re * plan.basis.ligand_value(&plan.axis, b, ligand.radii[j])
        });
        let scale = forward.cells_per_length();
        let center = forward.center();
        Self {
            spectra,
            ligand,
            center: [0, 1, 2].map(|axis| center[axis] / scale[axis]),
        }
    }

    /// `H[basis function][mode]`, window and volume not yet divided out on the ligand's side.
    pub fn spectra(&self) -> &[Vec<Complex<T>>] {
        &self.spectra
    }

    /// Leaves out all modes but those of a selection, for the whole correlation.
    pub fn keep(&mut self, selection: &Selection) {
        for spectrum in &mut self.spectra {
            for (place, value) in spectrum.iter_mut().enumerate() {
                if !selection.keeps(place) {
                    *value = Complex::new(T::zero(), T::zero());
                }
            }
        }
    }

    /// d_j v_b(s_j) of ligand knot j.
    pub fn ligand_weight(&self, knot: usize, function: usize) -> f64 {
        self.ligand[(knot, function)]
    }

    /// Where the receptor's middle lies in the box, Å.
    pub fn center(&self) -> [f64; 3] {
        self.center
    }

    /// Number of basis functions: the rank that is exact.
    pub fn full_rank(&self) -> usize {
        self.spectra.len()
    }

    /// The factorisation of the lifted axis: for every rank q the receptor's combination (basis, q), the ligand's coefficients
    /// (knots, q), and the singular values, largest first.
    ///
    /// With D the ligand's (knots, basis) matrix and S = (D'D)^(1/2), the product H D' is (H S)(D S^-1)'; the singular vectors of
    /// H S, stacked [Re; Im] so that V stays real, give the best q terms in the mean over knots placed at random.
    pub fn factor(&self, modes: &ModeSet) -> (DMatrix<f64>, DMatrix<f64>, Vec<f64>) {
        let size = self.spectra.len();
        let mut gram = DMatrix::<f64>::zeros(size, size);
        let mut multiplicities = Vec::with_capacity(modes.count);
        modes.for_each(|_, _, multiplicity| multiplicities.push(multiplicity));
        for a in 0..size {
            for b in 0..=a {
                let sum: f64 = self.spectra[a]
                    .iter()
                    .zip(&self.spectra[b])
                    .zip(&multiplicities)
                    .map(|((x, y), m)| m * (x.re.wide() * y.re.wide() + x.im.wide() * y.im.wide()))
                    .sum();
                gram[(a, b)] = sum;
                gram[(b, a)] = sum;
            }
        }
        let ligand = SymmetricEigen::new(self.ligand.transpose() * &self.ligand);
        let largest = ligand.eigenvalues.max();
        let power = |exponent: f64| {
            let scaled = ligand.eigenvalues.map(|value| {
                // Functions that no ligand knot tells apart carry nothing.
                if value > 1e-13 * largest {
                    value.powf(exponent)
                } else {
                    0.0
                }
            });
            &ligand.eigenvectors * DMatrix::from_diagonal(&scaled) * ligand.eigenvectors.transpose()
        };
        let (root, inverse_root) = (power(0.5), power(-0.5));
        let eigen = SymmetricEigen::new(&root * gram * &root);
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let vectors = DMatrix::from_fn(size, size, |row, q| eigen.eigenvectors[(row, order[q])]);
        let singular = order
            .iter()
            .map(|&i| eigen.eigenvalues[i].max(0.0).sqrt())
            .collect();
        (
            &root * &vectors,
            &self.ligand * inverse_root * &vectors,
            singular,
        )
    }
}
