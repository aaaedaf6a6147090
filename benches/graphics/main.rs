//! What a graphics processor takes, beside one thread of the CPU in the same run; and its shares of the bandwidth and the
//! arithmetic that the adapter has, both measured.
//!
//! `cargo bench --bench graphics [-- --json FILE] [RECEPTOR LIGAND]...` takes the adapter that `knotdock dock --engine
//! gpu` takes, and the example pair unless pairs of files are named. It prints Markdown tables, and writes the same as
//! JSON to FILE. An adapter that is software runs the smallest sizes alone.

mod balls;
mod search;

use knotdock_scoring::gpu::{ADAPTER_VARIABLE, Ceilings, GpuDevice};
use knotdock_scoring::processor::Cost;
use serde_json::{Value, json};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

#[path = "../example/mod.rs"]
mod example;

/// An adapter and its peak rates.
struct Card {
    gpu: GpuDevice,
    ceilings: Ceilings,
}

impl Card {
    /// Shares of the adapter's bandwidth and arithmetic that a work of these seconds has.
    fn shares(&self, seconds: f64, cost: Cost) -> [f64; 2] {
        [
            cost.bytes / seconds / self.ceilings.bytes,
            cost.operations / seconds / self.ceilings.flops,
        ]
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).filter(|one| one != "--bench");
    let (mut files, mut json) = (Vec::new(), None);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--json" => json = arguments.next(),
            _ => files.push(argument),
        }
    }
    let gpu = match GpuDevice::open(std::env::var(ADAPTER_VARIABLE).ok().as_deref()) {
        Ok(gpu) => gpu,
        Err(error) => {
            println!("not measured: {error}");
            return Ok(());
        }
    };
    let (bytes, threads) = match gpu.is_software() {
        true => (16 << 20, 1 << 10),
        false => (1 << 30, 1 << 20),
    };
    let ceilings = Ceilings::measure(&gpu, bytes, threads)?;
    let card = Card { gpu, ceilings };
    println!(
        "{} ({}): {:.0} GB/s of copies, {:.2} TFLOP/s\n",
        card.gpu.name(),
        card.gpu.backend(),
        1e-9 * ceilings.bytes,
        1e-12 * ceilings.flops
    );
    let mut pairs = Vec::new();
    match files.chunks_exact(2) {
        named if named.len() > 0 => {
            for files in named {
                let knots = [example::load(&files[0])?, example::load(&files[1])?];
                let name = Path::new(&files[0]).file_stem().unwrap_or_default();
                pairs.push((name.display().to_string(), knots));
            }
        }
        _ => pairs.push(("1PPE".to_owned(), example::knots()?)),
    }
    if card.gpu.is_software() {
        pairs.sort_by_key(|(_, [receptor, _])| receptor.len());
        pairs.truncate(1);
    }
    let mut results = json!({
        "adapter": card.gpu.name(),
        "backend": card.gpu.backend(),
        "software": card.gpu.is_software(),
        "copy_bytes_per_second": ceilings.bytes,
        "flops_per_second": ceilings.flops,
    });
    let searches: Result<Vec<Value>, _> = pairs
        .iter()
        .map(|(name, knots)| search::measure(&card, name, knots))
        .collect();
    results["search"] = searches?.into();
    results["balls"] = balls::measure(&card)?;
    if let Some(file) = json {
        std::fs::write(&file, serde_json::to_vec_pretty(&results)?)
            .map_err(|error| format!("{file}: {error}"))?;
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
