//! The setting for an accuracy that is wanted or a time that may be spent.

use knotdock::dock::cost::{CostModel, LADDER, Rung, Workload};
use knotdock::dock::pair::Preparer;
use knotdock::options::DockOptions;
use knotdock::output::records::manifest::Chosen;
use knotdock_structures::Error;

/// Fewest rotations that a docking within a budget takes: below, an answer is a matter of luck.
pub const MIN_ROTATIONS: usize = 600;
/// Most: 6 degrees, beyond which rotations cost time and find nothing.
pub const MAX_ROTATIONS: usize = 56_250;
/// So many times as fast as the cost model has it a machine may be and still use all of a budget.
const FASTEST: f64 = 4.0;

/// Requested accuracy and time of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wanted {
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
    wanted: Wanted,
    options: &mut DockOptions,
    preparer: &mut Preparer,
) -> Result<Chosen, Error> {
    let mut predicted_error = None;
    if let Some(accuracy) = wanted.accuracy {
        let least = LADDER
            .iter()
            .fold(f64::INFINITY, |least, rung| least.min(rung.error));
        let rung = Rung::within(accuracy).ok_or_else(|| {
            Error::input(format!(
                "no setting is expected to bring the error down to {accuracy:e}; the least is {least:e}"
            ))
            .help(format!("ask for an accuracy of {least:e} or more"))
        })?;
        rung.apply(options);
        predicted_error = Some(rung.error);
    }
    // The rotations are left open: few are quickly planned.
    let draft = preparer.prepare(&options.changed(|options| options.search.rotations = 4))?;
    let work = Workload::of(&draft.plan);
    let threads = draft.plan.most_in_flight();
    let model = CostModel::BUILT_IN;
    let mut expected = f64::INFINITY;
    if let Some(budget) = wanted.budget {
        let most = options.search.fine_rotations.unwrap_or(MAX_ROTATIONS);
        let range = MIN_ROTATIONS..=most.clamp(MIN_ROTATIONS, MAX_ROTATIONS);
        // The deadline ends the search. What it has searched by then is nearly as even as a set of that size.
        options.search.rotations = model.rotations_within(&work, FASTEST * budget, threads, range);
        expected = budget;
    }
    Ok(Chosen {
        accuracy: wanted.accuracy,
        budget_seconds: wanted.budget,
        predicted_seconds: model
            .seconds(&work, options.search.rotations, threads)
            .min(expected),
        predicted_error,
    })
}
