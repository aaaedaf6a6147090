//! Cost model: the expected time of a docking and the expected error of its fast path.
//!
//! # Time
//!
//! A run's processor time is taken as a sum of stages, each a coefficient times what the stage works on:
//!
//! - a rotation: N log2 N (`inverse` + `field` q), N points of the grid, q fields of the compressed functions;
//! - preparing: `prepare` for each mode and effect, on the clock: threads share it in part;
//! - in double precision these two times [`DOUBLE`];
//! - an exact sum: `pair` for each pair of knots that can feel each other;
//! - rescoring a pose, refining a peak: `rescore`, `refine` for each knot of the ligand;
//! - the rotation set: `rotation` for each rotation, and `covering` to measure its covering radius.
//!
//! Coefficients are seconds of one thread while all are busy, on a two-core Intel Xeon at 2.50 GHz. So the time that is
//! expected is an order of size elsewhere; a run within a budget goes by the pace that it measures.
//!
//! # Error
//!
//! The fast path's error hangs on tolerance and spacing. [`LADDER`] holds settings of both, cheapest first, each with
//! the error that it was measured to make.

use std::time::Instant;

use crate::dock::plan::DockPlan;
use crate::options::DockOptions;
use crate::options::Precision;
use crate::search::deadline::Deadline;
use knotdock_scoring::terms::effect::Effect;

/// Coefficients of the time, in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CostModel {
    /// Of a rotation, whatever its fields.
    pub inverse: f64,
    /// Of a rotation, each field.
    pub field: f64,
    /// Of preparing, each mode and effect.
    pub prepare: f64,
    /// Of an exact sum, each pair of knots within reach.
    pub pair: f64,
    /// Of rescoring, each pose and ligand knot.
    pub rescore: f64,
    /// Of refining, each pose and ligand knot.
    pub refine: f64,
    /// Of making the rotation set, each rotation.
    pub rotation: f64,
    /// Of measuring its covering radius.
    pub covering: f64,
}

/// Exact sums made to measure a run's error.
const CHECKED: f64 = 100.0;
/// Poses that join a cluster for each that begins one, at 3,600 rotations and times the ligand's knots.
///
/// The larger the ligand, the farther neighbouring rotations move its atoms. As counted on the example pair, 1AVX and
/// 1EAW.
const JOINING: f64 = 500.0;
/// Power by which that number rises with rotations, as counted on the same pair.
const CROWDING: f64 = 0.7;
/// Ligand knots that feel the receptor in a pose that touches, per root of all: as timed on the same pairs.
const TOUCHING: f64 = 15.0;
/// Share of the poses that are scored for each unit of the tolerance, likewise.
const DOUBTFUL: f64 = 5.0;
/// A rotation, or preparing, in double precision against single. As measured on the example pair.
pub const DOUBLE: f64 = 2.1;
/// A finer rotation in rotations: it shares the ligand's transform with no other. As measured on the example pair.
const FINE: f64 = 2.1;
/// Knots about which neighbours are counted.
const PROBED: usize = 64;

impl CostModel {
    /// Coefficients of a two-core Intel Xeon at 2.50 GHz; `pair` was 1.6e-8 there. It is multiplied by what the sum
    /// of pairs has gained since (`benches/exact.rs`, score with slices over plain loop, on an AMD EPYC at 2.60 GHz:
    /// 0.71 then, 0.39 now). `inverse` was 2.7e-10 and `field` 9e-11: eight rotations now share a transform and data
    /// moves less (`cargo bench --bench rotation`, 1PPE at 3 and 7 components on one machine: 0.92 and 0.45 of them).
    pub const BUILT_IN: Self = Self {
        inverse: 2.5e-10,
        field: 4e-11,
        prepare: 4.5e-6,
        pair: 9e-9,
        rescore: 3e-6,
        refine: 3.5e-5,
        rotation: 1.2e-5,
        covering: 0.05,
    };

    /// Seconds of one thread for a rotation.
    pub fn rotation_seconds(&self, work: &Workload) -> f64 {
        work.precision * work.grid * (self.inverse + self.field * work.rank)
    }

