//! Time of the general transform between points and modes, three- and four-dimensional, in double precision on one
//! thread.
//!
//! `cargo bench --bench nfft` prints medians over 15 runs of sorting the points and of forward and adjoint execution.
//! Times are by the wall clock and the thread's own CPU time; the error is against the direct sum at 200 modes.
//!
//! With `--serve` it does one thing for each line on standard input and answers with one line, so that
//! `scripts/reference/finufft_reference.py` can alternate it with other programs run by run, on the same numbers:
//!
//! - `plan FOLDER TOLERANCE N1 N2 N3 [N4]`: reads `points.bin` (f64, D to a point, in units of the period) and
//!   `weights.bin` (f64, re and im) from the folder, and plans. It answers with grid, window width, and seconds of
//!   planning.
//! - `run`: sorts and executes forward once; answers `WALL_SORT WALL_FORWARD CPU_SORT CPU_FORWARD`, in seconds.
//! - `write FILE`: writes the modes of the last run (f64, re and im); answers `written`.

use cpu_time::ThreadTime;
use knotdock_scoring::transform::nufft::{Plan, SortedPoints, Workspace};
use num_complex::Complex64;
use std::error::Error;
use std::io::{BufRead, Write};
use std::path::Path;
use std::time::Instant;

const RUNS: usize = 15;

fn main() -> Result<(), Box<dyn Error>> {
    if std::env::args().any(|argument| argument == "--serve") {
        return serve();
    }
    println!("medians of {RUNS} runs in ms, wall clock (CPU time); relative error in the 2-norm");
    for tolerance in [1e-3, 1e-6] {
        table([64; 3], 3_000, tolerance)?;
        table([128; 3], 100_000, tolerance)?;
        table([16; 4], 3_000, tolerance)?;
        table([32; 4], 3_000, tolerance)?;
    }
    Ok(())
}

