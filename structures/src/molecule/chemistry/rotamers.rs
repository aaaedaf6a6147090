//! Chi angles of amino acids, about whose bonds the side chains turn, and rotamers by backbone.
//!
//! Atoms and signs are those of IUPAC-IUB, J. Mol. Biol. 52 (1970) 1-17. Chi k is the dihedral angle of four atoms in a
//! row of the chain N, CA, CB, ..., counted from its k-th atom. Alanine and glycine have none; proline's are left out,
//! because its ring does not turn.
//!
//! The table of rotamers beside this file is an excerpt of the 2010 Backbone-Dependent Rotamer Library: Shapovalov &
//! Dunbrack, Structure 19 (2011) 844-858, free under the Open Data Commons Attribution License. It holds nodes every 40
//! degrees of phi and psi, and rotamers of at least 2%. For amides, carboxylates and rings the library has a rotamer
//! every 30 degrees or so of the last angle, each with its own probability.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::sync::LazyLock;

use crate::molecule::chemistry::side_chain;

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
            side_chain: side_chain.iter().map(|atom| atom.name).collect(),
        })
    }

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

/// Lines of `#`, a header, then residue, phi, psi, probability in thousandths and the angles, in degrees.
const TABLE: &str = include_str!("rotamers.csv");

const STEP: i32 = 40;
/// Lowest node of phi and of psi, in degrees.
const LOWEST: [i32; 2] = [-180, -160];

/// Standard deviation in radians of an angle about a rotamer's mean: 15 degrees, the library's own being 6 to 21.
const DEVIATION: f64 = 15.0 * TAU / 360.0;

/// Probability of a conformation near no rotamer of the table: half of the least in the table.
const ELSEWHERE: f64 = 0.01;

/// One rotamer of a residue at a node of phi and psi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotamer {
    /// Its probability, 0.02 to 1.
    pub probability: f64,
    /// Mean chi angles in radians, -pi to pi; zero past the last that the residue has.
    pub chi: [f64; MAX_CHI],
}

type Nodes = HashMap<[i32; 2], Vec<Rotamer>>;

static ROTAMERS: LazyLock<HashMap<&'static str, Nodes>> = LazyLock::new(|| {
    let mut residues: HashMap<&'static str, Nodes> = HashMap::new();
    let lines = TABLE.lines().filter(|line| !line.starts_with('#'));
    for line in lines.skip(1) {
        let mut fields = line.split(',');
        let residue = fields.next().unwrap_or_default();
        // The table is part of the program, and a test reads all of it.
        let mut number = || fields.next().and_then(|field| field.parse::<i32>().ok());
        let (Some(phi), Some(psi), Some(thousandths)) = (number(), number(), number()) else {
            unreachable!("rotamers.csv: not a row of numbers: `{line}`");
        };
        let mut angle = || number().map_or(0.0, |degrees| f64::from(degrees).to_radians());
        let rotamer = Rotamer {
            probability: f64::from(thousandths) / 1000.0,
            chi: std::array::from_fn(|_| angle()),
        };
        let nodes = residues.entry(residue).or_default();
        nodes.entry([phi, psi]).or_default().push(rotamer);
    }
    residues
});

/// The rotamers of a residue for a backbone's phi and psi (radians), the most probable first: those of the nearest
/// node.
///
/// Empty for residues without chi angles and for names outside the twenty. Source: see the module.
pub fn rotamers(residue: &str, phi: f64, psi: f64) -> &'static [Rotamer] {
    let nearest = |angle: f64, lowest: i32| {
        let steps = ((angle.to_degrees() - f64::from(lowest)) / f64::from(STEP)).round();
        // Whole steps, modulo a turn; no number is the first node.
        lowest + STEP * (steps.rem_euclid(f64::from(360 / STEP)) as i32)
    };
    let node = [nearest(phi, LOWEST[0]), nearest(psi, LOWEST[1])];
    let nodes = ROTAMERS.get(residue);
    let rotamers = nodes.and_then(|nodes| nodes.get(&node));
    rotamers.map_or(&[], Vec::as_slice)
}

