//! Samplers against closed forms and against what the paper promises of them.

#![cfg(feature = "mesh")]

use std::f64::consts::PI;

use crate::solids::{Surface, cuboid, scattered, sphere};
use knotdock_structures::mesh::{Solid, read};
use knotdock_structures::sampling::ball_tree::BallTree;
use knotdock_structures::sampling::decomposition::{DecompositionOptions, decompose};
use knotdock_structures::sampling::feature_size::feature_size;
use knotdock_structures::sampling::grid::{DepthField, Grid};
use knotdock_structures::sampling::hausdorff::HausdorffMeter;
use knotdock_structures::sampling::skeletal_density::{Priority, SHARE_WIDTH, share};
use knotdock_structures::sampling::{Ball, Method, SetName, sample};

/// Past a wall thinner than anything the surface is far, and still no ball fits into the wall.
#[test]
fn thin_shells_are_as_thick_as_they_are() {
    for thickness in [0.003, 0.02] {
        let inner = sphere([0.0; 3], 0.5 - thickness, 40).inverted();
        let solid = sphere([0.0; 3], 0.5, 40).and(&inner).solid();
        let field = DepthField::new(&solid, Grid::new(&solid, 64));
        let found = feature_size(&solid, &field);
        let expected = 0.5 * thickness / solid.frame().unit;
        assert!(
            (found - expected).abs() < 0.1 * expected,
            "{found} for {expected}"
        );
    }
}

const BUNNY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/bunny.obj");

fn bunny() -> Solid {
    Solid::new(&read(BUNNY.as_ref()).unwrap().0).unwrap()
}

/// What must hold for a closed mesh: S(A1) in S in S(A2), S(A1) in S(A3) in S(A2), all within eps of S.
fn check_bounds(solid: &Solid, per_axis: usize, options: DecompositionOptions) -> [usize; 3] {
    let sampling = sample(solid, per_axis, Method::BehandishIlies(options)).unwrap();
    let epsilon = sampling.field.grid.epsilon();
    let meter = HausdorffMeter::new(solid, &sampling.field);
    let [a1, a2, a3] = &sampling.sets[..] else {
        panic!()
    };
    for set in [a1, a2, a3] {
        let fit = meter.measure(&set.balls);
        let context = format!(
            "n {per_axis}, {options:?}, {:?}: {fit:?}, eps {epsilon}",
            set.name
        );
        assert!(fit.hausdorff_inward <= epsilon, "{context}");
        let bound = fit.inward_bound.unwrap();
        assert!(
            fit.hausdorff_inward <= bound && bound <= 1.05 * epsilon,
            "{context}"
        );
        assert!(fit.outward_bound <= epsilon * (1.0 + 1e-12), "{context}");
        assert!(
            fit.hausdorff_outward <= fit.outward_bound + 1e-14,
            "{context}"
        );
        assert_eq!(fit.nodes_missed, 0, "{context}");
        match set.name {
            SetName::A1 => assert!(fit.outward_bound < 1e-14, "{context}"),
            SetName::A2 => assert!(bound <= 0.05 * epsilon, "{context}"),
            _ => {}
        }
    }
    assert!(a3.balls.iter().all(|ball| a2.balls.contains(ball)));
    let slack = |ball: &Ball| ball.grown(1e-14);
    assert!(
        a1.balls
            .iter()
            .all(|ball| a3.balls.iter().any(|kept| slack(kept).holds(ball)))
    );
    [a1, a2, a3].map(|set| set.balls.len())
}

#[test]
fn the_bunny_is_sampled_as_in_the_paper() {
    let solid = bunny();
    // |X| and n3 of the paper's Tables 1 and 2; edges of the box are counted one way or the other.
    for (per_axis, nodes, kept) in [(16, 666.0, [36, 53, 67]), (32, 5921.0, [161, 251, 324])] {
        let inside = DepthField::new(&solid, Grid::new(&solid, per_axis))
            .inside()
            .len() as f64;
        assert!((inside / nodes - 1.0).abs() < 0.05, "{inside} nodes inside");
        for (mu, kept) in [0.25, 0.5, 1.0].into_iter().zip(kept) {
            let priority = Priority::SkeletalDensity;
            let [.., a3] = check_bounds(&solid, per_axis, DecompositionOptions { mu, priority });
            assert!(
                a3 * 2 <= 3 * kept,
                "mu {mu}: {a3} balls, the paper has {kept}"
            );
        }
    }
}

