//! The general transform between points and modes, tested against the direct sum and by identities that need no
//! reference.

use knotdock_scoring::transform::Real;
use knotdock_scoring::transform::ndft;
use knotdock_scoring::transform::nufft::{Plan, PlanError, TransformError};
use num_complex::{Complex, Complex64};
use std::f64::consts::PI;

use crate::scene::Numbers;

/// Numbers, points and weights that every run sees alike.
struct Random(Numbers);

impl Random {
    /// In [-1, 1).
    fn next(&mut self) -> f64 {
        2.0 * self.0.next() - 1.0
    }

    fn points<const D: usize>(&mut self, count: usize) -> Vec<[f64; D]> {
        // Over three periods, so that folding is always at work.
        (0..count)
            .map(|_| std::array::from_fn(|_| 1.5 * self.next()))
            .collect()
    }

    fn numbers(&mut self, count: usize) -> Vec<Complex64> {
        (0..count)
            .map(|_| Complex64::new(self.next(), self.next()))
            .collect()
    }
}

fn cast<T: Real>(values: &[Complex64]) -> Vec<Complex<T>> {
    values
        .iter()
        .map(|v| Complex::new(T::of(v.re), T::of(v.im)))
        .collect()
}

fn zeros<T: Real>(count: usize) -> Vec<Complex<T>> {
    vec![Complex::new(T::zero(), T::zero()); count]
}

/// Norm of the difference over the norm of `exact`; the norm itself where that is zero.
fn error<T: Real>(ours: &[Complex<T>], exact: &[Complex64]) -> f64 {
    assert_eq!(ours.len(), exact.len());
    let difference: f64 = ours
        .iter()
        .zip(exact)
        .map(|(a, b)| (Complex64::new(a.re.wide(), a.im.wide()) - b).norm_sqr())
        .sum();
    let norm: f64 = exact.iter().map(|b| b.norm_sqr()).sum();
    if norm == 0.0 {
        difference.sqrt()
    } else {
        (difference / norm).sqrt()
    }
}

fn forward<T: Real, const D: usize>(
    plan: &Plan<T, D>,
    points: &[[f64; D]],
    weights: &[Complex64],
) -> Vec<Complex<T>> {
    let sorted = plan.locate(points).unwrap();
    let mut output = zeros(plan.mode_count());
    plan.forward(&sorted, &cast(weights), &mut plan.workspace(), &mut output)
        .unwrap();
    output
}

fn adjoint<T: Real, const D: usize>(
    plan: &Plan<T, D>,
    points: &[[f64; D]],
    modes: &[Complex64],
) -> Vec<Complex<T>> {
    let sorted = plan.locate(points).unwrap();
    let mut values = zeros(points.len());
    plan.adjoint(&sorted, &cast(modes), &mut plan.workspace(), &mut values)
        .unwrap();
    values
}

/// Both types against the direct sum, complex and real weights, one workspace for all so that leftovers would show.
fn meets_the_direct_sum<T: Real, const D: usize>(
    plan: &Plan<T, D>,
    tolerance: f64,
    points: usize,
    seed: u64,
) {
    let mut random = Random(Numbers(seed));
    let points = random.points::<D>(points);
    let weights = random.numbers(points.len());
    let modes = random.numbers(plan.mode_count());
    let sorted = plan.locate(&points).unwrap();
    let mut work = plan.workspace();
    let mut output = zeros(plan.mode_count());
    let mut values = zeros(points.len());
    let about = format!(
        "{:?} modes, grid {:?}, width {}, {} points, seed {seed}, tolerance {tolerance:e}",
        plan.modes(),
        plan.grid(),
        plan.width(),
        points.len()
    );
    plan.forward(&sorted, &cast(&weights), &mut work, &mut output)
        .unwrap();
    let worst = error(&output, &ndft::forward(&points, &weights, plan.modes()));
    assert!(worst <= tolerance, "forward: {worst:e} at {about}");
    plan.adjoint(&sorted, &cast(&modes), &mut work, &mut values)
        .unwrap();
    let exact = ndft::adjoint(&points, &modes, plan.modes());
    // A single value may happen to be small; sqrt(points) |modes| is the norm that values have on average. The error of
    // one or two values is a draw from a distribution, too: its tail is why they are given twice the tolerance.
    let allowed = if points.len() < 10 {
        2.0 * tolerance
    } else {
        tolerance
    };
    let typical = (exact.len() as f64 * modes.iter().map(|f| f.norm_sqr()).sum::<f64>()).sqrt();
    let norm = exact.iter().map(|v| v.norm_sqr()).sum::<f64>().sqrt();
    let worst = error(&values, &exact) * norm / typical;
    assert!(worst <= allowed, "adjoint: {worst:e} at {about}");
}

