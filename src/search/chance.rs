//! The chance that one of a ranking's first ten clusters is acceptable, as dockings of known complexes came out.
//!
//! Acceptable is a cluster whose best pose has a ligand RMSD of at most 10 Å or an interface RMSD of at most 4 Å. No figure of a ranking that
//! was tried (z-scores, how far clusters stand apart, how many poses they hold) told successes from failures better than the share of
//! successes itself, so the chance is that share and the same for all runs that it was taken of. docs/ranking.md has the figures.

use crate::options::DockOptions;
use knotdock_scoring::effect::Effect;

/// Clusters that the chance speaks of.
pub const DEPTH: usize = 10;

/// Share of pairs that succeeded. scripts/calibrate_chance.py, 25 November 2026: 63 pairs of Docking Benchmark 5, one turn of each, docked with
/// potentials derived without them.
pub const SHARE: f64 = 0.381;

/// The effects that were on in all runs that the share was taken of: none of their pairs has an antibody.
const ON: [Effect; 3] = [Effect::Shape, Effect::Electrostatics, Effect::Contact];

/// The chance of a run with some options in which these effects were on (by `Effect as usize`), and which found so many clusters.
///
/// `None` where it was not calibrated: of a run with other effects than shape, electrostatics and contact (as of meshes and antibodies), with any
/// option that searches, ranks or lists poses otherwise than by default (effects may be named that are on by default), or with fewer than ten clusters.
pub fn chance(
    options: &DockOptions,
    on: [bool; Effect::ALL.len()],
    clusters: usize,
) -> Option<f64> {
    let effects = Effect::ALL.map(|effect| ON.contains(&effect));
    let calibrated = is_default(options) && on == effects && clusters >= DEPTH;
    calibrated.then_some(SHARE)
}

/// Whether nothing is asked that moves the ranking: threads, memory and the engine do not, and which effects are on is seen by themselves.
fn is_default(options: &DockOptions) -> bool {
    let default = DockOptions::default();
    let rest = DockOptions {
        effects: default.effects.clone(),
        threads: default.threads,
        memory: default.memory,
        engine: default.engine,
        ..options.clone()
    };
    rest == default
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::EffectChoice;
    use crate::options::EngineChoice;

    /// As `auto` has them for two proteins.
    const AUTO: [bool; Effect::ALL.len()] = [true, true, true, false];

    /// What does not move the ranking does not matter, nor that effects were named which `auto` would have taken.
    #[test]
    fn default_rankings_have_one_whatever_threads_memory_engine_and_names() {
        assert_eq!(chance(&DockOptions::default(), AUTO, 10), Some(SHARE));
        let options = DockOptions {
            threads: 2,
            memory: Some(1 << 30),
            engine: EngineChoice::Gpu,
            effects: EffectChoice::Only(ON.to_vec()),
            ..DockOptions::default()
        };
        assert_eq!(chance(&options, AUTO, 1000), Some(SHARE));
    }

    #[test]
    fn there_is_none_for_what_it_was_not_calibrated_on() {
        let default = DockOptions::default;
        assert_eq!(chance(&default(), AUTO, 9), None);
        for effect in 0..AUTO.len() {
            let mut on = AUTO;
            on[effect] = !on[effect];
            assert_eq!(chance(&default(), on, 1000), None);
        }
        let changes: [fn(&mut DockOptions); 16] = [
            |options| options.rotations = 7200,
            |options| options.resolution = 6.0,
            |options| options.tolerance = 1e-3,
            |options| options.contact_weight = 1.0,
            |options| options.fine_contact_weight = 0.0,
            |options| options.atom_pair_weight = 0.0,
            |options| options.relaxed_weight = 0.0,
            |options| options.restraint_weight = 2.0,
            |options| options.peptidase_weight = 0.0,
            |options| options.unresolved_weight = 0.0,
            |options| options.termini_weight = 0.0,
            |options| options.poses = 1000,
            |options| options.refine = Some(300),
            |options| options.cluster_radius = 4.0,
            |options| options.every_pose = true,
            |options| options.sample_grid = Some(64),
        ];
        for change in changes {
            let mut options = default();
            change(&mut options);
            assert_eq!(chance(&options, AUTO, 1000), None, "{options:?}");
        }
    }
}
