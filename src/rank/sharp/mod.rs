//! The sharp stage: fits at atomic resolution, used where one stands out.
//!
//! The score that a search ranks by forgives the errors of unbound surfaces, so it does not distinguish an exact fit from
//! a fair one. This stage lets the best poses descend to optima of the [sharp fit](knotdock_scoring::sharp). If the best
//! optimum stands out from the other places of the same run, the two files fit as they are, and the poses are ranked by it
//! ([`evidence`]). If none does, the sharp energies are noise, and the ranking stays the same.

pub mod evidence;
mod stage;

pub use evidence::{Evidence, SharpFinding};

pub(crate) use stage::{Optima, SharpInputs, optima, settle};

/// The sharp fit of one pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharpPose {
    /// Energy of the optimum that the pose descends to, RT.
    pub energy: f64,
    /// Pairs of atoms of that optimum that overlap by more than 0.5 Å; the pose itself may have more.
    pub clashes: usize,
    /// Its part of the pose score; `None` if the run is ranked by the soft score.
    pub score: Option<f64>,
}

impl SharpPose {
    /// Whether it adds to the pose score. Then the pose is the optimum.
    pub fn is_rewarded(self) -> bool {
        self.score.is_some_and(|score| score > 0.0)
    }
}
