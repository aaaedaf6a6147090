//! Pose terms: functions of a pose that are too expensive for all translations of a search.
//!
//! # Conventions
//!
//! A search ranks poses by a correlation, in which every term is a sum of one radial function times a class matrix of
//! low rank. It keeps a few thousand poses. Each is then scored by the terms of [`POSE_TERMS`], which may be any
//! function of the pose. Their values are added to the score. Higher is better, lengths are in Å, and positions are
//! relative to the centres of the two bodies.
//!
//! | id | what is scored | source of its numbers |
//! |---|---|---|
//! | `fine_contact` | pairs of atoms by 18 types and 3 ranges of distance | interfaces of known complexes |
//! | `atom_pair` | pairs of atoms by 158 kinds and 6 distances | insides of proteins |
//! | `relaxed` | the same with a penalty on overlap, after a small rigid move | the same |
//! | `active_residues` | share of the active residues that are in contact | the user, or the active site of a peptidase |
//! | `unresolved` | atoms where the other side has unresolved residues | conformers of its unresolved segments |
//! | `termini` | contacts of residues near termini and gaps | the chains of the file |
//! | `restraints_penalty` | violations of distance restraints | the user |
//! | `membrane` | depth in a membrane | the file of one side, or the user |
//! | `interface_predictions` | log-odds of the residues in contact | a predictor, by the user |
//!
//! # Adding a term
//!
//! Write a file with a constant [`TermDefinition`], and add the constant to [`POSE_TERMS`]. Its weight is a line among
//! the options (`src/options/terms.rs`). Its column in `poses.csv`, its JSON keys and its place in every report follow
//! from the registry.

mod active_residues;
mod atom_pair;
mod bodies;
mod distance_restraints;
mod fine_contact;
mod interface_predictions;
mod membrane;
mod relaxed;
mod termini;
mod unresolved;

use crate::se3::Pose;
pub use active_residues::Residues;
pub use atom_pair::{AtomPairPotential, DISTANCES, STEP, atom_kinds};
pub use distance_restraints::{DistanceRestraint, DistanceRestraints};
pub use fine_contact::{DistanceBinnedPotential, RANGES};
pub use interface_predictions::PredictedResidue;
use knotdock_structures::{Conformers, Knots};
pub use membrane::Membrane;
pub use relaxed::Workspace;
use serde::{Serialize, Serializer};

/// Every pose term, in the order of sums, columns and reports.
pub const POSE_TERMS: &[TermDefinition] = &[
    fine_contact::TERM,
    atom_pair::TERM,
    relaxed::TERM,
    active_residues::TERM,
    unresolved::TERM,
    termini::TERM,
    distance_restraints::TERM,
    interface_predictions::TERM,
    membrane::TERM,
];

/// Time to score a pose by all terms but `relaxed`, as a share of the time by all terms. Measured on the example pair.
const UNRELAXED: f64 = 0.25;

/// A pose term prepared for two bodies: its weighted value at a pose of the ligand; higher is better. Calls with one
/// workspace allocate nothing once it has grown.
pub type PoseTerm = Box<dyn Fn(&Pose, &mut Workspace) -> f64 + Send + Sync>;

/// Definition of a pose term: its name, what it reads, and how it is prepared.
#[derive(Debug)]
pub struct TermDefinition {
    /// Name in columns, JSON and scripts: lower case with `_` between words.
    pub id: &'static str,
    /// Name in reports: lower case, in the plural.
    pub label: &'static str,
    /// Unit of its weight.
    pub unit: &'static str,
    /// Time to score a pose by this and all cheaper terms, as a share of the time with every term (cost model).
    pub time_share: f64,
    /// Whether tables have its column where it does not act, too.
    pub is_shown_always: bool,
    /// What it reads of each side, in the plural.
    pub reads: &'static str,
    /// How many of these receptor and ligand have.
    pub count: fn(&TermInputs) -> [usize; 2],
    /// Whether the inputs hold what it reads.
    pub applies: fn(&TermInputs) -> bool,
    /// Prepares it with a weight; called only if it applies.
    pub build: fn(&TermInputs, f64) -> PoseTerm,
}

impl TermDefinition {
    /// Whether it scores poses: its weight is positive and the inputs hold what it reads.
    pub fn acts(&self, inputs: &TermInputs, weight: f64) -> bool {
        weight > 0.0 && (self.applies)(inputs)
    }
}

