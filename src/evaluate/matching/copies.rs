//! The native's complexes: placements of both sides that share no residue and touch.
//!
//! A crystal's file holds several complexes, and neighbours that only touch in the crystal. A combination of the sides'
//! [`placements`](crate::evaluate::matching::placements) counts if it matches nearly as much of both sides as the best
//! does. Every pose is measured by the one with its best DockQ. Unless the user names chains, contacts of a few residues
//! are set aside if the native has a real interface.

use std::collections::HashMap;

use knotdock_structures::Error;
use nalgebra::{Point3, Vector3};

use crate::evaluate::contacts::{CONTACT_DISTANCE, contacts_between, no_contact};
use crate::evaluate::matching::chain_pair::ChainPair;
use crate::evaluate::matching::placements::Placement;
use crate::evaluate::matching::superposition::MAX_FIT_RMSD;
use crate::evaluate::residues::Residues;
use crate::evaluate::residues::residue::Residue;

/// Least matched residues of either side, as a share of those of the best combination.
const MIN_OF_BEST: f64 = 0.8;
/// Fewer residue contacts than this, and than this share of the largest interface's, are a crystal contact.
const CRYSTAL_CONTACT: (usize, f64) = (10, 0.2);

/// A receptor's placement with a ligand's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::evaluate) struct Combination {
    /// Indices of the placements of receptor and ligand.
    pub placements: [usize; 2],
    /// Residue contacts of the native's chains that they take.
    pub contacts: usize,
}

impl Combination {
    /// Its placements among those of receptor and ligand.
    pub fn of<'a>(&self, all: &'a [Vec<Placement>; 2]) -> [&'a Placement; 2] {
        [&all[0][self.placements[0]], &all[1][self.placements[1]]]
    }
}

/// One side: the docked molecule, the native's residues and the placements of the first on the second.
#[derive(Clone, Copy)]
pub(in crate::evaluate) struct PlacedCopy<'a> {
    pub user: &'a Residues,
    pub native: &'a Residues,
    pub placements: &'a [Placement],
}

impl PlacedCopy<'_> {
    /// Number of equal residues of a placement in chains of equal names.
    fn same_named(&self, placement: usize) -> usize {
        self.placements[placement].same_named(self.user, self.native)
    }

    /// Names of the chains of a placement: the docked molecule's and the native's.
    fn names(&self, placement: usize) -> Vec<(&str, &str)> {
        let chains = self.placements[placement].chains.iter();
        let name = |pair: &ChainPair| pair.names(self.user, self.native);
        let mut names: Vec<_> = chains.map(name).collect();
        names.sort_unstable();
        names
    }
}

/// Combinations of the two sides, those of most equal chain names first, then those of most contacts.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::evaluate) struct Combinations {
    /// Those by which poses are measured; never empty.
    pub measured: Vec<Combination>,
    /// Crystal contacts.
    pub set_aside: Vec<Combination>,
}

/// The combinations that count.
///
/// `disjoint` if both sides are placed on one native, of which no residue can belong to both; `named` if the user names
/// chains, so that no contact is too small.
///
/// # Errors
/// [`Error`] if both sides only match the same chain, or no two touch.
pub(in crate::evaluate) fn combinations(
    sides: [PlacedCopy; 2],
    disjoint: bool,
    named: bool,
) -> Result<Combinations, Error> {
    let [receptor, ligand] = sides;
    let mut counts = ContactCounts::new(receptor.native, ligand.native);
    let mut all = Vec::new();
    let mut any_disjoint = false;
    for (r, on_receptor) in receptor.placements.iter().enumerate() {
        let ours = on_receptor.native_segments();
        for (l, on_ligand) in ligand.placements.iter().enumerate() {
            let theirs = on_ligand.native_segments();
            let is_shared = disjoint && ours.iter().any(|one| theirs.contains(one));
            if is_shared && overlap(on_receptor, on_ligand) {
                continue;
            }
            any_disjoint = true;
            let contacts = if is_shared {
                let (ours, theirs) = (on_receptor.natives(), on_ligand.natives());
                contacts_between(receptor.native, &ours, ligand.native, &theirs)
            } else {
                let pairs = ours
                    .iter()
                    .flat_map(|n| theirs.iter().map(move |m| (*n, *m)));
                pairs.map(|(n, m)| counts.of(n, m)).sum()
            };
            all.push(Combination {
                placements: [r, l],
                contacts,
            });
        }
    }
    if !any_disjoint {
        return Err(Error::input(
            "receptor and ligand match the same chain of the native, which has only one copy of it",
        )
        .help(
            "give a native with both copies: of a crystal, `knotdock inspect FILE --assembly 1 --write COMPLEX.pdb` \
             builds the biological assembly",
        ));
    }
    all.retain(|one| one.contacts > 0);
    if all.is_empty() {
        return Err(no_contact());
    }
    let mut all = nearly_complete(sides, all);
    // The order in the file has no effect.
    all.sort_by_cached_key(|one| {
        let [r, l] = one.placements;
        let same_named = receptor.same_named(r) + ligand.same_named(l);
        let names = (receptor.names(r), ligand.names(l));
        (std::cmp::Reverse((same_named, one.contacts)), names)
    });
    let most = all.iter().map(|one| one.contacts).max().unwrap_or(0);
    let (few, share) = CRYSTAL_CONTACT;
    let (measured, set_aside) = all.into_iter().partition(|one| {
        named || one.contacts >= few || one.contacts as f64 >= share * most as f64
    });
    Ok(Combinations {
        measured,
        set_aside,
    })
}

