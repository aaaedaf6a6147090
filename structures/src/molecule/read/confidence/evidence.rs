//! What the values of a B column say of themselves: whether they are a prediction's, where the file says nothing.
//!
//! One value a residue is hardly ever a refined structure's. Where values differ from atom to atom (AlphaFold 3,
//! Chai-1), four things part pLDDT from temperature factors:
//!
//! | | pLDDT | temperature factors |
//! |---|---|---|
//! | level of models that anyone docks | high, up to 100 | low, and without bounds |
//! | tail of the distribution | low values | high values |
//! | tips of side chains against the backbone | lower | higher |
//! | atoms with many others about them | higher | lower |

use std::collections::HashSet;

use crate::molecule::model::atom::{Atom, squared_distance};
use crate::molecule::model::groups::Residue;
use crate::neighbours::SpatialHash;

/// Fewest residues of several atoms for values alone to show a prediction.
const ENOUGH_RESIDUES: usize = 5;

/// Mean pLDDT above which one value a residue shows a prediction: models that anyone docks are above it, most refined B
/// values below.
const TELLING_MEAN: f64 = 60.0;

/// The same of values that differ from atom to atom. Of the 424 files of Docking Benchmark 5 one is above it with a
/// tail of low values, and that one's side chains are far above its backbone.
const TELLING_MEAN_BY_ATOM: f64 = 70.0;

/// By how many standard deviations the median lies at least above the mean.
const LOW_TAIL: f64 = 0.1;

/// By how many standard deviations side chains lie at most above their backbones; of refined structures mostly 0.1 to
/// 0.5.
const MAX_TIPS: f64 = 0.1;

/// Least correlation of the value with the number of atoms about; of refined structures mostly -0.35 to -0.7.
const MIN_PACKING: f64 = -0.3;

/// Distance in Å within which atoms are about one.
const ABOUT: f64 = 6.0;

/// Most atoms that the correlation is taken over.
const MAX_SAMPLE: usize = 2000;

/// Whether values alone show a prediction of this mean. Values are times `scale` on the scale of 0 to 100.
pub(crate) fn is_prediction(
    atoms: &[Atom],
    residues: &[Residue<'_>],
    mean: f64,
    scale: f64,
) -> bool {
    let mut several = 0;
    let mut seen = HashSet::new();
    let mut by_atom = false;
    for residue in residues.iter().filter(|residue| residue.atoms.len() > 1) {
        let mut members = residue.atoms.iter().filter_map(|&index| atoms.get(index));
        let Some(first) = members.next() else {
            continue;
        };
        by_atom |= members.any(|atom| atom.b_factor != first.b_factor);
        several += 1;
        seen.insert(first.b_factor.to_bits());
    }
    if several < ENOUGH_RESIDUES || seen.len() < 2 {
        return false;
    }
    if by_atom {
        is_prediction_by_atom(atoms, residues, mean, scale)
    } else {
        mean > TELLING_MEAN
    }
}

fn is_prediction_by_atom(
    atoms: &[Atom],
    residues: &[Residue<'_>],
    mean_of_residues: f64,
    scale: f64,
) -> bool {
    if mean_of_residues <= TELLING_MEAN_BY_ATOM {
        return false;
    }
    let mut values: Vec<f64> = atoms.iter().map(|atom| scale * atom.b_factor).collect();
    let mean = mean(&values);
    let deviation = deviation(&values, mean);
    let tips = tips(atoms, residues, scale);
    let packing = packing(atoms, &values);
    values.sort_by(f64::total_cmp);
    let median = values.get(values.len() / 2).copied().unwrap_or(mean);
    median - mean > LOW_TAIL * deviation && tips <= MAX_TIPS * deviation && packing >= MIN_PACKING
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn deviation(values: &[f64], mean: f64) -> f64 {
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (squares / values.len().max(1) as f64).sqrt()
}

/// By how much the value of side chains beyond CB is above that of N, CA and C, as a mean over residues; 0 where there
/// are none.
fn tips(atoms: &[Atom], residues: &[Residue<'_>], scale: f64) -> f64 {
    let differences: Vec<f64> = residues
        .iter()
        .filter(|residue| residue.is_peptide())
        .filter_map(|residue| {
            let (mut backbone, mut tip) = (Vec::new(), Vec::new());
            for atom in residue.atoms.iter().filter_map(|&index| atoms.get(index)) {
                match atom.name.as_str() {
                    "N" | "CA" | "C" => backbone.push(scale * atom.b_factor),
                    "O" | "OXT" | "CB" => {}
                    _ => tip.push(scale * atom.b_factor),
                }
            }
            let both = !backbone.is_empty() && !tip.is_empty();
            both.then(|| mean(&tip) - mean(&backbone))
        })
        .collect();
    mean(&differences)
}

/// Correlation of the atoms' values with the number of atoms about them; 0 where one of the two does not vary.
fn packing(atoms: &[Atom], values: &[f64]) -> f64 {
    let cells = SpatialHash::of_crowded_points(atoms.iter().map(|atom| atom.position), ABOUT, 100);
    let step = atoms.len().div_ceil(MAX_SAMPLE).max(1);
    let sample = atoms.iter().zip(values).step_by(step);
    let (values, about): (Vec<f64>, Vec<f64>) = sample
        .map(|(atom, value)| {
            let near = cells
                .around(atom.position)
                .copied()
                .filter_map(|index| atoms.get(index));
            let near = near
                .filter(|other| squared_distance(other.position, atom.position) < ABOUT * ABOUT);
            (*value, near.count() as f64)
        })
        .unzip();
    let means = [mean(&values), mean(&about)];
    let spread = deviation(&values, means[0]) * deviation(&about, means[1]);
    let products = values.iter().zip(&about);
    let products = products.map(|(value, about)| (value - means[0]) * (about - means[1]));
    if spread > 0.0 {
        products.sum::<f64>() / (values.len() as f64 * spread)
    } else {
        0.0
    }
}
