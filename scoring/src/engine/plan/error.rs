//! Errors of planning.

use crate::kernel::KernelError;
use crate::terms::effect::{Effect, Label, Term};
use knotdock_structures::Knots;
use knotdock_structures::knots::KnotsError;

/// Why no plan could be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// The knots are not usable.
    #[error(transparent)]
    Knots(#[from] KnotsError),
    /// The kernel's options are not usable.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// A number is out of its range.
    #[error("{name} is {value}; it must be {bound}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its range.
        bound: &'static str,
    },
    /// A term's labels or class matrix do not fit the knots.
    #[error("the term {effect} {fault}")]
    Term {
        /// The term.
        effect: Effect,
        /// The mismatch, in words.
        fault: &'static str,
    },
    /// A body's weights are so large or small that scores would leave the range of single precision.
    #[error(
        "a body's weights add up to {0:.1e} in size; multiply them by a common factor that brings this between 1e-9 and 1e9"
    )]
    WeightRange(f64),
    /// The box would need more grid points than can be numbered or held: 2^32, or fewer where it is flat.
    #[error("a grid of {0:.2e} points is needed; use a coarser spacing")]
    TooLarge(f64),
}

/// Refuses knots that no engine can correlate: unusable ones, and weights that leave single precision.
pub(super) fn check_bodies(receptor: &Knots, ligand: &Knots) -> Result<(), PlanError> {
    for knots in [receptor, ligand] {
        knots.check()?;
        let size: f64 = knots.weights.iter().map(|c| c.abs()).sum();
        // A body without any weight scores nothing, which every precision holds.
        if size != 0.0 && !(1e-9..=1e9).contains(&size) {
            return Err(PlanError::WeightRange(size));
        }
    }
    Ok(())
}

/// Refuses terms whose labels or class matrix do not fit the knots.
pub(super) fn check_terms(
    terms: &[Term],
    receptor: &Knots,
    ligand: &Knots,
) -> Result<(), PlanError> {
    for term in terms {
        let refuse = |fault| {
            Err(PlanError::Term {
                effect: term.effect,
                fault,
            })
        };
        if term.receptor.len() != receptor.len() || term.ligand.len() != ligand.len() {
            return refuse("does not have one label per knot");
        }
        let classes = term.matrix.first().map_or(0, Vec::len);
        if term.matrix.iter().any(|row| row.len() != classes) {
            return refuse("has a class matrix with rows of different lengths");
        }
        let beyond = |labels: &[Label], classes: usize| {
            let mut taking_part = labels.iter().filter(|label| label.value != 0.0);
            taking_part.any(|label| label.class >= classes)
        };
        if beyond(&term.receptor, term.matrix.len()) || beyond(&term.ligand, classes) {
            return refuse("has a label of a class that its matrix lacks");
        }
        let values = term
            .receptor
            .iter()
            .chain(&term.ligand)
            .map(|label| label.value);
        let numbers = values.chain(term.matrix.iter().flatten().copied());
        if numbers.into_iter().any(|number| !number.is_finite()) {
            return refuse("has a label or a matrix entry that is not finite");
        }
    }
    Ok(())
}

/// Refuses a tolerance that no plan can be made for.
pub(super) fn check_tolerance(value: f64) -> Result<(), PlanError> {
    if (1e-8..=0.1).contains(&value) {
        return Ok(());
    }
    Err(PlanError::Option {
        name: "tolerance",
        value,
        bound: "between 1e-8 and 0.1",
    })
}

/// The requested spacing, if it is usable.
pub(super) fn checked_spacing(chosen: Option<f64>) -> Result<Option<f64>, PlanError> {
    match chosen {
        Some(value) if !(value.is_finite() && value > 0.0) => Err(PlanError::Option {
            name: "spacing",
            value,
            bound: "above 0 and finite",
        }),
        chosen => Ok(chosen),
    }
}