    /// Seconds on the clock, all cores to itself, for so many rotations on so many threads.
    pub fn seconds(&self, work: &Workload, rotations: usize, threads: usize) -> f64 {
        let count = rotations as f64;
        let alone = work.precision * self.prepare * work.modes * work.effects
            + self.covering
            + self.rotation * count / threads as f64;
        let searched = count * self.rotation_seconds(work) / threads as f64;
        alone + searched + self.seconds_after_search(work, rotations, threads)
    }

    /// Of these, the seconds that follow a search of so many rotations: finer rotations, rescoring, refining, exact
    /// sums.
    pub fn seconds_after_search(&self, work: &Workload, rotations: usize, threads: usize) -> f64 {
        // Few rotations have fewer peaks than poses are kept.
        let count = rotations as f64;
        let kept = (work.per_rotation * count / work.poses).min(1.0);
        let exact =
            self.pair * work.pairs * (CHECKED.min(kept * work.poses) + kept * work.reported(count));
        let rescored = self.rescore * work.ligand * kept * work.rescored;
        let refined = self.refine * work.ligand * work.refined.min(kept * work.poses);
        let finer = FINE * work.fine * self.rotation_seconds(work);
        (finer + exact + rescored + refined) / threads as f64
    }

    /// The most rotations, in fours, from `range` that fit into so many seconds; where none do, the fewest.
    pub fn rotations_within(
        &self,
        work: &Workload,
        seconds: f64,
        threads: usize,
        range: std::ops::RangeInclusive<usize>,
    ) -> usize {
        // Not a matter of dividing: fewer rotations leave more clusters, each of which is an exact sum.
        let fewest = *range.start();
        let fits = |rotations: &usize| self.seconds(work, *rotations, threads) <= seconds;
        range.step_by(4).filter(fits).last().unwrap_or(fewest)
    }
}

/// Amount of work in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Workload {
    /// N log2 N of the grid's N points.
    pub grid: f64,
    /// Fields of the compressed functions, as far as they can be foreseen.
    pub rank: f64,
    /// What the precision multiplies times of the fast path by: 1 in single precision.
    pub precision: f64,
    /// Finer rotations searched about the best.
    pub fine: f64,
    /// Modes kept.
    pub modes: f64,
    /// Effects that are on.
    pub effects: f64,
    /// Pairs of knots that feel each other in a pose that touches.
    pub pairs: f64,
    /// Knots of the ligand.
    pub ligand: f64,
    /// Poses kept of all rotations.
    pub poses: f64,
    /// Peaks kept of each rotation.
    pub per_rotation: f64,
    /// Share of them that the fast path's error could put before the centre of their cluster; all where every pose is
    /// a row.
    pub doubtful: f64,
    /// Poses rescored, each times the share of the pose terms' time that the acting terms take.
    pub rescored: f64,
    /// Poses refined.
    pub refined: f64,
}

impl Workload {
    /// The work of a plan, its rotations left open.
    pub fn of(plan: &DockPlan) -> Self {
        let options = &plan.options;
        let points = plan.grid.iter().product::<usize>() as f64;
        let [receptor, ligand] = plan.knots();
        // A knot of the ligand that touches has about as many within reach as the average knot of the receptor.
        let step = receptor.len().div_ceil(PROBED).max(1);
        let reach = plan.kernel_reach.powi(2);
        let (mut near, mut probed) = (0usize, 0usize);
        for center in receptor.centers.iter().step_by(step) {
            let within = receptor.centers.iter().filter(|other| {
                let square: f64 = (0..3)
                    .map(|axis| (other[axis] - center[axis]).powi(2))
                    .sum();
                square <= reach
            });
            near += within.count();
            probed += 1;
        }
        let on = |effect: Effect| f64::from(u8::from(plan.is_on(effect)));
        let poses = options.search.poses as f64;
        Self {
            grid: points * points.log2(),
            rank: expected_rank(plan),
            precision: match options.search.precision {
                Precision::Single => 1.0,
                Precision::Double => DOUBLE,
            },
            fine: options
                .search
                .fine_rotations
                .map_or(0.0, |finer| options.search.fine_share * finer as f64),
            modes: plan.modes as f64,
            effects: Effect::ALL.into_iter().map(on).sum(),
            pairs: TOUCHING * (ligand.len() as f64).sqrt() * near as f64 / probed.max(1) as f64,
            ligand: ligand.len() as f64,
            poses,
            per_rotation: options.search.per_rotation as f64,
            doubtful: if options.ranking.no_cluster {
                1.0
            } else {
                DOUBTFUL * options.kernel.tolerance
            },
            rescored: plan.rescoring().time_share() * poses,
            refined: (plan.refined() as f64).min(poses),
        }
    }
}

