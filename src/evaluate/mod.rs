//! Judging poses by a known complex: interface and ligand RMSD, native contacts, DockQ and CAPRI class.
//!
//! # Conventions
//!
//! - The user's receptor and ligand are the molecules as docked, each in its file's frame; the native is in any
//!   frame. A [`Pose`] takes a ligand atom x to R x + t in the receptor's frame. Lengths are in Å.
//! - **Residues** are matched by number and insertion code where these agree, and by sequence otherwise. Only equal
//!   residues are matched.
//! - **Chains** are matched by sequence, whatever their names. Of all assignments to native chains that touch, each pose
//!   gets the one with its best DockQ, as in DockQ 2; names decide between equal ones. A [`ChainChoice`] restricts them.
//!   Of a side of several chains, every pair of equal chains is superposed, which fixes the others. Contacts of fewer
//!   than 10 residues, and of less than a fifth of the largest interface, count only if the user names chains.
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
//! - `capri`: by the rules of [`Capri`] from `fnat`, `irmsd` and `lrmsd`; `incorrect` if the backbone of a side lies more
//!   than 15 Å RMSD from the native's.
//!
//! # Cost
//!
//! [`Evaluator::new`] aligns, superposes and lists contacts once. A pose then costs one eigenvalue problem of a 4 x 4
//! matrix, three quadratic forms and the contacts' atoms, whatever the size of the molecules. Of several assignments
//! only those are counted through whose RMSDs allow the best DockQ (branch and bound).

mod chain_choice;
mod conformation;
mod contacts;
mod matching;
mod native;
mod quality;
mod report;
mod residues;
mod rmsd;
mod shared_chains;
#[cfg(test)]
mod test_molecules;
#[cfg(test)]
mod tests;

use std::collections::{BTreeSet, HashMap, HashSet};

use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;
use rayon::prelude::*;

pub use chain_choice::ChainChoice;
pub use conformation::{Superposed, superpose};
pub use native::Native;
pub use quality::{Capri, Criterion, PoseQuality, dockq};
pub use report::{ChainMatch, MatchMethod, MatchReport, NativeComplex, SideMatch};
pub use residues::Trace;
pub use shared_chains::{SharedChains, shared_chains};

use crate::evaluate::matching::superposition::MAX_FIT_RMSD;
use contacts::{AcrossPair, NativeContacts, pairs_across};
use native::{Assignment, check_docked_share};
use residues::Residues;
use rmsd::{RmsdForms, Rmsds, Side, ligand_is_smaller};

/// Least share of a side's native interface residues that must be matched for its figures to mean anything.
const MIN_INTERFACE_SHARE: f64 = 0.5;
/// Fewest backbone atoms that fix a superposition.
const MIN_ATOMS: usize = 3;

/// DockQ figures that differ by less are equal: rounding does not decide between assignments.
const EQUAL_DOCKQ: f64 = 1e-9;

/// One assignment of chains, prepared to evaluate poses.
#[derive(Clone, Debug)]
struct PreparedAssignment {
    rmsds: RmsdForms,
    contacts: NativeContacts,
    /// Whether both sides have the native's shape.
    fits: bool,
    /// The native's receptor, superposed on the docked one, and ligand.
    traces: [Trace; 2],
    report: MatchReport,
}

/// A receptor, a ligand and their native, prepared to evaluate poses.
#[derive(Clone, Debug)]
pub struct Evaluator {
    /// Never empty; of equal DockQ the first is taken.
    assignments: Vec<PreparedAssignment>,
}

impl Evaluator {
    /// Matches the docked receptor and ligand with the native.
    ///
    /// # Errors
    /// [`Error`] when a molecule has no residues or no finite coordinates, or when the native has no
    /// contacts. Also when too little of the native's interface or of a docked side is matched.
    pub fn new(receptor: &Molecule, ligand: &Molecule, native: Native) -> Result<Self, Error> {
        Self::with_chains(receptor, ligand, native, &ChainChoice::default())
    }

