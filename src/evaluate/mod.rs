//! Judging poses by a known complex: interface and ligand RMSD, native contacts, DockQ and CAPRI class.
//!
//! # Conventions
//!
//! - The user's receptor and ligand are the molecules as docked, each in its file's frame; the native may lie in any
//!   frame. A [`Pose`] takes a ligand atom x to R x + t in the receptor's frame. Lengths are in Å.
//! - **Residues** are matched by number and insertion code where these agree, and by sequence otherwise. Only equal
//!   residues are matched.
//! - **Chains** are matched by sequence and place, whatever their names: each side is superposed on the native's
//!   chains. Of the native's copies those are taken that superpose, touch and have most contacts. Where identical
//!   chains of that complex can be matched in several ways, each pose gets the one with the best DockQ.
//! - **Backbone** is N, CA, C and O, and phosphate and sugar in nucleic acids, of matched residues, where both have the
//!   atom. Hydrogens, waters, ions, cofactors and glycans play no part.
//! - `irmsd`: backbone of the native's interface residues (any heavy atom within 10 Å across) after superposing them.
//! - `lrmsd`: backbone of the smaller side after superposing the larger on the native's. As in DockQ 2.1.3 the
//!   smaller side is the one of fewer native residues, and of two equal ones the receptor. So figures of unequal
//!   sides are the same whichever is called the receptor.
//! - `fnat`: share of the native's residue contacts (any heavy atoms within 5 Å) that the pose has too. Contacts of
//!   residues without a match count as lost.
//! - `dockq`: as DockQ 2.1.3 computes it. DockQ pairs residues by sequence alone: where a residue is missing beside
//!   one of the same kind it may pair the wrong one. (LEU 8 of 1PPE's unbound ligand is paired with LEU 7, since the
//!   native lacks 8.) Then our figures are those that it gives for the pairs that the numbers name.
//! - `capri`: by the rules of [`Capri`] from `fnat`, `irmsd` and `lrmsd`.
//!
//! # Cost
//!
//! [`Evaluator::new`] aligns, superposes and lists contacts once. A pose then costs one eigenvalue problem of a 4 x 4
//! matrix, three quadratic forms and the contacts' atoms, whatever the size of the molecules.

mod conformation;
mod contacts;
mod criterion;
mod dockq;
mod error;
mod matching;
mod native;
mod report;
mod residues;
mod rmsd;
mod shared_chains;
#[cfg(test)]
mod test_molecules;
#[cfg(test)]
mod tests;

use std::collections::{HashMap, HashSet};

use knotdock_scoring::se3::Pose;
use knotdock_structures::molecule::Molecule;
use serde::Serialize;

pub use conformation::{ConformationError, Superposed, superpose};
pub use criterion::Criterion;
pub use dockq::{Capri, dockq};
pub use error::EvaluateError;
pub use native::Native;
pub use report::{ChainMatch, MatchMethod, MatchReport, NativeComplex, SideMatch};
pub use shared_chains::{SharedChains, shared_chains};

use crate::evaluate::matching::placement::Placement;
use crate::evaluate::matching::superposition::MAX_FIT_RMSD;
use contacts::{AcrossPair, NativeContacts, pairs_across};
use native::{Groups, Way, check_docked_share};
use residues::Residues;
use rmsd::{RmsdForms, Side, ligand_is_smaller};

/// Least share of a side's native interface residues that must be matched for its figures to mean anything.
const MIN_INTERFACE_SHARE: f64 = 0.5;
/// Fewest backbone atoms that fix a superposition.
const MIN_ATOMS: usize = 3;

/// Quality of a pose against the native. All numbers are finite.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PoseQuality {
    /// Interface RMSD, in Å.
    pub irmsd: f64,
    /// RMSD of the smaller side with the larger superposed, in Å.
    pub lrmsd: f64,
    /// Share of native contacts kept, 0 to 1.
    pub fnat: f64,
    /// DockQ, 0 to 1.
    pub dockq: f64,
    /// CAPRI class.
    pub capri: Capri,
}

