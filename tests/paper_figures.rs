//! What `cargo bench --bench paper_figures` times is the same thing by every way: whole and truncated correlations,
//! one configuration, and a body's spectrum from a grid and from its balls. Minkowski sums of balls cover those of a
//! grid's nodes. Nothing is timed here.

#[path = "../benches/paper_figures/crossing.rs"]
mod crossing;
#[path = "../benches/paper_figures/scene.rs"]
#[allow(dead_code)]
mod scene;

use crate::docking_parts;
use knotdock::geometry::gap::expansion::{Expansion, Task};
use knotdock::geometry::gap::grid::Grid;
use knotdock::geometry::gap::spectrum::{self, Body, FrequencyBox, Kernel, exact};
use knotdock::geometry::gap::{lifted, ways};
use knotdock_scoring::minkowski::{self, Knot, Node, gap_of_balls, gap_of_nodes};
use knotdock_scoring::transform::truncation::{Selection, rms_left_out};
use knotdock_scoring::truncated::RotationSpectrum;
use knotdock_structures::mesh::{Mesh, from_triangles};
use nalgebra::Vector3;
use num_complex::Complex64;
use scene::{Scene, sampled};

const EDGE: f64 = 2.0;

/// Balls with radii of more than two to one.
fn body(count: usize, phase: f64) -> Body {
    let wave = |j: usize, step: f64| (phase + j as f64 * step).sin();
    Body {
        centers: (0..count)
            .map(|j| [0.3 * wave(j, 1.7), 0.25 * wave(j, 2.3), 0.2 * wave(j, 0.9)])
            .collect(),
        radii: (0..count).map(|j| 0.2 + 0.08 * wave(j, 3.1)).collect(),
    }
}

/// Grid, spectra of two bodies, their product, and the correlation's values.
struct Correlated {
    grid: Grid,
    spectra: [Vec<Complex64>; 2],
    product: Vec<Complex64>,
    values: Vec<f64>,
}

fn correlated(per_axis: usize) -> Correlated {
    let grid = Grid::new(per_axis, EDGE);
    let kernel = Kernel::new(20.0).unwrap();
    let mut buffers = grid.buffers();
    let spectra = [body(40, 0.0), body(12, 0.5)].map(|body| {
        grid.rasterise(&body.knots(), &kernel.bump, &mut buffers);
        grid.forward(&mut buffers);
        buffers.spectrum.clone()
    });
    let mut product = buffers.spectrum.clone();
    grid.multiply(&spectra[0], &spectra[1], &mut product);
    buffers.spectrum.copy_from_slice(&product);
    grid.inverse(&mut buffers);
    Correlated {
        grid,
        spectra,
        product,
        values: buffers.grid,
    }
}

impl Correlated {
    fn peak(&self) -> f64 {
        self.values.iter().fold(0.0, |peak, value| value.max(peak))
    }

    fn truncated(&self, selection: &Selection) -> Vec<f64> {
        let mut buffers = self.grid.buffers();
        self.grid
            .keep(&self.product, selection, &mut buffers.spectrum);
        self.grid.inverse(&mut buffers);
        buffers.grid
    }

    fn prepared(&self, selection: &Selection) -> RotationSpectrum {
        RotationSpectrum::from_spectrum(&self.grid.modes, selection, |mode| {
            self.grid.mode(&self.product, mode)
        })
    }
}

fn rms(errors: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = errors.len() as f64;
    (errors.map(|error| error * error).sum::<f64>() / count).sqrt()
}

/// All modes give the whole correlation; fewer, by falling magnitude, an error that is Parseval's, falls with every
/// mode, and is no larger than that of as many modes of lowest frequency.
#[test]
fn the_residual_falls_to_rounding() {
    let whole = correlated(16);
    let magnitudes = whole.grid.magnitudes(&whole.product);
    let error = |selection: &Selection| {
        let truncated = whole.truncated(selection);
        rms(whole.values.iter().zip(&truncated).map(|(a, b)| a - b)) / whole.peak()
    };
    let mut last = f64::INFINITY;
    for power in 6..=12 {
        let dominant = Selection::by_magnitude(&whole.grid.modes, &magnitudes, 1 << power);
        let low = Selection::low_frequency(&whole.grid.modes, 1 << power);
        let [by_magnitude, by_frequency] = [&dominant, &low].map(error);
        let tail = rms_left_out(&whole.grid.modes, &dominant, &magnitudes) / whole.peak();
        assert!((by_magnitude - tail).abs() < 1e-9 + 1e-6 * tail);
        assert!(by_magnitude < last && by_magnitude <= by_frequency + 1e-15);
        last = by_magnitude;
    }
    assert!(last < 1e-14, "{last}");
    assert!(error(&Selection::all(&whole.grid.modes)) < 1e-14);
}