#[test]
fn double_precision_meets_swept_tolerances_in_three_dimensions() {
    for (step, tolerance) in [
        1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12,
    ]
    .into_iter()
    .enumerate()
    {
        // Even, odd and prime counts; one mode; fewer modes than the window is wide; grids that round far up.
        for modes in [
            [16, 16, 16],
            [13, 8, 11],
            [1, 2, 31],
            [3, 1, 1],
            [1, 1, 1],
            [5, 40, 1],
            [2, 2, 2],
            [17, 1, 19],
        ] {
            for points in [1, 2, 70] {
                let plan = Plan::<f64, 3>::new(modes, tolerance, points).unwrap();
                meets_the_direct_sum(&plan, tolerance, points, 11 + step as u64);
            }
        }
    }
}

#[test]
fn every_oversampling_meets_the_tolerance_or_refuses() {
    let mut refused = 0;
    for oversampling in [1.1, 1.25, 1.5, 2.0, 3.0] {
        for tolerance in [1e-2, 1e-3, 1e-5, 1e-7, 1e-9, 1e-12] {
            match Plan::<f64, 3>::with_oversampling([20, 21, 23], tolerance, oversampling) {
                Ok(plan) => {
                    for seed in 0..3 {
                        meets_the_direct_sum(&plan, tolerance, 50, seed);
                    }
                }
                Err(PlanError::Tolerance { least, .. }) => {
                    assert!(least > tolerance);
                    refused += 1;
                }
                Err(other) => panic!("{other}"),
            }
        }
    }
    // A window of 16 points at an oversampling of 1.1 cannot do 1e-12; at 2 it can.
    assert!((1..10).contains(&refused), "{refused}");
}

#[test]
fn double_precision_meets_swept_tolerances_in_four_dimensions() {
    for (step, tolerance) in [1e-2, 1e-3, 1e-6, 1e-9, 1e-12].into_iter().enumerate() {
        for modes in [
            [6, 5, 4, 7],
            [1, 3, 2, 5],
            [4, 1, 1, 9],
            [8, 8, 8, 1],
            [1, 1, 1, 1],
        ] {
            let plan = Plan::<f64, 4>::new(modes, tolerance, 25).unwrap();
            meets_the_direct_sum(&plan, tolerance, 25, 5 + step as u64);
        }
    }
}

#[test]
fn single_precision_meets_swept_tolerances() {
    for (step, tolerance) in [1e-2, 1e-3, 1e-4, 1e-5].into_iter().enumerate() {
        for modes in [[32, 30, 17], [64, 3, 5], [1, 2, 31]] {
            let plan = Plan::<f32, 3>::new(modes, tolerance, 60).unwrap();
            meets_the_direct_sum(&plan, tolerance, 60, step as u64);
        }
        for modes in [[6, 5, 4, 7], [4, 1, 1, 9]] {
            let plan = Plan::<f32, 4>::new(modes, tolerance, 25).unwrap();
            meets_the_direct_sum(&plan, tolerance, 25, step as u64);
        }
    }
}

#[test]
fn many_slabs_and_clusters_meet_the_direct_sum() {
    // Points in two tight clusters leave most planes and rows of the grid empty, which the transform skips; a long
    // first axis lets the ring of planes turn several times.
    let mut random = Random(Numbers(3));
    let modes = [90, 12, 10];
    let points: Vec<[f64; 3]> = (0..60)
        .map(|i| std::array::from_fn(|_| [0.31, 0.97][i % 2] + 0.02 * random.next()))
        .collect();
    let weights = random.numbers(points.len());
    for tolerance in [1e-3, 1e-8] {
        let plan = Plan::<f64, 3>::new(modes, tolerance, 60).unwrap();
        let exact = ndft::forward(&points, &weights, modes);
        let ours = forward(&plan, &points, &weights);
        assert!(
            error(&ours, &exact) < tolerance,
            "{:e}",
            error(&ours, &exact)
        );
        let exact_values = ndft::adjoint(&points, &exact, modes);
        assert!(error(&adjoint(&plan, &points, &exact), &exact_values) < tolerance);
    }
}

#[test]
fn types_are_adjoint_to_rounding_whatever_the_tolerance() {
    // <F c, f> = <c, F* f> holds for the approximations as for the exact sums, since one is the other transposed.
    fn check<const D: usize>(modes: [usize; D]) {
        for tolerance in [1e-1, 1e-3, 1e-9] {
            let plan = Plan::<f64, D>::new(modes, tolerance, 40).unwrap();
            let mut random = Random(Numbers(17));
            let points = random.points::<D>(40);
            let weights = random.numbers(40);
            let modes = random.numbers(plan.mode_count());
            let product = |a: &[Complex64], b: &[Complex64]| -> Complex64 {
                a.iter().zip(b).map(|(a, b)| a * b.conj()).sum()
            };
            let (image, values) = (
                forward(&plan, &points, &weights),
                adjoint(&plan, &points, &modes),
            );
            let norm = |a: &[Complex64]| product(a, a).re.sqrt();
            let gap = (product(&image, &modes) - product(&weights, &values)).norm();
            assert!(gap < 1e-13 * norm(&image) * norm(&modes), "{gap:e}");
        }
    }
    check([12, 9, 17]);
    check([1, 30, 2]);
    check([5, 4, 3, 6]);
}

