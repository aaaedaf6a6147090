//! The native complex, as two groups of chains, and the ways in which the docked sides lie on it.

use std::collections::HashMap;

use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;

use super::chain_choice::ChainChoice;
use super::report::NativeComplex;
use super::residues::Residues;
use crate::evaluate::matching::copies::{Combination, PlacedCopy, combinations};
use crate::evaluate::matching::placement::Placement;
use crate::evaluate::matching::placements::placements;

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

/// Least share of a docked side's residues that must be matched, unless so many are matched that chance has no part
/// in it.
const MIN_DOCKED_SHARE: f64 = 0.25;
const ENOUGH_RESIDUES: usize = 50;
/// Share of the best identity, of equal residues among the aligned ones, that a placement must have: paralogues would
/// pass for each other.
const MIN_IDENTITY_OF_BEST: f64 = 0.9;
/// Most complexes that are listed.
const MOST_LISTED: usize = 24;

/// The native's two sides.
#[derive(Clone, Debug)]
pub(super) struct Groups {
    pub receptor: Residues,
    pub ligand: Residues,
}

/// Part of a complex: segments, each with the residues of it that belong to the part.
type Part = Vec<(usize, Vec<usize>)>;

/// Receptor and ligand on the native's two sides; residues and segments of the native are those of the groups.
#[derive(Clone, Debug)]
pub(super) struct Way {
    /// Index into [`Ways::groups`].
    pub groups: usize,
    pub receptor: Placement,
    pub ligand: Placement,
}

/// Every way to see the docked sides in the native, those of most equal chain names first.
#[derive(Clone, Debug, Default)]
pub(super) struct Ways {
    pub groups: Vec<Groups>,
    pub ways: Vec<Way>,
    /// The complexes that the native holds, at most [`MOST_LISTED`], those that poses are measured by first.
    pub complexes: Vec<NativeComplex>,
    /// Names of the native's chains that belong to no way.
    pub unused: Vec<String>,
}

/// The ways to see the docked sides in the native.
///
/// # Errors
/// [`Error`] for residues that cannot be read, for a choice of chains that are not there, and if no chain is the
/// receptor's or none the ligand's; for a whole complex also if it has one copy of both or they do not touch.
pub(super) fn ways(
    receptor: &Residues,
    ligand: &Residues,
    native: Native,
    choice: &ChainChoice,
) -> Result<Ways, Error> {
    match native {
        Native::Pair {
            receptor: native_receptor,
            ligand: native_ligand,
        } => {
            let groups = Groups {
                receptor: Residues::of(native_receptor, "native receptor")?,
                ligand: Residues::of(native_ligand, "native ligand")?,
            };
            of_pair(receptor, ligand, groups, choice)
        }
        Native::Complex(complex) => {
            let complex = Residues::of(complex, "native")?;
            of_complex(receptor, ligand, &complex, choice)
        }
    }
}

fn of_pair(
    receptor: &Residues,
    ligand: &Residues,
    groups: Groups,
    choice: &ChainChoice,
) -> Result<Ways, Error> {
    choice.check([receptor, ligand], &[&groups.receptor, &groups.ligand])?;
    let on_receptor = placed(receptor, &groups.receptor, choice, "receptor")?;
    let on_ligand = placed(ligand, &groups.ligand, choice, "ligand")?;
    let [ours, theirs] = [
        side(receptor, &groups.receptor, &on_receptor),
        side(ligand, &groups.ligand, &on_ligand),
    ];
    // Chains that are not matched may touch all the same, and what is matched of the interface is judged by another.
    let (measured, set_aside) = match combinations(ours, theirs, false, choice.named) {
        Ok(found) => (found.measured, found.set_aside),
        Err(_) => {
            let first = Combination {
                receptor: 0,
                ligand: 0,
                contacts: 0,
            };
            (vec![first], Vec::new())
        }
    };
    let ways = measured.iter().map(|one| Way {
        groups: 0,
        receptor: on_receptor[one.receptor].clone(),
        ligand: on_ligand[one.ligand].clone(),
    });
    Ok(Ways {
        ways: ways.collect(),
        complexes: complexes(ours, theirs, measured.iter().chain(&set_aside)),
        groups: vec![groups],
        unused: Vec::new(),
    })
}