/// The correlation at a voxel is the sum over the grid of one body times the other, moved there.
#[test]
fn the_transforms_give_the_sum_over_the_grid() {
    let per_axis = 64;
    let whole = correlated(per_axis);
    let kernel = Kernel::new(20.0).unwrap();
    let mut buffers = whole.grid.buffers();
    let sampled = [body(40, 0.0), body(12, 0.5)].map(|body| {
        whole
            .grid
            .rasterise(&body.knots(), &kernel.bump, &mut buffers);
        buffers.grid.clone()
    });
    let cell = (EDGE / per_axis as f64).powi(3);
    let n = per_axis;
    for [x, y, z] in [[0, 0, 0], [5, 60, 2], [12, 3, 50]] {
        let mut sum = 0.0;
        for i in 0..n * n * n {
            let (ix, iy, iz) = (i / (n * n), i / n % n, i % n);
            let back = |index: usize, shift: usize| (index + n - shift) % n;
            let j = (back(ix, x) * n + back(iy, y)) * n + back(iz, z);
            sum += sampled[0][i] * sampled[1][j];
        }
        let ours = whole.values[(x * n + y) * n + z];
        // What is left is the Nyquist planes, which the modes leave out.
        assert!(
            (ours - cell * sum).abs() < 1e-5 * whole.peak(),
            "{x} {y} {z}"
        );
    }
}

/// One configuration from some modes, and the small grid's values of the same modes, are the whole grid's truncated
/// function: at voxels of either.
#[test]
fn a_configuration_reads_the_truncated_function() {
    let whole = correlated(16);
    let magnitudes = whole.grid.magnitudes(&whole.product);
    let peak = whole.peak();
    for most in [64, 500, 1 << 12] {
        let selection = Selection::by_magnitude(&whole.grid.modes, &magnitudes, most);
        let prepared = whole.prepared(&selection);
        let mut work = prepared.workspace();
        let mut read = |size: [usize; 3], [x, y, z]: [usize; 3]| {
            let place = |index: usize, n: usize| {
                let signed = index as f64 - if 2 * index >= n { n as f64 } else { 0.0 };
                signed * EDGE / n as f64
            };
            let at = Vector3::new(place(x, size[0]), place(y, size[1]), place(z, size[2]));
            prepared.gradient(&at, &mut work).0
        };
        let truncated = whole.truncated(&selection);
        let truncation = whole.grid.truncate(&selection);
        let mut small = truncation.buffers();
        let spectra = [&whole.spectra[0][..], &whole.spectra[1][..]];
        truncation.multiply(&whole.grid, spectra, &mut small);
        truncation.inverse(&mut small);
        for [x, y, z] in [[0, 0, 0], [1, 2, 3], [4, 0, 5], [2, 5, 1]] {
            let value = truncated[(x * 16 + y) * 16 + z];
            assert!((read([16; 3], [x, y, z]) - value).abs() < 1e-13 * peak);
            let [nx, ny, nz] = truncation.size;
            let [x, y, z] = [x % nx, y % ny, z % nz];
            let value = small.grid[(x * ny + y) * nz + z];
            assert!((read(truncation.size, [x, y, z]) - value).abs() < 1e-13 * peak);
        }
    }
}

