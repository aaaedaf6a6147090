//! The atom pair potential: a table of energies by kinds of atoms and distance, as a script writes it.

use crate::terms::potential_table::{PotentialError, built_in, table_lines};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::sync::LazyLock;

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
/// energies contain half of what a kind gains by being buried.
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
    /// [`PotentialError`] with the line that has another form, or with the last line if pairs are missing.
    pub fn parse(text: &str) -> Result<Self, PotentialError> {
        let wrong = |line: usize, message: String| PotentialError { line, message };
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

#[cfg(test)]
mod tests {
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
        let error = |lines: &[&str]| AtomPairPotential::parse(&lines.join("\n")).unwrap_err();
        let spoilt = |line: &str| {
            let mut lines = lines.clone();
            lines[first] = line;
            error(&lines).line
        };
        for line in [
            "ALA_N,ALA_N,1,2",
            "ALA_N,ALA_QX,1,2,3,4,5,6",
            "ALA_N,ALA_N,1,2,3,4,5,x",
            "ALA_N,ALA_N,1,2,3,4,5,inf",
        ] {
            assert_eq!(spoilt(line), first + 1, "{line}");
        }
        assert_eq!(error(&lines[first..]).line, 1, "no header");
        assert_eq!(
            error(&lines[..lines.len() - 1]).line,
            lines.len() - 1,
            "cut short"
        );
        let twice: Vec<&str> = lines.iter().chain(&lines[first..=first]).copied().collect();
        assert_eq!(error(&twice).line, twice.len());
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