/// Everything about one way of matching that evaluating a pose needs.
#[derive(Clone, Debug)]
struct Arrangement {
    rmsds: RmsdForms,
    contacts: NativeContacts,
}

impl Arrangement {
    fn evaluate(&self, pose: &Pose) -> PoseQuality {
        let rmsds = self.rmsds.at(pose);
        let fnat = self.contacts.share_kept(pose);
        PoseQuality {
            irmsd: rmsds.interface,
            lrmsd: rmsds.ligand,
            fnat,
            dockq: dockq(fnat, rmsds.interface, rmsds.ligand),
            capri: Capri::of(fnat, rmsds.interface, rmsds.ligand),
        }
    }
}

/// A receptor, a ligand and their native, prepared to evaluate poses.
#[derive(Clone, Debug)]
pub struct Evaluator {
    first: Arrangement,
    others: Vec<Arrangement>,
    report: MatchReport,
}

impl Evaluator {
    /// Matches the user's receptor and ligand, as docked, with the native.
    ///
    /// # Errors
    /// [`EvaluateError`] when a molecule has no residues or no finite coordinates, or when the native has no
    /// contacts. Also when a side does not fit the native's, or too little of the native's interface or of a docked
    /// side is matched.
    pub fn new(
        receptor: &Molecule,
        ligand: &Molecule,
        native: Native,
    ) -> Result<Self, EvaluateError> {
        let receptor = Residues::of(receptor, "receptor")?;
        let ligand = Residues::of(ligand, "ligand")?;
        let found = native::ways(&receptor, &ligand, native)?;
        let across: Vec<Vec<AcrossPair>> = found
            .groups
            .iter()
            .map(|groups| pairs_across(&groups.receptor.residues, &groups.ligand.residues))
            .collect();
        let mut prepared: Vec<(Arrangement, MatchReport)> = Vec::new();
        let mut first_error = None;
        for way in &found.ways {
            let (groups, across) = (&found.groups[way.groups], &across[way.groups]);
            match arrange(&receptor, &ligand, way, groups, across) {
                Ok(arrangement) => prepared.push(arrangement),
                Err(error) => first_error = first_error.or(Some(error)),
            }
        }
        let permutations = prepared.len();
        let mut prepared = prepared.into_iter();
        let Some((first, report)) = prepared.next() else {
            return Err(first_error.unwrap_or(EvaluateError::Unmatched { side: "receptor" }));
        };
        Ok(Self {
            first,
            others: prepared.map(|(arrangement, _)| arrangement).collect(),
            report: MatchReport {
                permutations,
                complexes: found.complexes,
                ..report
            },
        })
    }

    /// Report on the matching.
    pub fn report(&self) -> &MatchReport {
        &self.report
    }

    /// Judges one pose of the ligand.
    pub fn evaluate(&self, pose: &Pose) -> PoseQuality {
        let first = self.first.evaluate(pose);
        self.others.iter().fold(first, |best, other| {
            let quality = other.evaluate(pose);
            if quality.dockq > best.dockq {
                quality
            } else {
                best
            }
        })
    }
}

/// Prepares one way of matching; `across` are the groups' residue pairs.
fn arrange(
    receptor: &Residues,
    ligand: &Residues,
    way: &Way,
    groups: &Groups,
    across: &[AcrossPair],
) -> Result<(Arrangement, MatchReport), EvaluateError> {
    if !across.iter().any(|pair| pair.contact) {
        return Err(EvaluateError::NoContact);
    }
    check_fit("receptor", &way.receptor)?;
    check_fit("ligand", &way.ligand)?;
    let receptor_pairs: Vec<_> = way.receptor.pairs().collect();
    let ligand_pairs: Vec<_> = way.ligand.pairs().collect();
    let rmsds = RmsdForms::new(
        Side {
            user: receptor,
            native: &groups.receptor,
            pairs: &receptor_pairs,
        },
        Side {
            user: ligand,
            native: &groups.ligand,
            pairs: &ligand_pairs,
        },
        across,
    );
    let of_native = |pairs: &[(usize, usize)]| -> HashMap<usize, usize> {
        pairs.iter().map(|&(user, native)| (native, user)).collect()
    };
    let contacts = NativeContacts::new(
        across,
        &receptor.residues,
        &ligand.residues,
        &of_native(&receptor_pairs),
        &of_native(&ligand_pairs),
    );
    let sides = side_matches([receptor, ligand], way, groups, across, &rmsds);
    check_matched(&sides, &rmsds)?;
    let report = match_report(sides, groups, &contacts);
    Ok((Arrangement { rmsds, contacts }, report))
}