/// Direct and fast sums through either expansion are the body's transform to the tolerance; a fine grid's is to its
/// aliases.
#[test]
fn every_way_gives_the_same_spectrum() {
    let body = body(40, 0.0);
    let kernel = Kernel::new(20.0).unwrap();
    let frequencies = FrequencyBox::of_power(10);
    assert_eq!(frequencies.count(), 1 << 10);
    let half = frequencies.count() / 2;
    let reference: Vec<Complex64> = (0..half)
        .map(|place| exact(&body, &kernel, EDGE, frequencies.frequency(place)))
        .collect();
    let largest = reference
        .iter()
        .map(|value| value.norm())
        .fold(0.0, f64::max);
    let worst = |values: &[Complex64]| {
        assert_eq!(values.len(), half);
        let errors = values.iter().zip(&reference).map(|(a, b)| (a - b).norm());
        errors.fold(0.0, f64::max) / largest
    };
    let mut last = 0;
    for tolerance in [1e-2, 1e-4, 1e-6] {
        let task = Task {
            body: &body,
            kernel: &kernel,
            edge: EDGE,
            frequencies,
            tolerance,
        };
        let (series, period) = lifted::series(&task);
        let compressed = Expansion::compressed(&task);
        assert!(series.rank() > compressed.rank() && compressed.rank() >= last);
        last = compressed.rank();
        let points = ways::Points::new(&body, EDGE, frequencies, &series);
        let direct = ways::direct(&points);
        let mut fast = lifted::planned(&points, &body.radii, period, tolerance).unwrap();
        let by_series = lifted::fast(&points, &mut fast).unwrap();
        let points = ways::Points::new(&body, EDGE, frequencies, &compressed);
        let plain = ways::direct(&points);
        let mut fast = ways::planned(&points, tolerance).unwrap();
        let ours = ways::fast(&points, &mut fast).unwrap();
        // The expansion is checked at some of the frequencies; a fast transform adds its own error.
        for (name, values) in [
            ("ndft", direct),
            ("4d", by_series),
            ("plain", plain),
            ("3d", ours),
        ] {
            let error = worst(&values);
            assert!(error < 3.0 * tolerance, "{name} {tolerance}: {error}");
        }
    }
    let grid = Grid::new(64, EDGE);
    let mut buffers = grid.buffers();
    grid.rasterise(&body.knots(), &kernel.bump, &mut buffers);
    grid.forward(&mut buffers);
    let rastered: Vec<Complex64> = (0..half)
        .map(|place| grid.transform_at(&buffers.spectrum, frequencies.frequency(place)))
        .collect();
    let error = worst(&rastered);
    assert!(error < 1e-4, "{error}");
}

/// Places and frequencies of a box agree, and the sampled ones spread over it from frequency zero on.
#[test]
fn places_and_frequencies_of_a_box_agree() {
    let frequencies = FrequencyBox::of_power(9);
    assert_eq!(frequencies.half(), [8, 8, 4]);
    let mut seen = 0;
    frequencies.for_each(|place, square| {
        assert_eq!(place, seen);
        assert_eq!(square, spectrum::square(frequencies.frequency(place)));
        seen += 1;
    });
    assert_eq!(seen, frequencies.count() / 2);
    let places = frequencies.sample(40);
    assert_eq!(frequencies.frequency(places[0]), [0; 3]);
    assert!(places.len() > 20);
}

#[test]
fn curves_cross_a_level_between_their_points() {
    let curve = [[64.0, 1.0], [128.0, 2.0], [256.0, 4.0]];
    let at = crossing::crossing(&curve, 2.0f64.sqrt()).unwrap();
    assert!((at - 64.0 * 2f64.sqrt()).abs() < 1e-9);
    assert_eq!(crossing::crossing(&curve, 0.5), None);
    assert_eq!(crossing::crossing(&curve, 5.0), None);
}

/// Centres of a sum of two sets of balls or nodes.
fn sum<const N: usize>(first: &[[f64; N]], second: &[[f64; N]]) -> Vec<[f64; N]> {
    let mut sum = Vec::new();
    minkowski::write(first, second, &mut sum);
    sum
}

fn center([x, y, z, _]: Knot) -> Node {
    [x, y, z]
}

