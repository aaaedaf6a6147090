//! Distances, winding numbers, orientation and soundness, against closed forms and slow sums.

#![cfg(feature = "mesh")]

use crate::solids::{Surface, cuboid, scattered, sphere};
use knotdock_structures::mesh::{Solid, from_triangles};

/// Signed distance to a box centred at zero, above zero inside.
fn box_depth(half: [f64; 3], p: [f64; 3]) -> f64 {
    let q = [0, 1, 2].map(|axis| p[axis].abs() - half[axis]);
    let outside = q
        .map(|v| v.max(0.0))
        .iter()
        .map(|v| v * v)
        .sum::<f64>()
        .sqrt();
    -outside - q.into_iter().fold(f64::NEG_INFINITY, f64::max).min(0.0)
}

#[test]
fn depth_in_and_about_a_box() {
    let half = [0.5, 0.25, 0.125];
    let solid = cuboid(half.map(|v| -v), half).solid();
    assert_eq!(solid.frame().unit, 1.0);
    for point in scattered(4000, 0.7) {
        let expected = box_depth(half, point);
        let found = solid.depth(point);
        assert!(
            (found - expected).abs() < 1e-14,
            "{point:?}: {found} {expected}"
        );
        assert_eq!(
            solid.distance_within(point, expected.abs()).to_bits(),
            found.abs().to_bits()
        );
        // A bound that is too small is found out, not believed.
        assert_eq!(
            solid.distance_within(point, expected.abs() / 2.0).to_bits(),
            found.abs().to_bits()
        );
    }
}

/// The polyhedron's vertices are on the sphere, so its depth is at most that of the ball and less by at most the
/// sagitta.
#[test]
fn depth_in_and_about_a_ball() {
    let (radius, rings) = (0.5, 60);
    let solid = sphere([0.0; 3], radius, rings).solid();
    let sagitta = radius * (1.0 - (std::f64::consts::PI / f64::from(rings)).cos());
    for point in scattered(2000, 0.6) {
        let ball =
            radius - (point[0] * point[0] + point[1] * point[1] + point[2] * point[2]).sqrt();
        let found = solid.depth(point);
        assert!(
            found <= ball + 1e-14 && found >= ball - 2.0 * sagitta,
            "{found} {ball}"
        );
    }
}

/// The same distances as parry's, of a ball, of a needle and of triangles that cross.
#[test]
fn distances_are_those_of_another_library() {
    use parry3d_f64::math::Vector;
    use parry3d_f64::query::PointQuery;
    use parry3d_f64::shape::TriMesh;

    let crossed = sphere([0.0; 3], 1.0, 24).and(&sphere([0.8, 0.3, 0.0], 0.9, 20));
    for surface in [
        sphere([0.0; 3], 1.0, 40),
        cuboid([0.0; 3], [1000.0, 1.0, 1.0]),
        crossed,
    ] {
        let solid = surface.solid();
        let mesh = solid.mesh();
        let positions = mesh.positions().iter().map(|&p| Vector::from_array(p));
        let other = TriMesh::new(positions.collect(), mesh.triangles().to_vec()).unwrap();
        for point in scattered(2000, 0.7) {
            let expected = other.distance_to_local_point(Vector::from_array(point), false);
            let found = solid.distance(point);
            assert!(
                (found - expected).abs() < 1e-14,
                "{point:?}: {found} {expected}"
            );
            let slack = solid.distance_within(point, 1.5 * expected);
            assert_eq!(slack.to_bits(), found.to_bits());
        }
    }
}

#[test]
fn volumes_and_areas_are_the_closed_forms() {
    let (mesh, report) = cuboid([1e6, 0.0, 0.0], [1e6 + 2.0, 3.0, 0.5]).mesh();
    assert!((mesh.volume() - 3.0).abs() < 1e-9 && (mesh.area() - 17.0).abs() < 1e-9);
    assert!(report.is_sound() && report.parts == 1 && report.missing_share == 0.0);
    let (ball, _) = sphere([0.0; 3], 2.0, 100).mesh();
    let volume = 4.0 / 3.0 * std::f64::consts::PI * 8.0;
    assert!(ball.volume() < volume && ball.volume() > volume * 0.998);
}

