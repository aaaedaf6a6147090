//! Atoms that take part in hydrogen bonds, and the direction in which each does.
//!
//! Hydrogens are mostly absent from files, so a bond is judged by its heavy atoms: by their distance, and by the
//! direction in which each points away from its bonded atoms. Amino acids give and take by the hydrogens that their
//! atoms carry (Baker & Hubbard, Prog. Biophys. Mol. Biol. 44 (1984) 97-179). Histidine's nitrogens do both, because
//! files do not show its protons. So do oxygens and nitrogens of other molecules.

use crate::molecule::chemistry::{is_amino_acid, parent, standard_atom_name};
use crate::molecule::model::{Atom, Molecule, residues};
use crate::neighbours::{CellList, Member};
use crate::polar_atom::PolarAtom;

/// Longest covalent bond of nitrogen or oxygen to a heavy atom, Å: to phosphorus or sulphur 1.6 to 1.7.
const BOND: f64 = 1.9;
/// Distance in Å below which two atoms are one that is given twice.
const SAME: f64 = 0.5;
/// Least length of the sum of the unit vectors from the bonded atoms that has a direction.
const DIRECTED: f64 = 0.3;
/// Edge of the cells that hold the atoms, Å.
const CELL_EDGE: f64 = 4.0;

/// What an atom does in hydrogen bonds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HydrogenBonding {
    /// Whether it carries a hydrogen to give.
    pub donor: bool,
    /// Whether it has electrons to take one.
    pub acceptor: bool,
}

/// What an atom does in hydrogen bonds, `None` of one that has no part in them.
pub fn hydrogen_bonding(
    residue_name: &str,
    atom_name: &str,
    element: &str,
) -> Option<HydrogenBonding> {
    if !matches!(element, "N" | "O") {
        return None;
    }
    let (donor, acceptor) = if is_amino_acid(residue_name) {
        let residue = parent(residue_name);
        match (residue, standard_atom_name(residue, atom_name)) {
            ("PRO", "N") => (false, false),
            ("SER", "OG") | ("THR", "OG1") | ("TYR", "OH") | ("HIS", "ND1" | "NE2") => (true, true),
            _ if element == "N" => (true, false),
            _ => (false, true),
        }
    } else {
        (true, true)
    };
    (donor || acceptor).then_some(HydrogenBonding { donor, acceptor })
}

impl Molecule {
    /// The part of each atom in hydrogen bonds; of carbon, sulphur and hydrogen none.
    pub fn polar_atoms(&self) -> Vec<PolarAtom> {
        let bonded = self.atoms.iter().filter(|atom| is_nonmetal(atom));
        let members = bonded.map(|atom| Member {
            position: atom.position,
            item: atom.position,
        });
        let cells = CellList::new(members.collect(), CELL_EDGE);
        let mut polar = vec![PolarAtom::default(); self.atoms.len()];
        for residue in &residues(&self.atoms) {
            for &index in &residue.atoms {
                let Atom {
                    name,
                    element,
                    position,
                    ..
                } = &self.atoms[index];
                if let Some(part) = hydrogen_bonding(residue.known_as, name, element) {
                    polar[index] = PolarAtom {
                        donates: part.donor,
                        accepts: part.acceptor,
                        direction: direction(&cells, *position),
                    };
                }
            }
        }
        polar
    }
}

/// Unit vector away from the atoms that the one at `position` is bonded to; zero where they surround it or are none.
fn direction(cells: &CellList<[f64; 3]>, position: [f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    cells.visit_within(position, BOND, |other, square| {
        if square > SAME * SAME {
            for ((sum, x), other) in sum.iter_mut().zip(position).zip(other) {
                *sum += (x - other) / square.sqrt();
            }
        }
    });
    let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > DIRECTED {
        sum.map(|x| x / length)
    } else {
        [0.0; 3]
    }
}

/// Whether an atom makes covalent bonds; those of metals are longer, and coordinate.
fn is_nonmetal(atom: &Atom) -> bool {
    matches!(
        atom.element.as_str(),
        "B" | "C" | "N" | "O" | "F" | "Si" | "P" | "S" | "Cl" | "Se" | "Br" | "I"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::{InputSpec, ReadOptions, read_bytes};

    /// An amide nitrogen points away from its two carbons, a carbonyl oxygen along its bond; carbon does nothing.
    #[test]
    fn atoms_point_away_from_their_bonds() {
        let text = "\
ATOM      1  N   ALA A   1       0.000   0.000   0.000  1.00  0.00           N
ATOM      2  CA  ALA A   1       1.200   0.800   0.000  1.00  0.00           C
ATOM      3  C   ALA A   1       2.500   0.000   0.000  1.00  0.00           C
ATOM      4  O   ALA A   1       2.500  -1.230   0.000  1.00  0.00           O
ATOM      5  N   GLY A   2      -1.000   0.000  60.000  1.00  0.00           N
";
        let spec = InputSpec::whole("two.pdb");
        let molecule =
            read_bytes(&spec, text.as_bytes().to_vec(), &ReadOptions::default()).unwrap();
        let polar = molecule.polar_atoms();
        assert!(polar[0].donates && !polar[0].accepts);
        let length = 1.2f64.hypot(0.8);
        let expected = [-1.2 / length, -0.8 / length, 0.0];
        for axis in 0..3 {
            assert!((polar[0].direction[axis] - expected[axis]).abs() < 1e-12);
            assert!((polar[3].direction[axis] - [0.0, -1.0, 0.0][axis]).abs() < 1e-12);
        }
        assert!(!polar[3].donates && polar[3].accepts);
        assert_eq!(polar[1], PolarAtom::default());
        assert_eq!(polar[4].direction, [0.0; 3]);
        assert!(polar[0].may_bond(&polar[3]) && !polar[0].may_bond(&polar[4]));
    }

    #[test]
    fn hydrogens_decide() {
        let of = |residue, atom, element| {
            hydrogen_bonding(residue, atom, element).map(|role| (role.donor, role.acceptor))
        };
        assert_eq!(of("ALA", "N", "N"), Some((true, false)));
        assert_eq!(of("PRO", "N", "N"), None);
        assert_eq!(of("ASP", "OD2", "O"), Some((false, true)));
        assert_eq!(of("HIE", "ND1", "N"), Some((true, true)));
        assert_eq!(of("TYR", "OH", "O"), Some((true, true)));
        assert_eq!(of("LYS", "NZ", "N"), Some((true, false)));
        assert_eq!(of("CYS", "SG", "S"), None);
        assert_eq!(of("HEM", "O1A", "O"), Some((true, true)));
    }
}
