//! Search effects: terms of the score that a search correlates.
//!
//! # Conventions
//!
//! Shape is the double-skin correlation of B&I. Every other effect is a sum over pairs of labelled knots,
//! `sum_ij a_i M[c_i][c_j] b_j k(|R y_j + t - x_i|)`. Each knot has a class c and a value (a charge, or 1). The class
//! matrix M carries the weight and the sign, and k is a radial function. A higher score is better, so energies enter
//! with a minus.
//!
//! The filter of the ranking kernel is applied to k (`kernel::radial_filter`). So k ends at the same reach
//! and the same frequency as shape, and an effect needs no further grid, modes or cell list. In the Fourier domain
//! it adds one function of the ligand for each class. The engine compresses these together with those of shape. An
//! effect that is off adds none.
//!
//! # Adding an effect
//!
//! Write a file with a constant `EFFECT` of type [`EffectDefinition`] that says its labels, radial function and class
//! matrix, and add it to the list of [`Effect`] below.

pub mod contact;
pub mod electrostatics;
mod kernel;
pub mod restraint;
pub mod shape;

use contact::Potential;
pub use kernel::EffectKernel;
use knotdock_structures::Knots;
use restraint::ResidueRole;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// The enumeration of the effects, their order and their definitions, from one line each.
macro_rules! effects {
    ($($(#[$doc:meta])* $name:ident in $file:ident),+ $(,)?) => {
        /// A term of the score that a search correlates.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Effect {
            $($(#[$doc])* $name),+
        }

        impl Effect {
            /// All effects, in the order of their columns.
            pub const ALL: [Self; [$(stringify!($name)),+].len()] = [$(Self::$name),+];

            /// Its definition.
            pub fn definition(self) -> &'static EffectDefinition {
                match self {
                    $(Self::$name => &$file::EFFECT),+
                }
            }
        }
    };
}

effects! {
    /// Shape complementarity: the double-skin correlation of B&I.
    Shape in shape,
    /// Smoothed Coulomb energy with a distance-dependent dielectric.
    Electrostatics in electrostatics,
    /// Contact potential over atom types.
    Contact in contact,
    /// Contacts of atoms that should have none, and of atoms that should have some.
    Restraint in restraint,
}

impl Effect {
    /// Name on the command line, in tables and in JSON.
    pub fn name(self) -> &'static str {
        self.definition().id
    }
}

impl std::fmt::Display for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// Definition of a search effect: its name, what it reads, and its term.
#[derive(Debug)]
pub struct EffectDefinition {
    /// Name on the command line, in tables and in JSON: lower case with `_` between words.
    pub id: &'static str,
    /// Reason that meshes are scored with it, or without it.
    pub of_meshes: &'static str,
    /// Number of components of the compressed functions that it takes at the default tolerance (cost model).
    pub components: f64,
    /// Data that the inputs lack for it; `None` if they hold what it reads.
    pub lacks: fn(&EffectInputs) -> Option<String>,
    /// Reason that it is on, where the inputs lack nothing.
    pub reason: fn(&EffectInputs) -> String,
    /// Its term between two labelled bodies at a weight; `None` for shape, which is no pair term.
    pub term: fn([&Knots; 2], &EffectInputs, f64) -> Option<Term>,
}

/// All that effects may read of the two bodies of a docking besides their labelled knots.
#[derive(Clone, Copy, Debug)]
pub struct EffectInputs<'a> {
    /// Numbers of labelled atoms of receptor and ligand.
    pub labels: [LabelCounts; 2],
    /// Potential of the contact effect; `None`: the built-in one.
    pub contact_potential: Option<&'a Potential>,
    /// Role of each knot of receptor and ligand; knots without one are free.
    pub roles: [&'a [ResidueRole]; 2],
    /// Reason for the roles, in words.
    pub roles_reason: &'a str,
    /// Score of a contact of an active atom.
    pub active_weight: f64,
}

/// Numbers of labelled atoms of one side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LabelCounts {
    /// Heavy atoms.
    pub atoms: usize,
    /// Atoms with a charge.
    pub charged: usize,
    /// Heavy atoms with a contact type.
    pub typed: usize,
}

impl EffectInputs<'_> {
    /// Names of the sides with their numbers of labelled atoms.
    fn sides(&self) -> impl Iterator<Item = (&'static str, LabelCounts)> {
        ["receptor", "ligand"].into_iter().zip(self.labels)
    }
}

