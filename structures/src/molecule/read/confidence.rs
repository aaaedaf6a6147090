//! Predicted models: the confidence (pLDDT) that their B column carries, and residues of which it knows no place.
//!
//! AlphaFold, ColabFold, ESMFold, Boltz and their like write in the place of temperature factors how sure they are of
//! each residue's surroundings. This is pLDDT, a predicted lDDT-Cα, from 0 to 100 (Jumper et al., Nature 596, 583-589,
//! 2021) or, of some programs, from 0 to 1.
//!
//! Below [`LOW`] a residue is likely disordered (Tunyasuvunakool et al., Nature 596, 590-596, 2021): where it stands is
//! no fact, and as a solid it blocks what it may not touch.
//!
//! What the column holds is detected from what the file says of itself ([`Provenance`]). Where it says nothing, the
//! values decide ([`evidence`]), or the user does by giving a least pLDDT.

mod evidence;

use crate::molecule::model::atom::Atom;
use crate::molecule::model::groups::{Residue, residues};
use crate::molecule::model::report::{Confidence, ConfidenceSource};
use crate::molecule::model::report::{DropKind, ReadReport};
use crate::molecule::model::wording::show_chain;
use crate::molecule::read::record_filter::provenance::Provenance;

/// pLDDT below which a residue is likely disordered.
pub const LOW: f64 = 50.0;

/// Share of the residues that reach the least pLDDT at least, where the user's word is taken.
const MIN_REACHING: f64 = 0.25;

/// The reason why the B column of a file cannot be pLDDT, if there is one.
fn contradiction(atoms: &[Atom], provenance: Provenance) -> Option<String> {
    let column = || atoms.iter().map(|atom| atom.b_factor);
    let lowest = column().fold(f64::INFINITY, f64::min);
    let highest = column().fold(f64::NEG_INFINITY, f64::max);
    if provenance == Provenance::NoConfidence {
        Some("the file names an experiment or another score".to_owned())
    } else if lowest < 0.0 {
        Some(format!("a B value is {lowest}, below 0"))
    } else if highest > 100.0 {
        Some(format!("a B value is {highest}, above 100"))
    } else {
        (highest <= 0.0).then(|| "all B values are 0".to_owned())
    }
}

/// pLDDT, 0 to 100, of each of the residues, and how it was known; `least` is requested, and `trusted` says that the
/// user's word is taken.
///
/// # Errors
/// Why the B column is taken for none.
fn values(
    atoms: &[Atom],
    residues: &[Residue<'_>],
    provenance: Provenance,
    (least, trusted): (f64, bool),
) -> Result<(ConfidenceSource, Vec<f64>), String> {
    let highest = atoms.iter().map(|atom| atom.b_factor);
    let highest = highest.fold(f64::NEG_INFINITY, f64::max);
    let scale = if highest <= 1.0 { 100.0 } else { 1.0 };
    let of_residue = |residue: &Residue<'_>| {
        let members = residue.atoms.iter().filter_map(|&index| atoms.get(index));
        let sum: f64 = members.map(|atom| atom.b_factor).sum();
        // Files have two decimals: what a mean adds to them by rounding must not carry a residue below the limit that
        // it stands at.
        (scale * sum / residue.atoms.len() as f64 * 1e6).round() / 1e6
    };
    let values: Vec<f64> = residues.iter().map(of_residue).collect();
    let reaching = values.iter().filter(|value| **value >= least).count();
    let first = atoms.first().map_or(0.0, |atom| atom.b_factor);
    match contradiction(atoms, provenance) {
        Some(reason) => Err(reason),
        None if provenance == Provenance::Confidence => Ok((ConfidenceSource::Header, values)),
        None if evidence::is_prediction(atoms, residues, mean(&values), scale) => {
            Ok((ConfidenceSource::Values, values))
        }
        None if atoms.iter().all(|atom| atom.b_factor == first) => {
            Err(format!("all B values are {first}"))
        }
        // A partner that was measured, whose low values leave next to nothing of it.
        None if trusted && (reaching as f64) < MIN_REACHING * values.len() as f64 => Err(format!(
            "{reaching} of {} residues reach {least}, as of temperature factors",
            values.len()
        )),
        None if trusted => Ok((ConfidenceSource::User, values)),
        None => Err("neither the file nor its B values say that they are pLDDT".to_owned()),
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Notes in the report how sure a prediction is of its residues, and leaves out those of a pLDDT below `least`.
///
/// `trusted` says that the B column is pLDDT wherever it can be. `dropped` hears of the atoms left out. Of what is no
/// prediction all stays.
pub(crate) fn weigh(
    atoms: Vec<Atom>,
    provenance: Provenance,
    least: Option<f64>,
    trusted: bool,
    report: &mut ReadReport,
    dropped: &mut dyn FnMut(Atom, DropKind),
) -> Vec<Atom> {
    let groups = residues(&atoms);
    let (source, values) =
        match values(&atoms, &groups, provenance, (least.unwrap_or(0.0), trusted)) {
            Ok(known) => known,
            Err(reason) => {
                report.no_confidence = least.map(|_| reason);
                return atoms;
            }
        };
    if source == ConfidenceSource::User {
        report.warnings.push(
            "the B values are taken for pLDDT because --min-plddt is given: neither the file nor they say so"
                .to_owned(),
        );
    }
    let below = |limit: f64| values.iter().filter(move |value| **value < limit).count();
    report.confidence = Some(Confidence {
        source,
        mean: mean(&values),
        residues: values.len(),
        below_50: below(LOW),
    });
    let least = least.unwrap_or(0.0);
    let doubtful = below(LOW).saturating_sub(below(least));
    if doubtful > 0 {
        report.warnings.push(format!(
            "{doubtful} of {} residues have a pLDDT below {LOW}, so that where they stand is likely no fact: \
             --min-plddt {LOW} leaves them out",
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
