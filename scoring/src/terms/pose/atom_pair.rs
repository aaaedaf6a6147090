//! Pose term `atom_pair`: a potential over pairs of atoms by kind and distance.

use super::bodies::Bodies;
use super::{PoseTerm, TermDefinition, UNRELAXED};
use crate::lanes::ROUNDING;
use crate::terms::{built_in, table_lines, wrong};
use knotdock_structures::{Error, Knots};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::sync::LazyLock;

/// Definition of the term.
pub(super) const TERM: TermDefinition = TermDefinition {
    id: "atom_pair",
    label: "atom pairs",
    unit: "score per RT",
    time_share: UNRELAXED,
    is_shown_always: true,
    reads: "atoms with kinds",
    count: |inputs| inputs.atoms_with_kinds(),
    applies: |inputs| inputs.has_atom_kinds(),
    build: |inputs, weight| {
        let potential = inputs.atom_pair_potential.cloned().unwrap_or_default();
        term(inputs.bodies, &potential, weight)
    },
};

/// Minus the weighted potential (score per RT) over the pairs of two sets of knots with atom kinds.
///
/// Two atoms of kinds a and b at distance d score `-weight E_ab(d)`, with E_ab by [`energy`]. Atoms without a
/// kind do not count.
pub(super) fn term(
    [receptor, ligand]: [&Knots; 2],
    potential: &AtomPairPotential,
    weight: f64,
) -> PoseTerm {
    let energies = EnergyTable::new(potential);
    let bodies = Bodies::new(
        receptor,
        ligand,
        |knots| &knots.atom_kinds,
        (energies.unknown(), REACH),
    );
    Box::new(move |pose, _| {
        let sum = bodies.sum(
            pose,
            #[inline(always)]
            |a, b, distance| energy(energies.row(b), a, distance),
        );
        -weight * sum
    })
}

/// Distances in Å at which the table holds energies, spaced by [`STEP`].
pub const DISTANCES: [f64; 6] = [3.25, 3.75, 4.25, 4.75, 5.25, 5.75];
/// Distance in Å between them.
pub const STEP: f64 = 0.5;

/// The built-in table: lines of `#`, a header, and a row for each pair of kinds.
const TABLE: &str = include_str!("atom_pair_potential.csv");

static KINDS: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
    let rows = table_lines(TABLE).skip(1);
    let mut kinds: Vec<&str> = rows
        .filter_map(|(_, row)| Some(row.split_once(',')?.0))
        .collect();
    kinds.dedup();
    kinds
});

/// Names of the kinds of atoms, residue and atom as in `ARG_CZ`, in the order of the built-in table.
pub fn atom_kinds() -> &'static [&'static str] {
    &KINDS
}

/// Energies of pairs of atoms by their kinds ([`atom_kinds`]) and distance, in units of RT; lower is better.
///
/// `scripts/potentials/atom_pair_potential.py` derives the built-in one from the insides of proteins. An energy is
/// minus the logarithm of the observed over the expected frequency of two kinds at a distance (Samudrala & Moult, J.
/// Mol. Biol. 275 (1998) 895-916).
///
/// The expected frequency follows from the shares of the kinds. A share is the geometric mean of two: that among all
/// atoms (the mole fractions of Zhang, Vasmatzis, Cornette & DeLisi, J. Mol. Biol. 267 (1997) 707-726) and that among
/// all partners (the quasi-chemical approximation of Miyazawa & Jernigan, J. Mol. Biol. 256 (1996) 623-644). So
/// energies contain half of a kind's gain by being buried.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Energies>", into = "Vec<Energies>")]
pub struct AtomPairPotential(Vec<Energies>);

/// Energies of one pair at [`DISTANCES`].
type Energies = [f32; DISTANCES.len()];

impl Default for AtomPairPotential {
    /// The built-in potential.
    fn default() -> Self {
        built_in("atom_pair_potential.csv", Self::parse(TABLE))
    }
}

impl From<AtomPairPotential> for Vec<Energies> {
    fn from(potential: AtomPairPotential) -> Self {
        potential.0
    }
}

impl TryFrom<Vec<Energies>> for AtomPairPotential {
    type Error = String;