/// Wall-clock and CPU seconds that a piece of work takes.
fn timed<R>(work: impl FnOnce() -> R) -> (R, [f64; 2]) {
    let (wall, cpu) = (Instant::now(), ThreadTime::now());
    let result = work();
    let cpu = cpu.elapsed().as_secs_f64();
    (result, [wall.elapsed().as_secs_f64(), cpu])
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// One row of the table: random points and weights.
fn table<const D: usize>(
    modes: [usize; D],
    count: usize,
    tolerance: f64,
) -> Result<(), Box<dyn Error>> {
    let mut state = 1u64;
    let mut random = move || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let points: Vec<[f64; D]> = (0..count)
        .map(|_| std::array::from_fn(|_| random()))
        .collect();
    let weights: Vec<Complex64> = (0..count)
        .map(|_| Complex64::new(random(), random()))
        .collect();
    let mut case = Case::new(modes, tolerance, points, weights)?;
    let mut values = case.weights.clone();
    let mut times: [[Vec<f64>; 2]; 3] = Default::default();
    for _ in 0..RUNS {
        let [sort, forward] = case.run()?;
        let (result, adjoint) = timed(|| {
            case.plan
                .adjoint(&case.sorted, &case.output, &mut case.work, &mut values)
        });
        result?;
        for (times, seconds) in times.iter_mut().zip([sort, forward, adjoint]) {
            times[0].push(seconds[0]);
            times[1].push(seconds[1]);
        }
    }
    let [sort, forward, adjoint] = times.map(|pair| pair.map(|seconds| 1e3 * median(seconds)));
    println!(
        "{modes:?} modes, {count} points, {tolerance:.0e}: grid {:?}, width {}; sort {:.2} ({:.2}), \
         forward {:.2} ({:.2}), adjoint {:.2} ({:.2}); error {:.1e}",
        case.plan.grid(),
        case.plan.width(),
        sort[0],
        sort[1],
        forward[0],
        forward[1],
        adjoint[0],
        adjoint[1],
        case.error()
    );
    Ok(())
}

/// A planned transform with its input and output.
struct Case<const D: usize> {
    plan: Plan<f64, D>,
    points: Vec<[f64; D]>,
    weights: Vec<Complex64>,
    sorted: SortedPoints<D>,
    work: Workspace<f64, D>,
    output: Vec<Complex64>,
}

impl<const D: usize> Case<D> {
    fn new(
        modes: [usize; D],
        tolerance: f64,
        points: Vec<[f64; D]>,
        weights: Vec<Complex64>,
    ) -> Result<Self, Box<dyn Error>> {
        let plan = Plan::new(modes, tolerance, points.len())?;
        let sorted = plan.locate(&points)?;
        let work = plan.workspace();
        let output = vec![Complex64::default(); plan.mode_count()];
        Ok(Self {
            plan,
            points,
            weights,
            sorted,
            work,
            output,
        })
    }

    /// [wall, CPU] seconds of sorting and of the forward transform.
    fn run(&mut self) -> Result<[[f64; 2]; 2], Box<dyn Error>> {
        let (result, sort) = timed(|| self.plan.locate_into(&self.points, &mut self.sorted));
        result?;
        let (result, forward) = timed(|| {
            self.plan.forward(
                &self.sorted,
                &self.weights,
                &mut self.work,
                &mut self.output,
            )
        });
        result?;
        Ok([sort, forward])
    }

    /// Relative error at 200 modes strewn over the array.
    fn error(&self) -> f64 {
        let modes = self.plan.modes();
        let (mut difference, mut norm) = (0.0, 0.0);
        for sample in 0..200 {
            let index = (sample * 1_000_003 + 77) % self.output.len();
            let mut rest = index;
            let mut k = [0.0; D];
            for axis in (0..D).rev() {
                k[axis] = (rest % modes[axis]) as f64 - (modes[axis] / 2) as f64;
                rest /= modes[axis];
            }
            let exact: Complex64 = self
                .points
                .iter()
                .zip(&self.weights)
                .map(|(x, c)| {
                    let turns: f64 = x.iter().zip(k).map(|(x, k)| x * k).sum();
                    c * Complex64::cis(-2.0 * std::f64::consts::PI * turns)
                })
                .sum();
            difference += (self.output[index] - exact).norm_sqr();
            norm += exact.norm_sqr();
        }
        (difference / norm).sqrt()
    }
}

/// A case of either dimension.
enum Served {
    Three(Box<Case<3>>),
    Four(Box<Case<4>>),
}

fn serve() -> Result<(), Box<dyn Error>> {
    let mut served: Option<Served> = None;
    let mut answer = std::io::stdout();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let words: Vec<&str> = line.split_whitespace().collect();
        match (words.as_slice(), &mut served) {
            (["plan", folder, tolerance, modes @ ..], _) => {
                let modes = modes
                    .iter()
                    .map(|n| n.parse())
                    .collect::<Result<Vec<usize>, _>>()?;
                let (case, seconds) = timed(|| -> Result<Served, Box<dyn Error>> {
                    let (folder, tolerance) = (Path::new(folder), tolerance.parse()?);
                    Ok(
                        if let Ok(modes) = <[usize; 3]>::try_from(modes.as_slice()) {
                            Served::Three(Box::new(load(folder, modes, tolerance)?))
                        } else {
                            Served::Four(Box::new(load(
                                folder,
                                modes.as_slice().try_into()?,
                                tolerance,
                            )?))
                        },
                    )
                });
                let case = case?;
                let (grid, width) = match &case {
                    Served::Three(case) => (case.plan.grid().to_vec(), case.plan.width()),
                    Served::Four(case) => (case.plan.grid().to_vec(), case.plan.width()),
                };
                writeln!(answer, "grid {grid:?} width {width} seconds {}", seconds[0])?;
                served = Some(case);
            }
            (["run"], Some(case)) => {
                let [sort, forward] = match case {
                    Served::Three(case) => case.run()?,
                    Served::Four(case) => case.run()?,
                };
                writeln!(
                    answer,
                    "{} {} {} {}",
                    sort[0], forward[0], sort[1], forward[1]
                )?;
            }
            (["write", file], Some(case)) => {
                let output = match case {
                    Served::Three(case) => &case.output,
                    Served::Four(case) => &case.output,
                };
                let bytes: Vec<u8> = output
                    .iter()
                    .flat_map(|f| [f.re, f.im])
                    .flat_map(f64::to_le_bytes)
                    .collect();
                std::fs::write(file, bytes)?;
                writeln!(answer, "written")?;
            }
            _ => return Err(format!("not understood: {line}").into()),
        }
        answer.flush()?;
    }
    Ok(())
}

fn load<const D: usize>(
    folder: &Path,
    modes: [usize; D],
    tolerance: f64,
) -> Result<Case<D>, Box<dyn Error>> {
    let numbers = |name: &str| -> Result<Vec<f64>, Box<dyn Error>> {
        let bytes = std::fs::read(folder.join(name))?;
        Ok(bytes
            .as_chunks::<8>()
            .0
            .iter()
            .map(|&bytes| f64::from_le_bytes(bytes))
            .collect())
    };
    let points = numbers("points.bin")?.as_chunks::<D>().0.to_vec();
    let weights = numbers("weights.bin")?
        .as_chunks::<2>()
        .0
        .iter()
        .map(|&[re, im]| Complex64::new(re, im))
        .collect();
    Case::new(modes, tolerance, points, weights)
}