    /// Matches as [`Self::new`], with native chains that the user chooses.
    ///
    /// # Errors
    /// Those of [`Self::new`], and a choice of chains that are not there.
    pub fn with_chains(
        receptor: &Molecule,
        ligand: &Molecule,
        native: Native,
        choice: &ChainChoice,
    ) -> Result<Self, Error> {
        let docked = [
            Residues::of(receptor, "receptor")?,
            Residues::of(ligand, "ligand")?,
        ];
        let found = native::assignments([&docked[0], &docked[1]], native, choice)?;
        let across: Vec<Vec<AcrossPair>> = found
            .groups
            .iter()
            .map(|[receptor, ligand]| pairs_across(&receptor.residues, &ligand.residues))
            .collect();
        let mut assignments = Vec::new();
        let mut first_error = None;
        for one in &found.list {
            let (groups, across) = (&found.groups[one.groups], &across[one.groups]);
            match prepare([&docked[0], &docked[1]], one, groups, across) {
                Ok(prepared) => assignments.push(prepared),
                Err(error) => first_error = first_error.or(Some(error)),
            }
        }
        if assignments.is_empty() {
            return Err(first_error.unwrap_or_else(|| native::unmatched("receptor")));
        }
        let permutations = assignments.len();
        for PreparedAssignment { report, .. } in &mut assignments {
            report.permutations = permutations;
            report.complexes.clone_from(&found.complexes);
            report.unused_native_chains.clone_from(&found.unused);
        }
        Ok(Self { assignments })
    }

    /// Report on the first assignment.
    pub fn report(&self) -> &MatchReport {
        &self.assignments[0].report
    }

    /// Judges one pose of the ligand.
    pub fn evaluate(&self, pose: &Pose) -> PoseQuality {
        self.best(pose).0
    }

    /// Judges one pose of the ligand, with the report of its best assignment.
    pub fn best(&self, pose: &Pose) -> (PoseQuality, &MatchReport) {
        let (quality, place) = self.assigned(pose);
        (quality, &self.assignments[place].report)
    }

    /// The known complexes by which poses are measured, and the place of each pose's own among them. A complex is the
    /// traces of receptor and ligand in the frame of the docked receptor, on which the known one is superposed.
    pub fn known(&self, poses: &[Pose]) -> (Vec<&[Trace; 2]>, Vec<usize>) {
        let own = poses.par_iter().map(|pose| self.assigned(pose).1);
        let own: Vec<usize> = own.collect();
        let used: BTreeSet<usize> = own.iter().copied().collect();
        let places = own.iter().map(|&one| used.range(..one).count()).collect();
        let traces = used.iter().map(|&one| &self.assignments[one].traces);
        (traces.collect(), places)
    }

    /// Judges one pose by its best assignment, with the place of that.
    fn assigned(&self, pose: &Pose) -> (PoseQuality, usize) {
        let bounded = self.assignments.iter().enumerate().map(|(place, one)| {
            let rmsds = one.rmsds.at(pose);
            let bound = dockq(one.contacts.most_kept(), rmsds.interface, rmsds.ligand);
            (bound, place, rmsds)
        });
        let mut bounded: Vec<_> = bounded.collect();
        bounded.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (_, mut best, rmsds) = bounded[0];
        let mut quality = self.assignments[best].quality(pose, rmsds);
        for &(bound, place, rmsds) in &bounded[1..] {
            if bound < quality.dockq - EQUAL_DOCKQ {
                break;
            }
            let other = self.assignments[place].quality(pose, rmsds);
            let gain = other.dockq - quality.dockq;
            if gain > EQUAL_DOCKQ || (gain >= -EQUAL_DOCKQ && place < best) {
                (quality, best) = (other, place);
            }
        }
        (quality, best)
    }
}

impl PreparedAssignment {
    fn quality(&self, pose: &Pose, rmsds: Rmsds) -> PoseQuality {
        let fnat = self.contacts.share_kept(pose);
        PoseQuality {
            irmsd: rmsds.interface,
            lrmsd: rmsds.ligand,
            fnat,
            dockq: dockq(fnat, rmsds.interface, rmsds.ligand),
            capri: match self.fits {
                true => Capri::of(fnat, rmsds.interface, rmsds.ligand),
                false => Capri::Incorrect,
            },
        }
    }
}

