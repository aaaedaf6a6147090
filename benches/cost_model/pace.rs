//! How fast the machine is at a moment: a fixed piece of work, timed.
//!
//! Virtual machines share cores and caches with others, and clocks rise and fall: the same docking may take half as
//! long again a minute later. A cost model cannot know that, so a time is printed with that of the same work just
//! before and after.

use std::sync::Arc;
use std::time::Instant;

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

/// Edge of the cube whose lines are transformed, 2 MiB a thread, and how often: a fifth of a second, longer than a
/// moment that is by chance fast or slow.
const EDGE: usize = 64;
const TIMES: usize = 500;

/// The work: transforms of all lines of a cube, on each thread.
pub struct Pace {
    transform: Arc<dyn Fft<f32>>,
    threads: usize,
}

impl Pace {
    pub fn new(threads: usize) -> Self {
        Self {
            transform: FftPlanner::new().plan_fft_forward(EDGE),
            threads,
        }
    }

    /// Seconds that it takes now.
    pub fn seconds(&self) -> f64 {
        let start = Instant::now();
        std::thread::scope(|scope| {
            for _ in 0..self.threads {
                scope.spawn(|| self.work());
            }
        });
        start.elapsed().as_secs_f64()
    }

    fn work(&self) {
        let mut cube = vec![Complex::new(1.0f32, 0.0); EDGE * EDGE * EDGE];
        let mut scratch = vec![Complex::default(); self.transform.get_inplace_scratch_len()];
        // What a transform of length n makes larger by root n is taken back, so that nothing overflows.
        let scale = 1.0 / (EDGE as f32).sqrt();
        for _ in 0..TIMES {
            self.transform.process_with_scratch(&mut cube, &mut scratch);
            for value in &mut cube {
                *value *= scale;
            }
        }
        std::hint::black_box(cube);
    }
}
