//! The same computations on a graphics processor, if there is one: wall time on the card alone, input and results there.

use knotdock_scoring::gpu::{ADAPTER_VARIABLE, GpuDevice, GpuError, Job};
use std::time::Instant;

/// Seconds after which no further run starts, once there are `MIN_RUNS` of them.
const ENOUGH: f64 = 0.2;
const MIN_RUNS: usize = 2;
const MAX_RUNS: usize = 300;
/// Waves that are summed at most: some seconds. Of more a share is timed.
const MOST_WAVES: [f64; 2] = [1e12, 1e8];

/// An adapter.
pub struct Card {
    gpu: GpuDevice,
}

impl Card {
    /// The adapter of the usual name, else the best one.
    pub fn open() -> Option<Self> {
        let opened = GpuDevice::open(std::env::var(ADAPTER_VARIABLE).ok().as_deref());
        match opened {
            Ok(gpu) => Some(Self { gpu }),
            Err(error) => {
                println!("no card: {error}\n");
                None
            }
        }
    }

    /// What "card" means in the tables.
    pub fn note(&self) -> String {
        let kind = match self.gpu.is_software() {
            true => "software on this machine's cores, no card",
            false => "wall time on the card alone",
        };
        format!("card: {} ({}), {kind}", self.gpu.name(), self.gpu.backend())
    }

    /// Sums of `terms` waves that are timed at most.
    pub fn most_sums(&self, terms: usize) -> usize {
        let most = MOST_WAVES[usize::from(self.gpu.is_software())];
        ((most / terms.max(1) as f64) as usize).max(1)
    }

    /// What the card measures; `None` if it cannot.
    pub fn measure<R>(&self, task: impl FnOnce(&GpuDevice) -> Result<R, GpuError>) -> Option<R> {
        task(&self.gpu)
            .inspect_err(|error| println!("not on the card: {error}"))
            .ok()
    }
}

/// Seconds of the fastest of several runs.
pub fn seconds<T>(job: &Job<T>) -> Result<f64, GpuError> {
    let (mut best, mut spent) = (f64::INFINITY, 0.0);
    for run in 0..MAX_RUNS {
        if run >= MIN_RUNS && spent > ENOUGH {
            break;
        }
        let start = Instant::now();
        job.run()?;
        let seconds = start.elapsed().as_secs_f64();
        best = best.min(seconds);
        spent += seconds;
    }
    Ok(best)
}
