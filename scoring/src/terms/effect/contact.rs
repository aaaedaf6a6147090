//! Effect `contact`: a potential over pairs of atom types within about 6 Å.
//!
//! The 18 types are those of atomic contact energies (Zhang, Vasmatzis, Cornette & DeLisi, J. Mol. Biol. 267 (1997)
//! 707-726), which contact potentials for docking use. `scripts/potentials/contact_potential.py` derives the
//! potential from the complexes of a benchmark. It writes the table beside this file, and the table's first lines
//! name its sources. The radial function k is 1 up to 5 Å and falls to 0 at 7 Å with all derivatives continuous.

use super::{Effect, EffectDefinition, Label, RadialFunction, Term};
use crate::kernel::smooth_step_down;
use crate::terms::{built_in, end, table_lines, wrong};
use knotdock_structures::{Error, Knots};
use serde::{Deserialize, Serialize};

/// Definition of the effect.
pub(super) const EFFECT: EffectDefinition = EffectDefinition {
    id: "contact",
    of_meshes: "meshes have no atom types",
    components: 3.0,
    lacks: |inputs| {
        let too_few = inputs.sides().find(|(_, labels)| {
            labels.typed == 0 || (labels.typed as f64) < TYPED_SHARE * labels.atoms as f64
        });
        too_few.map(|(side, labels)| {
            format!(
                "only {} of the {side}'s {} atoms are of known contact types",
                labels.typed, labels.atoms
            )
        })
    },
    reason: |_| "both sides are proteins of known atom types".to_owned(),
    term: |[receptor, ligand], inputs, weight| {
        let potential = inputs.contact_potential.cloned().unwrap_or_default();
        Some(term(receptor, ligand, weight, &potential))
    },
};

/// Least share of heavy atoms with contact types at which the potential applies to a molecule.
const TYPED_SHARE: f64 = 0.5;

/// Names of the types, in the order of their numbers.
pub const TYPES: [&str; 18] = [
    "N", "CA", "C", "O", "GCA", "CB", "KNZ", "KCD", "DOD", "RNH", "NNN", "RNE", "SOG", "HNE",
    "YCZ", "FCZ", "LCD", "CSG",
];

/// Distances in Å at which k begins to fall and ends.
const TAPER: [f64; 2] = [5.0, 7.0];

/// Radial function: 1 for a contact.
pub const RADIAL: RadialFunction = RadialFunction {
    value: count,
    support: TAPER[1],
};

fn count(distance: f64) -> f64 {
    smooth_step_down(distance, TAPER[0], TAPER[1])
}

/// The built-in table: lines of `#`, a header, and a row for each type.
const TABLE: &str = include_str!("contact_potential.csv");

/// Energy of a contact, `[type][type]`, symmetric, in units of RT; lower is better.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Vec<f64>>", into = "Vec<Vec<f64>>")]
pub struct Potential(Vec<Vec<f64>>);

impl Default for Potential {
    /// The built-in potential.
    fn default() -> Self {
        built_in("contact_potential.csv", Self::parse(TABLE))
    }
}

impl From<Potential> for Vec<Vec<f64>> {
    fn from(potential: Potential) -> Self {
        potential.0
    }
}

impl TryFrom<Vec<Vec<f64>>> for Potential {
    type Error = String;

    fn try_from(rows: Vec<Vec<f64>>) -> Result<Self, String> {
        let size = TYPES.len();
        if rows.len() != size || rows.iter().any(|row| row.len() != size) {
            return Err(format!(
                "a contact potential has {size} rows of {size} energies"
            ));
        }
        for (a, row) in rows.iter().enumerate() {
            for (b, value) in row.iter().enumerate() {
                if !value.is_finite() {
                    return Err(format!(
                        "the energy of {} and {} is {value}",
                        TYPES[a], TYPES[b]
                    ));
                }
                if *value != rows[b][a] {
                    return Err(format!(
                        "{} and {} have energy {value} one way and {} the other",
                        TYPES[a], TYPES[b], rows[b][a]
                    ));
                }
            }
        }
        Ok(Self(rows))
    }
}

impl Potential {
    /// Reads a table: lines of `#`, a header `type,` with the names of [`TYPES`], and a row for each type in that
    /// order.
    ///
    /// # Errors
    /// [`Error`] with the line that has another form, or if the energies are not finite and symmetric.
    pub fn parse(text: &str) -> Result<Self, Error> {
        let mut lines = table_lines(text);
        header(&mut lines, "")?;
        let potential = Self::parse_rows(&mut lines, "")?;
        end(&mut lines)?;
        Ok(potential)
    }

