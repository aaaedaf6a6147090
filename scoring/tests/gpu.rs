//! The engine on a graphics processor against the engine on the CPU in double precision, and against plain sorting for
//! its peaks.

#[path = "scene/adapter.rs"]
pub mod adapter;

use crate::scene::{Numbers, Pair, RADII, askew_cloud, cloud, engine_options, some_rotation};
use adapter::adapter;
use knotdock_scoring::Precision;
use knotdock_scoring::engine::gpu::{GpuEngine, GridPeak, LigandRotation};
use knotdock_scoring::engine::{EngineOptions, Plan};
use knotdock_scoring::gpu::{GpuDevice, GpuError};
use knotdock_scoring::grid_turn::GridTurn;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Knots;
use nalgebra::UnitQuaternion;

const MEMORY: u64 = 256 << 20;

fn rotations(count: usize, seed: u64) -> Vec<UnitQuaternion<f64>> {
    let mut numbers = Numbers(seed);
    (0..count)
        .map(|_| {
            let parts = std::array::from_fn(|_| numbers.next() - 0.5);
            Pose::from_parts(parts, [0.0; 3]).rotation
        })
        .collect()
}

/// Largest difference of the card's grid from the CPU's in f64 over all voxels and turns, as a share of the
/// largest score there.
fn difference(gpu: &GpuDevice, a: &Knots, b: &Knots, options: EngineOptions) -> f64 {
    difference_of(gpu, &Pair::new(Precision::Double, a, b, options))
}

fn difference_of(gpu: &GpuDevice, pair: &Pair) -> f64 {
    let engine = GpuEngine::new(gpu, &pair.engine, 1, 2, MEMORY).unwrap();
    let mut work = pair.engine.workspace();
    let rotation = some_rotation();
    pair.engine.transform_ligand(&rotation, &mut work);
    let (mut worst, mut best) = (0.0f64, 0.0f64);
    for &turn in pair.engine.turns() {
        pair.engine.correlate_turned(turn, &mut work);
        let grid = engine.correlate(&rotation, turn).unwrap();
        assert_eq!(grid.len(), work.scores.count());
        for (ours, theirs) in grid.iter().zip(work.scores.iter()) {
            worst = worst.max((f64::from(*ours) - theirs).abs());
            best = best.max(theirs);
        }
    }
    worst / best
}

/// The half-turns that are wanted, and no quarter turn.
fn of_half_turns(wanted: [bool; 4]) -> [bool; 8] {
    std::array::from_fn(|image| image < 4 && wanted[image])
}

/// The greedy choice among all voxels in order of score, none a neighbour of one before it.
fn greedy(grid: &[f32], size: [usize; 3], count: usize, reach: usize) -> Vec<(u32, f32)> {
    let [_, ny, nz] = size;
    let place = |voxel: usize| [voxel / (ny * nz), voxel / nz % ny, voxel % nz];
    let mut order: Vec<usize> = (0..grid.len()).collect();
    order.sort_by(|&a, &b| grid[b].total_cmp(&grid[a]).then(a.cmp(&b)));
    let mut kept: Vec<usize> = Vec::new();
    for voxel in order {
        let spaced = |&other: &usize| {
            (0..3).any(|axis| {
                let distance = place(voxel)[axis].abs_diff(place(other)[axis]);
                distance.min(size[axis] - distance) > reach.min((size[axis] - 1) / 2)
            })
        };
        if kept.iter().all(spaced) {
            kept.push(voxel);
            if kept.len() == count {
                break;
            }
        }
    }
    kept.into_iter().map(|v| (v as u32, grid[v])).collect()
}

/// The error of single precision is the same small share at every tolerance of the plan: window widths, ranks and grids
/// all change with it.
#[test]
fn the_grid_is_that_of_the_cpu_in_double_precision() {
    let Some(gpu) = adapter() else { return };
    let (a, b) = (cloud(150, 12.0, &RADII, 1), cloud(40, 6.0, &RADII, 2));
    for tolerance in [1e-2, 1e-3, 1e-4] {
        let share = difference(&gpu, &a, &b, engine_options(tolerance));
        let cpu = single_difference(&a, &b, engine_options(tolerance));
        println!("tolerance {tolerance:e}: {share:.1e}, {cpu:.1e} on the CPU");
        assert!(share < 3e-5, "{tolerance}: {share}");
    }
}

