//! Effects beside shape: separable terms over labelled knots.
//!
//! # Conventions
//!
//! A term is `sum_ij a_i M[c_i][c_j] b_j k(|R y_j + t - x_i|)`: every knot has a class c and a value (a charge, or 1), the class matrix M
//! carries the term's weight and its sign, and k is one radial function. As in the whole engine a higher score is better, so an
//! energy enters with a minus.
//!
//! k passes through the filter of the ranking kernel ([`crate::kernel::radial_filter`]): it ends at the same reach and the same frequency,
//! so a term needs no grid, no modes and no cell list of its own. In the Fourier domain it adds functions of the ligand to those of shape
//! (one for each class), which the engine compresses together with them; a term that is absent adds none.
//!
//! [`electrostatics`], [`contact`] and [`restraint`] say their labels, radial functions and class matrices.

pub mod contact;
pub mod electrostatics;
mod kernel;
pub mod restraint;

pub use kernel::EffectKernel;

use serde::{Deserialize, Serialize};

/// A term of the score.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Effect {
    /// Shape complementarity: the double-skin correlation of B&I.
    Shape,
    /// Smoothed Coulomb energy with a distance-dependent dielectric.
    Electrostatics,
    /// Contact potential over atom types.
    Contact,
    /// Contacts of atoms that should have none, and of atoms that should have some.
    Restraint,
}

impl Effect {
    /// All effects, in the order of their columns.
    pub const ALL: [Self; 4] = [
        Self::Shape,
        Self::Electrostatics,
        Self::Contact,
        Self::Restraint,
    ];

    /// Name on the command line, in tables and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shape => "shape",
            Self::Electrostatics => "electrostatics",
            Self::Contact => "contact",
            Self::Restraint => "restraint",
        }
    }
}

impl std::fmt::Display for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// What one knot is to a term.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Label {
    /// Class, an index into the matrix.
    pub class: usize,
    /// Value: a charge in e, or 1; 0 for a knot that takes no part.
    pub value: f64,
}

/// The radial function of a term before it is filtered: smooth, even, and 0 from its support on.
#[derive(Clone, Copy, Debug)]
pub struct RadialFunction {
    /// Value at a distance in Å.
    pub value: fn(f64) -> f64,
    /// Distance in Å from which it is 0.
    pub support: f64,
}

/// A separable term of one pair of knot sets.
#[derive(Clone, Debug)]
pub struct Term {
    /// Which effect it is.
    pub effect: Effect,
    /// Its radial function k.
    pub radial: RadialFunction,
    /// `M[receptor class][ligand class]`, weight and sign included, in units of score per unit of k.
    pub matrix: Vec<Vec<f64>>,
    /// A label for each knot of the receptor.
    pub receptor: Vec<Label>,
    /// A label for each knot of the ligand.
    pub ligand: Vec<Label>,
}

impl Term {
    /// Largest |a M b| of any two knots: how much one unit of k can weigh.
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
        let mut most = 0.0f64;
        for (row, a) in self.matrix.iter().zip(&receptor) {
            for (value, b) in row.iter().zip(&ligand) {
                most = most.max((a * value * b).abs());
            }
        }
        most
    }
}

/// A term with its filtered kernel, as a plan holds it.
#[derive(Clone, Debug)]
pub struct ActiveTerm {
    /// The term.
    pub term: Term,
    /// Its radial function, filtered.
    pub kernel: EffectKernel,
}
