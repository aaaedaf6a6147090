use super::*;
use crate::kernel::{KernelOptions, Trim};

fn kernel(low: f64, high: f64) -> RankingKernel {
    RankingKernel::new(KernelOptions::TEST, low, high, 1.0).unwrap()
}

#[test]
fn series_converges_to_the_slices() {
    let kernel = kernel(3.0, 3.8);
    let mut last = usize::MAX;
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-6].into_iter().rev() {
        let (axis, error) = LiftedAxis::for_tolerance(&kernel, tolerance);
        assert!(error <= tolerance);
        assert!(axis.modes() <= last);
        last = axis.modes();
    }
}

/// The square of the affinity function's factor is the weighted sum of the slices' factors.
#[test]
fn the_score_s_factor_is_the_weighted_sum_of_the_slices() {
    let kernel = kernel(3.0, 3.8);
    let axis = LiftedAxis::new(&kernel, 4);
    let weights = kernel.options().slice_weights();
    for k in [-4, 0, 1, 3] {
        let factor = |quantity| axis.fold_factor(&kernel, quantity, k);
        let slices = (0..3).map(|slice| weights[slice] * factor(Quantity::Slice(slice)));
        let sum: Complex64 = slices.sum();
        assert!((factor(Quantity::Score) - sum).norm() < 1e-12 * weights[0].abs());
    }
}

/// The period and the radii sampled were once those of the flat top whatever the trim was. B&I's then met its own
/// image, or was cut: no number of modes brought the series closer than 3e-4 to 1e-2.
#[test]
fn series_converges_with_the_trim_of_behandish_and_ilies() {
    for length in [4.0, 6.0, 9.0] {
        let options = KernelOptions {
            trim: Trim::BehandishIlies { length },
            ..KernelOptions::TEST
        };
        let kernel = RankingKernel::new(options, 3.0, 3.8, 1.0).unwrap();
        for tolerance in [1e-2, 1e-4, 1e-5] {
            let (axis, error) = LiftedAxis::for_tolerance(&kernel, tolerance);
            println!("{length} {tolerance:e}: {error:.1e} with {}", axis.modes());
            assert_eq!(axis.period(), 2.0 * length);
            assert!(error <= tolerance, "{length}: {error:e} at {tolerance:e}");
        }
    }
}

/// Both bases are the same finite sum over eta_k written two ways: they agree to rounding.
#[test]
fn classes_and_modes_are_the_same_sum() {
    let kernel = kernel(3.0, 3.8);
    let axis = LiftedAxis::new(&kernel, 9);
    let (r, s) = (1.61, 1.83);
    let classes = RadiusBasis::Classes([vec![r], vec![s]]);
    let modes = RadiusBasis::Modes;
    for fold in [Quantity::Score, Quantity::Slice(0), Quantity::Slice(2)] {
        for w in [0.0, 0.05, 0.13, 0.22] {
            let direct = classes
                .coupling(&kernel, &axis, fold, (0, 0), 0.25)
                .unwrap()
                .value(w)[0];
            let [na, nb] = [0, 1].map(|side| modes.size(&axis, side));
            let mut sum = 0.0;
            for a in 0..na {
                for b in 0..nb {
                    if let Some(table) = modes.coupling(&kernel, &axis, fold, (a, b), 0.25) {
                        sum += table.value(w)[0]
                            * modes.value(&axis, 0, a, r)
                            * modes.value(&axis, 1, b, s);
                    }
                }
            }
            let mut definition = Complex64::new(0.0, 0.0);
            for k in -9..=9 {
                definition += axis.coefficient(&kernel, w, k)
                    * axis.fold_factor(&kernel, fold, k)
                    * Complex64::cis(-2.0 * PI * axis.eta(k) * (r + s));
            }
            assert!((direct - sum).abs() < 1e-6 * direct.abs().max(1.0));
            assert!((definition.re - sum).abs() < 1e-6 * direct.abs().max(1.0));
            assert!(definition.im.abs() < 1e-9 * direct.abs().max(1.0));
        }
    }
}
