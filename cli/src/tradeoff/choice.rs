//! The setting for an accuracy that is wanted or a time that may be spent.

use knotdock::dock::pair::Preparer;
use knotdock::options::{DockOptions, Precision};
use knotdock::output::records::manifest::Chosen;
use knotdock_structures::Error;

/// Fewest rotations that a docking within a budget takes: below, an answer is a matter of luck.
pub const MIN_ROTATIONS: usize = 600;
/// Most: 6 degrees, beyond which rotations cost time and find nothing.
const MAX_ROTATIONS: usize = 56_250;
/// So many times as fast as expected a machine may be and still use all of a budget.
const FASTEST: f64 = 4.0;

/// Accuracy and time that a run is to keep to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunTarget {
    /// Error of the fast path, rms over the best grid poses, as a share of the best score.
    pub accuracy: Option<f64>,
    /// Seconds on the clock.
    pub budget: Option<f64>,
}

/// Chooses tolerance and spacing by the accuracy, then rotations by the budget, into `options`.
///
/// # Errors
/// [`Error`].
pub fn choose(
    wanted: RunTarget,
    options: &mut DockOptions,
    preparer: &mut Preparer,
) -> Result<Chosen, Error> {
    let mut predicted_error = None;
    if let Some(accuracy) = wanted.accuracy {
        let least = LADDER[LADDER.len() - 1].error;
        let rung = Rung::within(accuracy).ok_or_else(|| {
            Error::input(format!(
                "no setting is expected to bring the error down to {accuracy:e}; the least is {least:e}"
            ))
            .help(format!("ask for an accuracy of {least:e} or more"))
        })?;
        rung.apply(options);
        predicted_error = Some(rung.error);
    }
    if let Some(budget) = wanted.budget {
        // Few rotations are quickly planned.
        let draft = preparer.prepare(&options.changed(|options| options.search.rotations = 4))?;
        let each = draft.plan.search_seconds(MIN_ROTATIONS) / MIN_ROTATIONS as f64;
        let most = options.search.fine_rotations.unwrap_or(MAX_ROTATIONS);
        // The deadline ends the search. What it has searched by then is nearly as even as a set of that size.
        options.search.rotations = (FASTEST * budget / each)
            .min(most.min(MAX_ROTATIONS) as f64)
            .max(MIN_ROTATIONS as f64) as usize
            / 4
            * 4;
    }
    Ok(Chosen {
        accuracy: wanted.accuracy,
        budget_seconds: wanted.budget,
        predicted_error,
        gaps: None,
    })
}

/// A setting of the fast path with the error that it makes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rung {
    /// Tolerance.
    tolerance: f64,
    /// Spacing as a share of the resolution.
    spacing: f64,
    /// Precision that it needs.
    precision: Precision,
    /// Root mean square of the error over the best grid poses, as a share of the best score.
    error: f64,
}

/// Cheapest first, the defaults before all: each error the largest measured on the example pair, 1AVX, 1EAW and 7CEI.
/// Larger tolerances are left out, for they save next to nothing: every pose that the larger error leaves in doubt is
/// scored exactly. So are wider spacings, which keep the same modes.
const LADDER: [Rung; 8] = [
    Rung::new(1e-2, 0.5, 1.8e-3),
    Rung::new(3e-3, 0.5, 1.2e-3),
    Rung::new(3e-3, 0.445, 4.8e-4),
    Rung::new(1e-3, 0.445, 2.8e-4),
    Rung::new(1e-3, 0.4, 1.2e-4),
    Rung::new(1e-3, 0.355, 6.5e-5),
    Rung::new(1e-4, 0.23, 1.4e-6),
    Rung::new(1e-6, 0.23, 4.5e-8).in_double(),
];

impl Rung {
    const fn new(tolerance: f64, spacing: f64, error: f64) -> Self {
        Self {
            tolerance,
            spacing,
            precision: Precision::Single,
            error,
        }
    }

    const fn in_double(self) -> Self {
        Self {
            precision: Precision::Double,
            ..self
        }
    }

    /// The cheapest setting whose error is at most `accuracy`; `None` below that of any.
    fn within(accuracy: f64) -> Option<Self> {
        LADDER.into_iter().find(|rung| rung.error <= accuracy)
    }

    /// Options with this setting.
    fn apply(self, options: &mut DockOptions) {
        options.kernel.tolerance = self.tolerance;
        options.kernel.spacing = Some(self.spacing * options.kernel.resolution);
        if self.precision == Precision::Double {
            options.search.precision = Precision::Double;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ladder_rises_in_accuracy() {
        for pair in LADDER.windows(2) {
            assert!(pair[0].error > pair[1].error && pair[0].spacing >= pair[1].spacing);
            assert!(pair[0].tolerance >= pair[1].tolerance);
        }
        assert_eq!(Rung::within(1.0), Some(LADDER[0]));
        assert_eq!(Rung::within(1e-3).unwrap().error, 4.8e-4);
        let default = DockOptions::default();
        let mut first = default.clone();
        LADDER[0].apply(&mut first);
        assert_eq!(first.kernel.tolerance, default.kernel.tolerance);
        assert_eq!(Rung::within(1e-9), None);
    }
}
