//! Errors of the libraries below, as [`Error`] with a remedy.

use crate::progress::Interruption;
use knotdock_scoring::engine::PlanError;
use knotdock_structures::Error;

/// The remedy for a scene that takes too many modes or grid points.
pub(crate) const COARSER: &str =
    "use a coarser --resolution or --spacing, or check for atoms or parts far from the rest";

/// A search that found nothing.
pub(crate) fn no_pose() -> Error {
    Error::machine("no pose has a finite score").help("check lambda and the offset")
}

/// An engine that cannot be planned.
pub(crate) fn unplanned(error: PlanError) -> Error {
    Error::input(&error).help(match error {
        PlanError::TooLarge(_) => COARSER,
        _ => "give the option a value in its range",
    })
}

impl From<Interruption> for Error {
    fn from(ended: Interruption) -> Self {
        Self::lasting(ended).help(match ended {
            Interruption::Interrupted => "start it again",
            Interruption::TimeLimit(_) => {
                "allow more with --time-limit, or search fewer --rotations"
            }
        })
    }
}
