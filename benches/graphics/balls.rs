//! Sums of balls: Minkowski pairs, and transforms of knots by direct sums.

use crate::{Card, least_seconds};
use knotdock_scoring::gpu::{GpuError, Job, WaveSums};
use knotdock_scoring::minkowski::Knot;
use knotdock_scoring::processor::{Cost, Cpu, Processor};
use num_complex::Complex64;
use serde_json::{Value, json};
use std::error::Error;

/// Pairs of balls, powers of two.
const PAIRS: [u32; 4] = [15, 18, 21, 24];
/// Frequencies of transforms, powers of two.
const FREQUENCIES: [u32; 4] = [12, 15, 18, 21];
/// Knots that are transformed: the bunny's balls at 2^18.
const KNOTS: usize = 617;
/// Pairs, and waves, that one thread of the CPU is timed over: both grow in proportion.
const ON_CORE: (u32, u32) = (21, 12);

/// Prints a table, and returns what it holds.
pub fn measure(card: &Card) -> Result<Value, Box<dyn Error>> {
    println!("## Sums of balls\n");
    println!(
        "| computation | size | ms | share of copies | share of arithmetic | times one CPU thread |"
    );
    println!("|---|---|---|---|---|---|");
    let mut rows = Vec::new();
    let mut row = |name: &str, power: u32, seconds: f64, cost: Cost, core: f64| {
        let [copies, arithmetic] = card.shares(seconds, cost);
        println!(
            "| {name} | 2^{power} | {:.4} | {copies:.2} | {arithmetic:.2} | {:.1} |",
            1e3 * seconds,
            core / seconds
        );
        rows.push(json!({
            "computation": name,
            "size": 1u64 << power,
            "seconds": seconds,
            "bytes": cost.bytes,
            "operations": cost.operations,
            "cpu_seconds": core,
        }));
    };
    let sizes = |powers: [u32; 4]| match card.gpu.is_software() {
        true => vec![powers[0]],
        false => powers.to_vec(),
    };
    let places = [[0.9, 0.1, 0.2]];
    let [first, second] = sets(ON_CORE.0);
    let core = [
        least_seconds(3, || Cpu.pair_sums(&first, &second).map(drop))?,
        least_seconds(3, || Cpu.pair_distances(&first, &second, &places).map(drop))?,
    ];
    for power in sizes(PAIRS) {
        let [first, second] = sets(power);
        let of = |seconds: f64| seconds * f64::from(power as i32 - ON_CORE.0 as i32).exp2();
        let job = Job::pair_sums(&card.gpu, &first, &second)?;
        row(
            "pairs, written",
            power,
            timed(&job)?,
            job.cost(),
            of(core[0]),
        );
        let job = Job::pair_distances(&card.gpu, &first, &second, &places)?;
        row(
            "pairs, streamed",
            power,
            timed(&job)?,
            job.cost(),
            of(core[1]),
        );
    }
    let knots: Vec<[f64; 4]> = balls(KNOTS);
    let weights = vec![Complex64::new(1.0, 0.0); KNOTS];
    let few = frequencies(ON_CORE.1);
    let core = least_seconds(2, || Cpu.wave_sums(&knots, &weights, &few).map(drop))?;
    for power in sizes(FREQUENCIES) {
        let sums = WaveSums::forward(&card.gpu, &knots, &weights, &frequencies(power))?;
        let of_core = core * f64::from(power - ON_CORE.1).exp2();
        row(
            "4D NDFT of 617 knots",
            power,
            timed(&sums.job)?,
            sums.job.cost(),
            of_core,
        );
    }
    println!();
    Ok(rows.into())
}

fn timed<T>(job: &Job<T>) -> Result<f64, GpuError> {
    least_seconds(5, || job.run())
}

/// Two sets of balls with a number of pairs.
fn sets(power: u32) -> [Vec<Knot>; 2] {
    [power / 2, power - power / 2].map(|power| balls(1 << power))
}

/// Balls strewn over a unit cube by the golden ratio's powers.
fn balls(count: usize) -> Vec<Knot> {
    let steps = [0.819_172_513_396, 0.671_043_606_704, 0.549_700_477_902];
    (1..=count)
        .map(|index| {
            let [x, y, z] = steps.map(|step: f64| (step * index as f64).fract());
            [x, y, z, 0.01 + 0.05 * z]
        })
        .collect()
}

/// A box of a number of frequencies, eight of which are along the fourth axis.
fn frequencies(power: u32) -> Vec<[i32; 4]> {
    let [a, b, c] = [0, 1, 2].map(|more| 1 << ((power - 3 + more) / 3));
    let line =
        move |[x, y]: [i32; 2]| (0..c).flat_map(move |z| (0..8).map(move |eta| [x, y, z, eta]));
    (0..a)
        .flat_map(|x| (0..b).map(move |y| [x - a / 2, y - b / 2]))
        .flat_map(line)
        .collect()
}
