//! Time of a rotation of the example pair on a graphics processor beside one thread of the CPU, in the same run,
//! peaks included.
//!
//! `cargo bench --bench graphics` takes the adapter that `knotdock dock --engine gpu` takes, and prints its name. It
//! measures two ranks of the lifted axis, that of shape alone and about that of all effects of proteins. It prints the
//! milliseconds per rotation on either device, their ratio, and the stages on the card, each submitted by itself.
//! Except on an adapter that is software, it also times 54,000 rotations: the same 3,600 fifteen times.

mod example;

use knotdock_scoring::Precision;
use knotdock_scoring::engine::gpu::{GpuEngine, LigandRotation};
use knotdock_scoring::engine::{CpuEngine, Plan, ReceptorSpectra};
use knotdock_scoring::gpu::{ADAPTER_VARIABLE, GpuDevice};
use knotdock_scoring::grid_turn::GridTurn;
use knotdock_scoring::peaks::PeakLimits;
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::so3::rotation_set;
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

/// Fours of rotations.
const TURNS: usize = 450;
/// Rotations of a fine search.
const FINE_ROTATIONS: usize = 54_000;
/// Peaks of a rotation, and their least distance, as in a search.
const PEAKS: (usize, usize) = (3, 2);

fn main() -> Result<(), Box<dyn Error>> {
    let gpu = match GpuDevice::open(std::env::var(ADAPTER_VARIABLE).ok().as_deref()) {
        Ok(gpu) => gpu,
        Err(error) => {
            println!("not measured: {error}");
            return Ok(());
        }
    };
    let [receptor, ligand] = example::knots()?;
    let options = knotdock::options::DockOptions::default().kernel.engine();
    let plan = Arc::new(Plan::new(&receptor, &ligand, options)?.fitted(&receptor)?);
    let images = GridTurn::of(plan.modes()).len();
    let spectra = ReceptorSpectra::new(
        &plan,
        &receptor,
        &ligand,
        Quantity::Score,
        Precision::Single,
    );
    let turns: Vec<LigandRotation> = rotation_set(images * TURNS)
        .into_iter()
        .step_by(images)
        .map(|rotation| LigandRotation {
            rotation,
            wanted: std::array::from_fn(|image| image < images),
        })
        .collect();
    println!("{} ({})", gpu.name(), gpu.backend());
    for rank in [2, 7] {
        let engine = CpuEngine::new(Arc::clone(&plan), &spectra, &ligand, rank);
        let card = GpuEngine::new(&gpu, &engine, PEAKS.0, PEAKS.1, 512 << 20)?;
        let search = |rounds: usize| -> Result<(), Box<dyn Error>> {
            for _ in 0..rounds {
                card.best(&turns, &mut |_| {})?;
            }
            Ok(())
        };
        let on_card = least_seconds(2, || search(1))?;
        let mut work = engine.workspace_of(images);
        let on_core = least_seconds(2, || {
            let mut found = Vec::new();
            for turn in &turns[..TURNS / 9] {
                engine.transform_ligand(&turn.rotation, &mut work);
                engine.correlate_each(engine.turns(), &mut work, &mut |_, scores| {
                    let limits = PeakLimits {
                        count: PEAKS.0,
                        floor: f64::NEG_INFINITY,
                    };
                    scores.find_peaks(0, limits, &mut found);
                });
                found.clear();
            }
            Ok::<(), Box<dyn Error>>(())
        })?;
        let of_rotation = |seconds: f64, turns: usize| 1e3 * seconds / (images * turns) as f64;
        let (card_ms, core_ms) = (of_rotation(on_card, TURNS), of_rotation(on_core, TURNS / 9));
        println!(
            "rank {}, {} rotations in flight: {} rotations in {on_card:.3} s, {card_ms:.4} ms each; \
             one thread of the CPU {core_ms:.4} ms; ratio {:.2}",
            engine.rank(),
            card.in_flight(),
            images * TURNS,
            core_ms / card_ms
        );
        if !gpu.is_software() {
            let fine = least_seconds(1, || search(FINE_ROTATIONS / (images * TURNS)))?;
            println!("  {FINE_ROTATIONS} rotations in {fine:.3} s");
        }
        for (name, seconds) in card.stage_seconds(&turns[0].rotation)? {
            println!("  {name}: {:.4} ms a rotation", 1e3 * seconds);
        }
    }
    Ok(())
}

/// The least of a few runs.
fn least_seconds<E>(runs: usize, mut run: impl FnMut() -> Result<(), E>) -> Result<f64, E> {
    let mut least = f64::INFINITY;
    for _ in 0..runs {
        let start = Instant::now();
        run()?;
        least = least.min(start.elapsed().as_secs_f64());
    }
    Ok(least)
}
