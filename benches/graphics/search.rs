//! The search of a pair: seconds by number of rotations and of those in flight, and each stage.

use crate::{Card, least_seconds};
use knotdock_scoring::Precision;
use knotdock_scoring::engine::gpu::{GpuEngine, LigandRotation};
use knotdock_scoring::engine::{CpuEngine, Plan, ReceptorSpectra};
use knotdock_scoring::gpu::GpuError;
use knotdock_scoring::grid_turn::GridTurn;
use knotdock_scoring::peaks::PeakLimits;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::so3::rotation_set;
use knotdock_structures::Knots;
use serde_json::{Value, json};
use std::error::Error;
use std::sync::Arc;

/// Rotations of searches; software takes the first alone.
const ROTATIONS: [usize; 3] = [600, 3_600, 54_000];
/// Shape alone takes 2 components, and all effects of proteins about 7.
const RANKS: [usize; 2] = [2, 7];
/// Peaks of a rotation, and their least distance, as in a search.
const PEAKS: (usize, usize) = (3, 2);
/// Memory of rotations in flight, MiB: what a last cache holds, and what `--engine gpu` takes.
const MEMORY: [u64; 3] = [32, 128, 512];
/// Rotations that one thread of the CPU is timed over.
const ON_CORE: usize = 200;

/// Prints the tables of one pair, and returns what they hold.
pub fn measure(
    card: &Card,
    name: &str,
    [receptor, ligand]: &[Knots; 2],
) -> Result<Value, Box<dyn Error>> {
    let options = knotdock::options::DockOptions::default().kernel.engine();
    let plan = Arc::new(Plan::new(receptor, ligand, options)?.fitted(receptor)?);
    let images = GridTurn::of(plan.modes()).len();
    let spectra = ReceptorSpectra::new(&plan, receptor, ligand, Quantity::Score, Precision::Single);
    let [nx, ny, nz] = plan.size();
    println!("## {name}: grid {nx} x {ny} x {nz}\n");
    let (mut searches, mut stages) = (Vec::new(), Vec::new());
    println!(
        "| components | MiB | rotations | in flight | s | µs a rotation | times one CPU thread |"
    );
    println!("|---|---|---|---|---|---|---|");
    for rank in RANKS {
        let engine = CpuEngine::new(Arc::clone(&plan), &spectra, ligand, rank);
        let core = on_core(&engine, images)?;
        for memory in MEMORY {
            if card.gpu.is_software() && memory < MEMORY[2] {
                continue;
            }
            let on_card = match GpuEngine::new(&card.gpu, &engine, PEAKS.0, PEAKS.1, memory << 20) {
                Err(GpuError::TooSmall { .. }) if memory < MEMORY[2] => continue,
                on_card => on_card?,
            };
            for rotations in ROTATIONS {
                if card.gpu.is_software() && rotations > ROTATIONS[0] {
                    continue;
                }
                let turns = turns(rotations, images);
                let seconds = least_seconds(2, || on_card.best(&turns, &mut |_| {}).map(drop))?;
                let of_rotation = seconds / (images * turns.len()) as f64;
                println!(
                    "| {} | {memory} | {rotations} | {} | {seconds:.4} | {:.2} | {:.1} |",
                    engine.rank(),
                    on_card.in_flight(),
                    1e6 * of_rotation,
                    core / of_rotation
                );
                searches.push(json!({
                    "components": engine.rank(),
                    "memory_mib": memory,
                    "rotations": rotations,
                    "in_flight": on_card.in_flight(),
                    "seconds": seconds,
                    "cpu_seconds_of_rotation": core,
                }));
            }
            if memory == MEMORY[2] {
                for stage in on_card.stages(&turns(images, images)[0].rotation)? {
                    stages.push((engine.rank(), stage));
                }
            }
        }
    }
    println!(
        "\n| components | stage | µs a rotation | MB | Mflop | share of copies | share of arithmetic |"
    );
    println!("|---|---|---|---|---|---|---|");
    let mut of_stages = Vec::new();
    for (rank, stage) in stages {
        let [copies, arithmetic] = card.shares(stage.seconds, stage.cost);
        println!(
            "| {rank} | {} | {:.3} | {:.3} | {:.3} | {copies:.2} | {arithmetic:.2} |",
            stage.name,
            1e6 * stage.seconds,
            1e-6 * stage.cost.bytes,
            1e-6 * stage.cost.operations
        );
        of_stages.push(json!({
            "components": rank,
            "stage": stage.name,
            "seconds": stage.seconds,
            "bytes": stage.cost.bytes,
            "operations": stage.cost.operations,
        }));
    }
    println!();
    Ok(json!({"pair": name, "grid": plan.size(), "searches": searches, "stages": of_stages}))
}

/// Turns of the ligand that make a number of rotations with all their images.
fn turns(rotations: usize, images: usize) -> Vec<LigandRotation> {
    rotation_set(rotations)
        .into_iter()
        .step_by(images)
        .map(|rotation| LigandRotation {
            rotation,
            wanted: std::array::from_fn(|image| image < images),
        })
        .collect()
}

/// Seconds of a rotation on one thread of the CPU, peaks included.
fn on_core(engine: &CpuEngine, images: usize) -> Result<f64, Box<dyn Error>> {
    let turns = turns(ON_CORE, images);
    let mut work = engine.workspace_of(images);
    let limits = PeakLimits {
        count: PEAKS.0,
        floor: f64::NEG_INFINITY,
    };
    let seconds = least_seconds(2, || {
        let mut found = Vec::new();
        for turn in &turns {
            engine.transform_ligand(&turn.rotation, &mut work);
            engine.correlate_each(engine.turns(), &mut work, &mut |_, scores| {
                scores.find_peaks(0, limits, &mut found);
            });
            found.clear();
        }
        Ok::<(), Box<dyn Error>>(())
    })?;
    Ok(seconds / (images * turns.len()) as f64)
}