/// Prepares one assignment; `across` are the groups' residue pairs.
fn prepare(
    docked: [&Residues; 2],
    assignment: &Assignment,
    groups: &[Residues; 2],
    across: &[AcrossPair],
) -> Result<PreparedAssignment, Error> {
    if !across.iter().any(|pair| pair.contact) {
        return Err(contacts::no_contact());
    }
    let placements = assignment.placements.each_ref();
    let pairs = placements.map(|one| one.pairs().collect::<Vec<_>>());
    let rmsds = RmsdForms::new(
        std::array::from_fn(|side| Side {
            user: docked[side],
            native: &groups[side],
            pairs: &pairs[side],
        }),
        across,
    );
    let docked_of = pairs.map(|pairs| -> HashMap<usize, usize> {
        let pairs = pairs.into_iter();
        pairs.map(|(user, native)| (native, user)).collect()
    });
    let contacts = NativeContacts::new(across, docked.map(|side| &side.residues[..]), &docked_of);
    let backbone_rmsd = rmsds.of_the_parts();
    let sides: [SideMatch; 2] = std::array::from_fn(|side| {
        let near: HashSet<usize> = across.iter().map(|pair| pair.residues[side]).collect();
        let (user, native) = (docked[side], &groups[side]);
        SideMatch::new(
            user,
            native,
            &placements[side].chains,
            &near,
            backbone_rmsd[side],
        )
    });
    check_matched(&sides, &rmsds)?;
    Ok(PreparedAssignment {
        fits: backbone_rmsd.iter().all(|rmsd| *rmsd <= MAX_FIT_RMSD),
        traces: groups
            .each_ref()
            .map(|group| group.trace(&rmsds.to_receptor())),
        report: match_report(sides, groups, &contacts),
        rmsds,
        contacts,
    })
}

/// Refuses a match of too few residues or atoms.
fn check_matched(sides: &[SideMatch; 2], rmsds: &RmsdForms) -> Result<(), Error> {
    let named = ["receptor", "ligand"].into_iter().zip(sides);
    for ((side, found), atoms) in named.zip(rmsds.atoms()) {
        let interface = found.interface_residues.max(1) as f64;
        if (found.interface_matched as f64 / interface) < MIN_INTERFACE_SHARE {
            return Err(Error::input(format!(
                "only {} of the {} residues that the native's {side} has at the interface are matched in the {side} \
                 that was docked; at least half are needed",
                found.interface_matched, found.interface_residues
            ))
            .help(
                "check that the native is of the same proteins and that receptor and ligand are not exchanged; name \
                 the native's chains with --native-receptor FILE:CHAINS and --native-ligand FILE:CHAINS. Only \
                 residues of the same name are matched",
            ));
        }
        if atoms < MIN_ATOMS {
            return Err(Error::input(format!(
                "only {atoms} backbone atoms of the {side} are matched with the native; at least 3 are needed"
            ))
            .help("give files with backbone atoms (N, CA, C and O) for all residues"));
        }
        check_docked_share(side, found.matched, found.residues)?;
    }
    // Each side may have half of the interface, and yet no part of it be matched on both.
    let atoms = rmsds.interface_atoms();
    if atoms.contains(&0) || atoms.iter().sum::<usize>() < MIN_ATOMS {
        let [receptor, ligand] = atoms;
        return Err(Error::input(format!(
            "only {receptor} and {ligand} backbone atoms of receptor and ligand are matched on both sides of one \
             place of the native's interface; some of each and 3 in all are needed"
        ))
        .help(
            "give files with the residues of the interface and their backbone atoms (N, CA, C and O), and check that \
             the native is of the same proteins",
        ));
    }
    Ok(())
}

/// The report of one assignment.
fn match_report(
    [receptor, ligand]: [SideMatch; 2],
    groups: &[Residues; 2],
    contacts: &NativeContacts,
) -> MatchReport {
    let kept = receptor.interface_matched + ligand.interface_matched;
    let interface = receptor.interface_residues + ligand.interface_residues;
    MatchReport {
        interface_share: kept as f64 / interface.max(1) as f64,
        native_contacts: contacts.total,
        native_contacts_matched: contacts.pairs.len(),
        dockq_ligand: if ligand_is_smaller(&groups[0], &groups[1]) {
            "ligand"
        } else {
            "receptor"
        },
        native_chains: assigned([&receptor, &ligand]),
        permutations: 1,
        complexes: Vec::new(),
        warnings: Vec::new(),
        unused_native_chains: Vec::new(),
        receptor,
        ligand,
    }
    .warned()
}

/// The chains of both sides with the native's, each pair once.
fn assigned(sides: [&SideMatch; 2]) -> String {
    let mut pairs: Vec<String> = Vec::new();
    for side in sides {
        let mut own: Vec<_> = side.chains.iter().map(ChainMatch::names).collect();
        own.sort();
        own.dedup();
        pairs.extend(
            own.into_iter()
                .map(|(docked, native)| format!("{docked}:{native}")),
        );
    }
    pairs.join(",")
}
