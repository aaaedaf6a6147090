//! Measurements of each setting of a sweep.
//!
//! - **Time** by stage, on the clock and of all processors.
//! - **Error** of the fast path: against the setting's own exact sum, over its 100 best grid poses, as every docking
//!   run measures it.
//! - **Definition**: some settings change what is summed. The *reference score* is the exact sum at the default's
//!   resolution and sampling and at the finest tolerance, whose kernel is cut off last. A setting's exact sum is set
//!   against it at the poses that the reference ranks first.
//! - **Agreement**: the share of the reference's first 100 rows that have one of the setting's first 100 rows within
//!   the radius of clusters.
//! - **Ranks** of near poses, where a known complex is given.

use serde::Serialize;

use crate::tradeoff::settings::{Refused, Setting};
use knotdock::dock::outcome::MeasuredError;
use knotdock::dock::outcome::StageTime;
use knotdock::options::DockOptions;

/// Rows whose agreement is measured.
pub const FIRST: usize = 100;

/// Ranks of poses near the known complex, by rows of its table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NativeRanks {
    /// Rank of the first acceptable pose ([`Criterion`](knotdock::evaluate::Criterion)).
    pub first_acceptable: Option<usize>,
    /// Rank of the first near-native pose.
    pub first_near_native: Option<usize>,
    /// Acceptable poses among the first 100.
    pub acceptable: usize,
    /// Near-native poses among the first 100.
    pub near_native: usize,
}

/// Measured cost and quality of a setting.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The setting.
    pub setting: Setting,
    /// Grid points an axis.
    pub grid: [usize; 3],
    /// Grid spacing.
    pub spacing: f64,
    /// Modes kept in three dimensions, conjugates not counted.
    pub modes: usize,
    /// Rank of the lifted axis.
    pub rank: usize,
    /// Width of the spreading window.
    pub spreading_width: usize,
    /// Poses refined.
    pub refined: usize,
    /// Time by stage; the search's own stages after sampling and planning.
    pub timing: Vec<StageTime>,
    /// The fast path's error against the exact sum.
    pub error: MeasuredError,
    /// Root mean square of the exact sum against the reference score, as a share of its best.
    pub definition_rms: f64,
    /// Correlation of the two; `None` where either does not vary.
    pub definition_correlation: Option<f64>,
    /// Share of the reference's first rows found again.
    pub agreement: f64,
    /// Ranks of near poses, with a known complex.
    pub native: Option<NativeRanks>,
    /// Whether no other setting with the default's score has a smaller error in less time.
    pub front_error: bool,
    /// Whether no other setting finds more of the reference's rows in less time.
    pub front_agreement: bool,
}

impl Measured {
    /// Seconds of all stages: on the clock.
    pub fn wall_seconds(&self) -> f64 {
        self.timing.iter().map(|stage| stage.wall_seconds).sum()
    }

    /// Seconds of all stages and processors, where the system reports them.
    pub fn cpu_seconds(&self) -> Option<f64> {
        self.timing.iter().map(|stage| stage.cpu_seconds).sum()
    }

    /// What settings are compared by: seconds of all processors, which other programs disturb little, or on the clock
    /// where the system does not tell.
    pub fn cost(&self) -> f64 {
        self.cpu_seconds().unwrap_or_else(|| self.wall_seconds())
    }

    /// Whether it ranks by the default's score: whether its error is a loss against settings of the default's
    /// resolution and sampling.
    pub fn same_score(&self, default: &DockOptions) -> bool {
        let options = &self.setting.options;
        (
            options.kernel.resolution,
            options.kernel.pass_length,
            options.sampling.sample_grid,
        ) == (
            default.kernel.resolution,
            default.kernel.pass_length,
            default.sampling.sample_grid,
        )
    }
}

/// All that a sweep measured.
#[derive(Clone, Debug)]
pub struct Tradeoff {
    /// The settings that ran: the default, the reference, then in the order of [`super::settings::settings`].
    pub measured: Vec<Measured>,
    /// Those that did not.
    pub refused: Vec<Refused>,
    /// Radius of agreement, in the unit of lengths.
    pub radius: f64,
    /// Whether a known complex was given.
    pub with_native: bool,
}
