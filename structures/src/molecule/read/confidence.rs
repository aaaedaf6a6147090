//! Predicted models: the confidence (pLDDT) in their B column, and residues without a known place.
//!
//! AlphaFold, ColabFold, ESMFold, Boltz and their like write in the place of temperature factors how sure they are of
//! each residue's surroundings. This is pLDDT, a predicted lDDT-Cα, from 0 to 100 (Jumper et al., Nature 596, 583-589,
//! 2021) or, of some programs, from 0 to 1.
//!
//! Below [`LOW`] a residue is likely disordered (Tunyasuvunakool et al., Nature 596, 590-596, 2021): its place is no
//! fact, and as a solid it blocks what it may not touch.
//!
//! The meaning of the column is detected from the file's statements ([`Provenance`]). If there are none, the values
//! decide, or the user does by giving a least pLDDT. One value per residue is hardly ever a refined structure's. If
//! values differ from atom to atom (AlphaFold 3, Chai-1), four things part pLDDT from temperature factors:
//!
//! | | pLDDT | temperature factors |
//! |---|---|---|
//! | level of models that anyone docks | high, up to 100 | low, and without bounds |
//! | tail of the distribution | low values | high values |
//! | tips of side chains against the backbone | lower | higher |
//! | atoms with many others about them | higher | lower |

use crate::molecule::model::{
    Atom, Confidence, ConfidenceSource, DropKind, Residue, residues, show_chain,
};
use crate::molecule::read::{Drops, ReadOptions};
use crate::neighbours::SpatialHash;
use crate::vector::{bounds, squared_distance};
use std::collections::HashSet;

/// Provenance of the coordinates, as the file states it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Provenance {
    /// Nothing.
    #[default]
    Unstated,
    /// They were measured, or are scored by something else than pLDDT: the B column is none.
    NoConfidence,
    /// They were predicted and the B column is pLDDT.
    Confidence,
}

/// Whether a method of `EXPDTA` or `_exptl.method` is a measurement: any but the theoretical models of old and of
/// predictors.
pub(crate) fn is_measured(method: &str) -> bool {
    let method = method.trim().to_ascii_uppercase();
    !method.is_empty() && !method.contains("THEORETICAL")
}

/// pLDDT below which a residue is likely disordered.
pub const LOW: f64 = 50.0;

/// Least share of the residues that must reach the least pLDDT for the user's word to be taken.
const MIN_REACHING: f64 = 0.25;

/// pLDDT, 0 to 100, of each of the residues, and how it was detected.
///
/// # Errors
/// Why the B column is not taken for pLDDT.
fn values(
    atoms: &[Atom],
    residues: &[Residue<'_>],
    provenance: Provenance,
    options: &ReadOptions,
) -> Result<(ConfidenceSource, Vec<f64>), String> {
    let ([lowest], [highest]) = bounds(atoms.iter().map(|atom| [atom.b_factor]));
    let scale = if highest <= 1.0 { 100.0 } else { 1.0 };
    let of_residue = |residue: &Residue<'_>| {
        let sum: f64 = residue.members(atoms).map(|atom| atom.b_factor).sum();
        // Files have two decimals: what a mean adds to them by rounding must not carry a residue below the limit that
        // it has.
        (scale * sum / residue.atoms.len() as f64 * 1e6).round() / 1e6
    };
    let values: Vec<f64> = residues.iter().map(of_residue).collect();
    let least = options.min_plddt.unwrap_or(0.0);
    let reaching = values.iter().filter(|value| **value >= least).count();
    if provenance == Provenance::NoConfidence {
        Err("the file names an experiment or another score".to_owned())
    } else if lowest < 0.0 {
        Err(format!("a B value is {lowest}, below 0"))
    } else if highest > 100.0 {
        Err(format!("a B value is {highest}, above 100"))
    } else if highest <= 0.0 {
        Err("all B values are 0".to_owned())
    } else if provenance == Provenance::Confidence {
        Ok((ConfidenceSource::Header, values))
    } else if is_prediction(atoms, residues, mean(&values), scale) {
        Ok((ConfidenceSource::Values, values))
    } else if lowest == highest {
        Err(format!("all B values are {lowest}"))
    } else if !options.trust_plddt {
        Err("neither the file nor its B values say that they are pLDDT".to_owned())
    } else if (reaching as f64) < MIN_REACHING * values.len() as f64 {
        // A partner that was measured, whose low values leave next to nothing of it.
        let all = values.len();
        Err(format!(
            "{reaching} of {all} residues reach {least}, as of temperature factors"
        ))
    } else {
        Ok((ConfidenceSource::User, values))
    }
}

