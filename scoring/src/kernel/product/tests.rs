//! Tests of the product kernel against closed forms, and its two domains against each other.

use super::*;
use crate::kernel::Trim;
use crate::kernel::radial_transform::sinc;

fn options(alpha: f64) -> KernelOptions {
    KernelOptions {
        lambda: 10.0,
        offset: 2.0,
        alpha,
        resolution: 4.0,
        pass_length: 8.0,
        trim: Trim::FlatTop,
    }
}

fn kernel(alpha: f64, band: Band) -> ProductKernel {
    ProductKernel::new(options(alpha), band, 1.9, 3.0).unwrap()
}

/// The limit alpha -> infinity is the lens volume, approached like 1 / alpha: the bump's edge is about radius / alpha
/// wide. Distances cover coincidence, one ball inside the other, crossing, near touch and beyond.
#[test]
fn tends_to_the_lens_volume() {
    let (a, b) = (1.5, 1.9);
    let mut last = f64::INFINITY;
    for alpha in [10.0, 30.0, 100.0, 300.0, 1000.0] {
        let kernel = kernel(alpha, Band::Whole);
        let mut worst: f64 = 0.0;
        for d in [0.0, 1e-6, 0.2, 0.4, 1.0, 1.7, 2.5, 3.3, 3.4, 5.0] {
            let error = (kernel.overlap(d, a, b) - lens_volume(a, b, d)).abs();
            worst = worst.max(error / lens_volume(a, b, 0.0));
        }
        assert!(
            worst * alpha < 6.0 && worst < 0.5 * last,
            "{alpha}: {worst:e}"
        );
        last = worst;
    }
    let sharp = kernel(f64::INFINITY, Band::Whole);
    assert_eq!(sharp.overlap(0.3, a, b), 4.0 / 3.0 * PI * 1.5f64.powi(3));
}

/// Overlap in space and product of transforms are the same function: the quadrature in u against the inverse radial
/// transform.
#[test]
fn space_and_frequency_agree() {
    let kernel = ProductKernel::new(options(2.0), Band::Whole, 1.9, 12.0).unwrap();
    let scale = kernel.overlap(0.0, 1.5, 1.9);
    for d in [0.0, 1e-7, 1e-3, 0.4, 1.0, 2.2, 3.3, 4.0] {
        let step = 1.0 / 40.0;
        let inverse: f64 = (0..480)
            .map(|n| f64::from(n) * step)
            .map(|w| {
                4.0 * PI
                    * w
                    * w
                    * step
                    * sinc(2.0 * w * d)
                    * kernel.coupling(Quantity::Slice(0), 1.5, 1.9, w)
            })
            .sum();
        let direct = kernel.overlap(d, 1.5, 1.9);
        assert!(
            (inverse - direct).abs() < 1e-8 * scale,
            "{d}: {inverse} against {direct}"
        );
    }
    // At w = 0 both say the product of the bumps' volumes.
    let volume = kernel.spectrum(Body::Solid, 1.5, 0.0) * kernel.spectrum(Body::Solid, 1.9, 0.0);
    let integral: f64 = (0..4000)
        .map(|i| 1e-3 * f64::from(i))
        .map(|d| 4.0 * PI * d * d * kernel.overlap(d, 1.5, 1.9) * 1e-3)
        .sum();
    assert!((integral / volume - 1.0).abs() < 1e-6);
}

#[test]
fn tables_follow_the_definition_and_end_where_they_say() {
    for band in [Band::Whole, Band::LowPass] {
        for alpha in [2.0, 4.0] {
            let kernel = kernel(alpha, band);
            let table = kernel.pair_table(1.5, 1.9);
            let (peak_score, _) = peak_score_and_reach(&table, 1e-3);
            let mut worst: f64 = 0.0;
            for i in 0..200 {
                let d = 0.0137 + 0.05 * f64::from(i);
                let exact = kernel.value(d, 1.5, 1.9);
                for (ours, exact) in table.value(d).into_iter().zip(exact) {
                    worst = worst.max((ours - exact).abs());
                }
            }
            let tail = table.value(0.999 * table.end())[3].abs();
            assert!(
                worst < 1e-6 * peak_score && tail < 1e-7 * peak_score,
                "{band:?} {alpha}: {worst:e} {tail:e}"
            );
        }
    }
}

/// The four products of the double skin are the three slices with the weights of the score, in either domain.
#[test]
fn score_is_the_weighted_slices() {
    let kernel = kernel(2.0, Band::LowPass);
    let weights = kernel.options().slice_weights();
    for w in [0.0, 0.05, 0.12, 0.2, 0.24] {
        let sum: f64 = (0..3)
            .map(|i| weights[i] * kernel.coupling(Quantity::Slice(i), 1.5, 1.9, w))
            .sum();
        let score = kernel.coupling(Quantity::Score, 1.5, 1.9, w);
        assert!((sum - score).abs() < 1e-12 * score.abs().max(1.0));
    }
    assert_eq!(kernel.low_pass(0.25), 0.0);
}

#[test]
fn refuses_what_defines_no_kernel() {
    assert!(ProductKernel::new(options(0.0), Band::Whole, 1.9, 1.0).is_err());
    assert!(ProductKernel::new(options(2.0), Band::Whole, f64::NAN, 1.0).is_err());
    assert!(ProductKernel::new(options(2.0), Band::Whole, 1.9, 0.0).is_err());
}

/// Two half-passed bumps about one point, multiplied and integrated, are the low-passed kernel of the pair at distance
/// zero (Parseval): the halves share the low-pass.
#[test]
fn half_passed_bumps_multiply_to_the_pair_kernel() {
    let kernel = kernel(2.0, Band::LowPass);
    let (r, s) = (1.5, 1.9);
    let [first, second] = [r, s].map(|radius| kernel.half_passed(radius, 24.0));
    let (end, count) = (first.end().min(second.end()), 20_000);
    let step = end / f64::from(count);
    let mut sums = [0.0; 2];
    for d in (0..count).map(|i| (f64::from(i) + 0.5) * step) {
        let (a, b) = (first.value(d), second.value(d));
        for layer in 0..2 {
            sums[layer] += 4.0 * PI * d * d * a[layer] * b[layer] * step;
        }
    }
    let [plain, _, grown, _] = kernel.value(0.0, r, s);
    assert!((sums[0] / plain - 1.0).abs() < 1e-4, "{sums:?} {plain}");
    assert!((sums[1] / grown - 1.0).abs() < 1e-4, "{sums:?} {grown}");
}
