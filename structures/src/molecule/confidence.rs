//! Predicted models: the confidence (pLDDT) that their B column carries, and residues of which it knows no place.
//!
//! AlphaFold, ColabFold, ESMFold, Boltz and their like write in the place of temperature factors how sure they are of each residue's
//! surroundings: pLDDT, a predicted lDDT-Cα, from 0 to 100 (Jumper et al., Nature 596, 583-589, 2021) or, of some programs, from 0 to 1.
//! Below [`LOW`] a residue is likely disordered (Tunyasuvunakool et al., Nature 596, 590-596, 2021): where it stands is no fact, and
//! as a solid it blocks what it may not touch.
//!
//! What the column holds is told by what the file says of itself ([`Provenance`]), or where it says nothing by the values: those of a
//! prediction are one a residue, as those of a refined structure hardly are.

use std::collections::HashSet;

use serde::Serialize;

use super::Atom;
use super::groups::{Residue, residues};
use super::report::{DropKind, ReadReport, show_chain};

/// pLDDT below which a residue is likely disordered.
pub const LOW: f64 = 50.0;

/// Fewest residues of several atoms by which values alone tell a prediction.
const ENOUGH_RESIDUES: usize = 5;

/// Mean pLDDT above which values alone tell a prediction: models that anyone docks are above it, most refined B values below.
const TELLING_MEAN: f64 = 60.0;

/// What a file says of where its coordinates come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Provenance {
    /// Nothing.
    #[default]
    Untold,
    /// They were measured, or are scored by something else than pLDDT: the B column is none.
    NoConfidence,
    /// They were predicted and the B column is pLDDT.
    Confidence,
}

/// How a prediction was known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ToldBy {
    /// The file says so: `_ma_qa_metric` of ModelCIF.
    Header,
    /// The B column holds one value a residue, as only a prediction's does.
    Values,
}

/// How sure a prediction is of a molecule.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Confidence {
    /// How it was known that the B column is pLDDT.
    pub told_by: ToldBy,
    /// Mean pLDDT of the residues, 0 to 100, those that are left out among them.
    pub mean: f64,
    /// Residues.
    pub residues: usize,
    /// Those of them with a pLDDT below 50.
    pub below_50: usize,
}

/// pLDDT, 0 to 100, of each of the residues, and how it was known; nothing where the B column holds none.
fn values(
    atoms: &[Atom],
    residues: &[Residue<'_>],
    provenance: Provenance,
) -> Option<(ToldBy, Vec<f64>)> {
    let column = || atoms.iter().map(|atom| atom.b_factor);
    let highest = column().fold(f64::NEG_INFINITY, f64::max);
    if provenance == Provenance::NoConfidence
        || !column().all(|value| (0.0..=100.0).contains(&value))
        || highest <= 0.0
    {
        return None;
    }
    let scale = if highest <= 1.0 { 100.0 } else { 1.0 };
    let of_residue = |residue: &Residue<'_>| {
        let members = residue.atoms.iter().filter_map(|&index| atoms.get(index));
        let sum: f64 = members.map(|atom| atom.b_factor).sum();
        // Files have two decimals: what a mean adds to them by rounding must not carry a residue below the limit that it stands at.
        (scale * sum / residue.atoms.len() as f64 * 1e6).round() / 1e6
    };
    let values: Vec<f64> = residues.iter().map(of_residue).collect();
    match provenance {
        Provenance::Confidence => Some((ToldBy::Header, values)),
        _ => looks_like_one(atoms, residues, mean(&values)).then_some((ToldBy::Values, values)),
    }
}

/// Whether values alone tell a prediction of this mean.
fn looks_like_one(atoms: &[Atom], residues: &[Residue<'_>], mean: f64) -> bool {
    let mut several = 0;
    let mut seen = HashSet::new();
    for residue in residues.iter().filter(|residue| residue.atoms.len() > 1) {
        let mut members = residue.atoms.iter().filter_map(|&index| atoms.get(index));
        let Some(first) = members.next() else {
            continue;
        };
        if members.any(|atom| atom.b_factor != first.b_factor) {
            return false;
        }
        several += 1;
        seen.insert(first.b_factor.to_bits());
    }
    several >= ENOUGH_RESIDUES && seen.len() > 1 && mean > TELLING_MEAN
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Notes in the report how sure a prediction is of its residues, and leaves out those of a pLDDT below `least`.
///
/// `dropped` hears of the atoms left out. Of what is no prediction all stays.
pub(super) fn weigh(
    atoms: Vec<Atom>,
    provenance: Provenance,
    least: Option<f64>,
    report: &mut ReadReport,
    dropped: &mut dyn FnMut(Atom, DropKind),
) -> Vec<Atom> {
    let groups = residues(&atoms);
    let Some((told_by, values)) = values(&atoms, &groups, provenance) else {
        return atoms;
    };
    let below = |limit: f64| values.iter().filter(move |value| **value < limit).count();
    report.confidence = Some(Confidence {
        told_by,
        mean: mean(&values),
        residues: values.len(),
        below_50: below(LOW),
    });
    let least = least.unwrap_or(0.0);
    let doubtful = below(LOW).saturating_sub(below(least));
    if doubtful > 0 {
        report.warnings.push(format!(
            "{doubtful} of {} residues have a pLDDT below {LOW}, so that where they stand is likely no fact: --min-plddt {LOW} leaves them out",
            values.len()
        ));
    }
    let mut leave = vec![false; atoms.len()];
    for (group, _) in groups
        .iter()
        .zip(&values)
        .filter(|(_, value)| **value < least)
    {
        let (chain, number, insertion, _) = group.key;
        let insertion = insertion.map_or(String::new(), String::from);
        let name = format!("{} {number}{insertion}", show_chain(chain));
        report.drop_atoms(DropKind::LowConfidence, &name, group.atoms.len());
        for &index in &group.atoms {
            if let Some(place) = leave.get_mut(index) {
                *place = true;
            }
        }
    }
    let mut kept = Vec::with_capacity(atoms.len());
    for (atom, leave) in atoms.into_iter().zip(leave) {
        if leave {
            dropped(atom, DropKind::LowConfidence);
        } else {
            kept.push(atom);
        }
    }
    kept
}
