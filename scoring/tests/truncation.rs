//! Truncating a whole correlation to m' modes: the bound holds at every voxel, the estimate is near the error's root mean square, and fewer
//! modes are never claimed to be better. Measured against the untruncated correlation of the same engine, voxel by voxel.

use knotdock_scoring::engine::cpu::Folded;
use knotdock_scoring::engine::{CpuEngine, Dominance, EngineOptions, Plan, Truncation};
use knotdock_scoring::kernel::{Band, KernelOptions, Trim};
use knotdock_scoring::lifted_axis::Fold;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Knots;
use std::sync::Arc;

fn cloud(count: usize, size: f64, seed: u64) -> Knots {
    let mut state = seed;
    let mut next = move || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let centers = (0..count)
        .map(|_| std::array::from_fn(|_| size * next()))
        .collect();
    Knots::new(
        centers,
        (0..count).map(|i| [1.5, 1.7, 1.9][i % 3]).collect(),
    )
    .unwrap()
}

#[test]
fn bound_holds_and_estimate_is_near() {
    let (a, b) = (cloud(120, 18.0, 1), cloud(50, 12.0, 2));
    let options = EngineOptions {
        kernel: KernelOptions {
            lambda: 10.0,
            offset: 2.0,
            alpha: 2.0,
            resolution: 4.0,
            pass_length: 8.0,
            trim: Trim::FlatTop,
        },
        spacing: None,
        tolerance: 1e-3,
        rank: None,
    };
    // Both kernels go through the same truncation.
    for plan in [
        Plan::new(&a, &b, options).unwrap(),
        Plan::product(&a, &b, options, Band::LowPass).unwrap(),
    ] {
        let plan = Arc::new(plan);
        let folded = Folded::<f64>::new(&plan, &a, &b, Fold::Score);
        let rank = folded.full_rank();
        let whole = CpuEngine::new(Arc::clone(&plan), &folded, &b, rank);
        let mut work = whole.workspace();
        let rotations = [[1.0, 0.0, 0.0, 0.0], [0.3, -0.2, 0.8, 0.4]]
            .map(|q| Pose::from_parts(q, [0.0; 3]).rotation);
        for dominance in [Dominance::LowFrequency, Dominance::Magnitude] {
            let mut last = f64::INFINITY;
            for modes in [0, 100, 512, 4096, 8192, usize::MAX] {
                let truncation = Truncation::new(&plan, &folded, dominance, modes);
                assert!(truncation.modes <= modes);
                let engine =
                    CpuEngine::new(Arc::clone(&truncation.plan), &truncation.folded, &b, rank);
                let mut own = engine.workspace();
                let (mut squares, mut worst, mut count) = (0.0, 0.0f64, 0.0);
                for rotation in &rotations {
                    whole.correlate(rotation, &mut work);
                    engine.correlate(rotation, &mut own);
                    for (x, y) in work.grid.iter().zip(&own.grid) {
                        squares += (x - y) * (x - y);
                        worst = worst.max((x - y).abs());
                        count += 1.0;
                    }
                }
                let rms = f64::sqrt(squares / count);
                println!(
                    "{dominance:?} {}: rms {rms:.3e} (estimate {:.3e}), worst {worst:.3e} (bound {:.3e})",
                    truncation.modes, truncation.estimate, truncation.bound
                );
                let rounding = 1e-8 * work.grid.iter().fold(0.0f64, |a, b| a.max(b.abs()));
                assert!(worst <= truncation.bound + rounding);
                assert!(truncation.bound <= last);
                last = truncation.bound;
                // Knots are in phase at the lowest modes, where the mean over random places says too little; past those it is near.
                if modes >= 4096 {
                    assert!(rms <= 2.0 * truncation.estimate + rounding);
                    assert!(truncation.estimate <= 3.0 * rms + rounding);
                }
            }
        }
    }
}