#[test]
fn parseval_holds_on_equispaced_points() {
    // On the points j / n the transform is unitary up to the number of modes: |f|^2 = N |c|^2.
    let modes = [6, 5, 8];
    let points: Vec<[f64; 3]> = (0..240)
        .map(|i| {
            [
                (i / 40) as f64 / 6.0,
                (i / 8 % 5) as f64 / 5.0,
                (i % 8) as f64 / 8.0,
            ]
        })
        .collect();
    let weights = Random(Numbers(23)).numbers(240);
    let energy = |values: &[Complex64]| values.iter().map(|v| v.norm_sqr()).sum::<f64>();
    let plan = Plan::<f64, 3>::new(modes, 1e-10, 240).unwrap();
    let ratio = energy(&forward(&plan, &points, &weights)) / (240.0 * energy(&weights));
    assert!((ratio - 1.0).abs() < 1e-10, "{ratio}");
}

#[test]
fn moving_the_points_turns_the_modes() {
    // f_k of points moved by s is f_k exp(-2 pi i k.s); this also pins the sign and the order of the modes.
    let modes = [9, 4, 7];
    let mut random = Random(Numbers(29));
    let points = random.points::<3>(30);
    let weights = random.numbers(30);
    let shift = [0.137, -0.61, 0.29];
    let moved: Vec<[f64; 3]> = points
        .iter()
        .map(|p| std::array::from_fn(|axis| p[axis] + shift[axis]))
        .collect();
    let plan = Plan::<f64, 3>::new(modes, 1e-9, 30).unwrap();
    let turned: Vec<Complex64> = forward(&plan, &points, &weights)
        .into_iter()
        .enumerate()
        .map(|(index, value)| {
            let k = [index / 28, index / 7 % 4, index % 7];
            let turns: f64 = (0..3)
                .map(|axis| (k[axis] as f64 - (modes[axis] / 2) as f64) * shift[axis])
                .sum();
            value * Complex64::cis(-2.0 * PI * turns)
        })
        .collect();
    assert!(error(&forward(&plan, &moved, &weights), &turned) < 2e-9);
}

#[test]
fn direct_sums_of_one_point_are_plane_waves() {
    let modes = ndft::forward(&[[0.25, 0.5, 0.0]], &[Complex64::new(2.0, 0.0)], [4, 2, 1]);
    // k0 = -2..1 gives exp(-i pi k0 / 2) = -1, i, 1, -i; k1 = -1, 0 gives -1, 1.
    let i = Complex64::i();
    for (index, factor) in [-Complex64::ONE, i, Complex64::ONE, -i]
        .into_iter()
        .enumerate()
    {
        assert!((modes[2 * index] + 2.0 * factor).norm() < 1e-15);
        assert!((modes[2 * index + 1] - 2.0 * factor).norm() < 1e-15);
    }
    let values = ndft::adjoint(&[[0.25, 0.5, 0.0]], &modes, [4, 2, 1]);
    assert!((values[0] - 16.0).norm() < 1e-14);
}

#[test]
fn the_edge_of_the_box_and_periodic_images() {
    // Points on a face lie half in one image of the box, half in the next; 1 - 2^-53 and -1e-300 fold onto the period
    // itself.
    let plan = Plan::<f64, 3>::new([12, 14, 9], 1e-8, 8).unwrap();
    let weights = Random(Numbers(37)).numbers(8);
    let edge = [
        0.0,
        1.0,
        -1.0,
        0.5,
        1.0 - f64::EPSILON / 2.0,
        -1e-300,
        7.0,
        -0.5,
    ];
    let points: Vec<[f64; 3]> = (0..8)
        .map(|i| [edge[i], edge[(i + 3) % 8], edge[(i + 5) % 8]])
        .collect();
    let exact = ndft::forward(&points, &weights, [12, 14, 9]);
    let worst = error(&forward(&plan, &points, &weights), &exact);
    // All points lie on grid points, where aliases of all axes add in step: 1.4e-8 before the plan left room for that.
    assert!(worst < 1e-8, "{worst:e}");
    // An image 2^20 periods away, where the sum is exact in f64, has the same modes to the last bit.
    let near: Vec<[f64; 3]> = (0..8).map(|i| [0.125 * i as f64, 0.75, 0.5]).collect();
    let far: Vec<[f64; 3]> = near
        .iter()
        .map(|p| [p[0] + 1048576.0, p[1] - 1048576.0, p[2]])
        .collect();
    assert_eq!(
        forward(&plan, &near, &weights),
        forward(&plan, &far, &weights)
    );
}