#[test]
fn winding_numbers_count_how_often_a_point_is_enclosed() {
    let outer = cuboid([0.0; 3], [4.0; 3]);
    let inner = cuboid([1.0; 3], [2.0; 3]);
    for (surface, expected) in [
        (outer.clone().and(&inner), 2.0), // a solid within a solid
        (outer.clone().and(&inner.inverted()), 0.0), // a cavity
    ] {
        let (mesh, report) = surface.mesh();
        // A solid within a solid may be a cavity that faces the wrong way.
        assert_eq!(report.is_sound(), expected == 0.0);
        assert!(report.is_closed() && report.parts == 2);
        let solid = Solid::new(&mesh).unwrap();
        let at = |x: f64| solid.frame().inward([x; 3]);
        assert!((solid.winding_number(at(1.5)) - expected).abs() < 1e-12);
        assert_eq!(solid.is_inside(at(1.5)), expected > 0.5);
        assert!((solid.winding_number(at(3.0)) - 1.0).abs() < 1e-12 && solid.is_inside(at(3.0)));
        assert!(solid.winding_number(at(5.0)).abs() < 1e-12 && !solid.is_inside(at(5.0)));
    }
}

/// The dipoles never change the answer of the full sum: closed, self-intersecting, open.
#[test]
fn the_fast_inside_test_is_the_slow_one() {
    let ball = sphere([0.0; 3], 1.0, 24);
    let crossed = ball.clone().and(&sphere([0.8, 0.3, 0.0], 0.9, 20));
    let mut open = ball.clone();
    // A tenth of the ball's top is missing.
    open.triangles.retain(|t| {
        t.iter()
            .all(|&corner| ball.positions[corner as usize][2] < 0.8)
    });
    for (surface, is_closed) in [(ball, true), (crossed, true), (open, false)] {
        let (mesh, report) = surface.mesh();
        assert_eq!(report.is_closed(), is_closed);
        let solid = Solid::new(&mesh).unwrap();
        let mut inside = 0;
        for point in scattered(3000, 0.55) {
            let winding = solid.winding_number(point);
            let in_box = (0..3).all(|axis| point[axis].abs() <= solid.half_sides()[axis]);
            assert_eq!(
                solid.is_inside(point),
                winding > 0.5 && in_box,
                "{point:?}: {winding}"
            );
            if is_closed {
                assert!((winding - winding.round()).abs() < 1e-9);
            }
            inside += usize::from(solid.is_inside(point));
        }
        assert!(inside > 100);
    }
}

/// Both sides of every triangle, as programs for pictures write them, bound nothing; the surface twice has twice the
/// volume.
#[test]
fn a_surface_that_is_there_twice_is_taken_once() {
    let ball = sphere([0.0; 3], 1.0, 8);
    let (once, plain) = ball.mesh();
    assert_eq!(plain.times, 1);
    for again in [ball.clone().inverted(), ball.clone()] {
        let (mesh, report) = ball.clone().and(&again).mesh();
        assert_eq!((report.times, report.triangles), (2, plain.triangles));
        assert_eq!((report.parts, report.nonmanifold_edges), (1, 0));
        assert_eq!(report.file_triangles, 2 * plain.file_triangles);
        assert_eq!(mesh.volume(), once.volume());
        assert!(report.is_closed() && !report.is_sound());
        assert!(report.warnings()[0].contains("each triangle 2 times"));
    }
}

#[test]
fn triangles_and_parts_that_face_the_wrong_way_are_turned() {
    let ball = sphere([0.0; 3], 1.0, 8);
    let volume = ball.mesh().0.volume();
    // Some triangles of one part.
    let mut mixed = ball.clone();
    for triangle in mixed.triangles.iter_mut().step_by(3) {
        triangle.swap(0, 1);
    }
    let (mesh, report) = mixed.mesh();
    assert!(report.is_closed() && !report.is_sound());
    assert_eq!(report.turned_triangles, ball.triangles.len().div_ceil(3));
    assert!((mesh.volume() - volume).abs() < 1e-12);
    // A whole part; beside it, one that is right.
    let pair = ball
        .clone()
        .inverted()
        .and(&sphere([3.0, 0.0, 0.0], 1.0, 8));
    let (mesh, report) = pair.mesh();
    assert_eq!((report.inverted_parts, report.parts), (1, 2));
    assert!((mesh.volume() - 2.0 * volume).abs() < 1e-12);
    // A shell whose two walls both face the wrong way stays a shell; so does a sound one, untouched.
    let shell = ball.clone().and(&sphere([0.0; 3], 0.5, 8).inverted());
    for (surface, turned) in [(shell.clone(), 0), (shell.inverted(), 2)] {
        let (mesh, report) = surface.mesh();
        assert_eq!(report.inverted_parts, turned);
        assert!((mesh.volume() - volume * 0.875).abs() < 1e-12);
        let solid = Solid::new(&mesh).unwrap();
        assert!(!solid.is_inside([0.0; 3]) && solid.is_inside([0.0, 0.0, 0.375]));
    }
}

