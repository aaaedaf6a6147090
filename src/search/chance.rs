//! The chance that one of a ranking's first ten clusters is acceptable, as dockings of known complexes came out.
//!
//! Acceptable is a cluster whose best pose has a ligand RMSD of at most 10 Å or an interface RMSD of at most 4 Å. No figure of a ranking that
//! was tried (z-scores, how far clusters stand apart, how many poses they hold) told successes from failures better than the share of
//! successes itself, so the chance is that share and the same for all runs that it was taken of. docs/ranking.md has the figures.

use super::options::DockOptions;

/// Clusters that the chance speaks of.
pub const DEPTH: usize = 10;

/// Share of pairs that succeeded. scripts/calibrate_chance.py, 23 November 2026: 63 pairs of Docking Benchmark 5, one turn of each, docked with
/// potentials derived without them.
pub const SHARE: f64 = 0.349;

/// The chance of a run with some options in which shape, electrostatics and contact were on or off, and which found so many clusters.
///
/// `None` where it was not calibrated: of a run without all three effects (as of meshes), with any option that searches, ranks or lists
/// poses otherwise than by default (effects may be named that are on by default), or with fewer than ten clusters.
pub fn chance(options: &DockOptions, effects_on: &[bool], clusters: usize) -> Option<f64> {
    let calibrated = is_default(options) && effects_on.iter().all(|&on| on) && clusters >= DEPTH;
    calibrated.then_some(SHARE)
}

/// Whether nothing is asked that moves the ranking: threads and memory do not, and which effects are on is seen by themselves.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::EffectChoice;
    use knotdock_scoring::effect::Effect;

    const ALL: [bool; Effect::ALL.len()] = [true; Effect::ALL.len()];

    /// What does not move the ranking does not matter, nor that effects were named which `auto` would have taken.
    #[test]
    fn default_rankings_have_one_whatever_threads_memory_and_names() {
        assert_eq!(chance(&DockOptions::default(), &ALL, 10), Some(SHARE));
        let options = DockOptions {
            threads: 2,
            memory: Some(1 << 30),
            effects: EffectChoice::Only(Effect::ALL.to_vec()),
            ..DockOptions::default()
        };
        assert_eq!(chance(&options, &ALL, 1000), Some(SHARE));
    }

    #[test]
    fn there_is_none_for_what_it_was_not_calibrated_on() {
        let default = DockOptions::default;
        assert_eq!(chance(&default(), &ALL, 9), None);
        for effect in 0..ALL.len() {
            let mut on = ALL;
            on[effect] = false;
            assert_eq!(chance(&default(), &on, 1000), None);
        }
        let changes: [fn(&mut DockOptions); 12] = [
            |options| options.rotations = 7200,
            |options| options.resolution = 6.0,
            |options| options.tolerance = 1e-3,
            |options| options.contact_weight = 1.0,
            |options| options.fine_contact_weight = 0.0,
            |options| options.atom_pair_weight = 0.0,
            |options| options.relaxed_weight = 0.0,
            |options| options.poses = 1000,
            |options| options.refine = Some(300),
            |options| options.cluster_radius = 4.0,
            |options| options.every_pose = true,
            |options| options.sample_grid = Some(64),
        ];
        for change in changes {
            let mut options = default();
            change(&mut options);
            assert_eq!(chance(&options, &ALL, 1000), None, "{options:?}");
        }
    }
}