impl Workload {
    /// Poses that are exactly scored for the table: of each cluster the centre, and whatever might come before it.
    fn reported(&self, rotations: f64) -> f64 {
        let joining = JOINING / self.ligand * (rotations / 3600.0).powf(CROWDING);
        let centres = 1.0 / (1.0 + joining);
        self.poses * (centres + self.doubtful).min(1.0)
    }
}

/// Number of components that a tolerance needs.
///
/// At 1e-2 each effect needs those of its definition, and shape one where all balls are alike. Where more error is
/// allowed, fewer do.
fn expected_rank(plan: &DockPlan) -> f64 {
    let tolerance = plan.options.kernel.tolerance;
    let share = match tolerance {
        tolerance if tolerance >= 0.1 => 0.6,
        tolerance if tolerance >= 0.03 => 0.85,
        tolerance if tolerance >= 1e-3 => 1.0,
        _ => 1.15,
    };
    let alike = plan.radii == [1, 1];
    let components = |effect: Effect| match effect {
        Effect::Shape if alike => 1.0,
        _ => effect.definition().components,
    };
    let on = Effect::ALL.into_iter().filter(|effect| plan.is_on(*effect));
    let components: f64 = on.map(components).sum();
    (share * components).max(1.0)
}

/// The deadline of a planned run that is to end at `end`, by what the model expects it to take.
pub fn deadline(plan: &DockPlan, end: Instant) -> Deadline {
    let (model, work) = (CostModel::BUILT_IN, Workload::of(plan));
    let threads = plan.in_flight();
    let rotation = model.rotation_seconds(&work) / threads as f64;
    Deadline::new(end, rotation, move |rotations| {
        model.seconds_after_search(&work, rotations, threads)
    })
}

/// A setting of the fast path with the error that it makes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rung {
    /// Tolerance.
    pub tolerance: f64,
    /// Spacing as a share of the resolution.
    pub spacing: f64,
    /// Precision that it needs.
    pub precision: Precision,
    /// Root mean square of the error over the best grid poses, as a share of the best score.
    pub error: f64,
}

/// Cheapest first, the defaults before all: each error the largest measured on the example pair, 1AVX, 1EAW and 7CEI.
/// Larger tolerances are left out, for
/// they save next to nothing: every pose that the larger error leaves in doubt is scored exactly. So are wider
/// spacings, which keep the same modes.
pub const LADDER: [Rung; 8] = [
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

    /// The cheapest setting whose error is at most `accuracy`; `None` below what is known of any.
    pub fn within(accuracy: f64) -> Option<Self> {
        LADDER.into_iter().find(|rung| rung.error <= accuracy)
    }

    /// Options with this setting.
    pub fn apply(self, options: &mut DockOptions) {
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

    fn work() -> Workload {
        Workload {
            grid: 1.85e6,
            rank: 7.0,
            precision: 1.0,
            fine: 0.0,
            modes: 29_772.0,
            effects: 3.0,
            pairs: 2e5,
            ligand: 221.0,
            poses: 2000.0,
            per_rotation: 3.0,
            doubtful: 0.05,
            rescored: 2000.0,
            refined: 0.0,
        }
    }

    #[test]
    fn rotations_fill_the_time() {
        let model = CostModel::BUILT_IN;
        for (seconds, threads) in [(9.0, 1), (5.0, 4), (60.0, 2)] {
            let within = |range| model.rotations_within(&work(), seconds, threads, range);
            let rotations = within(600..=1_000_000);
            assert!(model.seconds(&work(), rotations, threads) <= seconds);
            assert!(model.seconds(&work(), rotations + 4, threads) > seconds);
            assert_eq!(within(600..=800), 800);
        }
        assert_eq!(model.rotations_within(&work(), 0.1, 2, 600..=1200), 600);
    }

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