/// A surface whose triangles share no corners: each corner is a little off its neighbours', as many programs write
/// them.
fn in_pieces(surface: &Surface) -> Surface {
    let mut pieces = Surface {
        positions: Vec::new(),
        triangles: Vec::new(),
    };
    for corners in &surface.triangles {
        let corners = corners.map(|corner| surface.positions[corner as usize]);
        let first = pieces.positions.len() as u32;
        pieces.triangles.push([first, first + 1, first + 2]);
        for corner in corners {
            pieces.positions.push(std::array::from_fn(|axis| {
                let middle = corners.iter().map(|c| c[axis]).sum::<f64>() / 3.0;
                corner[axis] + 1e-8 * (middle - corner[axis])
            }));
        }
    }
    pieces
}

/// A piece of a surface has no inside: all pieces face as the whole does, the wall of a cavity too.
#[test]
fn pieces_of_a_surface_are_turned_together() {
    let outer = cuboid([-1.0; 3], [1.0; 3]);
    let cavity = cuboid([-0.5, -0.4, -0.3], [0.5, 0.4, 0.3]).inverted();
    let shell = outer.clone().and(&cavity);
    // A cavity that runs through from side to side.
    let tube = {
        let mut tube = cuboid([-1.0; 3], [1.0; 3]);
        let bore = cuboid([-0.5, -0.5, -1.0], [0.5, 0.5, 1.0]).inverted();
        let ends = |z: f64| move |corner: &[f64; 3]| corner[2] == z;
        for z in [-1.0, 1.0] {
            let flat = |surface: &Surface, triangle: &[u32; 3]| {
                triangle
                    .iter()
                    .all(|&c| ends(z)(&surface.positions[c as usize]))
            };
            let caps: Vec<[u32; 3]> = tube
                .triangles
                .iter()
                .copied()
                .filter(|t| flat(&tube, t))
                .collect();
            tube.triangles.retain(|t| !caps.contains(t));
            // What is left of an end about the bore.
            for (low, high) in [
                ([-1.0, -1.0], [1.0, -0.5]),
                ([-1.0, 0.5], [1.0, 1.0]),
                ([-1.0, -0.5], [-0.5, 0.5]),
                ([0.5, -0.5], [1.0, 0.5]),
            ] {
                let strip = cuboid([low[0], low[1], z.min(0.0)], [high[0], high[1], z.max(0.0)]);
                let mut strip_end = strip.clone();
                strip_end.triangles.retain(|t| flat(&strip, t));
                tube = tube.and(&strip_end);
            }
        }
        let mut walls = bore.clone();
        walls.triangles.retain(|t| {
            !t.iter().all(|&c| bore.positions[c as usize][2] == 1.0)
                && !t.iter().all(|&c| bore.positions[c as usize][2] == -1.0)
        });
        tube.and(&walls)
    };
    for (surface, hollow, solid_at) in [
        (outer, [3.0; 3], [0.1, 0.2, 0.0]),
        (shell, [0.1, 0.2, 0.0], [0.8, 0.1, 0.2]),
        (tube, [0.1, 0.2, 0.0], [0.8, 0.1, 0.2]),
    ] {
        for (surface, turns) in [(surface.clone(), false), (surface.inverted(), true)] {
            let (mesh, report) = in_pieces(&surface).mesh();
            assert_eq!(report.parts, surface.triangles.len());
            assert_eq!(report.inverted_parts, if turns { report.parts } else { 0 });
            let solid = Solid::new(&mesh).unwrap();
            let inside = |point: [f64; 3]| solid.is_inside(solid.frame().inward(point));
            assert!(!inside(hollow) && inside(solid_at), "{turns}");
        }
    }
}

