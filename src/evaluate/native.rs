//! The native complex, as two groups of chains, and the placements of the docked sides on it.

use std::collections::HashMap;

use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;

use super::chain_choice::ChainChoice;
use super::report::NativeComplex;
use super::residues::Residues;
use crate::evaluate::matching::copies::{Combination, PlacedCopy, combinations};
use crate::evaluate::matching::placements::{Placement, placements};

/// The known answer that poses are judged by.
#[derive(Clone, Copy, Debug)]
pub enum Native<'a> {
    /// One file with the whole complex, perhaps in several copies. Every assignment of its chains that the sequences
    /// allow is tried for every pose, and the one with the best DockQ is taken.
    Complex(&'a Molecule),
    /// The two sides as separate molecules, in one common frame.
    Pair {
        /// The native's receptor.
        receptor: &'a Molecule,
        /// The native's ligand.
        ligand: &'a Molecule,
    },
}

/// Least share of a docked side's residues that must be matched, unless [`ENOUGH_RESIDUES`] are: then chance has no part
/// in it.
const MIN_DOCKED_SHARE: f64 = 0.25;
const ENOUGH_RESIDUES: usize = 50;
/// Share of the best identity, of equal residues among the aligned ones, that a placement must have: paralogues would
/// pass for each other.
const MIN_IDENTITY_OF_BEST: f64 = 0.9;
/// Most complexes that are listed.
const MAX_LISTED: usize = 24;

/// Part of a complex: segments, each with the residues of it that belong to the part.
type Part = Vec<(usize, Vec<usize>)>;

/// Receptor and ligand on the native's two sides; residues and segments of the native are those of the groups.
#[derive(Clone, Debug)]
pub(super) struct Assignment {
    /// Index into [`Assignments::groups`].
    pub groups: usize,
    /// Placements of receptor and ligand.
    pub placements: [Placement; 2],
}

/// Every assignment of the docked sides to the native's, those of most equal chain names first.
#[derive(Clone, Debug, Default)]
pub(super) struct Assignments {
    /// The native's two sides, receptor first.
    pub groups: Vec<[Residues; 2]>,
    pub list: Vec<Assignment>,
    /// The complexes that the native holds, at most [`MAX_LISTED`], those that poses are measured by first.
    pub complexes: Vec<NativeComplex>,
    /// Names of the native's chains that belong to no assignment.
    pub unused: Vec<String>,
}

/// The assignments of the docked sides to the native's.
///
/// # Errors
/// [`Error`] for residues that cannot be read, and for a choice of chains that are not there. Also if no chain is the
/// receptor's or none the ligand's, and for a whole complex if it has one copy of both or they do not touch.
pub(super) fn assignments(
    docked: [&Residues; 2],
    native: Native,
    choice: &ChainChoice,
) -> Result<Assignments, Error> {
    match native {
        Native::Pair { receptor, ligand } => {
            let groups = [
                Residues::of(receptor, "native receptor")?,
                Residues::of(ligand, "native ligand")?,
            ];
            of_pair(docked, groups, choice)
        }
        Native::Complex(complex) => of_complex(docked, &Residues::of(complex, "native")?, choice),
    }
}

fn of_pair(
    docked: [&Residues; 2],
    groups: [Residues; 2],
    choice: &ChainChoice,
) -> Result<Assignments, Error> {
    let natives = [&groups[0], &groups[1]];
    choice.check(docked, &natives)?;
    let placements = all_placed(docked, natives, choice)?;
    let copies = copies(docked, natives, &placements);
    // Chains without a match may touch all the same. Another check is for the matched share of the interface.
    let (measured, set_aside) = match combinations(copies, false, choice.named) {
        Ok(found) => (found.measured, found.set_aside),
        Err(_) => {
            let first = Combination {
                placements: [0, 0],
                contacts: 0,
            };
            (vec![first], Vec::new())
        }
    };
    let list = measured.iter().map(|one| Assignment {
        groups: 0,
        placements: one.of(&placements).map(Placement::clone),
    });
    Ok(Assignments {
        list: list.collect(),
        complexes: complexes(copies, measured.iter().chain(&set_aside)),
        groups: vec![groups],
        unused: Vec::new(),
    })
}

fn of_complex(
    docked: [&Residues; 2],
    complex: &Residues,
    choice: &ChainChoice,
) -> Result<Assignments, Error> {
    choice.check(docked, &[complex])?;
    let placements = all_placed(docked, [complex, complex], choice)?;
    let copies = copies(docked, [complex, complex], &placements);
    let all = combinations(copies, true, choice.named)?;
    let mut found = Assignments {
        complexes: complexes(copies, all.measured.iter().chain(&all.set_aside)),
        ..Assignments::default()
    };
    let mut splits: Vec<[Part; 2]> = Vec::new();
    for one in all.measured {
        let sides = one.of(&placements);
        let split = split(complex, sides);
        let groups = match splits.iter().position(|known| *known == split) {
            Some(groups) => groups,
            None => {
                let groups = split.each_ref().map(|part| complex.only(part));
                found.groups.push(groups);
                splits.push(split.clone());
                splits.len() - 1
            }
        };
        found.list.push(Assignment {
            groups,
            placements: std::array::from_fn(|side| in_group(sides[side], &split[side])),
        });
    }
    let parts = || splits.iter().flatten().flatten();
    found.unused = complex.unused(|index| parts().any(|(segment, _)| *segment == index));
    Ok(found)
}

