//! Chi angles: about which bonds the side chains of amino acids turn.
//!
//! Atoms and signs are those of IUPAC-IUB, J. Mol. Biol. 52 (1970) 1-17. Chi k is the dihedral angle of four atoms in
//! a row of the chain N, CA, CB, ..., counted from its k-th atom. Alanine and glycine have none; proline's are left
//! out, because its ring does not turn.

use crate::molecule::chemistry::residues::side_chain;

/// Most chi angles of a residue.
pub(crate) const MAX_CHI: usize = 4;

/// The atoms after CB in the chain of a residue's chi angles. There are as many as angles.
const CHAINS: [(&str, &[&str]); 17] = [
    ("ARG", &["CG", "CD", "NE", "CZ"]),
    ("ASN", &["CG", "OD1"]),
    ("ASP", &["CG", "OD1"]),
    ("CYS", &["SG"]),
    ("GLN", &["CG", "CD", "OE1"]),
    ("GLU", &["CG", "CD", "OE1"]),
    ("HIS", &["CG", "ND1"]),
    ("ILE", &["CG1", "CD1"]),
    ("LEU", &["CG", "CD1"]),
    ("LYS", &["CG", "CD", "CE", "NZ"]),
    ("MET", &["CG", "SD", "CE"]),
    ("PHE", &["CG", "CD1"]),
    ("SER", &["OG"]),
    ("THR", &["OG1"]),
    ("TRP", &["CG", "CD1"]),
    ("TYR", &["CG", "CD1"]),
    ("VAL", &["CG1"]),
];

/// The turning bonds of a residue's side chain, by atom names.
pub(crate) struct ChiAngles {
    /// The residue in the tables of rotamers: of selenomethionine `MET`, of selenocysteine `CYS`.
    pub(crate) residue: &'static str,
    /// N, CA, CB and the atoms after it; chi k is the angle of the k-th to the (k + 3)-th, from 1.
    pub(crate) chain: Vec<&'static str>,
    /// All heavy atoms of the side chain, CB first.
    pub(crate) side_chain: Vec<&'static str>,
}

impl ChiAngles {
    /// The turning bonds of a residue by its plain name, `None` where nothing turns.
    pub(crate) fn of(plain_name: &str) -> Option<Self> {
        let (residue, selenium) = match plain_name {
            "MSE" => ("MET", Some("SD")),
            "SEC" => ("CYS", Some("SG")),
            other => (other, None),
        };
        let (residue, after) = CHAINS.iter().find(|(name, _)| *name == residue)?;
        let element = |name: &&'static str| if Some(*name) == selenium { "SE" } else { *name };
        let side_chain = side_chain(plain_name)?;
        Some(Self {
            residue,
            chain: ["N", "CA", "CB"]
                .into_iter()
                .chain(after.iter().map(element))
                .collect(),
            side_chain: side_chain.iter().map(|(name, _)| *name).collect(),
        })
    }

    /// How many angles there are.
    pub(crate) fn count(&self) -> usize {
        self.chain.len() - 3
    }

    /// The heavy atoms that angle `k`, from 0, moves: all beyond its bond.
    pub(crate) fn moved(&self, k: usize) -> impl Iterator<Item = &'static str> {
        let fixed = self.chain.get(..k + 3).unwrap_or_default();
        // The only branch that leaves the chain before its last bond.
        let branch = (self.residue == "ILE" && k == 1).then_some("CG2");
        let atoms = self.side_chain.iter().copied();
        atoms.filter(move |name| !fixed.contains(name) && Some(*name) != branch)
    }
}

/// Period in radians of angle `k`, from 0: half a turn where the atoms beyond the bond are alike, such as the two sides
/// of a ring and the oxygens of a carboxylate.
pub(crate) fn period(residue: &str, k: usize) -> f64 {
    match (residue, k) {
        ("PHE" | "TYR" | "ASP", 1) | ("GLU", 2) => std::f64::consts::PI,
        _ => std::f64::consts::TAU,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_angle_moves_what_lies_beyond_its_bond() {
        let moved =
            |name: &str, k: usize| -> Vec<&str> { ChiAngles::of(name).unwrap().moved(k).collect() };
        assert_eq!(moved("ILE", 0), ["CG1", "CG2", "CD1"]);
        assert_eq!(moved("ILE", 1), ["CD1"]);
        assert_eq!(moved("LEU", 1), ["CD1", "CD2"]);
        assert_eq!(moved("ARG", 3), ["CZ", "NH1", "NH2"]);
        assert_eq!(moved("MSE", 1), ["SE", "CE"]);
        assert_eq!(moved("TYR", 1).len(), 6);
        assert!(ChiAngles::of("ALA").is_none() && ChiAngles::of("PRO").is_none());
        for (name, after) in CHAINS {
            let angles = ChiAngles::of(name).unwrap();
            assert_eq!(angles.count(), after.len());
            for k in 0..angles.count() {
                assert!(angles.moved(k).count() > 0, "{name} {k}");
                assert!(
                    angles.side_chain.contains(&angles.chain[k + 3]),
                    "{name} {k}"
                );
            }
        }
    }
}
