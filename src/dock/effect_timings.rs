//! Timings of the effects: the fields of the compressed functions that it adds, and the time of a rotation with and
//! without it.

use crate::dock::effect_decisions::Decision;
use crate::dock::outcome::EffectCost;
use crate::dock::plan::DockPlan;
use crate::search::plan::SearchPlan;
use knotdock_scoring::engine::{ChosenRank, CpuEngine, ReceptorSpectra, choose_rank};
use knotdock_scoring::grid_turn::GridTurn;
use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::transform::Real;
use rayon::prelude::*;
use std::time::Instant;

/// Most fours of rotations that are timed, each sharing a transform of the ligand.
const TIMED: usize = 3;
/// Milliseconds after which no further four are timed.
const ENOUGH: u128 = 100;

/// Timings by effect: of shape what it takes alone, of every other that is on what leaving it out would save.
///
/// An effect may share fields with others, so the parts need not add up to the whole.
pub(super) fn effect_timings<T: Real>(
    plan: &DockPlan,
    spectra: &ReceptorSpectra<T>,
    engine: &CpuEngine<T>,
) -> Vec<EffectCost> {
    let on = |decision: &&Decision| decision.on;
    let active: Vec<Effect> = plan.decisions.iter().filter(on).map(|d| d.effect).collect();
    let whole = (engine.rank(), milliseconds(plan, engine));
    let alone = active
        .iter()
        .filter(|effect| **effect != Effect::Shape)
        .fold(spectra.clone(), |spectra, &effect| spectra.without(effect));
    // Made at once, as many as memory has room for, and timed one by one. Where one effect is on, it is the whole.
    let others = if active.len() > 1 {
        active.as_slice()
    } else {
        &[]
    };
    let without = |effect: Effect| {
        let ChosenRank { engine, .. } = match effect {
            Effect::Shape => rank_of(plan, &alone),
            effect => rank_of(plan, &spectra.without(effect)),
        };
        engine
    };
    let mut parts: Vec<(Effect, (usize, f64))> = Vec::new();
    for together in others.chunks(plan.memory.effects_at_once()) {
        let engines: Vec<CpuEngine<T>> =
            together.par_iter().map(|&effect| without(effect)).collect();
        // An engine goes once it is timed.
        let timed = engines
            .into_iter()
            .map(|engine| (engine.rank(), milliseconds(plan, &engine)));
        parts.extend(together.iter().copied().zip(timed));
    }
    let part = |effect: Effect| {
        let part = parts.iter().find(|(of, _)| *of == effect);
        part.map_or(whole, |(_, part)| *part)
    };
    plan.decisions
        .iter()
        .map(|decision| {
            let (rank, milliseconds) = if !decision.on {
                (0, 0.0)
            } else if decision.effect == Effect::Shape {
                part(Effect::Shape)
            } else {
                let (rank, milliseconds) = part(decision.effect);
                (whole.0.saturating_sub(rank), whole.1 - milliseconds)
            };
            EffectCost {
                effect: decision.effect,
                on: decision.on,
                reason: decision.reason.clone(),
                rank,
                milliseconds_per_rotation: milliseconds,
            }
        })
        .collect()
}

/// The engine of the lowest rank that the plan's tolerance allows.
pub(super) fn rank_of<T: Real>(plan: &DockPlan, spectra: &ReceptorSpectra<T>) -> ChosenRank<T> {
    let SearchPlan {
        engine, rotations, ..
    } = &plan.search;
    choose_rank(engine, spectra, &plan.ligand, &rotations.coarse)
}

/// Least milliseconds of a rotation on one thread, over a few.
fn milliseconds<T: Real>(plan: &DockPlan, engine: &CpuEngine<T>) -> f64 {
    let rotations = &plan.search.rotations;
    let images = &GridTurn::ALL[..rotations.images];
    let mut work = engine.workspace_of(images.len());
    let start_of_all = Instant::now();
    let times = (0..TIMED)
        .take_while(|&index| index == 0 || start_of_all.elapsed().as_millis() < ENOUGH)
        .map(|index| {
            let rotation = &rotations.coarse[(rotations.images * index) % rotations.coarse.len()];
            let start = Instant::now();
            engine.transform_ligand(rotation, &mut work);
            engine.correlate_each(images, &mut work, |_, _| ());
            1e3 * start.elapsed().as_secs_f64() / images.len() as f64
        });
    times.fold(f64::INFINITY, f64::min)
}
