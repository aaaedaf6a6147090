//! Predictions as B values: a residue's is the mean over its heavy atoms.

use knotdock_structures::molecule::Molecule;

use super::{Prediction, PredictionFault, is_probability};
use crate::named_columns::AtLine;

/// The predictions of a molecule, residue by residue.
pub(super) fn read(molecule: &Molecule) -> Result<Vec<Prediction>, AtLine<PredictionFault>> {
    let atoms = &molecule.atoms;
    let heavy: Vec<bool> = atoms.iter().map(|atom| !atom.is_hydrogen()).collect();
    let values = || atoms.iter().map(|atom| atom.b_factor);
    if !values().all(is_probability) {
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        let fault = PredictionFault::BValues {
            low: values().fold(low, f64::min),
            high: values().fold(high, f64::max),
        };
        return Err(fault.in_file());
    }
    let residues = molecule.atoms_by_residue(&heavy).into_iter();
    let prediction = |residue: Vec<usize>| {
        let sum: f64 = residue.iter().map(|&at| atoms[at].b_factor).sum();
        let mean = sum / residue.len() as f64;
        (residue, mean)
    };
    Ok(residues.map(prediction).collect())
}
