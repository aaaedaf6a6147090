//! Choice of the native's copies: the complex by which poses are measured.
//!
//! A crystal's file holds several complexes, and neighbours that only touch in the crystal. Each side's
//! [`placements`](crate::evaluate::matching::placements) are combined, without a residue in both; a combination
//! counts that matches nearly as much of both sides as the best does and whose sides touch. The one with most
//! contacts is the complex; of several that stand alike, the one whose chain names agree.

use std::collections::HashMap;

use knotdock_scoring::se3::Pose;
use nalgebra::{Point3, Vector3};

use crate::evaluate::contacts::contacts_between;
use crate::evaluate::matching::chain_pair::ChainPair;
use crate::evaluate::matching::placement::Placement;
use crate::evaluate::matching::superposition::MAX_FIT_RMSD;
use crate::evaluate::residues::Residues;

/// Share of what the best combination matches, of either side, that another must match.
const MIN_OF_BEST: f64 = 0.8;
/// Complexes are alike when their ligands differ by at most this shift in Å and this angle in radians (20 degrees).
const ALIKE: (f64, f64) = (4.0, std::f64::consts::PI / 9.0);

/// A receptor's placement with a ligand's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::evaluate) struct Combination {
    /// Index of the receptor's placement.
    pub receptor: usize,
    /// Index of the ligand's.
    pub ligand: usize,
    /// Residue contacts of the native's chains that they take.
    pub contacts: usize,
}

/// One side: the user's molecule, the native's residues and the ways in which the first lies on the second.
#[derive(Clone, Copy)]
pub(in crate::evaluate) struct PlacedCopy<'a> {
    pub user: &'a Residues,
    pub native: &'a Residues,
    pub placements: &'a [Placement],
}

impl PlacedCopy<'_> {
    /// Equal residues of a placement in chains of equal names.
    fn same_named(&self, placement: usize) -> usize {
        let is_same = |chain: &&ChainPair| {
            self.user.segments[chain.user].name == self.native.segments[chain.native].name
        };
        let chains = self.placements[placement].chains.iter();
        chains.filter(is_same).map(|chain| chain.pairs.len()).sum()
    }
}

/// Why nothing can be combined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::evaluate) enum Uncombined {
    /// Both sides only match the same chain.
    OneCopy,
    /// No two touch.
    NoContact,
}

/// The combinations that count, the complex first and then by their contacts.
///
/// `disjoint` where both sides are placed on one native, of which no residue can belong to both.
pub(in crate::evaluate) fn combinations(
    receptor: PlacedCopy,
    ligand: PlacedCopy,
    disjoint: bool,
) -> Result<Vec<Combination>, Uncombined> {
    let mut counts = ContactCounts::new(receptor.native, ligand.native);
    let mut all = Vec::new();
    let mut any_disjoint = false;
    for (r, on_receptor) in receptor.placements.iter().enumerate() {
        let ours = on_receptor.native_segments();
        for (l, on_ligand) in ligand.placements.iter().enumerate() {
            let theirs = on_ligand.native_segments();
            let shared: Vec<usize> = match disjoint {
                true => ours
                    .iter()
                    .copied()
                    .filter(|one| theirs.contains(one))
                    .collect(),
                false => Vec::new(),
            };
            if !shared.is_empty() && overlap(on_receptor, on_ligand) {
                continue;
            }
            any_disjoint = true;
            let contacts = if shared.is_empty() {
                let pairs = ours
                    .iter()
                    .flat_map(|&n| theirs.iter().map(move |&m| (n, m)));
                pairs.map(|(n, m)| counts.of(n, m)).sum()
            } else {
                let (ours, theirs) = (on_receptor.natives(), on_ligand.natives());
                contacts_between(receptor.native, &ours, ligand.native, &theirs)
            };
            all.push(Combination {
                receptor: r,
                ligand: l,
                contacts,
            });
        }
    }
    if !any_disjoint {
        return Err(Uncombined::OneCopy);
    }
    all.retain(|one| one.contacts > 0);
    if all.is_empty() {
        return Err(Uncombined::NoContact);
    }
    let mut all = nearly_complete(receptor, ligand, all);
    let same_named =
        |one: &Combination| receptor.same_named(one.receptor) + ligand.same_named(one.ligand);
    all.sort_by_key(|one| std::cmp::Reverse((one.contacts, same_named(one))));
    let pose = |one: &Combination| {
        let (r, l) = (
            &receptor.placements[one.receptor],
            &ligand.placements[one.ligand],
        );
        r.motion.inverse().after(&l.motion)
    };
    let Some(largest) = all.first().map(pose) else {
        return Err(Uncombined::NoContact);
    };
    let center = center_of(ligand.user);
    let mut chosen = 0;
    for (place, one) in all.iter().enumerate() {
        if are_alike(&pose(one), &largest, center) && same_named(one) > same_named(&all[chosen]) {
            chosen = place;
        }
    }
    let complex = all.remove(chosen);
    all.insert(0, complex);
    Ok(all)
}

/// Those that match of both sides nearly as much as the best, and of these the ones that fit, if any does.
fn nearly_complete(
    receptor: PlacedCopy,
    ligand: PlacedCopy,
    all: Vec<Combination>,
) -> Vec<Combination> {
    let matched = |one: &Combination| {
        [
            receptor.placements[one.receptor].matched() as f64,
            ligand.placements[one.ligand].matched() as f64,
        ]
    };
    let most = all.iter().map(matched).fold([1.0_f64; 2], |most, one| {
        [most[0].max(one[0]), most[1].max(one[1])]
    });
    let share = |one: &Combination| {
        let matched = matched(one);
        (matched[0] / most[0]).min(matched[1] / most[1])
    };
    let best = all.iter().map(share).fold(0.0, f64::max);
    let complete = |one: &Combination| share(one) >= MIN_OF_BEST * best;
    let fits =
        |placement: &Placement| placement.rmsd <= MAX_FIT_RMSD && placement.displaced.is_none();
    let fit = |one: &Combination| {
        fits(&receptor.placements[one.receptor]) && fits(&ligand.placements[one.ligand])
    };
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

fn center_of(residues: &Residues) -> Point3<f64> {
    let sum: Vector3<f64> = residues.residues.iter().map(|one| one.center.coords).sum();
    Point3::from(sum / residues.residues.len().max(1) as f64)
}

fn are_alike(a: &Pose, b: &Pose, center: Point3<f64>) -> bool {
    let (shift, angle) = ALIKE;
    let place = |pose: &Pose| Point3::from(pose.apply(center.into()));
    nalgebra::distance(&place(a), &place(b)) <= shift && a.rotation.angle_to(&b.rotation) <= angle
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
        if nalgebra::distance(&center, &other)
            > radius + other_radius + crate::evaluate::contacts::CONTACT_DISTANCE
        {
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
            let members = || {
                segment
                    .members
                    .iter()
                    .map(|&member| &residues.residues[member])
            };
            let sum: Vector3<f64> = members().map(|one| one.center.coords).sum();
            let center = Point3::from(sum / segment.members.len().max(1) as f64);
            let reach = |one: &crate::evaluate::residues::residue::Residue| {
                nalgebra::distance(&one.center, &center) + one.radius
            };
            (center, members().map(reach).fold(0.0, f64::max))
        })
        .collect()
}
