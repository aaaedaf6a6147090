//! Side chains that turn: their bonds and angles, and reasons for a side chain to stay as it is.

use std::collections::HashMap;

use serde::Serialize;

use crate::molecule::chemistry::{
    BOND, ChiAngles, backbone_type, is_metal, parent, standard_atom_name,
};
use crate::molecule::model::{Atom, Molecule, Residue, residues};
use crate::neighbours::{CellList, Member};
use crate::vector::{cross, dot, norm, squared_distance, subtract};

/// phi and psi in radians for the end of a chain, which leaves one undefined: -75 and 145 degrees, as of an extended
/// chain.
const EXTENDED: [f64; 2] = [-1.309, 2.531];

/// The side chain of an amino acid with chi angles.
#[derive(Clone, Debug, PartialEq)]
pub struct SideChain {
    /// The author's name of the chain; may be empty.
    pub chain: String,
    /// The author's number with the insertion code, e.g. `52A`.
    pub number: String,
    /// The residue's name in the file.
    pub name: String,
    /// The residue in the table of rotamers, e.g. `HIS` of `HIE` and `MET` of `MSE`.
    pub residue: &'static str,
    /// Places in the molecule of its heavy atoms that the file has, CB first.
    pub atoms: Vec<usize>,
    /// Places of all atoms of the residue, and of the C before and the N after it: none of them more than a few bonds
    /// away.
    pub near_bonds: Vec<usize>,
    /// Its turning bonds, the one next to the backbone first; none where `held` says that atoms are missing.
    pub bonds: Vec<TurningBond>,
    /// phi and psi in radians.
    pub backbone: [f64; 2],
    /// Why it must stay as it is; `None` where it may turn.
    pub held: Option<HeldSideChain>,
}

/// A bond about which a side chain turns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TurningBond {
    /// Places of the four atoms of its chi angle; the bond is between the second and the third.
    pub atoms: [usize; 4],
    /// Places of the atoms beyond the bond, which turn, hydrogens included.
    pub moved: Vec<usize>,
}

impl SideChain {
    /// The chi angles in radians, -pi to pi, of the atoms at `positions` (Å, one per atom of the molecule).
    pub fn chi(&self, positions: &[[f64; 3]]) -> Vec<f64> {
        let of = |bond: &TurningBond| dihedral(bond.atoms.map(|atom| positions[atom]));
        self.bonds.iter().map(of).collect()
    }

    /// Turns the side chain to these chi angles (radians). Angles past those given stay, and so do bond lengths and
    /// bond angles.
    pub fn set_chi(&self, positions: &mut [[f64; 3]], chi: &[f64]) {
        for (bond, target) in self.bonds.iter().zip(chi) {
            let by = target - dihedral(bond.atoms.map(|atom| positions[atom]));
            if by == 0.0 {
                continue;
            }
            let [_, from, to, _] = bond.atoms.map(|atom| positions[atom]);
            for &atom in &bond.moved {
                positions[atom] = turned(positions[atom], from, to, by);
            }
        }
    }
}

impl Molecule {
    /// The side chains with chi angles, in file order: those of all amino acids but alanine, glycine and proline.
    ///
    /// Residues whose backbone lacks N, CA or C are left out.
    pub fn side_chains(&self) -> Vec<SideChain> {
        let groups = residues(&self.atoms);
        let bonds = SideChainBonds::new(&self.atoms, &groups);
        let place = |place: usize| groups.get(place).filter(|group| group.is_peptide());
        let of = |(at, residue): (usize, &Residue<'_>)| {
            let before = at.checked_sub(1).and_then(place);
            self.side_chain(residue, [before, place(at + 1)], &bonds)
        };
        groups.iter().enumerate().filter_map(of).collect()
    }

