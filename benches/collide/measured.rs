//! Times of questions on a path, and their spread: median, 99% and worst.

use std::hint::black_box;
use std::time::Instant;

/// Microseconds of poses, by number.
#[derive(Clone, Debug, Default)]
pub struct Times {
    /// Numbers of the poses.
    pub poses: Vec<usize>,
    /// Microseconds of each.
    pub micros: Vec<f64>,
}

/// Median, 99% and worst.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    pub median: f64,
    pub most: f64,
    pub worst: f64,
}

impl Times {
    /// Asks about every `stride`th pose, `runs` times over: each time is the least, since other programs take time too.
    /// The poses come in their order, so what a program keeps from one pose to the next helps it.
    pub fn of<R>(
        count: usize,
        stride: usize,
        runs: usize,
        mut ask: impl FnMut(usize) -> R,
    ) -> Self {
        let poses: Vec<usize> = (0..count).step_by(stride.max(1)).collect();
        let mut micros = vec![f64::INFINITY; poses.len()];
        for _ in 0..runs.max(1) {
            for (pose, micros) in poses.iter().zip(&mut micros) {
                let start = Instant::now();
                black_box(ask(*pose));
                *micros = micros.min(1e6 * start.elapsed().as_secs_f64());
            }
        }
        Self { poses, micros }
    }

    /// The spread over the poses that `keep` takes, if any.
    pub fn spread(&self, keep: impl Fn(usize) -> bool) -> Option<Spread> {
        let poses = self.poses.iter().zip(&self.micros);
        let mut kept: Vec<f64> = poses
            .filter(|(pose, _)| keep(**pose))
            .map(|(_, micros)| *micros)
            .collect();
        kept.sort_by(f64::total_cmp);
        let at = |share: f64| kept[(share * (kept.len() - 1) as f64).round() as usize];
        (!kept.is_empty()).then(|| Spread {
            median: at(0.5),
            most: at(0.99),
            worst: at(1.0),
        })
    }
}
