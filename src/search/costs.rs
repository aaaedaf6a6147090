//! What each effect costs: the fields of the compressed functions that it adds, and the time of a rotation with and without it.

use super::effects::Decision;
use super::outcome::EffectCost;
use super::plan::DockPlan;
use super::scan::{Chosen, choose_rank};
use knotdock_scoring::effect::Effect;
use knotdock_scoring::engine::{CpuEngine, Folded};
use knotdock_scoring::se3::HalfTurn;
use knotdock_scoring::transform::Real;
use std::time::Instant;

/// Rotations that are timed, in fours that share the ligand's transform.
const TIMED: usize = 3;

/// Costs by effect: of shape what it takes alone, of every other that is on what leaving it out would save.
///
/// An effect may share fields with others, so the parts need not add up to the whole.
pub(super) fn costs<T: Real>(
    plan: &DockPlan,
    folded: &Folded<T>,
    engine: &CpuEngine<T>,
) -> Vec<EffectCost> {
    let on = |decision: &&Decision| decision.on;
    let active: Vec<Effect> = plan.decisions.iter().filter(on).map(|d| d.effect).collect();
    let whole = (engine.rank(), milliseconds(plan, engine));
    let alone = active
        .iter()
        .filter(|effect| **effect != Effect::Shape)
        .fold(folded.clone(), |folded, &effect| folded.without(effect));
    let cost_of = |folded: &Folded<T>| {
        let Chosen { engine, .. } = choose_rank(plan, folded);
        (engine.rank(), milliseconds(plan, &engine))
    };
    plan.decisions
        .iter()
        .map(|decision| {
            let (rank, milliseconds) = match decision.effect {
                _ if !decision.on => (0, 0.0),
                Effect::Shape if active.len() == 1 => whole,
                Effect::Shape => cost_of(&alone),
                effect => {
                    let (rank, milliseconds) = cost_of(&folded.without(effect));
                    (whole.0.saturating_sub(rank), whole.1 - milliseconds)
                }
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

/// Least milliseconds of a rotation on one thread, over a few.
fn milliseconds<T: Real>(plan: &DockPlan, engine: &CpuEngine<T>) -> f64 {
    let mut work = engine.workspace();
    let times = (0..TIMED).map(|index| {
        let rotation = &plan.set[(4 * index) % plan.set.len()];
        let start = Instant::now();
        engine.turn(rotation, &mut work);
        for half_turn in HalfTurn::ALL {
            engine.correlate_turned(half_turn, &mut work);
        }
        250.0 * start.elapsed().as_secs_f64()
    });
    times.fold(f64::INFINITY, f64::min)
}