/// Class and value of one knot in a term.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Label {
    /// Class, an index into the matrix.
    pub class: usize,
    /// Value: a charge in e, or 1; 0 if the knot does not count.
    pub value: f64,
}

/// The classes of the labels that count, each once.
pub(crate) fn classes(labels: &[Label]) -> BTreeSet<usize> {
    let counting = labels.iter().filter(|label| label.value != 0.0);
    counting.map(|label| label.class).collect()
}

/// Radial function of a term before it is filtered: smooth, even, and 0 from its support on.
#[derive(Clone, Copy, Debug)]
pub struct RadialFunction {
    /// Value at a distance in Å.
    pub value: fn(f64) -> f64,
    /// Distance in Å from which it is 0.
    pub support: f64,
}

/// Separable term of one pair of knot sets.
#[derive(Clone, Debug)]
pub struct Term {
    /// Its effect.
    pub effect: Effect,
    /// Its radial function k.
    pub radial: RadialFunction,
    /// `M[receptor class][ligand class]`, weight and sign included, in units of score per unit of k.
    pub matrix: Vec<Vec<f64>>,
    /// Label of each knot of the receptor.
    pub receptor: Vec<Label>,
    /// Label of each knot of the ligand.
    pub ligand: Vec<Label>,
}

impl Term {
    /// Largest |a M b| of any two knots: the largest factor of k.
    pub fn largest(&self) -> f64 {
        let ends = |labels: &[Label], classes: usize| {
            let mut largest = vec![0.0f64; classes];
            for label in labels {
                if let Some(value) = largest.get_mut(label.class) {
                    *value = value.max(label.value.abs());
                }
            }
            largest
        };
        let receptor = ends(&self.receptor, self.matrix.len());
        let ligand = ends(&self.ligand, self.matrix.first().map_or(0, Vec::len));
        let mut largest = 0.0f64;
        for (row, a) in self.matrix.iter().zip(&receptor) {
            for (value, b) in row.iter().zip(&ligand) {
                largest = largest.max((a * value * b).abs());
            }
        }
        largest
    }
}

/// Term with its filtered kernel, as a plan holds it.
#[derive(Clone, Debug)]
pub struct ActiveTerm {
    /// The term.
    pub term: Term,
    /// Its radial function, filtered.
    pub kernel: EffectKernel,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Records, tables and the command line name an effect alike, and no two effects share a name.
    #[test]
    fn names_of_effects_are_unique_and_those_of_records() {
        for (index, effect) in Effect::ALL.into_iter().enumerate() {
            assert_eq!(effect as usize, index);
            let mut others = Effect::ALL.into_iter().filter(|other| *other != effect);
            assert!(others.all(|other| other.name() != effect.name()));
            let text = effect.name().to_owned();
            let named = serde::de::value::StringDeserializer::<serde::de::value::Error>::new(text);
            assert_eq!(Effect::deserialize(named), Ok(effect));
        }
    }

    /// Without labels and roles there is shape alone; with them each effect has its term.
    #[test]
    fn effects_without_inputs_lack_them() {
        let nothing = EffectInputs {
            labels: [LabelCounts::default(); 2],
            contact_potential: None,
            roles: [&[], &[]],
            roles_reason: "",
            active_weight: 1.0,
        };
        let counts = LabelCounts {
            atoms: 1,
            charged: 1,
            typed: 1,
        };
        let all = EffectInputs {
            labels: [counts; 2],
            roles: [&[], &[ResidueRole::Active]],
            ..nothing
        };
        let knots = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
        let knots = knots.with_labels(vec![0.5], vec![Some(6)]).unwrap();
        for effect in Effect::ALL {
            let definition = effect.definition();
            let is_shape = effect == Effect::Shape;
            assert_eq!((definition.lacks)(&nothing).is_none(), is_shape, "{effect}");
            assert_eq!((definition.lacks)(&all), None, "{effect}");
            let term = (definition.term)([&knots, &knots], &all, 2.0);
            assert_eq!(term.is_none(), is_shape, "{effect}");
            if let Some(term) = term {
                assert_eq!(term.effect, effect);
                assert!(term.largest() > 0.0, "{effect}");
            }
        }
    }
}