/// Natural logarithm of the probability of chi angles (radians) relative to the most probable ones, at most 0.
///
/// It is ln((max_r p_r exp(-sum_k (chi_k - chi_rk)^2 / (2 s^2)) + e) / (max_r p_r + e)) over the rotamers r, with
/// s = 15 degrees and e = 0.01. Angles of rings and carboxylates count modulo half a turn.
pub fn log_probability(residue: &str, rotamers: &[Rotamer], chi: &[f64]) -> f64 {
    let (mut here, mut top) = (0.0_f64, 0.0_f64);
    for rotamer in rotamers {
        let angles = chi.iter().zip(rotamer.chi).enumerate();
        let squares = angles.map(|(k, (chi, mean))| {
            let period = period(residue, k);
            let difference = chi - mean;
            (difference - period * (difference / period).round()).powi(2)
        });
        let exponent = squares.sum::<f64>() / (2.0 * DEVIATION * DEVIATION);
        here = here.max(rotamer.probability * (-exponent).exp());
        top = top.max(rotamer.probability);
    }
    ((here + ELSEWHERE) / (top + ELSEWHERE)).ln()
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

    const TURNING: [&str; 17] = [
        "ARG", "ASN", "ASP", "CYS", "GLN", "GLU", "HIS", "ILE", "LEU", "LYS", "MET", "PHE", "SER",
        "THR", "TRP", "TYR", "VAL",
    ];

    /// Every residue has rotamers at every node, each probability is one, and they sum to most of the whole.
    #[test]
    fn every_node_has_rotamers() {
        for residue in TURNING {
            let count = ChiAngles::of(residue).unwrap().count();
            for phi in 0..9 {
                for psi in 0..9 {
                    let angle = |step: i32| f64::from(STEP * step - 180).to_radians();
                    let rotamers = rotamers(residue, angle(phi), angle(psi));
                    let sum: f64 = rotamers.iter().map(|rotamer| rotamer.probability).sum();
                    // Glutamine has 108 rotamers, many of them below 2%.
                    assert!((0.4..1.01).contains(&sum), "{residue} {phi} {psi} {sum}");
                    for rotamer in rotamers {
                        assert!(rotamer.chi[count..].iter().all(|&chi| chi == 0.0));
                        assert!(rotamer.chi.iter().all(|chi| chi.abs() <= 3.15));
                    }
                }
            }
        }
        assert!(rotamers("ALA", 0.0, 0.0).is_empty());
        assert!(!rotamers("SER", f64::NAN, 1e300).is_empty());
    }

    /// Valine in a helix and in a strand is trans (chi1 near 175 degrees); phi and psi are read modulo a turn.
    #[test]
    fn the_nearest_node_counts_modulo_a_turn() {
        let of = |phi: f64, psi: f64| rotamers("VAL", phi.to_radians(), psi.to_radians());
        let helix = of(-65.0, -42.0);
        assert!(helix[0].probability > 0.8 && helix[0].chi[0].abs() > 2.9);
        assert_eq!(helix, of(295.0, 318.0));
        // Node -180 serves 175, too; psi's nodes are -160 to 160.
        assert_eq!(of(175.0, -175.0), of(-180.0, -160.0));
        assert_eq!(of(175.0, 175.0), of(-180.0, 160.0));
    }

    #[test]
    fn probability_falls_with_the_distance_from_a_rotamer() {
        let table = rotamers("PHE", -1.0, -0.7);
        let of = |chi: [f64; 2]| log_probability("PHE", table, &chi);
        let [chi1, chi2, ..] = table[0].chi;
        assert!(of([chi1, chi2]).abs() < 1e-12);
        // Half a turn of the ring changes nothing.
        assert!((of([chi1 + 0.1, chi2]) - of([chi1 + 0.1, chi2 + 3.0 * TAU / 2.0])).abs() < 1e-9);
        assert!(of([chi1 + 0.3, chi2]) < of([chi1 + 0.1, chi2]));
        assert!(of([0.0, chi2]) >= (ELSEWHERE / 1.01_f64).ln());
    }
}