#[test]
fn every_protrusion_factor_and_order_keeps_the_bounds() {
    let solid = cuboid([-1.0, -0.7, -0.3], [1.0, 0.7, 0.3]).solid();
    for mu in [0.0, 0.1, 0.9, 1.0] {
        for priority in [Priority::SkeletalDensity, Priority::Radius] {
            check_bounds(&solid, 13, DecompositionOptions { mu, priority });
        }
    }
    // One node an edge's end and nothing between.
    check_bounds(&solid, 2, DecompositionOptions::default());
}

/// Lemma 4 of the paper takes every point of S to lie within eps of an inside node. Under a face just below a plane of
/// nodes it is sqrt(2) eps.
#[test]
fn a_face_just_under_a_plane_of_nodes() {
    let (n, h) = (16, 1.0 / 15.0);
    let top = 6.5 * h - 1e-9;
    let solid = cuboid([-0.5, -0.5, -top], [0.5, 0.5, top]).solid();
    let grid = Grid::new(&solid, n);
    let field = DepthField::new(&solid, grid);
    let nodes: Vec<Ball> = field
        .inside()
        .into_iter()
        .map(|node| Ball {
            center: grid.node(node),
            radius: 0.0,
        })
        .collect();
    let far = BallTree::new(&nodes).distance([0.0, 0.0, top], -1.0);
    assert!(
        (far / grid.epsilon() - 2f64.sqrt()).abs() < 1e-6,
        "{}",
        far / grid.epsilon()
    );
    check_bounds(&solid, n, DecompositionOptions::default());
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let solid = bunny();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let sampling = sample(
                &solid,
                20,
                Method::BehandishIlies(DecompositionOptions::default()),
            )
            .unwrap();
            let meter = HausdorffMeter::new(&solid, &sampling.field);
            let fits: Vec<_> = sampling
                .sets
                .iter()
                .map(|set| meter.measure(&set.balls))
                .collect();
            let others = [Method::WellerZachmann, Method::Octree, Method::Voxels]
                .map(|method| sample(&solid, 20, method).unwrap().sets.remove(0).balls);
            (
                sampling.field,
                sampling
                    .sets
                    .into_iter()
                    .map(|set| set.balls)
                    .collect::<Vec<_>>(),
                fits,
                others,
            )
        })
    };
    assert!(run(1) == run(3));
}

#[test]
fn skeletal_density_is_its_closed_forms() {
    let s = SHARE_WIDTH;
    // Cutting the Gaussian and cutting the surface into pieces costs some per cent.
    let near = |found: f64, expected: f64, tolerance: f64| {
        assert!(
            (found / expected - 1.0).abs() < tolerance,
            "{found} for {expected}"
        );
    };
    let ball = sphere([0.0; 3], 0.5, 60).solid();
    near(share(&ball, [0.0; 3], ball.distance([0.0; 3])), 1.0, 0.02);
    // Off the centre of a ball of radius R by a, dA = 2 pi R / a rho d rho at distance rho.
    let (radius, off) = (0.5, 0.2);
    let depth = radius - off;
    let steps = 100_000;
    let integral: f64 = (0..steps)
        .map(|i| depth + (i as f64 + 0.5) / steps as f64 * 2.0 * off)
        .map(|rho| (-((rho / depth - 1.0) / s).powi(2)).exp() * rho * 2.0 * off / steps as f64)
        .sum();
    let point = [0.0, off, 0.0];
    near(
        share(&ball, point, ball.distance(point)),
        radius / (2.0 * off * depth * depth) * integral,
        0.03,
    );
    // Near one face, half-way between two, and near a tenfold larger one: s (sqrt(pi) + s) / 4 each.
    let face = s * (PI.sqrt() + s) / 4.0;
    let plate = cuboid([-1.0, -1.0, -0.1], [1.0, 1.0, 0.1]).solid();
    for (z, faces) in [(0.0, 2.0), (0.08 * plate.half_sides()[0], 1.0)] {
        let point = [0.01, 0.02, z];
        near(
            share(&plate, point, plate.distance(point)),
            faces * face,
            0.04,
        );
    }
}

