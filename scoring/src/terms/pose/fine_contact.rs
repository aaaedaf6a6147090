//! Pose term `fine_contact`: a contact potential in three ranges of distance.

use super::bodies::Bodies;
use super::{PoseTerm, TermDefinition, UNRELAXED};
use crate::terms::effect::contact::{Potential, TYPES, header};
use crate::terms::{built_in, end, table_lines};
use knotdock_structures::{Error, Knots};
use serde::{Deserialize, Serialize};
use std::array::from_fn;

/// Definition of the term.
pub(super) const TERM: TermDefinition = TermDefinition {
    id: "fine_contact",
    label: "fine contacts",
    unit: "score per RT",
    time_share: UNRELAXED,
    is_shown_always: true,
    reads: "atoms with contact types",
    count: |inputs| {
        inputs
            .bodies
            .map(|knots| knots.contact_types.iter().flatten().count())
    },
    applies: |inputs| {
        let [receptor, ligand] = inputs.bodies;
        !receptor.contact_types.is_empty() && !ligand.contact_types.is_empty()
    },
    build: |inputs, weight| {
        let potential = inputs.fine_contact_potential.cloned().unwrap_or_default();
        term(inputs.bodies, &potential, weight)
    },
};

/// Distance in Å from which nothing counts.
const REACH: f64 = ENDS[2][1];

/// Minus the weighted potential (score per RT) over the contacts of two sets of knots with contact types.
///
/// Two atoms of types a and c at distance d score `-weight sum_b E_b[a][c] (s_b(d) - s_{b-1}(d))` over the ranges b.
/// s_b is the step that ends range b, and s_{-1} = 0. Atoms without a type do not count.
fn term(
    [receptor, ligand]: [&Knots; 2],
    potential: &DistanceBinnedPotential,
    weight: f64,
) -> PoseTerm {
    let energy = |range: usize, a: usize, b: usize| {
        let table = potential.ranges.get(range);
        table.map_or(0.0, |table| table.energy(a, b))
    };
    // Factor of each step s_b, -weight (E_b - E_{b+1}): [receptor type][ligand type][range].
    let step = |range, a, b| -weight * (energy(range, a, b) - energy(range + 1, a, b));
    let steps: [[[f64; 3]; TYPES.len()]; TYPES.len()] =
        from_fn(|a| from_fn(|b| from_fn(|range| step(range, a, b))));
    let bodies = Bodies::new(
        receptor,
        ligand,
        |knots| &knots.contact_types,
        (TYPES.len(), REACH),
    );
    Box::new(move |pose, _| {
        bodies.sum(
            pose,
            #[inline(always)]
            |a, b, distance| {
                let [first, second, third] = steps[a][b];
                first * step_down(distance, ENDS[0])
                    + second * step_down(distance, ENDS[1])
                    + third * step_down(distance, ENDS[2])
            },
        )
    })
}

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
    /// Reads a table: lines of `#`, a header `range,type,` with the names of the types, then one row per range and type.
    ///
    /// # Errors
    /// [`Error`] with the line that has another form, or if the energies of a range are not finite and
    /// symmetric.
    pub fn parse(text: &str) -> Result<Self, Error> {
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
    use crate::se3::Pose;
    use crate::terms::pose::Workspace;

    /// Score of a pair of knots at x on the first axis.
    fn at(contacts: &PoseTerm, x: f64) -> f64 {
        let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
        contacts(&pose, &mut Workspace::default())
    }

    /// Two atoms in the middle of a range have its energy, and between two ranges a part of both. Beyond the reach
    /// there is none.
    #[test]
    fn one_pair_has_the_energy_of_its_range() {
        let potential = DistanceBinnedPotential::default();
        let one = |kind: u8| {
            let knots = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
            knots.with_labels(Vec::new(), vec![Some(kind)]).unwrap()
        };
        let contacts = term([&one(6), &one(8)], &potential, 3.0);
        let at = |x: f64| at(&contacts, x);
        let energy = |range: usize| potential.ranges[range].energy(6, 8);
        for (range, distance) in [3.0, 4.75, 6.5].into_iter().enumerate() {
            assert!(
                (at(distance) + 3.0 * energy(range)).abs() < 1e-12,
                "{}",
                RANGES[range]
            );
        }
        for index in 0..800 {
            let distance = 0.01 * f64::from(index);
            let [near, middle, far] = ENDS.map(|ends| step_down(distance, ends));
            let expected =
                near * energy(0) + (middle - near) * energy(1) + (far - middle) * energy(2);
            assert!((at(distance) + 3.0 * expected).abs() < 1e-12, "{distance}");
        }
        assert_eq!([at(8.0), at(500.0), at(-1e9)], [0.0; 3]);
    }

    /// Every pair of types has its own energies, whichever body has which.
    #[test]
    fn every_pair_of_types_has_its_own_energies() {
        let potential = DistanceBinnedPotential::default();
        let one = |kind: usize| {
            let knots = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
            knots
                .with_labels(Vec::new(), vec![Some(kind as u8)])
                .unwrap()
        };
        for a in 0..TYPES.len() {
            for b in 0..TYPES.len() {
                let contacts = term([&one(a), &one(b)], &potential, 1.0);
                for (range, x) in [3.0, 4.75, 6.5].into_iter().enumerate() {
                    let energy = potential.ranges[range].energy(a, b);
                    assert!((at(&contacts, x) + energy).abs() < 1e-12, "{a} {b}");
                }
            }
        }
    }

    #[test]
    fn no_typed_atom_scores_nothing() {
        let bare = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
        let contacts = term([&bare, &bare], &DistanceBinnedPotential::default(), 1.0);
        assert_eq!(at(&contacts, 0.0), 0.0);
    }
}

#[cfg(test)]
mod distance_binned_potential_tests {
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
        let line_of = |text: &str| {
            let error = DistanceBinnedPotential::parse(text).unwrap_err();
            error.line().unwrap() as usize
        };
        assert_eq!(line_of("# x\nrange,type,A\n"), 2);
        let first = TABLE
            .lines()
            .position(|line| line.starts_with("far,CA,"))
            .unwrap();
        let lines: Vec<&str> = TABLE.lines().collect();
        let spoilt = |line: &str| {
            let mut lines = lines.clone();
            lines[first] = line;
            line_of(&lines.join("\n"))
        };
        assert_eq!(spoilt("near,CA,1"), first + 1);
        assert_eq!(spoilt("far,CA,x"), first + 1);
        assert!(DistanceBinnedPotential::parse(&lines[..first].join("\n")).is_err());
        let longer = format!("{TABLE}far,N,1\n");
        assert_eq!(line_of(&longer), lines.len() + 1);
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
