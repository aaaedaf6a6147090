//! The computations of `processor` on a graphics processor against those on the CPU in double precision.

use crate::gpu::adapter::adapter;
use crate::scene::Numbers;
use knotdock_scoring::gpu::{GpuDevice, GpuError, WaveSums};
use knotdock_scoring::minkowski::{Knot, Node};
use knotdock_scoring::processor::{Cpu, Processor};
use knotdock_scoring::transform::nufft::Plan;
use num_complex::Complex64;

/// Balls in a cube of edge `size` about a place, radii from a tenth to a half of a unit.
fn balls(count: usize, size: f64, about: Node, seed: u64) -> Vec<Knot> {
    let mut numbers = Numbers(seed);
    let ball = |_| {
        let [x, y, z] = about.map(|middle| middle + size * (numbers.next() - 0.5));
        [x, y, z, 0.1 + 0.4 * numbers.next()]
    };
    (0..count).map(ball).collect()
}

/// Points in units of the period, some periods away too.
fn points<const D: usize>(count: usize, seed: u64) -> Vec<[f64; D]> {
    let mut numbers = Numbers(seed);
    (0..count)
        .map(|_| std::array::from_fn(|_| 5.0 * (numbers.next() - 0.5)))
        .collect()
}

fn weights(count: usize, seed: u64) -> Vec<Complex64> {
    let weight = |[re, im]: [f64; 2]| Complex64::new(re, im);
    points(count, seed).into_iter().map(weight).collect()
}

/// Frequencies of all sizes up to `most`.
fn frequencies<const D: usize>(count: usize, most: f64, seed: u64) -> Vec<[i32; D]> {
    let of = |x: [f64; D]| x.map(|part| (0.4 * most * part) as i32);
    points(count, seed).into_iter().map(of).collect()
}

fn sum_of_sizes(weights: &[Complex64]) -> f64 {
    weights.iter().map(|weight| weight.norm()).sum()
}

fn worst<T: Copy>(ours: &[T], theirs: &[T], distance: impl Fn(T, T) -> f64) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let pairs = ours.iter().zip(theirs);
    pairs.map(|(a, b)| distance(*a, *b)).fold(0.0, f64::max)
}

/// Coordinates about the middles are at most E / 2 and rounded by at most E 2^-25 each, and so is their sum; WGSL may round
/// either way, which doubles it: 4 E 2^-24 bounds a coordinate's error. Far from the origin the CPU's own digits are
/// fewer.
#[test]
fn written_sums_of_all_pairs() {
    let Some(gpu) = adapter() else { return };
    assert_eq!(
        gpu.pair_sums(&[[1.0, 2.0, -3.0, 0.5]], &[[0.25, -1.0, 4.0, 0.125]]),
        Ok(vec![[1.25, 1.0, 1.0, 0.625]])
    );
    for offset in [0.0, 1e6] {
        let first = balls(37, 10.0, [offset, 0.0, 1.0], 1);
        let second = balls(131, 6.0, [0.0, -offset, 2.0], 2);
        let ours = gpu.pair_sums(&first, &second).unwrap();
        let theirs = Cpu.pair_sums(&first, &second).unwrap();
        let error = worst(&ours, &theirs, |a, b| {
            (0..4).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max)
        });
        let bound = 4.0 * 10.0 * 0.5f64.powi(24) + 4.0 * f64::EPSILON * offset;
        assert!(error <= bound, "{offset}: {error}");
        // Divided among buffers of 3 rows, the last of 1.
        let divided = gpu.with_buffers_of(16 * 131 * 3 + 100);
        assert_eq!(divided.pair_sums(&first, &second).unwrap(), ours);
        let refused = gpu.with_buffers_of(16 * 130).pair_sums(&first, &second);
        assert!(matches!(refused, Err(GpuError::TooSmall { .. })));
    }
    assert_eq!(gpu.pair_sums(&[], &balls(3, 1.0, [0.0; 3], 1)), Ok(vec![]));
    assert_eq!(gpu.pair_sums(&balls(3, 1.0, [0.0; 3], 1), &[]), Ok(vec![]));
}

