//! Report on the matching: which parts of the native and of the docked molecules the figures cover.

use serde::Serialize;

use super::residues::{Residues, chain_of};
use crate::evaluate::matching::chain_pair::ChainPair;
use crate::evaluate::matching::superposition::MAX_FIT_RMSD;

/// Share of a docked side's residues below which the match is worth a warning.
const GOOD_DOCKED_SHARE: f64 = 0.7;
/// Backbone RMSD in Å of a docked side from the native's above which the match is worth a warning.
const GOOD_FIT: f64 = 5.0;

/// Method by which a chain's residues were matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum MatchMethod {
    /// All matched residues have the same number and insertion code in both files.
    Number,
    /// By sequence alignment: at least one pair differs in number.
    Sequence,
}

/// A docked chain matched with one of the native's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChainMatch {
    /// Chain name in the user's file; `/2`, `/3` ... mark further runs of numbers under one name.
    pub chain: String,
    /// Chain name in the native.
    pub native_chain: String,
    /// How they were matched.
    pub method: MatchMethod,
    /// Equal residues matched.
    pub matched: usize,
    /// Equal residues as a share, 0 to 1, of all aligned ones.
    pub identity: f64,
}

impl ChainMatch {
    /// Names of both chains as their files have them, `_` for an empty one.
    pub(super) fn names(&self) -> (&str, &str) {
        let plain = |name| match chain_of(name) {
            "" => "_",
            chain => chain,
        };
        (plain(&self.chain), plain(&self.native_chain))
    }
}

/// The match of one side.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SideMatch {
    /// Residues of the docked molecule.
    pub residues: usize,
    /// Residues of the native's.
    pub native_residues: usize,
    /// Equal residues matched.
    pub matched: usize,
    /// `matched` as a share, 0 to 1, of the native's residues.
    pub matched_share: f64,
    /// `matched` as a share, 0 to 1, of the residues of the docked molecule.
    pub docked_share: f64,
    /// Matched residues whose number and insertion code agree; the others were matched by sequence.
    pub matched_by_number: usize,
    /// Native residues within 10 Å of the other side.
    pub interface_residues: usize,
    /// Those of them that are matched.
    pub interface_matched: usize,
    /// Backbone RMSD in Å of the docked molecule superposed on the native's, which rigid docking cannot correct.
    pub backbone_rmsd: f64,
    /// Chain by chain, the one with most matched residues first.
    pub chains: Vec<ChainMatch>,
    /// Docked chains that no chain of the native matches.
    pub unmatched_chains: Vec<String>,
    /// Chains of the native that no docked chain matches.
    pub unmatched_native_chains: Vec<String>,
}

/// Two groups of the native's chains that touch and that the docked sides superpose on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NativeComplex {
    /// The native's chains that the receptor is superposed on.
    pub receptor: Vec<String>,
    /// Those that the ligand is superposed on.
    pub ligand: Vec<String>,
    /// Residue contacts (5 Å) between them.
    pub contacts: usize,
}

/// The match of the docked molecules with the native.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MatchReport {
    /// The receptor's match.
    pub receptor: SideMatch,
    /// The ligand's match.
    pub ligand: SideMatch,
    /// Share, 0 to 1, of the native's interface residues of both sides that are matched.
    pub interface_share: f64,
    /// Residue contacts (5 Å) of the native.
    pub native_contacts: usize,
    /// Those of them whose two residues are matched: the most that a pose can keep.
    pub native_contacts_matched: usize,
    /// The side that is the ligand in `lrmsd`, `dockq` and `capri`: the one of fewer residues, as in DockQ.
    pub dockq_ligand: &'static str,
    /// The chains matched, as `DOCKED:NATIVE,DOCKED:NATIVE`.
    pub native_chains: String,
    /// Assignments of the native's chains to the docked ones; every pose is given the best of them by `dockq`. This
    /// report is of the first, unless a pose is named.
    pub permutations: usize,
    /// Chains of a native complex to which no docked chain is assigned.
    pub unused_native_chains: Vec<String>,
    /// The complexes that the native holds, at most 24: those of equal chain names first, then those of most contacts.
    /// Crystal contacts of a few residues, by which no pose is measured, come last.
    pub complexes: Vec<NativeComplex>,
    /// Warnings before trusting the figures: a docked side of which less than 70% is matched, or whose backbone is more
    /// than 5 Å RMSD from the native's. Beyond 15 Å the class of every pose is `incorrect`.
    pub warnings: Vec<String>,
}

impl MatchReport {
    /// The report with its warnings.
    pub(super) fn warned(mut self) -> Self {
        let mut warnings = Vec::new();
        for (name, side) in [("receptor", &self.receptor), ("ligand", &self.ligand)] {
            if side.docked_share < GOOD_DOCKED_SHARE {
                warnings.push(format!(
                    "only {} of the docked {name}'s {} residues ({:.0}%) are matched with the native",
                    side.matched,
                    side.residues,
                    100.0 * side.docked_share
                ));
            }
            if side.backbone_rmsd > MAX_FIT_RMSD {
                warnings.push(format!(
                    "the docked {name} does not fit the native: its backbone is {:.1} Å RMSD from it, more than \
                     {MAX_FIT_RMSD:.0} Å, so every pose counts as incorrect; name native chains that belong together, \
                     as in --native FILE:A,B, or dock parts that move apart",
                    side.backbone_rmsd
                ));
            } else if side.backbone_rmsd > GOOD_FIT {
                warnings.push(format!(
                    "the docked {name} has another shape than the native's: its backbone is {:.1} Å RMSD from it",
                    side.backbone_rmsd
                ));
            }
        }
        self.warnings = warnings;
        self
    }
}

impl SideMatch {
    /// Counts what `assignment` matches; `interface` holds the native's interface residues of this side.
    pub(super) fn new(
        user: &Residues,
        native: &Residues,
        assignment: &[ChainPair],
        interface: &std::collections::HashSet<usize>,
        backbone_rmsd: f64,
    ) -> Self {
        let same_number =
            |&&(i, j): &&(usize, usize)| user.residues[i].number == native.residues[j].number;
        let chains: Vec<_> = assignment
            .iter()
            .map(|chain| {
                let by_number = chain.pairs.iter().filter(same_number).count();
                ChainMatch {
                    chain: user.segments[chain.user].name.clone(),
                    native_chain: native.segments[chain.native].name.clone(),
                    method: if by_number == chain.pairs.len() {
                        MatchMethod::Number
                    } else {
                        MatchMethod::Sequence
                    },
                    matched: chain.pairs.len(),
                    identity: chain.pairs.len() as f64 / chain.aligned.max(1) as f64,
                }
            })
            .collect();
        let all = || assignment.iter().flat_map(|chain| &chain.pairs);
        let matched = all().count();
        Self {
            residues: user.residues.len(),
            native_residues: native.residues.len(),
            matched,
            matched_share: matched as f64 / native.residues.len().max(1) as f64,
            docked_share: matched as f64 / user.residues.len().max(1) as f64,
            matched_by_number: all().filter(same_number).count(),
            interface_residues: interface.len(),
            interface_matched: all().filter(|(_, j)| interface.contains(j)).count(),
            backbone_rmsd,
            chains,
            unmatched_chains: user.unused(|index| assignment.iter().any(|c| c.user == index)),
            unmatched_native_chains: native
                .unused(|index| assignment.iter().any(|c| c.native == index)),
        }
    }
}
