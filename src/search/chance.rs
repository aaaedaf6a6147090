//! The chance that one of a ranking's first ten clusters is acceptable, as dockings of known complexes came out.
//!
//! Acceptable is a cluster whose best pose has a ligand RMSD of at most 10 Å or an interface RMSD of at most 4 Å. docs/ranking.md has the
//! figures behind the chance and how far they reach.

use super::options::DockOptions;

/// Clusters that the chance speaks of.
pub const DEPTH: usize = 10;

/// Logit of the chance where no pose has company. scripts/calibrate_chance.py, 22 November 2026: fitted to 38 pairs of Docking Benchmark 5.
const INTERCEPT: f64 = -1.5149;
/// Change of the logit with the logarithm of poses a cluster; by the same fit.
const CROWDING_SLOPE: f64 = 2.1578;

/// The chance of a run with some options in which shape, electrostatics and contact were on or off, and so many `poses` were kept in so
/// many `clusters`.
///
/// `None` where it was not calibrated: of a run without all three effects (as of meshes), with any option that ranks, searches or lists
/// poses otherwise than by default (the effects may be named), or with fewer than ten clusters.
pub fn chance(
    options: &DockOptions,
    effects_on: &[bool],
    poses: usize,
    clusters: usize,
) -> Option<f64> {
    let calibrated = is_default(options) && effects_on.iter().all(|&on| on) && clusters >= DEPTH;
    calibrated.then(|| {
        let crowding = (poses as f64 / clusters as f64).ln();
        logistic(INTERCEPT + CROWDING_SLOPE * crowding)
    })
}

/// Whether nothing is asked that moves the ranking: threads and memory do not, and which effects are on is seen in the plan.
fn is_default(options: &DockOptions) -> bool {
    let default = DockOptions::default();
    let rest = DockOptions {
        effects: default.effects.clone(),
        threads: default.threads,
        memory: default.memory,
        ..options.clone()
    };
    rest == default
}

fn logistic(logit: f64) -> f64 {
    1.0 / (1.0 + (-logit).exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::EffectChoice;
    use knotdock_scoring::effect::Effect;

    const ALL: [bool; 3] = [true; 3];

    fn of(poses: usize, clusters: usize) -> f64 {
        chance(&DockOptions::default(), &ALL, poses, clusters).unwrap()
    }

    fn logit(chance: f64) -> f64 {
        (chance / (1.0 - chance)).ln()
    }

    /// Where each pose is alone the logarithm is zero, and doubling the poses a cluster adds ln 2 of the slope.
    #[test]
    fn the_logit_is_linear_in_the_logarithm_of_poses_a_cluster() {
        assert!((logit(of(700, 700)) - INTERCEPT).abs() < 1e-12);
        let step = logit(of(2000, 500)) - logit(of(2000, 1000));
        assert!((step - CROWDING_SLOPE * 2f64.ln()).abs() < 1e-12);
        assert_eq!(of(2000, 1000), of(1000, 500));
    }

    #[test]
    fn fewer_clusters_of_as_many_poses_are_surer() {
        let chances: Vec<f64> = (1..20).map(|step| of(2000, 100 * step)).collect();
        assert!(chances.is_sorted_by(|a, b| a > b));
        assert!(chances.iter().all(|&chance| 0.0 < chance && chance < 1.0));
    }

    /// What does not move the ranking does not matter, nor that effects were named which `auto` would have taken.
    #[test]
    fn threads_memory_and_named_effects_leave_it() {
        let options = DockOptions {
            threads: 2,
            memory: Some(1 << 30),
            effects: EffectChoice::Only(Effect::ALL.to_vec()),
            ..DockOptions::default()
        };
        assert_eq!(chance(&options, &ALL, 2000, 1000), Some(of(2000, 1000)));
    }

    #[test]
    fn there_is_none_for_what_it_was_not_calibrated_on() {
        let told = |options: &DockOptions| chance(options, &ALL, 2000, 1000);
        let default = DockOptions::default;
        assert_eq!(chance(&default(), &[true, true, false], 2000, 1000), None);
        assert_eq!(chance(&default(), &ALL, 9, 9), None);
        let others = [
            DockOptions {
                rotations: 7200,
                ..default()
            },
            DockOptions {
                resolution: 6.0,
                ..default()
            },
            DockOptions {
                contact_weight: 1.0,
                ..default()
            },
            DockOptions {
                fine_contact_weight: 0.0,
                ..default()
            },
            DockOptions {
                poses: 1000,
                ..default()
            },
            DockOptions {
                refine: Some(300),
                ..default()
            },
            DockOptions {
                cluster_radius: 4.0,
                ..default()
            },
            DockOptions {
                every_pose: true,
                ..default()
            },
            DockOptions {
                sample_grid: Some(64),
                ..default()
            },
        ];
        for options in others {
            assert_eq!(told(&options), None, "{options:?}");
        }
    }
}
