//! Contact: a potential over pairs of atom types within about 6 Å.
//!
//! The 18 types are those of atomic contact energies, Zhang, Vasmatzis, Cornette & DeLisi, J. Mol. Biol. 267 (1997) 707-726, which
//! the field's contact potentials for docking use. The potential is ours: `scripts/contact_potential.py` derives it from complexes of a
//! benchmark folder and writes the table of this folder; its first lines say from what, how and when. k is 1 up to 5 Å and falls
//! C-infinity to 0 at 7 Å.

use super::{Effect, Label, RadialFunction, Term};
use crate::kernel::low_pass::smooth_step_down;
use knotdock_structures::Knots;

/// Names of the types, in the order of their numbers.
pub const TYPES: [&str; 18] = [
    "N", "CA", "C", "O", "GCA", "CB", "KNZ", "KCD", "DOD", "RNH", "NNN", "RNE", "SOG", "HNE",
    "YCZ", "FCZ", "LCD", "CSG",
];

/// Where k begins to fall and where it ends, Å.
const TAPER: [f64; 2] = [5.0, 7.0];

/// Counts a contact.
pub const RADIAL: RadialFunction = RadialFunction {
    value: count,
    support: TAPER[1],
};

fn count(distance: f64) -> f64 {
    smooth_step_down(distance, TAPER[0], TAPER[1])
}

/// The potential as its script wrote it: lines of `#`, a header, and a row for each type.
const TABLE: &str = include_str!("contact_potential.csv");

/// Energy of a contact, [type][type], symmetric, in units of RT; lower is better.
pub fn potential() -> Vec<Vec<f64>> {
    let rows = TABLE
        .lines()
        .filter(|line| !line.starts_with('#'))
        .skip(1)
        .take(TYPES.len());
    rows.map(|row| {
        let values = row.split(',').skip(1).map(|value| value.trim().parse());
        values.map(|value| value.unwrap_or(0.0)).collect()
    })
    .collect()
}

/// The term for two sets of knots with contact types: `weight` times minus the potential's sum.
pub fn term(receptor: &Knots, ligand: &Knots, weight: f64) -> Term {
    let labels = |knots: &Knots| {
        (0..knots.len())
            .map(|index| match knots.contact_types.get(index) {
                Some(&Some(kind)) if usize::from(kind) < TYPES.len() => Label {
                    class: usize::from(kind),
                    value: knots.weights.get(index).map_or(0.0, |weight| weight.re),
                },
                _ => Label::default(),
            })
            .collect()
    };
    let scaled = |row: Vec<f64>| row.into_iter().map(|value| -weight * value).collect();
    Term {
        effect: Effect::Contact,
        radial: RADIAL,
        matrix: potential().into_iter().map(scaled).collect(),
        receptor: labels(receptor),
        ligand: labels(ligand),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_whole_and_symmetric() {
        let potential = potential();
        assert_eq!(potential.len(), TYPES.len());
        let header = TABLE.lines().find(|line| !line.starts_with('#'));
        let names: Vec<&str> = header
            .into_iter()
            .flat_map(|line| line.split(','))
            .collect();
        assert_eq!(names[1..], TYPES);
        let fields = TABLE.lines().filter(|line| !line.starts_with('#')).skip(1);
        for (line, name) in fields.zip(TYPES) {
            let mut fields = line.split(',');
            assert_eq!(fields.next(), Some(name));
            assert!(fields.all(|field| field.trim().parse::<f64>().is_ok_and(f64::is_finite)));
        }
        for (a, row) in potential.iter().enumerate() {
            assert_eq!(row.len(), TYPES.len());
            for (b, value) in row.iter().enumerate() {
                assert_eq!(*value, potential[b][a]);
            }
        }
        // Opposite charges attract, like ones repel, fat sticks to fat.
        let of = |a: &str, b: &str| {
            let index = |name: &str| TYPES.iter().position(|kind| *kind == name).unwrap();
            potential[index(a)][index(b)]
        };
        assert!(of("KNZ", "DOD") < of("KNZ", "KNZ") && of("LCD", "LCD") < of("LCD", "DOD"));
    }
}