/// The card turns knots to the grid's axes as the cores do.
#[test]
fn a_grid_turned_to_fit_the_receptor() {
    let Some(gpu) = adapter() else { return };
    let (a, b) = (askew_cloud(150, 12.0, &RADII, 1), cloud(40, 6.0, &RADII, 2));
    let pair = Pair::fitted(Precision::Double, &a, &b, engine_options(1e-2));
    assert!(pair.plan.frame().angle() > 0.1);
    let share = difference_of(&gpu, &pair);
    assert!(share < 3e-5, "{share}");
}

/// Every radix that grids are made of, on every axis and both ways: needles along each axis, the shortest with a length
/// of 3, 5 and 7 times a power.
#[test]
fn every_radix_of_grid_lengths() {
    let Some(gpu) = adapter() else { return };
    let ligand = cloud(20, 4.0, &RADII, 4);
    let options = EngineOptions {
        spacing: Some(2.0),
        ..engine_options(1e-2)
    };
    for axis in 0..3 {
        let needle = |factor: f64| {
            let mut receptor = cloud(80, 8.0, &RADII, 3);
            for center in &mut receptor.centers {
                center[axis] *= factor;
            }
            receptor
        };
        for radix in [3, 5, 7] {
            let receptor = (0..80)
                .map(|step| needle(1.0 + 0.25 * f64::from(step)))
                .find(|receptor| {
                    let plan = Plan::new(receptor, &ligand, options).unwrap();
                    let lengths = [plan.modes().size[axis], plan.fine()[axis]];
                    lengths.iter().any(|length| length.is_multiple_of(radix))
                })
                .expect("no needle has such a length");
            let share = difference(&gpu, &receptor, &ligand, options);
            println!("axis {axis}, radix {radix}: {share:.1e}");
            assert!(share < 3e-5, "axis {axis}, radix {radix}: {share}");
        }
    }
}

/// One knot has one component of one row. Balls of sizes 1 to 30 have many components that cancel, so single precision
/// loses more digits. The card may lose as many as the CPU.
#[test]
fn a_single_knot_and_balls_of_many_sizes() {
    let Some(gpu) = adapter() else { return };
    let one = cloud(1, 1.0, &[1.7], 5);
    let share = difference(&gpu, &cloud(60, 9.0, &RADII, 6), &one, engine_options(1e-3));
    assert!(share < 3e-5, "one knot: {share}");
    let share = difference(&gpu, &one, &one, engine_options(1e-3));
    assert!(share < 3e-5, "two knots: {share}");
    let sizes = [1.0, 2.0, 4.0, 8.0, 15.0];
    let (a, b) = (cloud(60, 20.0, &sizes, 7), cloud(24, 10.0, &sizes, 8));
    let share = difference(&gpu, &a, &b, engine_options(1e-2));
    let cpu = single_difference(&a, &b, engine_options(1e-2));
    println!("many sizes: {share:.1e}, {cpu:.1e} on the CPU");
    assert!(share < 3.0 * cpu, "many sizes: {share}, {cpu} on the CPU");
}

/// As [`difference`], of the CPU's own single precision.
fn single_difference(a: &Knots, b: &Knots, options: EngineOptions) -> f64 {
    let (single, double) = (
        Pair::new(Precision::Single, a, b, options).correlate(&some_rotation()),
        Pair::new(Precision::Double, a, b, options).correlate(&some_rotation()),
    );
    let best = double.scores.iter().fold(0.0, f64::max);
    let differences = single.scores.iter().zip(double.scores.iter());
    differences
        .map(|(a, b)| (a - b).abs() / best)
        .fold(0.0, f64::max)
}