    fn side_chain(
        &self,
        residue: &Residue<'_>,
        neighbours: [Option<&Residue<'_>>; 2],
        bonds: &SideChainBonds<'_>,
    ) -> Option<SideChain> {
        let plain = parent(residue.known_as);
        let angles = ChiAngles::of(plain)?;
        let named = self.by_name(residue, plain);
        let at = |name: &str| named.get(name).and_then(|places| places.first()).copied();
        let [n, ca, c] = [at("N")?, at("CA")?, at("C")?];
        let [before, after] = neighbours;
        let before = before.and_then(|other| self.bonded(other, "C", n));
        let after = after.and_then(|other| self.bonded(other, "N", c));
        let angle = |places: [usize; 4]| dihedral(places.map(|place| self.atoms[place].position));
        let backbone = [
            before.map_or(EXTENDED[0], |before| angle([before, n, ca, c])),
            after.map_or(EXTENDED[1], |after| angle([n, ca, c, after])),
        ];
        let atoms: Vec<usize> = angles
            .side_chain
            .iter()
            .filter_map(|name| at(name))
            .collect();
        let near_bonds = residue.atoms.iter().copied().chain(before).chain(after);
        let held = self
            .unlike_the_table(&angles, &named)
            .or_else(|| {
                let [n, ca, c, cb] = [n, ca, c, *atoms.first()?].map(|i| self.atoms[i].position);
                (!is_left_handed(n, ca, c, cb)).then_some(HeldSideChain::Mirrored)
            })
            .or_else(|| bonds.held(residue, &atoms));
        Some(SideChain {
            chain: residue.key.chain.to_owned(),
            number: residue.key.number_text(),
            name: residue.key.name.to_owned(),
            residue: angles.residue,
            bonds: if held == Some(HeldSideChain::Incomplete) {
                Vec::new()
            } else {
                self.turning_bonds(residue, &angles, &at)
            },
            near_bonds: near_bonds.collect(),
            atoms,
            backbone,
            held,
        })
    }

    /// The places of a residue's heavy atoms by their standard names.
    fn by_name<'a>(&'a self, residue: &Residue<'_>, plain: &str) -> HashMap<&'a str, Vec<usize>> {
        let mut named: HashMap<&str, Vec<usize>> = HashMap::new();
        for &index in &residue.atoms {
            let atom = &self.atoms[index];
            if !atom.is_hydrogen() {
                let name = standard_atom_name(plain, &atom.name);
                named.entry(name).or_default().push(index);
            }
        }
        named
    }

    /// The atom of this name in a neighbour that is bonded to the atom at `end`.
    fn bonded(&self, neighbour: &Residue<'_>, name: &str, end: usize) -> Option<usize> {
        let end = self.atoms[end].position;
        let near = |&&index: &&usize| {
            let atom = &self.atoms[index];
            atom.name == name && squared_distance(atom.position, end) <= BOND * BOND
        };
        neighbour.atoms.iter().find(near).copied()
    }

    /// Whether atoms are missing, given twice, in other places too, or such as the residue does not have.
    fn unlike_the_table(
        &self,
        angles: &ChiAngles,
        named: &HashMap<&str, Vec<usize>>,
    ) -> Option<HeldSideChain> {
        let of = |name: &&str| named.get(*name).map_or(&[][..], Vec::as_slice);
        let places = || angles.side_chain.iter().map(of);
        if places().any(<[usize]>::is_empty) {
            return Some(HeldSideChain::Incomplete);
        }
        let known = |name: &&str| angles.side_chain.contains(name) || backbone_type(name).is_some();
        if !named.keys().all(known) || places().any(|places| places.len() > 1) {
            return Some(HeldSideChain::OtherAtoms);
        }
        let alternate = |&place: &usize| self.atoms[place].alternate_location.is_some();
        places()
            .flatten()
            .any(alternate)
            .then_some(HeldSideChain::AlternateLocations)
    }

    fn turning_bonds(
        &self,
        residue: &Residue<'_>,
        angles: &ChiAngles,
        at: &dyn Fn(&str) -> Option<usize>,
    ) -> Vec<TurningBond> {
        let of = |k: usize| {
            let mut chain = angles.chain.iter().skip(k).map(|name| at(name));
            let mut next = || chain.next().flatten();
            let atoms = [next()?, next()?, next()?, next()?];
            let mut moved: Vec<usize> = angles.moved(k).filter_map(at).collect();
            // Hydrogens go with the atom that they are nearest to; those of the bond's far end turn, too.
            let carriers = moved.iter().copied().chain([atoms[2]]).collect::<Vec<_>>();
            let hydrogens = residue.atoms.iter().copied();
            moved.extend(hydrogens.filter(|&index| {
                self.atoms[index].is_hydrogen()
                    && self
                        .carrier(residue, index)
                        .is_some_and(|carrier| carriers.contains(&carrier))
            }));
            Some(TurningBond { atoms, moved })
        };
        (0..angles.count()).filter_map(of).collect()
    }

    /// The heavy atom of the residue that is nearest to a hydrogen.
    fn carrier(&self, residue: &Residue<'_>, hydrogen: usize) -> Option<usize> {
        let from = |index: usize| {
            squared_distance(self.atoms[index].position, self.atoms[hydrogen].position)
        };
        let heavy = residue.atoms.iter().copied();
        heavy
            .filter(|&index| !Atom::is_hydrogen(&self.atoms[index]))
            .min_by(|&a, &b| from(a).total_cmp(&from(b)))
    }
}

/// Longest distance in Å of a metal from an atom that binds it.
const METAL: f64 = 2.8;
/// Longest distance in Å of the sulphurs of a disulphide, 2.05 Å in good structures.
const DISULPHIDE: f64 = 2.5;
/// Longest covalent bond in Å between carbon, nitrogen and oxygen, and with a larger atom.
const BONDS: [f64; 2] = [1.7, 2.0];

/// Why a side chain must stay as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum HeldSideChain {
    /// Atoms are missing.
    Incomplete,
    /// It has atoms that its residue does not have, or one twice.
    OtherAtoms,
    /// The file has it in more than one place.
    AlternateLocations,
    /// The residue is of the D form, of which no rotamers are known.
    Mirrored,
    /// It binds a metal.
    Metal,
    /// Its sulphur is bonded to another's.
    Disulphide,
    /// It is bonded to another residue or molecule.
    Bonded,
}