    fn try_from(rows: Vec<Energies>) -> Result<Self, String> {
        if rows.len() != pairs() {
            return Err(format!(
                "an atom pair potential has {} rows, not {}",
                pairs(),
                rows.len()
            ));
        }
        if rows.iter().flatten().any(|energy| !energy.is_finite()) {
            return Err("an energy is not a finite number".to_owned());
        }
        Ok(Self(rows))
    }
}

/// Number of pairs of kinds.
fn pairs() -> usize {
    atom_kinds().len() * (atom_kinds().len() + 1) / 2
}

/// Index of a pair in the order (0, 0), (1, 0), (1, 1), (2, 0), ...
fn place(a: usize, b: usize) -> usize {
    let (low, high) = (a.min(b), a.max(b));
    high * (high + 1) / 2 + low
}

impl AtomPairPotential {
    /// Reads a table: lines of `#`, a header `kind,kind,` with [`DISTANCES`], then a row for each pair of kinds, in
    /// any order.
    ///
    /// # Errors
    /// [`Error`] with the line that has another form, or with the last line if pairs are missing.
    pub fn parse(text: &str) -> Result<Self, Error> {
        let mut lines = table_lines(text);
        let distances: Vec<String> = DISTANCES.iter().map(f64::to_string).collect();
        let header = format!("kind,kind,{}", distances.join(","));
        match lines.next() {
            Some((_, found)) if found.trim_end() == header => {}
            found => {
                let line = found.map_or(1, |(line, _)| line);
                return Err(wrong(line, format!("the header should be {header}")));
            }
        }
        let kinds: HashMap<&str, usize> = atom_kinds()
            .iter()
            .enumerate()
            .map(|(number, &name)| (name, number))
            .collect();
        let mut rows: Vec<Option<Energies>> = vec![None; pairs()];
        let mut last = 1;
        for (line, text) in lines {
            last = line;
            let mut fields = text.split(',').map(str::trim);
            let mut kind = || {
                let name = fields.next().unwrap_or_default();
                let number = kinds.get(name).copied();
                number.ok_or_else(|| wrong(line, format!("there is no kind of atom '{name}'")))
            };
            let (a, b) = (kind()?, kind()?);
            let energies: Option<Vec<f32>> = fields
                .map(|field| field.parse().ok().filter(|energy: &f32| energy.is_finite()))
                .collect();
            let energies = energies
                .and_then(|energies| Energies::try_from(energies).ok())
                .ok_or_else(|| {
                    let count = DISTANCES.len();
                    wrong(
                        line,
                        format!("{count} finite energies should follow the kinds"),
                    )
                })?;
            if rows[place(a, b)].replace(energies).is_some() {
                let (a, b) = (atom_kinds()[a], atom_kinds()[b]);
                return Err(wrong(line, format!("{a} and {b} have a row already")));
            }
        }
        let missing = rows.iter().filter(|row| row.is_none()).count();
        if missing > 0 {
            return Err(wrong(last, format!("{missing} pairs of kinds have no row")));
        }
        Ok(Self(rows.into_iter().flatten().collect()))
    }

    /// Energies of two kinds at [`DISTANCES`] in RT.
    pub fn energies(&self, a: usize, b: usize) -> &Energies {
        &self.0[place(a, b)]
    }
}

/// Distance in Å from which energies are 0: one step beyond the last distance of the potential.
pub(super) const REACH: f64 = DISTANCES[DISTANCES.len() - 1] + STEP;
/// Distance in Å from which smooth energies are 0.
pub(super) const SMOOTH_REACH: f64 = REACH + 0.5 * STEP;
/// Energies stored for a pair of kinds: the first twice, those of the potential, then zeros.
const NODES: usize = DISTANCES.len() + 3;

/// Energies by the kinds of two atoms and their distance, joined by straight lines.
///
/// They are constant below the potential's first distance and fall to 0 over one step after the last.
pub(super) struct EnergyTable {
    /// `[ligand kind][receptor kind]`. The last kind in both is that of atoms without a kind, with energies of 0.
    energies: Vec<[f32; NODES]>,
    kinds: usize,
}

impl EnergyTable {
    /// Table of a potential.
    pub fn new(potential: &AtomPairPotential) -> Self {
        let kinds = atom_kinds().len() + 1;
        let mut energies = vec![[0.0; NODES]; kinds * kinds];
        for a in 0..kinds - 1 {
            for b in 0..kinds - 1 {
                let nodes = &mut energies[a * kinds + b];
                let known = potential.energies(a, b);
                nodes[0] = known[0];
                nodes[1..=known.len()].copy_from_slice(known);
            }
        }
        Self { energies, kinds }
    }