#[test]
fn peaks_are_those_of_a_sorted_grid() {
    let Some(gpu) = adapter() else { return };
    let (a, b) = (cloud(150, 12.0, &RADII, 1), cloud(40, 6.0, &RADII, 2));
    let pair = Pair::new(Precision::Single, &a, &b, engine_options(1e-2));
    let size = pair.engine.plan().size();
    for (count, reach) in [(1, 2), (5, 2), (40, 1), (3, 0)] {
        let engine = GpuEngine::new(&gpu, &pair.engine, count, reach, MEMORY).unwrap();
        for rotation in rotations(3, 9) {
            let wanted = of_half_turns([true, false, true, true]);
            let peaks = engine
                .best(&[LigandRotation { rotation, wanted }], &mut |_| {})
                .unwrap();
            let mut expected = Vec::new();
            for half_turn in (0..4).filter(|&half_turn| wanted[half_turn]) {
                let grid = engine
                    .correlate(&rotation, GridTurn::HALF_TURNS[half_turn])
                    .unwrap();
                for (voxel, score) in greedy(&grid, size, count, reach) {
                    expected.push(GridPeak {
                        turn: 0,
                        image: half_turn,
                        voxel,
                        score,
                    });
                }
            }
            assert_eq!(peaks, expected);
        }
    }
}

/// A driver may cut long loops short (llvmpipe does, after 65,536 rounds): then the peaks that are missing are finished
/// of.
#[test]
fn more_peaks_than_a_driver_counts_to_are_right_or_refused() {
    let Some(gpu) = adapter() else { return };
    let (a, b) = (cloud(150, 12.0, &RADII, 1), cloud(40, 6.0, &RADII, 2));
    let pair = Pair::new(Precision::Single, &a, &b, engine_options(1e-2));
    let size = pair.engine.plan().size();
    let engine = GpuEngine::new(&gpu, &pair.engine, 1500, 1, MEMORY).unwrap();
    let turns: Vec<LigandRotation> = rotations(2, 9)
        .into_iter()
        .map(|rotation| LigandRotation {
            rotation,
            wanted: of_half_turns([true, false, false, false]),
        })
        .collect();
    for turn in turns {
        match engine.best(&[turn], &mut |_| {}) {
            Ok(peaks) => {
                let grid = engine.correlate(&turn.rotation, GridTurn::NONE).unwrap();
                let found: Vec<_> = peaks.iter().map(|peak| (peak.voxel, peak.score)).collect();
                assert_eq!(found, greedy(&grid, size, 1500, 1));
            }
            Err(error) => assert!(error.to_string().contains("cut short"), "{error}"),
        }
    }
}

/// A neighbourhood that covers the whole grid leaves one peak, and no more are made up.
#[test]
fn a_grid_gives_no_more_peaks_than_it_has() {
    let Some(gpu) = adapter() else { return };
    let one = cloud(1, 1.0, &[1.7], 5);
    let pair = Pair::new(Precision::Single, &one, &one, engine_options(1e-2));
    let longest = pair.engine.plan().size().into_iter().max().unwrap();
    let engine = GpuEngine::new(&gpu, &pair.engine, 50, longest, MEMORY).unwrap();
    let turn = LigandRotation {
        rotation: some_rotation(),
        wanted: of_half_turns([true; 4]),
    };
    let peaks = engine.best(&[turn], &mut |_| {}).unwrap();
    let distinct: std::collections::HashSet<_> =
        peaks.iter().map(|peak| (peak.image, peak.voxel)).collect();
    assert_eq!(distinct.len(), peaks.len());
    assert!(peaks.len() < 4 * 50 && peaks.len() >= 4, "{}", peaks.len());
}