/// Notes in the report how sure a prediction is of its residues, and drops those of a pLDDT below the least one. Of
/// what is no prediction all stays.
pub(crate) fn weigh(
    atoms: Vec<Atom>,
    provenance: Provenance,
    options: &ReadOptions,
    drops: &mut Drops,
) -> Vec<Atom> {
    let groups = residues(&atoms);
    let (source, values) = match values(&atoms, &groups, provenance, options) {
        Ok(known) => known,
        Err(reason) => {
            drops.report.no_confidence = options.min_plddt.map(|_| reason);
            return atoms;
        }
    };
    let warnings = &mut drops.report.warnings;
    if source == ConfidenceSource::User {
        warnings.push(
            "the B values are taken for pLDDT because --min-plddt is given: neither the file nor they say so"
                .to_owned(),
        );
    }
    let least = options.min_plddt.unwrap_or(0.0);
    let below = |limit: f64| values.iter().filter(move |value| **value < limit).count();
    let doubtful = below(LOW).saturating_sub(below(least));
    if doubtful > 0 {
        warnings.push(format!(
            "{doubtful} of {} residues have a pLDDT below {LOW}, so that where they stand is likely no fact: \
             --min-plddt {LOW} leaves them out",
            values.len()
        ));
    }
    drops.report.confidence = Some(Confidence {
        source,
        mean: mean(&values),
        residues: values.len(),
        below_50: below(LOW),
    });
    let mut keep = vec![true; atoms.len()];
    for (group, _) in groups
        .iter()
        .zip(&values)
        .filter(|(_, value)| **value < least)
    {
        let name = format!(
            "{} {}",
            show_chain(group.key.chain),
            group.key.number_text()
        );
        for &index in &group.atoms {
            keep[index] = false;
            drops.add_named(&atoms[index], DropKind::LowConfidence, &name);
        }
    }
    let mut keep = keep.into_iter();
    let mut atoms = atoms;
    atoms.retain(|_| keep.next() == Some(true));
    atoms
}

/// Fewest residues of several atoms for values alone to show a prediction.
const ENOUGH_RESIDUES: usize = 5;

/// Mean pLDDT above which one value per residue shows a prediction: models that anyone docks are above it, most refined B
/// values below.
const TELLING_MEAN: f64 = 60.0;

/// The same of values that differ from atom to atom. Of the 424 files of Docking Benchmark 5 one is above it with a
/// tail of low values, and that one's side chains are far above its backbone.
const TELLING_MEAN_BY_ATOM: f64 = 70.0;

/// Least distance of the median above the mean, in standard deviations.
const LOW_TAIL: f64 = 0.1;

/// Largest distance of side chains above their backbones, in standard deviations; of refined structures mostly 0.1 to
/// 0.5.
const MAX_TIPS: f64 = 0.1;

/// Least correlation of the value with the number of atoms about; of refined structures mostly -0.35 to -0.7.
const MIN_PACKING: f64 = -0.3;

const ABOUT: f64 = 6.0;

const MAX_SAMPLE: usize = 2000;

/// Whether values alone show a prediction of this mean. Values are times `scale` on the scale of 0 to 100.
fn is_prediction(
    atoms: &[Atom],
    residues: &[Residue<'_>],
    mean_of_residues: f64,
    scale: f64,
) -> bool {
    let mut several = 0;
    let mut seen = HashSet::new();
    let mut by_atom = false;
    for residue in residues.iter().filter(|residue| residue.atoms.len() > 1) {
        let mut members = residue.members(atoms);
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
    if !by_atom || mean_of_residues <= TELLING_MEAN_BY_ATOM {
        return !by_atom && mean_of_residues > TELLING_MEAN;
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
            for atom in residue.members(atoms) {
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
            let near = cells.around(atom.position).filter(|&&other| {
                squared_distance(atoms[other].position, atom.position) < ABOUT * ABOUT
            });
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