#[test]
fn the_depth_field_is_the_depth_at_every_node() {
    let shell = sphere([0.0; 3], 1.0, 12).and(&sphere([0.1, 0.0, 0.0], 0.6, 9).inverted());
    let mut open = sphere([0.0; 3], 1.0, 12);
    open.triangles.truncate(500);
    for surface in [shell, open] {
        let solid = surface.solid();
        let grid = Grid::new(&solid, 17);
        let field = DepthField::new(&solid, grid);
        for node in 0..grid.nodes() {
            let depth = solid.depth(grid.node(node));
            assert!(
                (field.depth[node] - depth).abs() < 1e-12,
                "{} {depth}",
                field.depth[node]
            );
        }
    }
}

#[test]
fn grids_have_both_ends_and_the_middle() {
    let solid = cuboid([0.0; 3], [2.0, 1.0, 1.0]).solid();
    let grid = Grid::new(&solid, 5);
    assert_eq!(
        (grid.half(), grid.spacing(), grid.nodes()),
        (0.5, 0.25, 125)
    );
    assert!((grid.epsilon() - 3f64.sqrt() / 8.0).abs() < 1e-15);
    assert_eq!(grid.node(0), [-0.5; 3]);
    assert_eq!(grid.node(124), [0.5; 3]);
    assert_eq!(grid.node(62), [0.0; 3]);
    // Balls find the same nodes as a test of each node.
    for (center, radius) in scattered(50, 0.6).zip(scattered(50, 0.5)) {
        let radius = radius[0].abs();
        let mut found = Vec::new();
        grid.visit_ball(center, radius, |node, _| found.push(node));
        let within = |node: &usize| {
            let p = grid.node(*node);
            (0..3)
                .map(|axis| (p[axis] - center[axis]).powi(2))
                .sum::<f64>()
                <= radius * radius
        };
        assert_eq!(found, (0..125).filter(within).collect::<Vec<_>>());
    }
}

/// A ball in a cube that it touches: the corners are sqrt(3)/2 - 1/2 away, and all volumes are known.
#[test]
fn hausdorff_distances_and_volumes_of_a_ball_in_a_cube() {
    let solid = cuboid([-0.5; 3], [0.5; 3]).solid();
    let field = DepthField::new(&solid, Grid::new(&solid, 48));
    let meter = HausdorffMeter::new(&solid, &field);
    assert!((meter.volume() - 1.0).abs() < 1e-12);
    let ball = Ball {
        center: [0.0; 3],
        radius: 0.5,
    };
    let inside = meter.measure(&[ball]);
    let corner = 0.75f64.sqrt() - 0.5;
    let tenth = 0.1 * field.grid.epsilon();
    assert!(inside.hausdorff_inward <= corner && inside.hausdorff_inward >= corner - tenth);
    // No sample is at a corner; the upper bound holds for it.
    let bound = inside.inward_bound.unwrap();
    assert!(
        corner <= bound && bound < corner + tenth,
        "{bound} {corner}"
    );
    assert_eq!(
        (inside.hausdorff_outward, inside.volume_outside),
        (0.0, 0.0)
    );
    assert!(
        (inside.volume_missed - (1.0 - PI / 6.0)).abs() < 1e-3,
        "{inside:?}"
    );
    // Grown by t it leaves the cube by six caps of height t.
    let t = 0.02f64;
    let grown = meter.measure(&[ball.grown(t)]);
    let caps = 6.0 * PI * t * t * (3.0 * 0.52 - t) / 3.0;
    assert!((grown.hausdorff_outward - t).abs() < 1e-14 && (grown.outward_bound - t).abs() < 1e-14);
    assert!(
        (grown.volume_outside - caps).abs() < 3e-4,
        "{grown:?} {caps}"
    );
    let missed = 1.0 - (4.0 / 3.0 * PI * 0.52f64.powi(3) - caps);
    assert!(
        (grown.volume_missed - missed).abs() < 1e-3,
        "{grown:?} {missed}"
    );
    assert!(inside.nodes_missed > grown.nodes_missed && grown.nodes_missed > 0);
    // Nothing covers nothing.
    let none = meter.measure(&[]);
    assert!(none.hausdorff_inward == f64::INFINITY && (none.volume_missed - 1.0).abs() < 1e-12);
}

