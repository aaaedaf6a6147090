//! Times that a busy machine disturbs little: processor time of this thread, the least of several runs.

use cpu_time::ThreadTime;
use std::hint::black_box;

/// Seconds of processor time after which no further run starts, once there are `MIN_RUNS` of them.
const ENOUGH: f64 = 0.2;
const MIN_RUNS: usize = 2;
const MAX_RUNS: usize = 300;

/// Processor seconds of one call, and its result.
pub fn timed<R>(task: impl FnOnce() -> R) -> (f64, R) {
    let start = ThreadTime::now();
    let result = black_box(task());
    (start.elapsed().as_secs_f64(), result)
}

/// Processor seconds of the fastest of several calls.
pub fn least<R>(mut task: impl FnMut() -> R) -> f64 {
    let (mut best, mut spent) = (f64::INFINITY, 0.0);
    for run in 0..MAX_RUNS {
        if run >= MIN_RUNS && spent > ENOUGH {
            break;
        }
        let (seconds, _) = timed(&mut task);
        best = best.min(seconds);
        spent += seconds;
    }
    best
}