/// Receptor and ligand with the native's residues and the placements of each.
fn copies<'a>(
    docked: [&'a Residues; 2],
    natives: [&'a Residues; 2],
    placements: &'a [Vec<Placement>; 2],
) -> [PlacedCopy<'a>; 2] {
    std::array::from_fn(|side| PlacedCopy {
        user: docked[side],
        native: natives[side],
        placements: &placements[side],
    })
}

/// The placements of receptor and ligand.
fn all_placed(
    docked: [&Residues; 2],
    natives: [&Residues; 2],
    choice: &ChainChoice,
) -> Result<[Vec<Placement>; 2], Error> {
    let [receptor, ligand] = docked;
    Ok([
        placed(receptor, natives[0], choice, "receptor")?,
        placed(ligand, natives[1], choice, "ligand")?,
    ])
}

/// The placements of one side whose sequences match, at least one that matches enough of it.
fn placed(
    user: &Residues,
    native: &Residues,
    choice: &ChainChoice,
    side: &'static str,
) -> Result<Vec<Placement>, Error> {
    let mut found = placements(user, native, choice);
    let best = found.iter().map(Placement::identity).fold(0.0, f64::max);
    found.retain(|placement| placement.identity() >= MIN_IDENTITY_OF_BEST * best);
    match found.iter().map(Placement::matched).max() {
        None => Err(unmatched(side)),
        Some(matched) => {
            check_docked_share(side, matched, user.residues.len())?;
            Ok(found)
        }
    }
}

/// A side that no chain of the native matches.
pub(super) fn unmatched(side: &str) -> Error {
    Error::input(format!("no chain of the native has the sequence of the {side}")).help(
        "name the chains of the native that belong to each side with --native-receptor FILE:CHAINS and \
         --native-ligand FILE:CHAINS, and check that they are the same proteins and that receptor and ligand are not \
         exchanged",
    )
}

/// Refuses a side of which too little is matched for the figures to mean anything: some residues are equal by chance.
pub(super) fn check_docked_share(
    side: &'static str,
    matched: usize,
    residues: usize,
) -> Result<(), Error> {
    if matched < ENOUGH_RESIDUES && (matched as f64) < MIN_DOCKED_SHARE * residues as f64 {
        return Err(Error::input(format!(
            "only {matched} of the docked {side}'s {residues} residues are matched with the native; a quarter or 50 \
             are needed"
        ))
        .help(
            "check that the native's chain is that of the docked molecule and no fragment or other peptide. If the \
             native has one domain of it, give --receptor and --ligand as docked, cut to that domain",
        ));
    }
    Ok(())
}

/// The complexes among the combinations, by the names of their chains, in the order given.
fn complexes<'a>(
    copies: [PlacedCopy; 2],
    all: impl Iterator<Item = &'a Combination>,
) -> Vec<NativeComplex> {
    let mut found: Vec<NativeComplex> = Vec::new();
    for one in all {
        let [receptor, ligand] = [0, 1].map(|side| -> Vec<String> {
            let copy = copies[side];
            let segments = copy.placements[one.placements[side]].native_segments();
            let names = segments
                .iter()
                .map(|&segment| &copy.native.segments[segment].name);
            names.cloned().collect()
        });
        let next = NativeComplex {
            receptor,
            ligand,
            contacts: one.contacts,
        };
        let is_known = |known: &NativeComplex| {
            (&known.receptor, &known.ligand) == (&next.receptor, &next.ligand)
                || (&known.receptor, &known.ligand) == (&next.ligand, &next.receptor)
        };
        if found.len() < MAX_LISTED && !found.iter().any(is_known) {
            found.push(next);
        }
    }
    found
}

/// The residues of the complex that belong to each side, segment by segment.
///
/// Both sides may match a part of one segment. Then each residue goes to the side whose nearest matched residue is
/// nearer in the sequence.
fn split(complex: &Residues, placements: [&Placement; 2]) -> [Part; 2] {
    let segments = placements.map(Placement::native_segments);
    let matched = placements.map(Placement::natives);
    [0, 1].map(|this| {
        let other = 1 - this;
        let of_segment = |&segment: &usize| {
            let members = complex.segments[segment].members.iter().copied();
            let members = if segments[other].contains(&segment) {
                let is_ours = |&member: &usize| {
                    let [own, others] = [this, other].map(|side| nearest(&matched[side], member));
                    own < others || (own == others && this == 0)
                };
                members.filter(is_ours).collect()
            } else {
                members.collect()
            };
            (segment, members)
        };
        segments[this].iter().map(of_segment).collect()
    })
}

/// Distance to the nearest of some rising numbers.
fn nearest(rising: &[usize], number: usize) -> usize {
    let place = rising.partition_point(|&one| one < number);
    let around = [place.checked_sub(1), Some(place)].into_iter().flatten();
    let distances = around.filter_map(|place| rising.get(place).map(|one| one.abs_diff(number)));
    distances.min().unwrap_or(usize::MAX)
}

/// A placement whose residues and segments of the native are those of a group, which holds the segments and members
/// given.
fn in_group(placement: &Placement, group: &[(usize, Vec<usize>)]) -> Placement {
    let members = group.iter().flat_map(|(_, members)| members).copied();
    let places: HashMap<usize, usize> = members.zip(0..).collect();
    let mut placement = placement.clone();
    for chain in &mut placement.chains {
        let place = group
            .iter()
            .position(|(segment, _)| *segment == chain.native);
        chain.native = place.unwrap_or_default();
        let pairs = chain.pairs.iter();
        let pairs = pairs.filter_map(|&(user, native)| Some((user, *places.get(&native)?)));
        chain.pairs = pairs.collect();
    }
    placement
}