    /// Index of the kind of atoms without a kind.
    pub fn unknown(&self) -> usize {
        self.kinds - 1
    }

    /// Energies of atoms of the receptor with one of the ligand, by the receptor's kinds.
    #[inline(always)]
    pub fn row(&self, ligand: usize) -> &[[f32; NODES]] {
        let from = ligand * self.kinds;
        self.energies
            .get(from..from + self.kinds)
            .unwrap_or_default()
    }
}

/// Place of a distance among the nodes, the first one of the potential at zero: the nearest node, and the way from it.
#[inline(always)]
fn node(place: f64) -> (usize, f64) {
    let rounded = place + ROUNDING;
    (
        rounded.to_bits() as u32 as usize,
        place - (rounded - ROUNDING),
    )
}

/// Energy in RT of two atoms at a distance, from the row of one and the kind of the other.
#[inline(always)]
pub(super) fn energy(row: &[[f32; NODES]], kind: usize, distance: f64) -> f64 {
    let place = ((distance - DISTANCES[0]) / STEP).clamp(0.0, DISTANCES.len() as f64);
    // Of the middles between nodes; straight lines meet at the nodes themselves.
    let (first, from) = node(place - 0.5);
    let [_, low, high] = nodes(row, kind, first);
    low + (from + 0.5) * (high - low)
}

/// As [`energy`], averaged over the distances within a quarter of an Ångström, with its derivative by the distance in
/// RT/Å, which is continuous.
///
/// It is the quadratic B-spline of the nodes and ends at [`SMOOTH_REACH`].
#[inline(always)]
pub(super) fn smooth_energy(row: &[[f32; NODES]], kind: usize, distance: f64) -> (f64, f64) {
    let place = ((distance - DISTANCES[0]) / STEP).clamp(-0.5, DISTANCES.len() as f64 + 0.5);
    let (middle, from) = node(place);
    let [low, middle, high] = nodes(row, kind, middle);
    let (fall, rise) = (middle - low, high - middle);
    let (before, after) = (0.5 - from, 0.5 + from);
    (
        middle + 0.5 * (after * after * rise - before * before * fall),
        (before * fall + after * rise) / STEP,
    )
}