/// A ring of radius 10 and thickness 6, its triangles on the torus to a hundredth.
fn ring() -> Surface {
    let (around, across) = (96u32, 48u32);
    let mut surface = Surface::default();
    for i in 0..around {
        let t = 2.0 * PI * f64::from(i) / f64::from(around);
        for j in 0..across {
            let p = 2.0 * PI * f64::from(j) / f64::from(across);
            let r = 10.0 + 3.0 * p.cos();
            surface
                .positions
                .push([r * t.cos(), r * t.sin(), 3.0 * p.sin()]);
            let at = |i: u32, j: u32| i % around * across + j % across;
            let [a, b] = [at(i, j), at(i + 1, j)];
            let [c, d] = [at(i + 1, j + 1), at(i, j + 1)];
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    surface
}

/// One ball about a ring, its centre in the hole. The outward distance was measured at the point opposite to the
/// surface point nearest to the centre, where the ball is 14.9 from the ring; over the ring's axis it is 22.5.
#[test]
fn the_farthest_point_of_a_ball_about_a_ring_is_found() {
    let surface = ring();
    let (mesh, report) = surface.mesh();
    assert!(report.is_sound());
    let solid = Solid::new(&mesh).unwrap();
    let frame = solid.frame();
    let field = DepthField::new(&solid, Grid::new(&solid, 16));
    let meter = HausdorffMeter::new(&solid, &field);
    let (center, radius) = ([0.434, -0.514, 0.0], 23.481);
    let fit = meter.measure(&[Ball {
        center: frame.inward(center),
        radius: radius / frame.unit,
    }]);
    // By hand: a point at rho from the ring's axis has the square distance 100 + r^2 - d^2 - rho (20 - 2 d cos phi)
    // from its core. Here d is the centre's own distance from the axis. So the farthest point lies on the axis.
    let square = 100.0 + radius * radius - center[0].powi(2) - center[1].powi(2);
    let farthest = square.sqrt() - 3.0;
    assert!((farthest - 22.51).abs() < 0.01, "{farthest}");
    let [found, bound] =
        [fit.hausdorff_outward, fit.outward_bound].map(|length| length * frame.unit);
    assert!((found - farthest).abs() < 0.05, "{found} for {farthest}");
    assert!((29.0..30.0).contains(&bound), "{bound}");
    // Most of the ball lies beyond the grid's cube; its volume outside left that out.
    let ball = 4.0 / 3.0 * PI * radius.powi(3);
    let outside = fit.volume_outside * frame.unit.powi(3);
    let expected = ball - 2.0 * PI * PI * 10.0 * 9.0;
    assert!(
        (outside / expected - 1.0).abs() < 0.01,
        "{outside} for {expected}"
    );
}

/// A fin without thickness on a cube: no point of it is one of the solid. Its samples made the inward distance nine
/// times epsilon.
#[test]
fn sheets_have_no_part_in_the_inward_distance() {
    let body = cuboid([0.0; 3], [10.0; 3]);
    let mut front = cuboid([10.0, 5.0, 0.0], [20.0, 5.0, 10.0]);
    front.triangles.drain(..4);
    front.triangles.truncate(2);
    let solid = body.and(&front).and(&front.clone().inverted()).solid();
    let sampling = sample(
        &solid,
        16,
        Method::BehandishIlies(DecompositionOptions::default()),
    )
    .unwrap();
    assert_eq!(sampling.covering.unwrap().unreachable, 0);
    for set in &sampling.sets {
        let fit = HausdorffMeter::new(&solid, &sampling.field).measure(&set.balls);
        assert!(fit.hausdorff_inward <= sampling.field.grid.epsilon());
    }
}

#[test]
fn the_distance_to_many_balls_is_that_to_the_nearest() {
    let balls: Vec<Ball> = scattered(300, 0.5)
        .zip(scattered(900, 0.2).skip(500))
        .map(|(center, [radius, ..])| Ball {
            center,
            radius: radius.abs() + 1e-3,
        })
        .collect();
    let tree = BallTree::new(&balls);
    for point in scattered(500, 1.5) {
        let expected = balls
            .iter()
            .map(|ball| {
                (0..3)
                    .map(|a| (ball.center[a] - point[a]).powi(2))
                    .sum::<f64>()
                    .sqrt()
                    - ball.radius
            })
            .fold(f64::INFINITY, f64::min);
        assert_eq!(
            tree.distance(point, f64::NEG_INFINITY).to_bits(),
            expected.to_bits()
        );
        assert_eq!(tree.contains(point), expected <= 0.0);
    }
}

#[test]
fn packed_balls_lie_inside_and_do_not_overlap() {
    let solid = bunny();
    let sampling = sample(&solid, 20, Method::WellerZachmann).unwrap();
    let balls = &sampling.sets[0].balls;
    for (index, a) in balls.iter().enumerate() {
        assert!(solid.depth(a.center) >= a.radius - 1e-12);
        assert!(
            index == 0 || a.radius <= balls[index - 1].radius,
            "the largest first"
        );
        for b in &balls[..index] {
            let spacing = (0..3)
                .map(|axis| (a.center[axis] - b.center[axis]).powi(2))
                .sum::<f64>()
                .sqrt();
            assert!(spacing >= a.radius + b.radius - 1e-12);
        }
    }
    let fit = HausdorffMeter::new(&solid, &sampling.field).measure(balls);
    assert_eq!(fit.nodes_missed, 0);
}

#[test]
fn octree_medial_balls_and_voxels_cover_and_stay_near() {
    let solid = cuboid([-0.5; 3], [0.5; 3]).solid();
    for n in [16, 21] {
        let mut counts = Vec::new();
        for method in [Method::Voxels, Method::Octree, Method::MedialAxis] {
            let sampling = sample(&solid, n, method).unwrap();
            let fit = HausdorffMeter::new(&solid, &sampling.field).measure(&sampling.sets[0].balls);
            assert_eq!(fit.nodes_missed, 0);
            assert!(fit.outward_bound <= sampling.field.grid.epsilon() * (1.0 + 1e-12));
            counts.push(sampling.sets[0].balls.len());
        }
        assert_eq!(counts[0], (n - 2usize).pow(3));
        assert!(counts[1] < counts[0] / 2, "{counts:?}");
        assert!(counts[2] < counts[1], "{counts:?}");
    }
    // The medial axis of a rod is its line and those of its corners: the largest balls touch four faces.
    let rod = cuboid([-1.0, -0.25, -0.25], [1.0, 0.25, 0.25]).solid();
    let sampling = sample(&rod, 33, Method::MedialAxis).unwrap();
    let (grid, balls) = (sampling.field.grid, &sampling.sets[0].balls);
    let most = balls.iter().map(|ball| ball.radius).fold(0.0, f64::max);
    let half = 0.25 * grid.half() + grid.epsilon();
    assert!((most / half - 1.0).abs() < 0.01, "{most} {half}");
}

#[test]
fn a_ball_needs_one_ball() {
    let solid = sphere([0.0; 3], 1.0, 80).solid();
    let field = DepthField::new(&solid, Grid::new(&solid, 9));
    let found = decompose(
        &solid,
        &field,
        &DecompositionOptions {
            mu: 0.0,
            ..Default::default()
        },
    )
    .unwrap();
    assert_eq!(found.a3.len(), 1);
    assert_eq!(found.a3[0].center, [0.0; 3]);
}
