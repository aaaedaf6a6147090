//! Cost of the effects in a run's own search: the part of the compressed functions that each of them takes, and of the
//! time of a rotation.
//!
//! A rotation takes a forward transform and a product for each component of the compressed functions. A component is a
//! combination of the functions of all effects, and each function has a part of it ([`ChosenRank::shares`]). So the parts
//! of the effects add up to the whole, and none is below zero.

use crate::dock::effect_decisions::Decision;
use crate::dock::outcome::{EffectCost, StageTime};
use crate::dock::plan::DockPlan;
use crate::search::plan::SearchPlan;
use knotdock_scoring::engine::{ChosenRank, ReceptorSpectra, choose_rank};
use knotdock_scoring::terms::effect::Effect;

/// The engine of the lowest rank that the plan's tolerance allows.
pub(super) fn rank_of(plan: &DockPlan, spectra: &ReceptorSpectra) -> ChosenRank {
    let SearchPlan {
        engine, rotations, ..
    } = &plan.search;
    choose_rank(engine, spectra, &plan.ligand, &rotations.coarse)
}

/// Components of an engine by effect (`Effect as usize`), which add up to its rank.
pub(super) fn components_by_effect(
    spectra: &ReceptorSpectra,
    shares: &[f64],
) -> [f64; Effect::ALL.len()] {
    let mut components = [0.0; Effect::ALL.len()];
    for (function, share) in shares.iter().enumerate() {
        components[spectra.effect(function) as usize] += share;
    }
    components
}

/// The costs of all effects, of a search of this number of rotations whose stages took these times.
pub(super) fn effect_costs(
    plan: &DockPlan,
    components: &[f64; Effect::ALL.len()],
    (searched, on_card): (usize, bool),
    timing: &[StageTime],
) -> Vec<EffectCost> {
    let search = timing.iter().find(|stage| stage.name == "search");
    // A card searches while the processor waits.
    let seconds = search.map_or(0.0, |stage| match stage.cpu_seconds {
        Some(cpu_seconds) if !on_card => cpu_seconds,
        _ => stage.wall_seconds,
    });
    let milliseconds = 1e3 * seconds / searched.max(1) as f64;
    let whole: f64 = components.iter().sum();
    let cost = |decision: &Decision| {
        let functions = components[decision.effect as usize];
        EffectCost {
            effect: decision.effect,
            on: decision.on,
            reason: decision.reason.clone(),
            functions,
            milliseconds_per_rotation: milliseconds * functions / whole.max(f64::MIN_POSITIVE),
        }
    };
    plan.decisions.iter().map(cost).collect()
}