impl HeldSideChain {
    /// The reason in words, which follow a residue's name and a comma.
    pub fn words(self) -> &'static str {
        match self {
            Self::Incomplete => "incomplete",
            Self::OtherAtoms => "with atoms of its own",
            Self::AlternateLocations => "in alternate locations",
            Self::Mirrored => "of the D form",
            Self::Metal => "bound to a metal",
            Self::Disulphide => "in a disulphide",
            Self::Bonded => "bonded to another residue",
        }
    }
}

/// A heavy atom that a side chain may be bonded to: its place in the molecule.
struct SideChainBonds<'a> {
    atoms: &'a [Atom],
    residue_of: Vec<usize>,
    cells: CellList<usize>,
    origin: [f64; 3],
}

impl<'a> SideChainBonds<'a> {
    /// Sorts the heavy atoms of a molecule, whose residues are `groups`.
    fn new(atoms: &'a [Atom], groups: &[Residue<'_>]) -> Self {
        let mut residue_of = vec![usize::MAX; atoms.len()];
        for (place, group) in groups.iter().enumerate() {
            for &index in &group.atoms {
                residue_of[index] = place;
            }
        }
        // An offset of the whole costs no cells.
        let origin = atoms.first().map_or([0.0; 3], |atom| atom.position);
        let all = atoms.iter().enumerate();
        let heavy = all.filter(|(_, atom)| !atom.is_hydrogen());
        let members = heavy.map(|(item, atom)| Member {
            position: subtract(atom.position, origin),
            item,
        });
        Self {
            atoms,
            residue_of,
            cells: CellList::new(members.collect(), METAL),
            origin,
        }
    }

    /// The reason why a side chain is held: a bond of one of these atoms outside its residue. The first in the order of
    /// [`HeldSideChain`] counts.
    fn held(&self, residue: &Residue<'_>, side_chain: &[usize]) -> Option<HeldSideChain> {
        let mut held: Option<HeldSideChain> = None;
        let own = residue.atoms.first().map(|&first| self.residue_of[first]);
        for atom in side_chain.iter().map(|&index| &self.atoms[index]) {
            let center = subtract(atom.position, self.origin);
            self.cells.visit_within(center, METAL, |&other, _| {
                if Some(self.residue_of[other]) != own
                    && let Some(reason) = bond(atom, &self.atoms[other])
                {
                    held = Some(held.map_or(reason, |held| held.min(reason)));
                }
            });
        }
        held
    }
}

/// Bond of a side chain's atom to an atom of another residue.
fn bond(atom: &Atom, other: &Atom) -> Option<HeldSideChain> {
    let square = squared_distance(atom.position, other.position);
    let within = |reach: f64| square <= reach * reach;
    let element = other.element.as_str();
    if !element.is_empty() && is_metal(element) {
        let binds = matches!(atom.element.as_str(), "N" | "O" | "S" | "Se");
        return (binds && within(METAL)).then_some(HeldSideChain::Metal);
    }
    let is_sulphur = |atom: &Atom| matches!(atom.element.as_str(), "S" | "Se");
    if is_sulphur(atom) && is_sulphur(other) {
        return within(DISULPHIDE).then_some(HeldSideChain::Disulphide);
    }
    let is_small = |atom: &Atom| matches!(atom.element.as_str(), "C" | "N" | "O");
    let reach = BONDS[usize::from(!(is_small(atom) && is_small(other)))];
    within(reach).then_some(HeldSideChain::Bonded)
}

/// Dihedral angle in radians, -pi to pi, of four places: clockwise is positive when looking from the second to the
/// third (IUPAC-IUB, J. Mol. Biol. 52 (1970) 1-17). Zero if three of them are in line.
fn dihedral([a, b, c, d]: [[f64; 3]; 4]) -> f64 {
    let (first, axis, last) = (subtract(b, a), subtract(c, b), subtract(d, c));
    let (left, right) = (cross(first, axis), cross(axis, last));
    (norm(axis) * dot(first, right)).atan2(dot(left, right))
}

/// The place of a point after a right-handed turn by `angle` (radians) about the axis from `from` to `to`; the point
/// itself where the two coincide. Source: Rodrigues' formula.
fn turned(point: [f64; 3], from: [f64; 3], to: [f64; 3], angle: f64) -> [f64; 3] {
    let axis = subtract(to, from);
    let length = norm(axis);
    if length == 0.0 {
        return point;
    }
    let axis = axis.map(|x| x / length);
    let arm = subtract(point, from);
    let (sin, cos) = angle.sin_cos();
    let across = cross(axis, arm);
    let along = dot(axis, arm) * (1.0 - cos);
    std::array::from_fn(|k| from[k] + arm[k] * cos + across[k] * sin + axis[k] * along)
}

/// Whether an amino acid is of the L form: seen from CA with the side chain up, CO-R-N read clockwise.
fn is_left_handed(n: [f64; 3], ca: [f64; 3], c: [f64; 3], cb: [f64; 3]) -> bool {
    dot(cross(subtract(n, ca), subtract(c, ca)), subtract(cb, ca)) > 0.0
}

#[cfg(test)]
mod tests;