fn of_complex(
    receptor: &Residues,
    ligand: &Residues,
    complex: &Residues,
    choice: &ChainChoice,
) -> Result<Ways, Error> {
    choice.check([receptor, ligand], &[complex])?;
    let on_receptor = placed(receptor, complex, choice, "receptor")?;
    let on_ligand = placed(ligand, complex, choice, "ligand")?;
    let [ours, theirs] = [
        side(receptor, complex, &on_receptor),
        side(ligand, complex, &on_ligand),
    ];
    let all = combinations(ours, theirs, true, choice.named)?;
    let mut found = Ways {
        complexes: complexes(ours, theirs, all.measured.iter().chain(&all.set_aside)),
        ..Ways::default()
    };
    let mut splits: Vec<[Part; 2]> = Vec::new();
    for one in all.measured {
        let (r, l) = (&on_receptor[one.receptor], &on_ligand[one.ligand]);
        let split = split(complex, r, l);
        let groups = match splits.iter().position(|known| *known == split) {
            Some(groups) => groups,
            None => {
                found.groups.push(Groups {
                    receptor: complex.only(&split[0]),
                    ligand: complex.only(&split[1]),
                });
                splits.push(split.clone());
                splits.len() - 1
            }
        };
        found.ways.push(Way {
            groups,
            receptor: in_group(r, &split[0]),
            ligand: in_group(l, &split[1]),
        });
    }
    found.unused = unused(complex, &splits);
    Ok(found)
}

fn side<'a>(
    user: &'a Residues,
    native: &'a Residues,
    placements: &'a [Placement],
) -> PlacedCopy<'a> {
    PlacedCopy {
        user,
        native,
        placements,
    }
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
    receptor: PlacedCopy,
    ligand: PlacedCopy,
    all: impl Iterator<Item = &'a Combination>,
) -> Vec<NativeComplex> {
    let mut found: Vec<NativeComplex> = Vec::new();
    for one in all {
        let names = |side: PlacedCopy, placement: usize| -> Vec<String> {
            let segments = side.placements[placement].native_segments();
            let names = segments
                .into_iter()
                .map(|segment| &side.native.segments[segment].name);
            names.cloned().collect()
        };
        let next = NativeComplex {
            receptor: names(receptor, one.receptor),
            ligand: names(ligand, one.ligand),
            contacts: one.contacts,
        };
        let is_known = |known: &NativeComplex| {
            (&known.receptor, &known.ligand) == (&next.receptor, &next.ligand)
                || (&known.receptor, &known.ligand) == (&next.ligand, &next.receptor)
        };
        if found.len() < MOST_LISTED && !found.iter().any(is_known) {
            found.push(next);
        }
    }
    found
}

/// The residues of the complex that belong to each side, segment by segment.
///
/// Both sides may match a part of one segment. Then each residue goes to the side whose nearest matched residue is
/// nearer in the sequence.
fn split(complex: &Residues, receptor: &Placement, ligand: &Placement) -> [Part; 2] {
    let placements = [receptor, ligand];
    let segments = placements.map(Placement::native_segments);
    let matched = placements.map(Placement::natives);
    [0, 1].map(|this| {
        let other = 1 - this;
        let of_segment = |&segment: &usize| {
            let members = complex.segments[segment].members.iter().copied();
            let members = if segments[other].contains(&segment) {
                let is_ours = |&member: &usize| {
                    let (near, far) = (
                        nearest(&matched[this], member),
                        nearest(&matched[other], member),
                    );
                    near < far || (near == far && this == 0)
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

fn unused(complex: &Residues, splits: &[[Part; 2]]) -> Vec<String> {
    let parts = || splits.iter().flatten().flatten();
    let is_used = |index: usize| parts().any(|(segment, _)| *segment == index);
    let segments = complex.segments.iter().enumerate();
    segments
        .filter(|&(index, _)| !is_used(index))
        .map(|(_, segment)| segment.name.clone())
        .collect()
}

/// A placement whose residues and segments of the native are those of a group, which holds the segments and members
/// given.
fn in_group(placement: &Placement, group: &[(usize, Vec<usize>)]) -> Placement {
    let members = group.iter().flat_map(|(_, members)| members).copied();
    let places: HashMap<usize, usize> = members.zip(0..).collect();
    let mut placement = placement.clone();
    for chain in &mut placement.chains {
        chain.native = group
            .iter()
            .position(|(segment, _)| *segment == chain.native)
            .unwrap_or_default();
        chain.pairs = chain
            .pairs
            .iter()
            .filter_map(|&(user, native)| Some((user, *places.get(&native)?)))
            .collect();
    }
    placement
}