/// Written sums are all pairs', and streaming gives the gap that they have.
#[test]
fn streamed_sums_are_the_written_ones() {
    let [first, second] = [body(12, 0.0), body(7, 0.5)].map(|body| body.knots());
    let balls = sum(&first, &second);
    assert_eq!(balls.len(), 12 * 7);
    for (index, ball) in balls.iter().enumerate() {
        let pair = [&first[index / 7], &second[index % 7]];
        assert!((0..4).all(|i| ball[i] == pair[0][i] + pair[1][i]));
    }
    let centers = |balls: &[Knot]| -> Vec<Node> { balls.iter().copied().map(center).collect() };
    let nodes = sum(&centers(&first), &centers(&second));
    for place in [[0.0; 3], [0.3, -0.2, 0.1], [2.0, 1.0, -3.0]] {
        let to = |center: Node| (Vector3::from(center) - Vector3::from(place)).norm();
        let gaps = balls.iter().map(|ball| to(center(*ball)) - ball[3]);
        let gap = gap_of_balls(&first, &second, place);
        assert!((gap - gaps.fold(f64::INFINITY, f64::min)).abs() < 1e-14);
        let least = nodes
            .iter()
            .map(|node| to(*node))
            .fold(f64::INFINITY, f64::min);
        let gap = gap_of_nodes(&centers(&first), &centers(&second), place);
        assert!((gap - least).abs() < 1e-14);
    }
}

/// The sum of two boxes is a box. The balls reach out of it by both eps at most, and cover all of it to that. The nodes
/// do only to twice as much.
#[test]
fn sums_of_boxes_are_the_box_to_both_eps() {
    let halves = [[0.5, 0.3, 0.41], [0.5, 0.2, 0.13]];
    let per_axis = 12;
    let epsilon = 0.5 * 3f64.sqrt() / (per_axis - 1) as f64;
    let boxes = halves.map(|half| {
        let mesh = cuboid(half);
        let (body, nodes) = sampled(&mesh, 1.0, per_axis, 0.25).unwrap();
        (body.knots(), nodes)
    });
    let [(first, first_nodes), (second, second_nodes)] = &boxes;
    assert!(first.len() < first_nodes.len() && second.len() < second_nodes.len());
    let half: [f64; 3] = std::array::from_fn(|axis| halves[0][axis] + halves[1][axis]);
    for ball in sum(first, second) {
        for axis in 0..3 {
            assert!(ball[axis].abs() + ball[3] < half[axis] + 2.0 * epsilon + 1e-9);
        }
    }
    for node in sum(first_nodes, second_nodes) {
        assert!((0..3).all(|axis| node[axis].abs() < half[axis]));
    }
    const STEPS: usize = 8;
    for index in 0..(STEPS + 1).pow(3) {
        let numbers = [index, index / (STEPS + 1), index / (STEPS + 1).pow(2)];
        let place: Node = std::array::from_fn(|axis| {
            let share = (numbers[axis] % (STEPS + 1)) as f64 / STEPS as f64;
            half[axis] * (2.0 * share - 1.0)
        });
        assert!(gap_of_balls(first, second, place) < 2.0 * epsilon);
        // Planes of nodes end up to a spacing under a face, so 2 eps from a corner: eps is no bound for nodes alone.
        assert!(gap_of_nodes(first_nodes, second_nodes, place) < 4.0 * epsilon + 1e-9);
    }
}

/// A box about the origin.
fn cuboid(half: [f64; 3]) -> Mesh {
    let corners: Vec<Node> = (0..8)
        .map(|corner| std::array::from_fn(|axis| half[axis] * [-1.0, 1.0][corner >> axis & 1]))
        .collect();
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles: Vec<[u32; 3]> = quads
        .into_iter()
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    from_triangles(&corners, &triangles).unwrap().0
}

/// Bunny and peg: the sum of their balls covers what that of their nodes covers, to both eps, with fewer by the paper's
/// ratio at least (Table 1: 23 at 2^12).
#[test]
fn sums_of_balls_cover_those_of_nodes() {
    let scene = Scene::new(16).unwrap();
    let [bunny, peg] = [&scene.bunny, &scene.peg].map(|body| body.knots());
    let [bunny_nodes, peg_nodes, _] = &scene.nodes;
    let nodes = sum(bunny_nodes, peg_nodes);
    assert_eq!(nodes.len(), bunny_nodes.len() * peg_nodes.len());
    let ratio = nodes.len() as f64 / (bunny.len() * peg.len()) as f64;
    assert!(ratio > 23.0, "{ratio}");
    let same = (bunny_nodes.len() as f64 / bunny.len() as f64).powi(2);
    assert!(same > 23.0, "{same}");
    for node in nodes.into_iter().step_by(7) {
        let gap = gap_of_balls(&bunny, &peg, node);
        assert!(gap < 2.0 * scene.epsilon(), "{node:?}: {gap}");
    }
}