/// All that pose terms may read of the two bodies of a docking.
#[derive(Clone, Copy, Debug)]
pub struct TermInputs<'a> {
    /// Knots of receptor and ligand, with contact types and atom kinds where the contact effect is on.
    pub bodies: [&'a Knots; 2],
    /// Potential of `fine_contact`; `None`: the built-in one.
    pub fine_contact_potential: Option<&'a DistanceBinnedPotential>,
    /// Potential of `atom_pair` and `relaxed`; `None`: the built-in one.
    pub atom_pair_potential: Option<&'a AtomPairPotential>,
    /// Sets of active residues; a pose should touch all residues of one set.
    pub active_residues: &'a [Residues],
    /// Conformers of the unresolved segments of receptor and ligand.
    pub unresolved: [&'a [Conformers]; 2],
    /// Indices of the knots near termini and gaps of receptor and ligand.
    pub termini: [&'a [usize]; 2],
    /// Restraints on distances between the knots of receptor and ligand.
    pub distance_restraints: &'a DistanceRestraints,
    /// Residues of receptor and ligand with predictions.
    pub predicted: [&'a [PredictedResidue]; 2],
    /// A membrane of one side, which the other is to stay out of.
    pub membrane: Option<&'a Membrane>,
}

impl TermInputs<'_> {
    /// Numbers of atoms with a kind of receptor and ligand.
    fn atoms_with_kinds(&self) -> [usize; 2] {
        self.bodies
            .map(|knots| knots.atom_kinds.iter().flatten().count())
    }

    /// Whether both bodies carry atom kinds.
    fn has_atom_kinds(&self) -> bool {
        self.bodies.iter().all(|knots| !knots.atom_kinds.is_empty())
    }
}

/// The pose terms that act between two bodies, prepared for scoring poses.
pub struct Rescorer {
    /// Each with its place in [`POSE_TERMS`].
    terms: Vec<(usize, PoseTerm)>,
}

impl Rescorer {
    /// Prepares every term that has a positive weight and inputs to read; `None` if no term has.
    ///
    /// `weights` holds one weight for each of [`POSE_TERMS`].
    pub fn new(inputs: &TermInputs, weights: &[f64; POSE_TERMS.len()]) -> Option<Self> {
        let terms: Vec<_> = POSE_TERMS
            .iter()
            .zip(weights)
            .enumerate()
            .filter(|(_, (term, weight))| term.acts(inputs, **weight))
            .map(|(index, (term, weight))| (index, (term.build)(inputs, *weight)))
            .collect();
        (!terms.is_empty()).then_some(Self { terms })
    }

    /// Weighted values of the terms at a pose of the ligand. It allocates nothing once the workspace has grown.
    pub fn score(&self, pose: &Pose, workspace: &mut Workspace) -> TermValues {
        let mut values = TermValues::default();
        for (index, term) in &self.terms {
            values.set(*index, term(pose, workspace));
        }
        values
    }
}

/// Place of the term with an id in [`POSE_TERMS`].
fn index_of(id: &str) -> Option<usize> {
    POSE_TERMS.iter().position(|term| term.id == id)
}

/// Weighted values of the pose terms at one pose; higher is better. A term that does not act has no value.
///
/// It serialises to a map from ids to values, with `null` for the terms that do not act.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TermValues([Option<f64>; POSE_TERMS.len()]);

impl TermValues {
    /// Every term with its value, in the order of [`POSE_TERMS`].
    pub fn iter(&self) -> impl Iterator<Item = (&'static TermDefinition, Option<f64>)> {
        POSE_TERMS.iter().zip(self.0)
    }

    /// Value of the term with this id; `None` if the term does not act.
    pub fn get(&self, id: &str) -> Option<f64> {
        let index = index_of(id);
        debug_assert!(index.is_some(), "no pose term '{id}'");
        self.0[index?]
    }

    /// Sets the value of the term at `index` of [`POSE_TERMS`].
    pub(super) fn set(&mut self, index: usize, value: f64) {
        self.0[index] = Some(value);
    }

    /// The same values, with one more or another by its id.
    ///
    /// # Panics
    /// If no term has this id.
    #[must_use]
    pub fn with(mut self, id: &str, value: f64) -> Self {
        let Some(index) = index_of(id) else {
            unreachable!("no pose term '{id}'");
        };
        self.set(index, value);
        self
    }

    /// Sum of all values, in the order of [`POSE_TERMS`].
    pub fn sum(&self) -> f64 {
        let [first, others @ ..] = self.0.map(|value| value.unwrap_or(0.0));
        others.into_iter().fold(first, |sum, value| sum + value)
    }
}

impl Serialize for TermValues {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(self.iter().map(|(term, value)| (term.id, value)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns, JSON keys and reports are named by the registry, so no two terms may share a name.
    #[test]
    fn ids_and_labels_of_terms_are_unique_and_well_formed() {
        for (index, term) in POSE_TERMS.iter().enumerate() {
            let rest = &POSE_TERMS[index + 1..];
            assert!(rest.iter().all(|other| other.id != term.id), "{}", term.id);
            assert!(rest.iter().all(|other| other.label != term.label));
            let lower = |text: &str, between: char| {
                text.chars().all(|c| c.is_ascii_lowercase() || c == between)
            };
            assert!(lower(term.id, '_'), "{}", term.id);
            assert!(lower(term.label, ' '), "{}", term.label);
            assert!((0.0..=1.0).contains(&term.time_share));
            assert_eq!(index_of(term.id), Some(index));
        }
        assert!(index_of("gravity").is_none());
    }

    /// Without weights or without inputs there is nothing to score, and a term alone has the only value.
    #[test]
    fn only_terms_with_weights_and_inputs_have_values() {
        let bare = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
        let typed = bare
            .clone()
            .with_labels(Vec::new(), vec![Some(6)])
            .unwrap()
            .with_atom_kinds(vec![Some(6)])
            .unwrap();
        let sets = [[vec![vec![0]], Vec::new()]];
        let segment = [Conformers {
            origin: [0.0; 3],
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            traces: vec![vec![[1.0, 0.0, 0.0]]],
        }];
        let nothing = TermInputs {
            bodies: [&bare, &bare],
            fine_contact_potential: None,
            atom_pair_potential: None,
            active_residues: &[],
            unresolved: [&[], &[]],
            termini: [&[], &[]],
            distance_restraints: DistanceRestraints::none(),
            predicted: [&[], &[]],
            membrane: None,
        };
        let far = DistanceRestraints {
            list: vec![DistanceRestraint {
                pairs: vec![[vec![0], vec![0]]],
                lower: 0.0,
                upper: 1.0,
            }],
            needed: 1,
        };
        let predicted = [PredictedResidue {
            atoms: vec![0],
            log_odds: 1.0,
        }];
        let membrane = Membrane {
            side: 0,
            low: -9.0,
            high: 9.0,
        };
        let all = TermInputs {
            bodies: [&typed, &typed],
            active_residues: &sets,
            unresolved: [&[], &segment],
            termini: [&[0], &[]],
            distance_restraints: &far,
            predicted: [&predicted, &[]],
            membrane: Some(&membrane),
            ..nothing
        };
        let none = [0.0; POSE_TERMS.len()];
        let one = [1.0; POSE_TERMS.len()];
        assert!(Rescorer::new(&nothing, &one).is_none());
        assert!(Rescorer::new(&all, &none).is_none());
        for term in POSE_TERMS {
            assert_eq!((term.count)(&nothing), [0, 0], "{}", term.id);
            assert_ne!((term.count)(&all), [0, 0], "{}", term.id);
        }
        let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [4.0, 0.0, 0.0]);
        let mut workspace = Workspace::default();
        let together = Rescorer::new(&all, &one)
            .unwrap()
            .score(&pose, &mut workspace);
        for (index, (term, value)) in together.iter().enumerate() {
            assert!(value.is_some_and(|value| value != 0.0), "{}", term.id);
            let mut weights = none;
            weights[index] = 2.0;
            let alone = Rescorer::new(&all, &weights).unwrap();
            let alone = alone.score(&pose, &mut workspace);
            assert_eq!(alone, TermValues::default().with(term.id, alone.sum()));
            assert!((alone.sum() - 2.0 * value.unwrap()).abs() < 1e-12);
        }
    }
}

#[cfg(test)]
mod values_tests {
    use super::*;

    /// Sums run in the order of the registry, so that every table holds the same digits.
    #[test]
    fn values_add_up_in_the_order_of_the_registry() {
        let numbers = [1e16, 1.0, -1e16, 0.5, 0.25, 0.125, 0.0625];
        let values = POSE_TERMS
            .iter()
            .zip(numbers)
            .fold(TermValues::default(), |values, (term, number)| {
                values.with(term.id, number)
            });
        // 1e16 + 1 rounds to 1e16.
        assert_eq!(values.sum(), 0.9375);
        assert_eq!(TermValues::default().sum(), 0.0);
    }

    #[test]
    fn values_are_found_by_id() {
        let id = POSE_TERMS[1].id;
        let values = TermValues::default().with(id, -2.5);
        assert_eq!(values.get(id), Some(-2.5));
        let mut others = POSE_TERMS.iter().filter(|term| term.id != id);
        assert!(others.all(|term| values.get(term.id).is_none()));
        assert_eq!(values.sum(), -2.5);
    }
}
