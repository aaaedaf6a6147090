//! United-atom radii: heavy atoms that stand for their hydrogens too.
//!
//! One table, from five sources:
//!
//! - Proteins: ProtOr, Tsai, Taylor, Chothia & Gerstein, J. Mol. Biol. 290 (1999) 253-266: radii by element, number of
//!   bonds and hydrogens, from the packing of small-molecule crystals. A protein has seven distinct ones, 1.42 to 1.88
//!   Å.
//! - Nucleic acids: the same classes with phosphorus 1.80 Å, as in NucProt, Voss & Gerstein, J. Mol. Biol. 346 (2005)
//!   477-492.
//! - Halogens and selenium: Bondi, J. Phys. Chem. 68 (1964) 441-451.
//! - Metals and the rest: half the equilibrium distance x_I of UFF, Rappé, Casewit, Colwell, Goddard & Skiff,
//!   J. Am. Chem. Soc. 114 (1992) 10024-10035, Table I, rounded to 0.1 Å, so that metals add few distinct radii.
//! - Atoms of ligands and unlisted residues, whose hydrogens are not known: the class of their element in the middle
//!   (C3H1 for carbon) or most common in sugars and phosphate esters (O2H1 for oxygen).
//!
//! Where hydrogens are kept, all radii are all-atom ones: Bondi's of the element (the paper above, Table I), and 1.10 Å
//! for hydrogen, Rowland & Taylor, J. Phys. Chem. 100 (1996) 7384-7391; metals and the rest as above.
//!
//! Few distinct radii matter: each is a class of the lifted axis and costs time.

use crate::molecule::chemistry::residues::{C3H1, N, O2H1, P, RadiusClass, S, SE};
use crate::molecule::chemistry::{
    amino_acid_type, backbone_type, element, is_hydrogen, nucleotide_type,
};
use crate::molecule::model::GroupKind;

/// Radius of all other elements, in Å: in the middle of UFF's metals.
const OTHER: f64 = 1.7;

/// United-atom radius of a heavy atom, in Å.
///
/// `kind` is the residue's: those named like nucleotides are not all of them such, and modified residues have an amino
/// acid's backbone.
pub(crate) fn radius(residue_name: &str, atom_name: &str, element: &str, kind: GroupKind) -> f64 {
    amino_acid_type(residue_name, atom_name)
        .or_else(|| match kind {
            GroupKind::Nucleotide => nucleotide_type(residue_name, atom_name),
            GroupKind::AminoAcid | GroupKind::ModifiedResidue => backbone_type(atom_name),
            _ => None,
        })
        // A name in the tables is not enough where the element says otherwise.
        .filter(|class| class.element == element)
        .or_else(|| class_of_element(element))
        .map_or_else(|| of_element(element), |class| class.radius)
}

/// Radius in Å of an atom whose hydrogens are separate atoms.
pub(crate) fn all_atom_radius(symbol: &str) -> f64 {
    of_element(if is_hydrogen(symbol) { "H" } else { symbol })
}

fn class_of_element(element: &str) -> Option<&'static RadiusClass> {
    let classes = [&C3H1, &N, &O2H1, &S, &SE, &P];
    classes.into_iter().find(|class| class.element == element)
}

/// Radius of an element that has no class: Bondi's, or half of UFF's distance.
fn of_element(symbol: &str) -> f64 {
    let element = element(symbol);
    let radius = element.and_then(|element| element.radius);
    let distance = element.and_then(|element| element.distance);
    let half = || distance.map(|distance| (distance * 5.0).round() / 10.0);
    radius.or_else(half).unwrap_or(OTHER)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_protein_has_seven_radii() {
        // ProtOr's values for one atom of each class (Tsai et al. 1999).
        let examples = [
            ("ALA", "C", "C", 1.61),
            ("PHE", "CZ", "C", 1.76),
            ("ALA", "CB", "C", 1.88),
            ("LYS", "NZ", "N", 1.64),
            ("ALA", "O", "O", 1.42),
            ("SER", "OG", "O", 1.46),
            ("CYS", "SG", "S", 1.77),
        ];
        for (residue, atom, element, expected) in examples {
            assert_eq!(
                radius(residue, atom, element, GroupKind::AminoAcid),
                expected,
                "{residue} {atom}"
            );
        }
    }

    #[test]
    fn modified_residues_keep_the_backbone_and_ligands_go_by_element() {
        let modified = GroupKind::ModifiedResidue;
        assert_eq!(radius("SEP", "CA", "C", modified), 1.88);
        assert_eq!(radius("SEP", "P", "P", modified), 1.80);
        // Calcium named CA in a residue that has no backbone.
        assert_eq!(radius("CA", "CA", "Ca", GroupKind::Metal), 1.7);
        assert_eq!(radius("HEM", "FE", "Fe", GroupKind::Cofactor), 1.5);
        assert_eq!(radius("HEM", "CHA", "C", GroupKind::Cofactor), 1.76);
        assert_eq!(radius("U1", "U", "U", GroupKind::Metal), 1.7);
        // A thyroid hormone, whose name is a nucleotide's.
        assert_eq!(radius("T3", "C5", "C", GroupKind::Nucleotide), 1.61);
        assert_eq!(radius("T3", "C5", "C", GroupKind::Cofactor), 1.76);
    }

    #[test]
    fn every_radius_is_of_an_atoms_size() {
        for symbol in ["F", "Cl", "Br", "I", "Li", "Fe", "Zn", "U", "Xe", "Lr"] {
            assert!((1.2..=2.3).contains(&of_element(symbol)), "{symbol}");
        }
        assert_eq!(["H", "D", "T"].map(all_atom_radius), [1.10; 3]);
    }
}
