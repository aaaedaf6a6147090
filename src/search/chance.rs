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
    let rest = options.changed(|options| {
        options.kernel.effects = default.kernel.effects.clone();
        options.search.engine = default.search.engine;
        options.machine = default.machine.clone();
        // What is read and written moves no ranking.
        options.input = default.input.clone();
        options.output = default.output.clone();
    });
    rest == default
}

#[cfg(test)]
mod tests {
    use crate::options::EffectChoice;
    use crate::options::EngineChoice;
    use crate::options::SampleGrid;
    use crate::search::chance::*;

    /// As `auto` has them for two proteins.
    const AUTO: [bool; Effect::ALL.len()] = [true, true, true, false];

    /// What does not move the ranking does not matter, nor that effects were named which `auto` would have taken.
    #[test]
    fn default_rankings_have_one_whatever_threads_memory_engine_and_names() {
        assert_eq!(chance(&DockOptions::default(), AUTO, 10), Some(SHARE));
        let options = DockOptions::default().changed(|options| {
            options.machine.threads = 2.into();
            options.machine.memory = Some(1 << 30);
            options.search.engine = EngineChoice::Gpu;
            options.kernel.effects = EffectChoice::Only(ON.to_vec());
        });
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
            |options| options.search.rotations = 7200,
            |options| options.kernel.resolution = 6.0,
            |options| options.kernel.tolerance = 1e-3,
            |options| options.terms.contact_weight = 1.0,
            |options| options.terms.fine_contact_weight = 0.0,
            |options| options.terms.atom_pair_weight = 0.0,
            |options| options.terms.relaxed_weight = 0.0,
            |options| options.restraints.restraint_weight = 2.0,
            |options| options.restraints.peptidase_weight = 0.0,
            |options| options.terms.unresolved_weight = 0.0,
            |options| options.terms.termini_weight = 0.0,
            |options| options.search.poses = 1000,
            |options| options.search.refine = Some(300),
            |options| options.ranking.cluster_radius = 4.0,
            |options| options.ranking.no_cluster = true,
            |options| options.sampling.sample_grid = Some(SampleGrid::default()),
        ];
        for change in changes {
            let mut options = default();
            change(&mut options);
            assert_eq!(chance(&options, AUTO, 1000), None, "{options:?}");
        }
    }
}
