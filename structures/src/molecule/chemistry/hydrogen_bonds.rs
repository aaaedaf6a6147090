//! Which atoms give and take hydrogen bonds.
//!
//! Of amino acids by the hydrogens that their atoms carry (Baker & Hubbard, Prog. Biophys. Mol. Biol. 44 (1984)
//! 97-179). Histidine's nitrogens do both, because files do not show its protons. So do oxygens and nitrogens of other
//! molecules.

use crate::molecule::chemistry::residues::{is_amino_acid, parent, standard_atom_name};

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

#[cfg(test)]
mod tests {
    use super::*;

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