/// Three coordinates of p - a - b, each of three numbers up to E / 2 rounded, and of two differences: an error of 5 E
/// 2^-24 by axis, sqrt(3) times that in all; a few roundings of the distance (up to 2 E) and radii come to it: 25 E 2^-24.
#[test]
fn streamed_distances_to_sums_of_pairs() {
    let Some(gpu) = adapter() else { return };
    let one = [[1.0, 2.0, -3.0, 0.5]];
    assert_eq!(
        gpu.pair_distances(&one, &one, &[[2.0, 4.0, -4.0], [2.0, 1.0, -10.0]]),
        Ok(vec![1.0, 4.0])
    );
    for (a, b, offset) in [(1, 1, 0.0), (130, 700, 0.0), (1300, 129, 1e6)] {
        let first = balls(a, 10.0, [offset, 0.0, 1.0], 1);
        let second = balls(b, 6.0, [0.0, -offset, 2.0], 2);
        let places: Vec<Node> = points(33, 3)
            .into_iter()
            .map(|[x, y, z]: Node| [4.0 * x + offset, 4.0 * y - offset, 4.0 * z + 3.0])
            .collect();
        let ours = gpu.pair_distances(&first, &second, &places).unwrap();
        let theirs = Cpu.pair_distances(&first, &second, &places).unwrap();
        assert!(a == 1 || theirs.iter().any(|&x| x < 0.0) && theirs.iter().any(|&x| x > 0.0));
        let error = worst(&ours, &theirs, |a, b| (a - b).abs());
        println!("{a} x {b}: {error:.1e}");
        assert!(error <= 25.0 * 12.0 * 0.5f64.powi(24) + 8.0 * f64::EPSILON * offset);
        let again = gpu.pair_distances(&first, &second, &places).unwrap();
        assert_eq!(again, ours);
    }
    let some = balls(3, 1.0, [0.0; 3], 1);
    let nothing = gpu.pair_distances(&some, &[], &[[0.0; 3]]);
    assert_eq!(nothing, Ok(vec![f64::INFINITY]));
    assert_eq!(gpu.pair_distances(&some, &some, &[]), Ok(vec![]));
}

/// The bound that the sums state, in three and four dimensions and for frequencies up to a million, where a phase in
/// single precision would have no digit left. The measured error is far smaller: rounding errors seldom add up.
#[test]
fn sums_of_waves() {
    let Some(gpu) = adapter() else { return };
    fn check<const D: usize>(gpu: &GpuDevice, count: usize, most: f64, modes: usize) {
        let (x, c) = (points::<D>(count, 1), weights(count, 2));
        let k = frequencies::<D>(modes, most, 3);
        let sums = WaveSums::forward(gpu, &x, &c, &k).unwrap();
        sums.job.run().unwrap();
        let ours = sums.job.read().unwrap();
        let theirs = Cpu.wave_sums(&x, &c, &k).unwrap();
        let error = worst(&ours, &theirs, |a, b| (a - b).norm());
        let size = sum_of_sizes(&c);
        println!(
            "{D} axes, {count} points, |k| < {most:e}: {:.1e} of {:.1e}",
            error / size,
            sums.rounding / size
        );
        assert!(error <= sums.rounding);
        // Far below the bound, where the phases are exact.
        assert!(most > 1e3 || error < 1e-6 * size);
        sums.job.run().unwrap();
        assert_eq!(sums.job.read().unwrap(), ours);
        // Another number of frequencies divides the points otherwise; buffers of 8 chunks of 128.
        let divided = gpu.with_buffers_of((24 * count).max(1 << 13));
        let error = worst(&divided.wave_sums(&x, &c, &k).unwrap(), &ours, |a, b| {
            (a - b).norm()
        });
        assert!(error <= sums.rounding);
    }
    check::<3>(&gpu, 1, 60.0, 1);
    check::<3>(&gpu, 300, 60.0, 1000);
    check::<4>(&gpu, 1111, 30.0, 257);
    check::<3>(&gpu, 129, 1e6, 129);
    let c = [Complex64::new(0.25, -2.0)];
    let at_origin = gpu.wave_sums(&[[0.0; 3]], &c, &[[0, 5, -7], [1 << 30, 3, 9]]);
    assert_eq!(at_origin, Ok(vec![c[0]; 2]));
    // exp(-2 pi i / 4) = -i.
    let quarter = gpu.wave_sums(&[[0.25, 0.0]], &[Complex64::new(1.0, 0.0)], &[[1, 9]]);
    assert_eq!(quarter, Ok(vec![Complex64::new(0.0, -1.0)]));
    assert_eq!(
        gpu.wave_sums::<3>(&[], &[], &[[1, 2, 3]]),
        Ok(vec![Complex64::default()])
    );
    assert_eq!(gpu.wave_sums::<3>(&[[0.0; 3]], &c, &[]), Ok(vec![]));
    let refused = gpu.wave_sums(&[[f64::NAN; 3]], &c, &[[0; 3]]);
    assert!(matches!(refused, Err(GpuError::Input(_))));
}