/// Energies at a node and those beside it.
#[inline(always)]
fn nodes(row: &[[f32; NODES]], kind: usize, middle: usize) -> [f64; 3] {
    let nodes = row
        .get(kind)
        .and_then(|nodes| nodes.get(middle..middle + 3));
    debug_assert!(nodes.is_some(), "a kind or node that is not there");
    match nodes {
        Some(&[low, middle, high]) => [low, middle, high].map(f64::from),
        _ => [0.0; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::se3::Pose;
    use crate::terms::pose::Workspace;

    /// Every pair of kinds has the table's energy, whichever body carries which kind.
    #[test]
    fn every_pair_of_kinds_has_its_own_energies() {
        let potential = AtomPairPotential::default();
        let kinds = atom_kinds().len();
        let of = |kinds: std::ops::Range<usize>| {
            let centers = kinds.clone().map(|kind| [100.0 * kind as f64, 0.0, 0.0]);
            Knots::new(centers.collect(), vec![1.7; kinds.len()])
                .unwrap()
                .with_atom_kinds(kinds.map(|kind| Some(kind as u8)).collect())
                .unwrap()
        };
        let all = of(0..kinds);
        for b in 0..kinds {
            let pairs = term([&all, &of(b..b + 1)], &potential, 1.0);
            for a in 0..kinds {
                let x = 100.0 * (a as f64 - b as f64) + DISTANCES[2];
                let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
                let energy = f64::from(potential.energies(a, b)[2]);
                let score = pairs(&pose, &mut Workspace::default());
                assert!((score + energy).abs() < 1e-9, "{a} {b}");
            }
        }
    }

    /// Two atoms at each of the table's distances have its energy, and nearer ones the first. Beyond the reach there
    /// is none.
    #[test]
    fn one_pair_has_the_energy_of_its_distance() {
        let potential = AtomPairPotential::default();
        let one = |kind: u8| {
            let knots = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
            knots.with_atom_kinds(vec![Some(kind)]).unwrap()
        };
        let pairs = term([&one(6), &one(18)], &potential, 3.0);
        let at = |x: f64| {
            let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
            pairs(&pose, &mut Workspace::default())
        };
        let energies = potential.energies(6, 18);
        for (distance, energy) in DISTANCES.iter().zip(energies) {
            assert!((at(*distance) + 3.0 * f64::from(*energy)).abs() < 1e-12);
        }
        // Straight lines between: the hats of the nodes add up to the sum.
        for index in 0..650 {
            let distance = 0.01 * f64::from(index);
            let hat = |node: usize| {
                let from = (distance - DISTANCES[node]) / STEP;
                if node == 0 && from < 0.0 {
                    1.0
                } else {
                    (1.0 - from.abs()).max(0.0)
                }
            };
            let expected: f64 = (0..DISTANCES.len())
                .map(|node| hat(node) * f64::from(energies[node]))
                .sum();
            assert!((at(distance) + 3.0 * expected).abs() < 1e-10, "{distance}");
        }
        assert_eq!(at(0.0), at(DISTANCES[0]));
        let last = f64::from(energies[DISTANCES.len() - 1]);
        assert!((at(REACH - 0.5 * STEP) + 1.5 * last).abs() < 1e-9);
        assert_eq!([at(REACH), at(500.0), at(-1e9)].map(f64::abs), [0.0; 3]);
    }
}

#[cfg(test)]
mod atom_pair_potential_tests {
    use super::*;

    #[test]
    fn the_table_is_whole_and_says_what_chemistry_does() {
        let potential = AtomPairPotential::parse(TABLE).unwrap();
        assert_eq!(AtomPairPotential::default(), potential);
        let index = |name: &str| atom_kinds().iter().position(|kind| *kind == name).unwrap();
        let energy = |a: &str, b: &str| potential.energies(index(a), index(b));
        // A salt bridge against two like charges; two hydrophobic atoms against one and a charge; a disulphide.
        assert!(energy("LYS_NZ", "ASP_OD1")[0] < energy("LYS_NZ", "LYS_NZ")[0]);
        assert!(energy("LEU_CD1", "ILE_CD1")[1] < energy("LEU_CD1", "LYS_NZ")[1]);
        assert!(energy("CYS_SG", "CYS_SG")[0] < 0.0);
    }

    #[test]
    fn every_pair_has_a_place_of_its_own() {
        let kinds = atom_kinds().len();
        let mut seen = vec![false; pairs()];
        for a in 0..kinds {
            for b in 0..=a {
                assert_eq!(place(a, b), place(b, a));
                assert!(!std::mem::replace(&mut seen[place(a, b)], true));
            }
        }
        assert!(seen.iter().all(|seen| *seen));
    }

    #[test]
    fn tables_that_are_none_are_refused_by_line() {
        let lines: Vec<&str> = TABLE.lines().collect();
        let first = lines
            .iter()
            .position(|line| line.starts_with("ALA_N,"))
            .unwrap();
        let line_of = |lines: &[&str]| {
            let error = AtomPairPotential::parse(&lines.join("\n")).unwrap_err();
            error.line().unwrap() as usize
        };
        let spoilt = |line: &str| {
            let mut lines = lines.clone();
            lines[first] = line;
            line_of(&lines)
        };
        for line in [
            "ALA_N,ALA_N,1,2",
            "ALA_N,ALA_QX,1,2,3,4,5,6",
            "ALA_N,ALA_N,1,2,3,4,5,x",
            "ALA_N,ALA_N,1,2,3,4,5,inf",
        ] {
            assert_eq!(spoilt(line), first + 1, "{line}");
        }
        assert_eq!(line_of(&lines[first..]), 1, "no header");
        assert_eq!(
            line_of(&lines[..lines.len() - 1]),
            lines.len() - 1,
            "cut short"
        );
        let twice: Vec<&str> = lines.iter().chain(&lines[first..=first]).copied().collect();
        assert_eq!(line_of(&twice), twice.len());
        assert!(AtomPairPotential::try_from(vec![[0.0; DISTANCES.len()]; 3]).is_err());
    }

    /// A table survives its record in `run.json`.
    #[test]
    fn a_table_survives_its_record() {
        let potential = AtomPairPotential::default();
        let again = AtomPairPotential::try_from(Vec::from(potential.clone()));
        assert_eq!(again, Ok(potential));
    }
}
