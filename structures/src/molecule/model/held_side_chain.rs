//! Side chains that must stay as they are, by what they are bonded to.

use serde::Serialize;

use crate::molecule::model::atom::{Atom, squared_distance};
use crate::molecule::model::groups::{NON_METALS, Residue};
use crate::neighbours::{CellList, Member};

/// Longest distance in Å of a metal from an atom that binds it (`metal_sites`).
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
pub(crate) struct SideChainBonds<'a> {
    atoms: &'a [Atom],
    /// Which residue each atom belongs to.
    residue_of: Vec<usize>,
    cells: CellList<usize>,
    origin: [f64; 3],
}

impl<'a> SideChainBonds<'a> {
    /// Sorts the heavy atoms of a molecule, whose residues are `groups`.
    pub(crate) fn new(atoms: &'a [Atom], groups: &[Residue<'_>]) -> Self {
        let mut residue_of = vec![usize::MAX; atoms.len()];
        for (place, group) in groups.iter().enumerate() {
            for &index in &group.atoms {
                residue_of[index] = place;
            }
        }
        // An offset of the whole costs no cells.
        let origin = atoms.first().map_or([0.0; 3], |atom| atom.position);
        let heavy = atoms
            .iter()
            .enumerate()
            .filter(|(_, atom)| !atom.is_hydrogen());
        let members = heavy.map(|(item, atom)| Member {
            position: from(origin, atom.position),
            item,
        });
        Self {
            atoms,
            residue_of,
            cells: CellList::new(members.collect(), METAL),
            origin,
        }
    }

    /// Whether one of these atoms of a residue is bonded outside of it, and to what. The first reason in the order of
    /// [`HeldSideChain`] counts.
    pub(crate) fn held(
        &self,
        residue: &Residue<'_>,
        side_chain: &[usize],
    ) -> Option<HeldSideChain> {
        let mut held: Option<HeldSideChain> = None;
        let own = residue
            .atoms
            .first()
            .and_then(|&first| self.residue_of.get(first));
        for atom in side_chain.iter().filter_map(|&index| self.atoms.get(index)) {
            let center = from(self.origin, atom.position);
            self.cells.visit_within(center, METAL, |&other, _| {
                if self.residue_of.get(other) != own
                    && let Some(reason) = bond(atom, &self.atoms[other])
                {
                    held = Some(held.map_or(reason, |held| held.min(reason)));
                }
            });
        }
        held
    }
}

fn from(origin: [f64; 3], position: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| position[axis] - origin[axis])
}

/// What bonds an atom of a side chain to an atom of another residue.
fn bond(atom: &Atom, other: &Atom) -> Option<HeldSideChain> {
    let square = squared_distance(atom.position, other.position);
    let within = |reach: f64| square <= reach * reach;
    let element = other.element.as_str();
    if !element.is_empty() && !NON_METALS.contains(&element) {
        return (element_binds(atom) && within(METAL)).then_some(HeldSideChain::Metal);
    }
    let is_sulphur = |atom: &Atom| matches!(atom.element.as_str(), "S" | "Se");
    if is_sulphur(atom) && is_sulphur(other) {
        return within(DISULPHIDE).then_some(HeldSideChain::Disulphide);
    }
    let is_small = |atom: &Atom| matches!(atom.element.as_str(), "C" | "N" | "O");
    let reach = BONDS[usize::from(!(is_small(atom) && is_small(other)))];
    within(reach).then_some(HeldSideChain::Bonded)
}

/// Whether atoms of this element bind metals.
fn element_binds(atom: &Atom) -> bool {
    matches!(atom.element.as_str(), "N" | "O" | "S" | "Se")
}