/// Boxes that share an edge and both face inward, and boxes that overlap, of which one does, whichever of its corners
/// comes first.
#[test]
fn touching_and_overlapping_parts_are_turned() {
    let touching = cuboid([0.0; 3], [1.0; 3]).and(&cuboid([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]));
    let (mesh, report) = touching.inverted().mesh();
    assert_eq!(report.inverted_parts, 2);
    assert!((mesh.volume() - 2.0).abs() < 1e-15 && !report.is_sound());
    for first in 0..12 {
        let mut inward = cuboid([1.0; 3], [3.0; 3]).inverted();
        inward.triangles.rotate_left(first);
        let (mesh, report) = cuboid([0.0; 3], [2.0; 3]).and(&inward).mesh();
        assert_eq!(report.inverted_parts, 1, "{first}");
        assert!((mesh.volume() - 16.0).abs() < 1e-12);
    }
}

#[test]
fn open_and_nonmanifold_edges_are_counted() {
    let mut open = cuboid([0.0; 3], [1.0, 1.0, 1.0]);
    open.triangles.truncate(10); // without its top
    let (_, report) = open.mesh();
    assert_eq!((report.open_edges, report.unbalanced_edges), (4, 4));
    assert!((report.open_length - 4.0).abs() < 1e-15);
    assert!(
        (report.missing_share - 0.2).abs() < 1e-15,
        "one side of five"
    );
    assert!(!report.is_closed() && report.warnings()[0].contains("4 open"));
    // Two boxes that share an edge: four triangles meet there, but every point is plainly in or out.
    let touching = cuboid([0.0; 3], [1.0; 3]).and(&cuboid([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]));
    let (mesh, report) = touching.mesh();
    assert_eq!((report.nonmanifold_edges, report.parts), (1, 2));
    assert!(report.is_sound() && (mesh.volume() - 2.0).abs() < 1e-15);
}

#[test]
fn triangles_without_area_do_no_harm() {
    // The corner 8 lies on an edge of the box; the sliver there keeps the surface closed.
    let mut surface = cuboid([0.0; 3], [1.0; 3]);
    surface.positions.push([0.5, 0.0, 0.0]);
    let edge = surface
        .triangles
        .iter()
        .position(|t| t.contains(&0) && t.contains(&1))
        .unwrap();
    let [a, b, c] = surface.triangles[edge];
    let (from, to, tip) = [(a, b, c), (b, c, a), (c, a, b)]
        .into_iter()
        .find(|(from, to, _)| from + to == 1)
        .unwrap();
    surface.triangles[edge] = [from, 8, tip];
    surface.triangles.push([8, to, tip]);
    surface.triangles.push([from, to, 8]);
    surface.triangles.push([3, 3, 5]);
    let (mesh, report) = surface.mesh();
    assert!(report.is_sound(), "{report:?}");
    assert_eq!(report.degenerate_triangles, 2);
    let solid = Solid::new(&mesh).unwrap();
    for point in scattered(1000, 0.7) {
        assert!((solid.depth(point) - box_depth([0.5; 3], point)).abs() < 1e-14);
    }
}

#[test]
fn samples_cover_the_surface_as_densely_as_requested() {
    let surface = cuboid([0.0; 3], [1.0, 0.1, 0.001]);
    let (mesh, _) = surface.mesh();
    let solid = Solid::new(&mesh).unwrap();
    let spacing = 0.01;
    let mut samples = Vec::new();
    for triangle in 0..solid.sampled_triangles() {
        solid.samples_of(
            triangle,
            spacing,
            |_, _| false,
            |sample| samples.push(sample),
        );
    }
    let area: f64 = samples.iter().map(|sample| sample.area).sum();
    assert!((area - mesh.area()).abs() < 1e-12);
    assert!(samples.len() < 20_000, "{} samples", samples.len());
    for point in scattered(300, 0.5) {
        let point = solid.nearest(point);
        let nearest = samples
            .iter()
            .map(|sample| {
                (0..3)
                    .map(|axis| (sample.point[axis] - point[axis]).powi(2))
                    .sum::<f64>()
            })
            .fold(f64::INFINITY, f64::min);
        assert!(nearest.sqrt() <= spacing);
    }
    for sample in samples {
        assert!(solid.distance(sample.point) < 1e-15);
        let inward = [0, 1, 2].map(|axis| sample.point[axis] - 1e-5 * sample.normal[axis]);
        assert!(solid.is_inside(inward));
    }
}

#[test]
fn indices_out_of_range_are_refused() {
    assert!(from_triangles(&[[0.0; 3], [1.0; 3]], &[[0, 1, 2]]).is_err());
}