/// The adjoint is the forward sum's: <F c, f> = <c, F* f>; and a card's hits are a part of the CPU's, which lack only
/// values within both roundings of the bound.
#[test]
fn values_and_hits_of_many_translations() {
    let Some(gpu) = adapter() else { return };
    let (k, modes) = (frequencies::<3>(200, 20.0, 4), weights(200, 5));
    let x = points::<3>(10_001, 6);
    let ours = gpu.wave_values(&k, &modes, &x).unwrap();
    let theirs = Cpu.wave_values(&k, &modes, &x).unwrap();
    let size = sum_of_sizes(&modes);
    let error = worst(&ours, &theirs, |a, b| (a - b).abs());
    println!("values: {:.1e}", error / size);
    assert!(error < 1e-6 * size);

    let c = weights(x.len(), 7);
    let forward = gpu.wave_sums(&x, &c, &k).unwrap();
    let adjoint = WaveSums::adjoint(&gpu, &k, &modes, &x).unwrap();
    adjoint.job.run().unwrap();
    let dot = |a: &[Complex64], b: &[Complex64]| -> Complex64 {
        a.iter().zip(b).map(|(a, b)| a * b.conj()).sum()
    };
    let (left, right) = (dot(&forward, &modes), dot(&c, &adjoint.job.read().unwrap()));
    assert!((left - right).norm() < 1e-6 * size * sum_of_sizes(&c));

    let bound = 0.1 * size;
    let hits = gpu.wave_hits(&k, &modes, &x, bound).unwrap();
    let exact = Cpu.wave_hits(&k, &modes, &x, bound).unwrap();
    println!("hits: {} of {}", hits.count(), exact.count());
    assert!(hits.count() > 10 && exact.count() < x.len() / 2);
    for (index, value) in theirs.iter().enumerate() {
        assert!(exact.contains(index) || !hits.contains(index));
        if *value > bound + 2.0 * adjoint.rounding {
            assert!(hits.contains(index));
        }
    }
    let divided = gpu
        .with_buffers_of(1 << 14)
        .wave_hits(&k, &modes, &x, bound);
    assert_eq!(divided.unwrap(), hits);
}

/// Values in single precision are off by a few 2^-24 of a bump, transforms of 2^15 points by about 15 roundings of the
/// root mean square. The largest value of g is as many times its root mean square as the box is larger than the solids;
/// 2e-6 of it is 30 roundings.
#[test]
fn gap_functions_on_grids() {
    let Some(gpu) = adapter() else { return };
    for (n, edge) in [(16, 4.0), (18, 4.0), (32, 3.0)] {
        // Balls over the faces of the cube, one larger than half of it.
        let first = balls(40, 3.0, [0.3, 0.0, -0.2], 1);
        let mut second = balls(25, 2.0, [1.5, -7.0, 0.1], 2);
        second.push([0.5, 0.5, 0.0, 1.6]);
        let ours = gpu.gap_grid([&first, &second], n, edge).unwrap();
        let theirs = Cpu.gap_grid([&first, &second], n, edge).unwrap();
        let largest = theirs.iter().copied().fold(0.0, f64::max);
        let error = worst(&ours, &theirs, |a, b| (a - b).abs());
        println!("{n}: {:.1e}", error / largest);
        assert!(error < 2e-6 * largest);
        assert_eq!(gpu.gap_grid([&first, &second], n, edge).unwrap(), ours);
    }
    // One ball with itself: even, and largest where it covers itself.
    let n = 32;
    let one = [[1.0, 1.0, 1.0, 0.7]];
    let own = gpu.gap_grid([&one, &one], n, 2.5).unwrap();
    for (index, value) in own.iter().enumerate() {
        let back = [index / (n * n), index / n % n, index % n].map(|part| (n - part) % n);
        let mirrored = own[(back[0] * n + back[1]) * n + back[2]];
        assert!((value - mirrored).abs() < 1e-6 * own[0] && *value <= own[0]);
    }
    let nothing = gpu.gap_grid([&one, &[]], 16, 2.0).unwrap();
    assert!(nothing.iter().all(|&value| value == 0.0));
    for n in [0, 15, 22] {
        assert!(gpu.gap_grid([&one, &one], n, 2.0).is_err());
    }
}

