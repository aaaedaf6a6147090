//! The interface of a complex: which residues touch, what holds them together, and what the score says of it.
//!
//! # Conventions
//!
//! - A complex is two molecules where they stand, side 0 and side 1. Lengths are in Å, areas in Å^2.
//! - **Contact**: two residues with heavy atoms nearer than 5 Å (Méndez et al., Proteins 52 (2003) 51-67). Their distance
//!   is that of the nearest heavy atoms.
//! - **Hydrogen bond**: a donor and an acceptor within 3.5 Å (Baker & Hubbard, Prog. Biophys. Mol. Biol. 44 (1984)
//!   97-179), each on the side of the other that faces away from what it is bonded to. Files mostly lack hydrogens, so
//!   that their angles cannot be judged.
//! - **Salt bridge**: a nitrogen of a positive side chain within 4 Å of an oxygen of a negative one (Barlow & Thornton,
//!   J. Mol. Biol. 168 (1983) 867-885), at most one for two residues. The charges of the electrostatic effect say which
//!   side chains are charged; ends of chains are not counted.
//! - **Buried surface**: accessible area (probe of 1.4 Å) alone less that in the complex.

mod score;

pub use score::{PlacedScore, score_in_place};

use knotdock_structures::PolarAtom;
use knotdock_structures::molecule::{Atom, Molecule};
use knotdock_structures::neighbours::{CellList, Member};
use serde::Serialize;
use std::collections::BTreeMap;

use crate::pose_geometry::SURFACE_POINTS;

/// Largest distance of a contact, in Å.
pub const CONTACT: f64 = 5.0;
/// Largest distance between donor and acceptor of a hydrogen bond, in Å.
pub const HYDROGEN_BOND: f64 = 3.5;
/// Largest distance between the charged atoms of a salt bridge, in Å.
pub const SALT_BRIDGE: f64 = 4.0;
/// Least charge of a side chain that is charged, in e.
const CHARGED: f64 = 0.5;
/// Atoms that belong to no side chain.
const BACKBONE: [&str; 5] = ["N", "CA", "C", "O", "OXT"];

/// A residue as files name it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct ResidueName {
    /// Its chain, by the author's name.
    pub chain: String,
    /// Its number and insertion code, as `52A`.
    pub number: String,
    /// Its name, as `GLY`.
    pub name: String,
}

impl ResidueName {
    fn of(atom: &Atom) -> Self {
        let insertion = atom.insertion_code.map(String::from).unwrap_or_default();
        Self {
            chain: atom.chain.clone(),
            number: format!("{}{insertion}", atom.residue_number),
            name: atom.residue_name.clone(),
        }
    }
}

/// Two residues in contact.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResiduePair {
    /// That of each side.
    pub residues: [ResidueName; 2],
    /// Distance of their nearest heavy atoms, in Å.
    pub distance: f64,
    /// Hydrogen bonds between them.
    pub hydrogen_bonds: usize,
    /// Whether they make a salt bridge.
    pub salt_bridge: bool,
}

/// The interface of a complex.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Interface {
    /// Residues in contact, in the order of side 0, then of side 1.
    pub pairs: Vec<ResiduePair>,
    /// Residues of each side that have a contact.
    pub residues: [usize; 2],
    /// Hydrogen bonds.
    pub hydrogen_bonds: usize,
    /// Salt bridges.
    pub salt_bridges: usize,
    /// Surface that each side loses to the other, in Å^2.
    pub buried: [f64; 2],
}

/// What the pairs of atoms say of two residues.
#[derive(Default)]
struct Found {
    /// Square of the least distance.
    square: f64,
    hydrogen_bonds: usize,
    salt_bridge: bool,
}

/// An atom with what it may do.
struct Site<'a> {
    residue: usize,
    atom: &'a Atom,
    polar: PolarAtom,
    /// Sign of the charge that its side chain may bring to a salt bridge by it.
    sign: i8,
}