    /// Reads the rows of a table, one for each type in order. `prefix` precedes the type's name.
    pub(crate) fn parse_rows<'a>(
        lines: &mut impl Iterator<Item = (usize, &'a str)>,
        prefix: &str,
    ) -> Result<Self, Error> {
        let mut rows = Vec::new();
        let mut last = 1;
        for ((line, text), name) in lines.by_ref().take(TYPES.len()).zip(TYPES) {
            last = line;
            let fields = text
                .strip_prefix(prefix)
                .and_then(|text| text.strip_prefix(name))
                .and_then(|text| text.strip_prefix(','))
                .ok_or_else(|| wrong(line, format!("this should be the row of {prefix}{name}")))?;
            let row: Result<Vec<f64>, _> =
                fields.split(',').map(str::trim).map(str::parse).collect();
            rows.push(row.map_err(|_| wrong(line, "an energy is not a number"))?);
        }
        rows.try_into().map_err(|message| wrong(last, message))
    }

    /// Potential whose energies are all 0.
    pub fn zero() -> Self {
        Self(vec![vec![0.0; TYPES.len()]; TYPES.len()])
    }

    /// Energy of a contact of types a and b in RT.
    pub fn energy(&self, a: usize, b: usize) -> f64 {
        self.0[a][b]
    }
}

/// Reads the header of a table: `prefix`, then `type,` with the names of the types.
pub(crate) fn header<'a>(
    lines: &mut impl Iterator<Item = (usize, &'a str)>,
    prefix: &str,
) -> Result<(), Error> {
    let expected = format!("{prefix}type,{}", TYPES.join(","));
    match lines.next() {
        Some((_, header)) if header.trim() == expected => Ok(()),
        Some((line, _)) => Err(wrong(line, format!("the header is not `{expected}`"))),
        None => Err(wrong(1, "the table is empty")),
    }
}

/// Term of two sets of knots with contact types: minus `weight` (score per RT) times the potential.
pub fn term(receptor: &Knots, ligand: &Knots, weight: f64, potential: &Potential) -> Term {
    let labels = |knots: &Knots| {
        (0..knots.len())
            .map(|index| match knots.contact_types.get(index) {
                Some(&Some(kind)) if usize::from(kind) < TYPES.len() => Label {
                    class: usize::from(kind),
                    value: knots.weights.get(index).copied().unwrap_or(0.0),
                },
                _ => Label::default(),
            })
            .collect()
    };
    let scaled = |row: &Vec<f64>| row.iter().map(|value| -weight * value).collect();
    Term {
        effect: Effect::Contact,
        radial: RADIAL,
        matrix: potential.0.iter().map(scaled).collect(),
        receptor: labels(receptor),
        ligand: labels(ligand),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_whole_and_says_what_chemistry_does() {
        let Potential(potential) = Potential::parse(TABLE).unwrap();
        assert!(potential.iter().flatten().any(|value| *value != 0.0));
        // Opposite charges attract, like charges repel, and hydrophobic atoms attract each other.
        let of = |a: &str, b: &str| {
            let index = |name: &str| TYPES.iter().position(|kind| *kind == name).unwrap();
            potential[index(a)][index(b)]
        };
        assert!(of("KNZ", "DOD") < of("KNZ", "KNZ") && of("LCD", "LCD") < of("LCD", "DOD"));
    }

    #[test]
    fn tables_that_are_none_are_refused_by_line() {
        let line_of = |text: &str| {
            let error = Potential::parse(text).unwrap_err();
            error.line().unwrap() as usize
        };
        assert_eq!(line_of(""), 1);
        assert_eq!(line_of("# x\ntype,A,B\n"), 2);
        let lines = TABLE.lines().count();
        assert_eq!(line_of(&format!("{TABLE}N,1\n")), lines + 1);
        let spoilt = |from: &str, to: &str| Potential::parse(&TABLE.replacen(from, to, 1));
        assert!(spoilt("\nKNZ,", "\nXXX,").is_err());
        assert!(spoilt("\nKNZ,", "\nKNZ,NaN,").is_err());
        assert!(spoilt("\nCA,", "\nCA,1").is_err(), "not symmetric any more");
    }
}