/// On a device with no more than every adapter has and every index in its shaders tested: the same but for rounding.
#[test]
fn the_least_that_adapters_have_is_enough() {
    let Some(gpu) = adapter() else { return };
    let least = GpuDevice::open_least(None).unwrap();
    let (first, second) = (balls(37, 3.0, [0.0; 3], 1), balls(131, 2.0, [0.0; 3], 2));
    let (x, c) = (points::<4>(300, 3), weights(300, 4));
    let k = frequencies::<4>(300, 40.0, 5);
    let plan = Plan::<f64, 4>::new([8, 6, 4, 5], 1e-5, 300).unwrap();
    let flat = |all: Vec<Complex64>| all.into_iter().flat_map(|x| [x.re, x.im]).collect();
    let [most, same] = [&gpu, &least].map(|gpu| -> [Vec<f64>; 6] {
        let hits = gpu.wave_hits(&k, &c, &x, 0.0).unwrap();
        [
            gpu.pair_sums(&first, &second).unwrap().concat(),
            gpu.pair_distances(&first, &second, &points(9, 6)).unwrap(),
            flat(gpu.wave_sums(&x, &c, &k).unwrap()),
            vec![hits.count() as f64],
            gpu.gap_grid([&first, &second], 40, 5.0).unwrap(),
            flat(gpu.knot_modes(&plan, &x, &c).unwrap()),
        ]
    });
    for (most, same) in most.iter().zip(&same) {
        let largest = most
            .iter()
            .fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let error = worst(most, same, |a, b| (a - b).abs());
        assert!(error < 1e-5 * largest, "{error} of {largest}");
    }
}

/// More than 65,535 workgroups, which stand in rows of that many, of which the last is not full.
#[test]
fn sums_of_more_workgroups_than_a_row_has() {
    let Some(gpu) = adapter() else { return };
    let (x, c) = (points::<1>(1, 1), weights(1, 2));
    let count = 65_536 * 128 + 1;
    let k: Vec<[i32; 1]> = (0..count).map(|index| [index % 7]).collect();
    let sums = gpu.wave_sums(&x, &c, &k).unwrap();
    let few = Cpu.wave_sums(&x, &c, &k[..7]).unwrap();
    for (index, sum) in sums.iter().enumerate() {
        assert!((sum - few[index % 7]).norm() < 1e-6, "{index}");
    }
}

/// In the 2-norm over all modes: the plan's tolerance, and 1e-5 of single precision and whole numbers.
#[test]
fn fast_transforms_of_knots() {
    let Some(gpu) = adapter() else { return };
    fn check<const D: usize>(gpu: &GpuDevice, modes: [usize; D], count: usize, tolerance: f64) {
        let plan = Plan::<f64, D>::new(modes, tolerance, count).unwrap();
        let (x, c) = (points::<D>(count, 1), weights(count, 2));
        let ours = gpu.knot_modes(&plan, &x, &c).unwrap();
        let exact = knotdock_scoring::transform::ndft::forward(&x, &c, modes);
        let square =
            |all: &mut dyn Iterator<Item = Complex64>| all.map(|x| x.norm_sqr()).sum::<f64>();
        let error = square(&mut ours.iter().zip(&exact).map(|(a, b)| a - b));
        let error = (error / square(&mut exact.iter().copied())).sqrt();
        println!("{modes:?}, {count} knots, {tolerance:e}: {error:.1e}");
        assert!(error < tolerance + 1e-5);
        assert_eq!(gpu.knot_modes(&plan, &x, &c).unwrap(), ours);
    }
    check(&gpu, [8, 8, 8], 1, 1e-3);
    check(&gpu, [12, 9, 14], 300, 1e-6);
    check(&gpu, [6, 1, 20], 300, 1e-4);
    check(&gpu, [8, 6, 4, 5], 200, 1e-5);
    let plan = Plan::<f64, 3>::new([4, 4, 4], 1e-3, 1).unwrap();
    let nothing = gpu.knot_modes(&plan, &[], &[]).unwrap();
    assert_eq!(nothing, vec![Complex64::default(); 64]);
}
