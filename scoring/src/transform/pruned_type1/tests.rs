//! The pruned transform against the direct sum.

use super::*;
use crate::test_support::Numbers;
use crate::transform::ndft::ndft_3d;

fn points(count: usize, radius: f64, seed: u64) -> (Vec<[f64; 3]>, Vec<f64>) {
    let mut numbers = Numbers(seed);
    let mut next = || numbers.next();
    let points = (0..count)
        .map(|_| std::array::from_fn(|_| radius * (2.0 * next() - 1.0)))
        .collect();
    let weights = (0..2 * count).map(|_| 2.0 * next() - 1.0).collect();
    (points, weights)
}

fn worst<T: Real>(tolerance: f64, oversampling: f64) -> f64 {
    let size = [20, 18, 24];
    let lengths = [40.0, 36.0, 48.0];
    let modes = Arc::new(ModeSet::new(size, lengths, 0.24));
    let fine = size.map(|n| crate::transform::fast_size((n as f64 * oversampling).ceil() as usize));
    let width = SpreadingKernel::<T>::width_for(tolerance, oversampling);
    let radius = 5.0;
    let extent = [0, 1, 2].map(|axis| radius * fine[axis] as f64 / lengths[axis]);
    let forward = Forward::<T>::new(Arc::clone(&modes), fine, width, extent, 2);
    let (points, weights) = points(40, radius, 7);
    let mut work = forward.workspace();
    let mut output = vec![Complex::new(T::zero(), T::zero()); 2 * modes.count];
    let cast: Vec<T> = weights.iter().map(|&w| T::of(w)).collect();
    forward.transform(&points, &cast, &mut work, &mut output);
    let center = forward.center();
    let scale = forward.cells_per_length();
    let shifted: Vec<[f64; 3]> = points
        .iter()
        .map(|p| [0, 1, 2].map(|axis| p[axis] + center[axis] / scale[axis]))
        .collect();
    let mut error: f64 = 0.0;
    let mut largest: f64 = 0.0;
    for component in 0..2 {
        let of_field: Vec<f64> = weights.iter().skip(component).step_by(2).copied().collect();
        modes.for_each(|mode, w, _| {
            let exact = ndft_3d(&shifted, &of_field, w);
            let ours = output[component * modes.count + mode];
            error = error.max((exact - Complex::new(ours.re.wide(), ours.im.wide())).norm());
            largest = largest.max(exact.norm());
        });
    }
    error / largest
}

#[test]
fn meets_the_direct_sum_over_swept_tolerances() {
    for oversampling in [1.25, 1.5, 2.0] {
        for tolerance in [1e-2, 1e-3, 1e-4, 1e-6, 1e-8] {
            if SpreadingKernel::<f64>::width_for(tolerance, oversampling) >= MAX_WIDTH {
                continue;
            }
            let error = worst::<f64>(tolerance, oversampling);
            assert!(error < tolerance, "{tolerance} at {oversampling}: {error}");
        }
        for tolerance in [1e-2, 1e-3, 1e-5] {
            let error = worst::<f32>(tolerance, oversampling);
            assert!(
                error < tolerance,
                "f32 {tolerance} at {oversampling}: {error}"
            );
        }
    }
}