/// However many rotations go through together, down to one image alone, the bits are the same: so are they from run to
/// run.
#[test]
fn batches_change_no_bit() {
    let Some(gpu) = adapter() else { return };
    let (a, b) = (cloud(150, 12.0, &RADII, 1), cloud(40, 6.0, &RADII, 2));
    let pair = Pair::new(Precision::Single, &a, &b, engine_options(1e-2));
    let turns: Vec<LigandRotation> = rotations(16, 11)
        .into_iter()
        .enumerate()
        .map(|(index, rotation)| LigandRotation {
            rotation,
            wanted: of_half_turns(std::array::from_fn(|image| (index >> image) % 3 != 1)),
        })
        .collect();
    let images: usize = turns
        .iter()
        .map(|turn| turn.wanted.iter().filter(|&&wanted| wanted).count())
        .sum();
    let mut runs: Vec<Vec<GridPeak>> = Vec::new();
    let mut sizes = Vec::new();
    for memory in [
        MEMORY,
        MEMORY,
        MEMORY / 16,
        3 << 20,
        3 << 19,
        5 << 18,
        1 << 20,
    ] {
        let Ok(engine) = GpuEngine::new(&gpu, &pair.engine, 3, 2, memory) else {
            continue;
        };
        sizes.push(engine.in_flight());
        let mut finished = 0;
        runs.push(engine.best(&turns, &mut |count| finished += count).unwrap());
        assert_eq!(finished, images);
    }
    println!("images in flight: {sizes:?}");
    assert!(
        sizes.first() > sizes.last() && sizes.contains(&1),
        "{sizes:?}"
    );
    assert_eq!(runs[0].len(), 3 * images);
    for run in &runs[1..] {
        assert_eq!(run, &runs[0]);
    }
    let engine = GpuEngine::new(&gpu, &pair.engine, 3, 2, MEMORY).unwrap();
    assert_eq!(engine.best(&[], &mut |_| {}).unwrap(), []);
}

/// On a device with no more than every adapter has and every index in its shaders tested: the same but for rounding. A
/// plane of the larger grid does not fit its workgroup's memory.
#[test]
fn the_least_that_adapters_have_is_enough() {
    let Some(gpu) = adapter() else { return };
    let least = GpuDevice::open_least(None).unwrap();
    let ligand = cloud(40, 6.0, &RADII, 2);
    for (size, spacing) in [(12.0, None), (30.0, Some(1.0))] {
        let receptor = cloud(150, size, &RADII, 1);
        let options = EngineOptions {
            spacing,
            ..engine_options(1e-2)
        };
        let pair = Pair::new(Precision::Single, &receptor, &ligand, options);
        let turns = rotations(3, 5).into_iter().map(|rotation| LigandRotation {
            rotation,
            wanted: of_half_turns([true, false, true, true]),
        });
        let turns: Vec<LigandRotation> = turns.collect();
        let [most, same] = [&gpu, &least].map(|gpu| {
            let engine = GpuEngine::new(gpu, &pair.engine, 5, 2, MEMORY).unwrap();
            let grid = engine.correlate(&some_rotation(), GridTurn::NONE).unwrap();
            let peaks = engine.best(&turns, &mut |_| {}).unwrap();
            let scores = peaks.iter().map(|peak| peak.score);
            grid.into_iter().chain(scores).collect::<Vec<f32>>()
        });
        let best = most.iter().copied().fold(0.0, f32::max);
        assert_eq!(most.len(), same.len());
        for (a, b) in most.iter().zip(&same) {
            assert!((a - b).abs() < 1e-5 * best, "{a}, {b} of {best}");
        }
    }
}

#[test]
fn what_cannot_be_had_is_said() {
    let Some(gpu) = adapter() else { return };
    let Err(error) = GpuDevice::open(Some("no such card")) else {
        panic!("a card of no such name was opened")
    };
    assert!(matches!(error, GpuError::NoAdapter { .. }));
    let text = error.to_string();
    assert!(
        text.contains("no such card") && text.contains(gpu.name()),
        "{text}"
    );
    let part: String = gpu.name().to_uppercase().chars().take(4).collect();
    assert_eq!(GpuDevice::open(Some(&part)).unwrap().name(), gpu.name());
    let one = cloud(1, 1.0, &[1.7], 5);
    let pair = Pair::new(Precision::Single, &one, &one, engine_options(1e-2));
    let Err(error) = GpuEngine::new(&gpu, &pair.engine, 1, 2, 1000) else {
        panic!("a batch in a thousand bytes")
    };
    assert!(matches!(error, GpuError::TooSmall { .. }), "{error}");
}
