//! The fine contact potential: a table of energies for each range of distance, as a script writes it.

use crate::terms::effect::contact::{Potential, header};
use crate::terms::potential_table::{PotentialError, built_in, end, table_lines};
use serde::{Deserialize, Serialize};

/// Names of the ranges in the table, from near to far.
pub const RANGES: [&str; 3] = ["near", "middle", "far"];

/// Distances in Å between which each range passes into the next, and the last into nothing.
pub(super) const ENDS: [[f64; 2]; 3] = [[3.5, 4.5], [5.0, 6.0], [7.0, 8.0]];

/// The built-in table: lines of `#`, a header, and a row for each range and type.
const TABLE: &str = include_str!("fine_contact_potential.csv");

/// Energies of contacts by distance range and types, in units of RT; lower is better.
///
/// `scripts/potentials/contact_potential.py --fine` derives the built-in one. In each range an energy is minus the
/// logarithm of the contacts in known complexes over those in docked poses, less the mean. This is the reference
/// state of DARS (Chuang, Kozakov, Brenke, Comeau & Vajda, Biophys. J. 95 (2008) 4217-4227).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct DistanceBinnedPotential {
    /// One table for each of [`RANGES`].
    pub ranges: [Potential; 3],
}

impl Default for DistanceBinnedPotential {
    /// The built-in potential.
    fn default() -> Self {
        built_in("fine_contact_potential.csv", Self::parse(TABLE))
    }
}

impl DistanceBinnedPotential {
    /// Reads a table: lines of `#`, a header `range,type,` with the names of the types, then for each range a row for
    /// each type.
    ///
    /// # Errors
    /// [`PotentialError`] with the line that has another form, or if the energies of a range are not finite and
    /// symmetric.
    pub fn parse(text: &str) -> Result<Self, PotentialError> {
        let mut lines = table_lines(text);
        header(&mut lines, "range,")?;
        let mut range = |name: &str| Potential::parse_rows(&mut lines, &format!("{name},"));
        let [near, middle, far] = RANGES;
        let ranges = [range(near)?, range(middle)?, range(far)?];
        end(&mut lines)?;
        Ok(Self { ranges })
    }
}

/// Step of degree 5: 1 up to `start` and 0 from `stop` on, with two continuous derivatives.
pub(super) fn step_down(distance: f64, [start, stop]: [f64; 2]) -> f64 {
    let u = ((distance - start) / (stop - start)).clamp(0.0, 1.0);
    1.0 - u * u * u * (10.0 + u * (6.0 * u - 15.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::effect::contact::TYPES;

    #[test]
    fn the_table_is_whole_and_says_what_chemistry_does() {
        let DistanceBinnedPotential { ranges } = DistanceBinnedPotential::parse(TABLE).unwrap();
        assert_eq!(DistanceBinnedPotential::default().ranges, ranges);
        let index = |name: &str| TYPES.iter().position(|kind| *kind == name).unwrap();
        let near = |a: &str, b: &str| ranges[0].energy(index(a), index(b));
        // Opposite charges attract, like charges repel, and hydrophobic atoms attract each other.
        assert!(near("KNZ", "DOD") < near("KNZ", "KNZ"));
        assert!(near("LCD", "LCD") < near("LCD", "DOD"));
    }

    #[test]
    fn tables_that_are_none_are_refused_by_line() {
        assert_eq!(
            DistanceBinnedPotential::parse("# x\nrange,type,A\n")
                .unwrap_err()
                .line,
            2
        );
        let first = TABLE
            .lines()
            .position(|line| line.starts_with("far,CA,"))
            .unwrap();
        let lines: Vec<&str> = TABLE.lines().collect();
        let spoilt = |line: &str| {
            let mut lines = lines.clone();
            lines[first] = line;
            DistanceBinnedPotential::parse(&lines.join("\n"))
        };
        assert_eq!(spoilt("near,CA,1").unwrap_err().line, first + 1);
        assert_eq!(spoilt("far,CA,x").unwrap_err().line, first + 1);
        assert!(DistanceBinnedPotential::parse(&lines[..first].join("\n")).is_err());
        let longer = format!("{TABLE}far,N,1\n");
        assert_eq!(
            DistanceBinnedPotential::parse(&longer).unwrap_err().line,
            lines.len() + 1
        );
    }

    #[test]
    fn steps_fall_smoothly() {
        let ends = [3.5, 4.5];
        assert_eq!(
            [3.0, 3.5, 4.0, 4.5, 9.0].map(|d| step_down(d, ends)),
            [1.0, 1.0, 0.5, 0.0, 0.0]
        );
    }
}