impl Interface {
    /// The interface of two molecules where they stand; charges are those at a pH.
    pub fn of([first, second]: [&Molecule; 2], ph: f64) -> Self {
        let (first_sites, first_names) = sites(first, ph);
        let (second_sites, second_names) = sites(second, ph);
        let members = second_sites.iter().enumerate().map(|(item, site)| Member {
            position: site.atom.position,
            item,
        });
        let cells = CellList::new(members.collect(), CONTACT);
        let mut found: BTreeMap<(usize, usize), Found> = BTreeMap::new();
        for one in &first_sites {
            cells.visit_within(one.atom.position, CONTACT, |&at, square| {
                let other = &second_sites[at];
                let pair = found.entry((one.residue, other.residue)).or_insert(Found {
                    square,
                    ..Found::default()
                });
                pair.square = pair.square.min(square);
                pair.hydrogen_bonds += usize::from(is_bond(one, other, square));
                pair.salt_bridge |= is_bridge(one, other, square);
            });
        }
        let pairs: Vec<ResiduePair> = found
            .iter()
            .map(|(&(i, j), found)| ResiduePair {
                residues: [first_names[i].clone(), second_names[j].clone()],
                distance: found.square.sqrt(),
                hydrogen_bonds: found.hydrogen_bonds,
                salt_bridge: found.salt_bridge,
            })
            .collect();
        let touching = |side: fn(&(usize, usize)) -> usize| {
            let residues: std::collections::BTreeSet<usize> = found.keys().map(side).collect();
            residues.len()
        };
        Self {
            residues: [touching(|pair| pair.0), touching(|pair| pair.1)],
            hydrogen_bonds: pairs.iter().map(|pair| pair.hydrogen_bonds).sum(),
            salt_bridges: pairs.iter().filter(|pair| pair.salt_bridge).count(),
            buried: first.buried_areas(second, SURFACE_POINTS),
            pairs,
        }
    }
}

/// The heavy atoms of a molecule, and the names of the residues that they point to.
fn sites(molecule: &Molecule, ph: f64) -> (Vec<Site<'_>>, Vec<ResidueName>) {
    let heavy: Vec<bool> = molecule
        .atoms
        .iter()
        .map(|atom| !atom.is_hydrogen())
        .collect();
    let (polar, labels) = (molecule.polar_atoms(), molecule.labels(ph));
    let (mut sites, mut names) = (Vec::new(), Vec::new());
    for (residue, atoms) in molecule.atoms_by_residue(&heavy).into_iter().enumerate() {
        let of_side_chain = atoms
            .iter()
            .filter(|&&at| !BACKBONE.contains(&molecule.atoms[at].name.as_str()));
        let charge: f64 = of_side_chain.map(|&at| labels.charges[at]).sum();
        for &at in &atoms {
            let atom = &molecule.atoms[at];
            let is_end = BACKBONE.contains(&atom.name.as_str());
            sites.push(Site {
                residue,
                atom,
                polar: polar[at],
                sign: match atom.element.as_str() {
                    "N" if charge > CHARGED && !is_end => 1,
                    "O" if charge < -CHARGED && !is_end => -1,
                    _ => 0,
                },
            });
        }
        names.extend(
            atoms
                .first()
                .map(|&at| ResidueName::of(&molecule.atoms[at])),
        );
    }
    (sites, names)
}

/// Whether two atoms make a hydrogen bond.
fn is_bond(one: &Site, other: &Site, square: f64) -> bool {
    square <= HYDROGEN_BOND * HYDROGEN_BOND
        && one.polar.may_bond(&other.polar)
        && faces(one, other)
        && faces(other, one)
}

/// Whether an atom's free side is towards another; one without a direction has no other side.
fn faces(one: &Site, other: &Site) -> bool {
    let direction = one.polar.direction;
    let along: f64 = (0..3)
        .map(|axis| direction[axis] * (other.atom.position[axis] - one.atom.position[axis]))
        .sum();
    direction == [0.0; 3] || along > 0.0
}

/// Whether two atoms make a salt bridge.
fn is_bridge(one: &Site, other: &Site, square: f64) -> bool {
    square <= SALT_BRIDGE * SALT_BRIDGE && one.sign * other.sign < 0
}

#[cfg(test)]
mod tests;