/// Report on the matching of receptor and ligand.
fn side_matches(
    [receptor, ligand]: [&Residues; 2],
    way: &Way,
    groups: &Groups,
    across: &[AcrossPair],
    rmsds: &RmsdForms,
) -> [SideMatch; 2] {
    let receptor_near: HashSet<_> = across.iter().map(|pair| pair.receptor).collect();
    let ligand_near: HashSet<_> = across.iter().map(|pair| pair.ligand).collect();
    let (receptor_rmsd, ligand_rmsd) = rmsds.of_the_parts();
    [
        SideMatch::new(
            receptor,
            &groups.receptor,
            &way.receptor.chains,
            &receptor_near,
            receptor_rmsd,
        ),
        SideMatch::new(
            ligand,
            &groups.ligand,
            &way.ligand.chains,
            &ligand_near,
            ligand_rmsd,
        ),
    ]
}

/// Refuses a match of too few residues or atoms.
fn check_matched(sides: &[SideMatch; 2], rmsds: &RmsdForms) -> Result<(), EvaluateError> {
    let (receptor_atoms, ligand_atoms) = rmsds.atoms();
    let named = ["receptor", "ligand"].into_iter().zip(sides);
    for ((side, found), atoms) in named.zip([receptor_atoms, ligand_atoms]) {
        if found.interface_share() < MIN_INTERFACE_SHARE {
            return Err(EvaluateError::Interface {
                side,
                matched: found.interface_matched,
                interface: found.interface_residues,
            });
        }
        if atoms < MIN_ATOMS {
            return Err(EvaluateError::Backbone { side, atoms });
        }
        check_docked_share(side, found.matched, found.residues)?;
    }
    // Each side may have half of the interface and yet no place of it be matched on both.
    let atoms = rmsds.interface_atoms();
    if atoms.contains(&0) || atoms.iter().sum::<usize>() < MIN_ATOMS {
        return Err(EvaluateError::Across { atoms });
    }
    Ok(())
}

/// The report of one way of matching.
fn match_report(
    [receptor, ligand]: [SideMatch; 2],
    groups: &Groups,
    contacts: &NativeContacts,
) -> MatchReport {
    let kept = receptor.interface_matched + ligand.interface_matched;
    let interface = receptor.interface_residues + ligand.interface_residues;
    MatchReport {
        interface_share: kept as f64 / interface.max(1) as f64,
        native_contacts: contacts.total(),
        native_contacts_matched: contacts.matched(),
        dockq_ligand: if ligand_is_smaller(&groups.receptor, &groups.ligand) {
            "ligand"
        } else {
            "receptor"
        },
        permutations: 1,
        complexes: Vec::new(),
        warnings: Vec::new(),
        unused_native_chains: groups.unused.clone(),
        receptor,
        ligand,
    }
    .warned()
}

/// Refuses a side that does not fit the native's as one rigid body.
fn check_fit(side: &'static str, placement: &Placement) -> Result<(), EvaluateError> {
    if let Some(displaced) = &placement.displaced {
        return Err(EvaluateError::Displaced {
            side,
            chain: displaced.chain.clone(),
            native_chain: displaced.native_chain.clone(),
            distance: displaced.distance,
        });
    }
    if placement.rmsd > MAX_FIT_RMSD {
        return Err(EvaluateError::Superposition {
            side,
            rmsd: placement.rmsd,
        });
    }
    Ok(())
}