#[test]
fn no_points_and_coincident_points() {
    let plan = Plan::<f64, 3>::new([6, 7, 8], 1e-6, 0).unwrap();
    assert!(
        forward(&plan, &[], &[])
            .iter()
            .all(|value| value.norm() == 0.0)
    );
    assert!(adjoint(&plan, &[], &Random(Numbers(1)).numbers(336)).is_empty());
    // A thousand points at one place are one point with the sum of their weights.
    let weights = Random(Numbers(41)).numbers(1000);
    let many = forward(&plan, &[[0.3, 0.6, 0.9]; 1000], &weights);
    let one = forward(&plan, &[[0.3, 0.6, 0.9]], &[weights.iter().sum()]);
    assert!(error(&many, &one) < 1e-12);
}

#[test]
fn results_do_not_depend_on_what_the_workspace_did_before() {
    let plan = Plan::<f64, 3>::new([20, 6, 9], 1e-6, 50).unwrap();
    let mut random = Random(Numbers(43));
    let points = random.points::<3>(50);
    let weights = random.numbers(50);
    let modes = random.numbers(plan.mode_count());
    let mut sorted = plan.locate(&[[0.5; 3]; 3]).unwrap();
    plan.locate_into(&points, &mut sorted).unwrap();
    let mut work = plan.workspace();
    let (mut output, mut values) = (zeros::<f64>(plan.mode_count()), zeros::<f64>(50));
    for _ in 0..2 {
        plan.forward(&sorted, &weights, &mut work, &mut output)
            .unwrap();
        assert_eq!(output, forward(&plan, &points, &weights));
        plan.adjoint(&sorted, &modes, &mut work, &mut values)
            .unwrap();
        assert_eq!(values, adjoint(&plan, &points, &modes));
    }
}

#[test]
fn bad_input_is_named() {
    assert_eq!(
        Plan::<f64, 3>::new([4, 0, 4], 1e-3, 1).err(),
        Some(PlanError::NoModes { axis: 1 })
    );
    for tolerance in [0.0, 1e-14, -1.0, 1.0, f64::NAN, f64::INFINITY] {
        assert!(
            matches!(
                Plan::<f64, 3>::new([4; 3], tolerance, 1).err(),
                Some(PlanError::Tolerance { .. })
            ),
            "{tolerance}"
        );
    }
    assert!(matches!(
        Plan::<f32, 3>::new([4; 3], 1e-6, 1).err(),
        Some(PlanError::Tolerance { .. })
    ));
    for size in [1 << 21, usize::MAX / 8] {
        assert!(
            matches!(
                Plan::<f64, 3>::new([size; 3], 1e-3, 1).err(),
                Some(PlanError::TooLarge { .. })
            ),
            "{size}"
        );
    }
    for oversampling in [1.0, 0.0, 5.0, f64::NAN] {
        assert!(matches!(
            Plan::<f64, 3>::with_oversampling([4; 3], 1e-3, oversampling).err(),
            Some(PlanError::Oversampling { .. })
        ));
    }
    let plan = Plan::<f64, 3>::new([4, 6, 5], 1e-3, 2).unwrap();
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        match plan.locate(&[[0.0; 3], [0.0, 0.0, value]]) {
            Err(TransformError::Point {
                index: 1, axis: 2, ..
            }) => {}
            other => panic!("{other:?}"),
        }
    }
    let points = plan.locate(&[[0.1; 3], [0.2; 3]]).unwrap();
    let mut work = plan.workspace();
    let mut output = zeros::<f64>(120);
    let length = plan.forward(&points, &zeros(3), &mut work, &mut output);
    assert!(matches!(
        length,
        Err(TransformError::Length {
            expected: 2,
            got: 3,
            ..
        })
    ));
    let length = plan.forward(&points, &zeros(2), &mut work, &mut output[1..]);
    assert!(matches!(
        length,
        Err(TransformError::Length {
            expected: 120,
            got: 119,
            ..
        })
    ));
    let other = Plan::<f64, 3>::new([40, 6, 5], 1e-3, 2).unwrap();
    let foreign = other.forward(&points, &zeros(2), &mut other.workspace(), &mut zeros(1200));
    assert!(matches!(foreign, Err(TransformError::Foreign { .. })));
    let foreign = plan.forward(&points, &zeros(2), &mut other.workspace(), &mut output);
    assert!(matches!(foreign, Err(TransformError::Foreign { .. })));
}