/// Those that match of both sides nearly as much as the best, and of these the ones that fit, if any does.
fn nearly_complete(sides: [PlacedCopy; 2], all: Vec<Combination>) -> Vec<Combination> {
    let placed =
        |one: &Combination| [0, 1].map(|side| &sides[side].placements[one.placements[side]]);
    let matched = |one: &Combination| placed(one).map(|placement| placement.matched() as f64);
    let most = all.iter().map(matched).fold([1.0_f64; 2], |most, one| {
        [most[0].max(one[0]), most[1].max(one[1])]
    });
    let share = |one: &Combination| {
        let matched = matched(one);
        (matched[0] / most[0]).min(matched[1] / most[1])
    };
    let best = all.iter().map(share).fold(0.0, f64::max);
    let complete = |one: &Combination| share(one) >= MIN_OF_BEST * best;
    let fit = |one: &Combination| placed(one).iter().all(|side| side.rmsd <= MAX_FIT_RMSD);
    let (fitting, others): (Vec<_>, Vec<_>) = all.into_iter().filter(complete).partition(fit);
    if fitting.is_empty() { others } else { fitting }
}

/// Whether a residue of the native is matched by both.
fn overlap(receptor: &Placement, ligand: &Placement) -> bool {
    let taken = receptor.natives();
    ligand
        .pairs()
        .any(|(_, native)| taken.binary_search(&native).is_ok())
}

/// Contacts of the native's chains, each pair counted once.
struct ContactCounts<'a> {
    sides: [&'a Residues; 2],
    balls: [Vec<(Point3<f64>, f64)>; 2],
    known: HashMap<(usize, usize), usize>,
}

impl<'a> ContactCounts<'a> {
    fn new(receptor: &'a Residues, ligand: &'a Residues) -> Self {
        let sides = [receptor, ligand];
        Self {
            sides,
            balls: sides.map(balls),
            known: HashMap::new(),
        }
    }

    /// Residue contacts of two segments.
    fn of(&mut self, receptor: usize, ligand: usize) -> usize {
        let [receptors, ligands] = self.sides;
        let ((center, radius), (other, other_radius)) =
            (self.balls[0][receptor], self.balls[1][ligand]);
        if nalgebra::distance(&center, &other) > radius + other_radius + CONTACT_DISTANCE {
            return 0;
        }
        *self.known.entry((receptor, ligand)).or_insert_with(|| {
            let (ours, theirs) = (&receptors.segments[receptor], &ligands.segments[ligand]);
            contacts_between(receptors, &ours.members, ligands, &theirs.members)
        })
    }
}

/// A ball about each segment that holds all its heavy atoms.
fn balls(residues: &Residues) -> Vec<(Point3<f64>, f64)> {
    let segments = residues.segments.iter();
    segments
        .map(|segment| {
            let members = residues.at(&segment.members);
            let sum: Vector3<f64> = members.iter().map(|one| one.center.coords).sum();
            let center = Point3::from(sum / members.len().max(1) as f64);
            let reach = |one: &&Residue| nalgebra::distance(&one.center, &center) + one.radius;
            (center, members.iter().map(reach).fold(0.0, f64::max))
        })
        .collect()
}
