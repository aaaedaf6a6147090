//! Closed forms: balls, boxes, shells and nested solids.

use std::time::Duration;

use knotdock_scoring::se3::Pose;
use knotdock_structures::Ball;
use knotdock_structures::ball_solid::BallSolid;
use knotdock_structures::mesh::{self, Solid};
use knotdock_structures::sampling::ball_tree::BallTree;

use super::{Certificate, Collision, CollisionReport, DistanceBounds, Method, Verdict};
use crate::geometry::bracket::Bracket;
use crate::geometry::motion::geodesic_ball;
use crate::geometry::obstacle::{mirrored, sum};

fn balls(list: &[([f64; 3], f64)]) -> BallSolid {
    let balls: Vec<Ball> = list
        .iter()
        .map(|&(center, radius)| Ball { center, radius })
        .collect();
    BallSolid::from_balls(&balls, None).unwrap()
}

fn ball(radius: f64) -> BallSolid {
    balls(&[([0.0; 3], radius)])
}

/// Corners and faces of a box, outward, or inward where a part is hollowed out.
fn cuboid(half: [f64; 3], inward: bool) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let corner = |i: u32| {
        [0, 1, 2].map(|axis| {
            if i >> axis & 1 == 1 {
                half[axis]
            } else {
                -half[axis]
            }
        })
    };
    let faces = [
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];
    let faces = faces.map(|[a, b, c]| if inward { [a, c, b] } else { [a, b, c] });
    ((0..8).map(corner).collect(), faces.to_vec())
}

fn solid(parts: &[([f64; 3], bool)], per_axis: usize) -> BallSolid {
    let mut corners = Vec::new();
    let mut faces = Vec::new();
    for &(half, inward) in parts {
        let first = corners.len() as u32;
        let (own, triangles) = cuboid(half, inward);
        corners.extend(own);
        faces.extend(triangles.iter().map(|t| t.map(|corner| corner + first)));
    }
    let (mesh, _) = mesh::from_triangles(&corners, &faces).unwrap();
    BallSolid::from_mesh(&Solid::new(&mesh).unwrap(), per_axis)
        .unwrap()
        .0
}

fn at(translation: [f64; 3]) -> Pose {
    Pose::from_parts([1.0, 0.0, 0.0, 0.0], translation)
}

fn collision(solids: &[BallSolid; 2]) -> Collision<'_> {
    Collision::new(&solids[0], &solids[1])
}

fn ask(solids: &[BallSolid; 2], pose: &Pose) -> (CollisionReport, DistanceBounds) {
    let report = collision(solids).distance(true).at(pose).unwrap();
    (report, report.distance.unwrap())
}

#[test]
fn two_balls_are_exact() {
    let scene = [ball(1.0), ball(0.5)];
    for (x, verdict) in [
        (3.0, Verdict::Free),
        (1.5 + 1e-12, Verdict::Free),
        (1.5, Verdict::Undecided),
        (1.5 - 1e-12, Verdict::Hit),
        (0.7, Verdict::Hit),
        (0.0, Verdict::Hit),
    ] {
        let (found, bounds) = ask(&scene, &at([0.0, x, 0.0]));
        assert_eq!(found.verdict, verdict, "{x}");
        assert!((bounds.high - (x - 1.5)).abs() < 1e-14, "{x}");
        assert!(
            bounds.low <= bounds.high && bounds.high - bounds.low < 1e-10,
            "{x}: {bounds:?}"
        );
        let [a, b] = bounds.witnesses;
        if x > 0.0 {
            assert!((a[1] - 1.0).abs() < 1e-14 && (b[1] - (x - 0.5)).abs() < 1e-14);
        }
    }
}

#[test]
fn a_margin_is_a_distance() {
    let scene = [ball(1.0), ball(0.5)];
    for (x, verdict) in [(1.74, Verdict::Hit), (1.76, Verdict::Free)] {
        let report = collision(&scene).margin(0.25).at(&at([x, 0.0, 0.0]));
        assert_eq!(report.unwrap().verdict, verdict);
    }
    for margin in [-1.0, f64::NAN, f64::INFINITY] {
        let refused = collision(&scene).margin(margin).at(&at([0.0; 3]));
        let error = refused.unwrap_err();
        assert!(error.is_input() && error.remedy().is_some(), "{error}");
    }
}

#[test]
fn a_box_and_a_ball() {
    let block = solid(&[([1.0, 0.6, 0.4], false)], 24);
    let band = block.epsilon();
    let scene = [block, ball(0.5)];
    // Above a face, beyond an edge, beyond a corner, and through a face: exact signed distances.
    let slope = (0.3f64 * 0.3 + 0.4 * 0.4).sqrt();
    let corner = (0.3f64 * 0.3 * 3.0).sqrt();
    for (center, exact) in [
        ([0.1, 0.2, 1.7], 0.8),
        ([1.3, 1.0, 0.1], slope - 0.5),
        ([1.3, 0.9, 0.7], corner - 0.5),
        ([0.0, 0.0, 0.8], -0.1),
        ([0.0, 0.0, 0.0], -0.9),
    ] {
        let (found, bounds) = ask(&scene, &at(center));
        assert!(
            bounds.low <= exact + 1e-12 && exact <= bounds.high + 1e-12,
            "{center:?} {bounds:?}"
        );
        if exact > 0.0 {
            assert!((bounds.high - bounds.low - band).abs() < 1e-12);
        }
        match found.verdict {
            Verdict::Hit => assert!(exact < 0.0),
            Verdict::Free => assert!(exact >= 0.0),
            Verdict::Undecided => assert!(exact.abs() <= band),
        }
    }
    assert_eq!(ask(&scene, &at([0.0; 3])).0.verdict, Verdict::Hit);
    assert_eq!(
        ask(&scene, &at([0.1, 0.2, 1.7])).0.certificate,
        Certificate::OuterBalls
    );
}

/// Surface trees miss a solid within another; within a shell's hollow there is none.
#[test]
fn containment_is_a_hit_and_a_hollow_is_free() {
    let block = solid(&[([1.0; 3], false)], 24);
    let scene = [block, ball(0.2)];
    assert_eq!(ask(&scene, &at([0.1, -0.1, 0.2])).0.verdict, Verdict::Hit);
    let shell = solid(&[([1.0; 3], false), ([0.8; 3], true)], 32);
    let scene = [shell, ball(0.3)];
    let (found, bounds) = ask(&scene, &at([0.1, 0.0, 0.0]));
    assert_eq!(found.verdict, Verdict::Free);
    assert!(
        bounds.low <= 0.4 && 0.4 <= bounds.high && bounds.low > 0.2,
        "{bounds:?}"
    );
    assert_eq!(ask(&scene, &at([0.8, 0.0, 0.0])).0.verdict, Verdict::Hit);
    assert_eq!(ask(&scene, &at([1.5, 0.0, 0.0])).0.verdict, Verdict::Free);
}

/// A ball in a ring of balls: the translation that frees it goes along the axis.
#[test]
fn penetration_depth_of_nested_solids() {
    let ring: Vec<_> = (0..36)
        .map(|i| f64::from(i) * std::f64::consts::TAU / 36.0)
        .map(|turn| ([turn.cos(), turn.sin(), 0.0], 0.3))
        .collect();
    let scene = [balls(&ring), ball(0.8)];
    let (found, bounds) = ask(&scene, &at([0.0; 3]));
    assert_eq!(found.verdict, Verdict::Hit);
    // All pairs are 0.1 deep; along z the ball must go until it rests on the ring.
    let out = (1.1f64 * 1.1 - 1.0).sqrt();
    assert!((bounds.high + 0.1).abs() < 1e-14);
    assert!((bounds.low + out).abs() < 1e-9, "{bounds:?}");
}

/// Far coordinates, small sizes and radius ratios of a million.
#[test]
fn far_small_and_uneven_solids() {
    for (offset, size) in [(1e6, 1.0), (0.0, 1e-6), (1e6, 1e3)] {
        let one = balls(&[([offset, -offset, offset], size)]);
        let other = balls(&[
            ([-offset, offset, 0.0], size),
            ([-offset + 1.5 * size, offset, 0.0], 1e-6 * size),
        ]);
        let scene = [one, other];
        for (gap, verdict) in [(0.1, Verdict::Free), (-0.1, Verdict::Hit)] {
            let pose = at([2.0 * offset, -2.0 * offset, offset + (2.0 + gap) * size]);
            let (found, bounds) = ask(&scene, &pose);
            assert_eq!(found.verdict, verdict, "{offset} {size} {gap}");
            assert!((bounds.high / size - gap).abs() < 1e-8 + 1e-9 * offset / size);
        }
    }
}

/// Poses of the ball of SE(3) about a pose that a report promises have its verdict, and of one four times as large some
/// have not.
#[test]
fn pose_tolerances_hold() {
    let boxes = [[1.0, 0.6, 0.4], [0.7, 0.3, 0.9]].map(|half| solid(&[(half, false)], 16));
    let unions = [ball(1.0), balls(&[([0.3; 3], 0.5), ([1.0, 0.0, 0.0], 0.2)])];
    for (scene, margin) in [(&boxes, 0.0), (&boxes, 0.2), (&unions, 0.0)] {
        let ask = collision(scene).margin(margin).distance(true);
        let mut larger = 0;
        for (number, step) in [0.2, 0.6, 1.0, 1.6, 1.9, 2.2, 3.0].into_iter().enumerate() {
            let turn = [0.8, 0.1 * number as f64, -0.3, 0.2];
            let pose = Pose::from_parts(turn, [step, 0.2 * step, -0.1 * step]);
            let report = ask.at(&pose).unwrap();
            let tolerance = report.pose_tolerance.unwrap();
            assert_eq!(tolerance > 0.0, report.verdict != Verdict::Undecided);
            let others = |radius: f64| {
                let poses = geodesic_ball(&pose, radius, 200);
                let reports = ask.at_each(&poses).unwrap().into_iter();
                reports
                    .filter(|other| other.verdict != report.verdict)
                    .count()
            };
            assert_eq!(others((1.0 - 1e-9) * tolerance), 0, "{margin} {step}");
            larger += others(4.0 * tolerance);
        }
        assert!(larger > 0, "no tolerance is anywhere near the true one");
    }
}

#[test]
fn deadlines_bracket() {
    let block = solid(&[([1.0, 0.6, 0.4], false)], 24);
    let other = solid(&[([0.7, 0.3, 0.9], false)], 24);
    let scene = [block, other];
    let pose = Pose::from_parts([0.9, 0.1, -0.3, 0.2], [1.4, 0.7, 0.4]);
    let (whole, all) = ask(&scene, &pose);
    let hurried = collision(&scene).deadline(Some(Duration::ZERO));
    let early = hurried.distance(true).at(&pose).unwrap();
    let bounds = early.distance.unwrap();
    assert!(bounds.low <= all.high && bounds.high >= all.high);
    assert!(early.certificate == whole.certificate || early.certificate == Certificate::Deadline);
}

#[test]
fn forces_are_slopes_of_the_energy() {
    for (method, error) in [
        (Method::Tree, 1e-6),
        (Method::Hybrid, 1e-6),
        (Method::Auto, 1e-8),
    ] {
        slopes_of_the_energy(method, error);
    }
}

fn slopes_of_the_energy(method: Method, error: f64) {
    let block = solid(&[([1.0, 0.6, 0.4], false)], 20);
    let other = solid(&[([0.7, 0.3, 0.9], false)], 20);
    let scene = [block, other];
    let forces = collision(&scene).method(method).force(true);
    let contact = |pose: &Pose| forces.at(pose).unwrap().contact.unwrap();
    let pose = Pose::from_parts([0.9, 0.1, -0.3, 0.2], [0.9, 0.3, 0.2]);
    let here = contact(&pose);
    assert!(here.energy > 0.01);
    let step = 1e-5;
    let [_, b] = &scene;
    let center = pose.apply([0, 1, 2].map(|axis| b.origin()[axis] + b.centroid()[axis]));
    for axis in 0..3 {
        let mut shift = [0.0; 3];
        shift[axis] = step;
        let moved = |sign: f64| Pose {
            rotation: pose.rotation,
            translation: pose.translation + nalgebra::Vector3::from(shift) * sign,
        };
        let slope = (contact(&moved(1.0)).energy - contact(&moved(-1.0)).energy) / (2.0 * step);
        assert!(
            (slope + here.force[axis]).abs() < error,
            "{axis}: {slope} {:?}",
            here.force
        );
        let turned = |sign: f64| {
            let turn =
                nalgebra::UnitQuaternion::from_scaled_axis(nalgebra::Vector3::from(shift) * sign);
            let about = nalgebra::Vector3::from(center);
            Pose {
                rotation: turn * pose.rotation,
                translation: turn * (pose.translation - about) + about,
            }
        };
        let slope = (contact(&turned(1.0)).energy - contact(&turned(-1.0)).energy) / (2.0 * step);
        assert!(
            (slope + here.torque[axis]).abs() < error,
            "{axis}: {slope} {:?}",
            here.torque
        );
    }
}

/// Two boxes with faces parallel: flush faces are no hit and no miss, and the shared volume is a product of lengths.
#[test]
fn boxes_with_parallel_faces() {
    let half = [1.0, 0.5, 0.75];
    let scene = [solid(&[(half, false)], 12), solid(&[([0.5; 3], false)], 12)];
    let all = collision(&scene)
        .distance(true)
        .shared_volume(true)
        .force(true);
    for (place, verdict, shared) in [
        ([1.5, 0.0, 0.0], Verdict::Undecided, 0.0),
        ([1.5, 1.0, 0.0], Verdict::Undecided, 0.0),
        ([1.5, 1.0, 1.25], Verdict::Undecided, 0.0),
        ([1.5 + 1e-9, 0.0, 0.0], Verdict::Free, 0.0),
        ([1.5 - 1e-9, 0.0, 0.0], Verdict::Hit, 1e-9),
        // Faces in one plane.
        ([1.25, 0.0, 0.25], Verdict::Hit, 0.25),
        ([0.5, 0.0, 0.25], Verdict::Hit, 1.0),
        // Within it.
        ([0.1, 0.0, 0.0], Verdict::Hit, 1.0),
    ] {
        let found = all.at(&at(place)).unwrap();
        assert_eq!(found.verdict, verdict, "{place:?} {found:?}");
        let (volume, contact) = (found.shared_volume.unwrap(), found.contact.unwrap());
        assert!(
            (volume.value - shared).abs() <= volume.bound,
            "{place:?} {volume:?}"
        );
        assert!(volume.bound < 1e-9, "{place:?} {volume:?}");
        assert_eq!(contact.energy, volume.value);
        if verdict == Verdict::Free {
            let bounds = found.distance.unwrap();
            assert!(
                (bounds.high - 1e-9).abs() < 1e-13 && bounds.low >= 0.0,
                "{bounds:?}"
            );
        }
        // Along x; along y and z the volume is largest where faces are in one plane, and has no slope.
        if place[0] > 1.1 && verdict == Verdict::Hit {
            assert!((contact.force[0] - 1.0).abs() < 1e-6, "{contact:?}");
        }
    }
    let close = collision(&scene).margin(0.1);
    for (x, verdict) in [
        (1.59, Verdict::Hit),
        (1.61, Verdict::Free),
        (1.6, Verdict::Undecided),
    ] {
        assert_eq!(
            close.at(&at([x, 0.1, 0.2])).unwrap().verdict,
            verdict,
            "{x}"
        );
    }
}

/// Penetration depth of two boxes: the least overlap along the normals of faces and the products of two edges.
fn depth_of_boxes(halves: [[f64; 3]; 2], pose: &Pose) -> f64 {
    let matrix = pose.rotation.to_rotation_matrix();
    let still = [0, 1, 2].map(|axis| nalgebra::Vector3::ith(axis, 1.0));
    let turned = still.map(|edge: nalgebra::Vector3<f64>| matrix * edge);
    let products = still.iter().flat_map(|a| turned.map(|b| a.cross(&b)));
    let axes = still.into_iter().chain(turned).chain(products);
    let axes = axes.filter_map(|axis| axis.try_normalize(1e-6));
    let overlap = |axis: nalgebra::Vector3<f64>| {
        let reach = |half: &[f64; 3], edges: &[nalgebra::Vector3<f64>; 3]| {
            let parts = half.iter().zip(edges);
            parts
                .map(|(half, edge)| half * axis.dot(edge).abs())
                .sum::<f64>()
        };
        reach(&halves[0], &still) + reach(&halves[1], &turned) - axis.dot(&pose.translation).abs()
    };
    axes.map(overlap).fold(f64::INFINITY, f64::min)
}

/// Depths of boxes are found, not only bounded, and an exchange of the bodies does not change them.
#[test]
fn penetration_depth_of_boxes() {
    let halves = [[1.5, 1.0, 0.5], [1.0, 1.0, 1.0]];
    let scene = halves.map(|half| solid(&[(half, false)], 16));
    let turned_round = [scene[1].clone(), scene[0].clone()];
    let (mut hits, mut exact) = (0, 0);
    for step in 0..60 {
        let part = |by: f64| 2.0 * (f64::from(step) * by).fract() - 1.0;
        let rotation = [part(0.8191), part(0.671), part(0.5497), part(0.4503)];
        let pose = Pose::from_parts(
            rotation,
            [2.0 * part(0.31), 1.7 * part(0.77), 1.5 * part(0.19)],
        );
        let depth = depth_of_boxes(halves, &pose);
        let (found, bounds) = ask(&scene, &pose);
        assert_eq!(
            found.verdict == Verdict::Hit,
            depth > 0.0,
            "{step}: {depth}"
        );
        if depth <= 0.0 {
            continue;
        }
        let (_, back) = ask(&turned_round, &pose.inverse());
        assert!(
            bounds.low <= -depth * (1.0 - 1e-12) && -depth <= bounds.high + 1e-12,
            "{step}"
        );
        assert!(
            -bounds.low <= 1.5 * depth + 1e-9,
            "{step}: {bounds:?} {depth}"
        );
        assert!(
            (back.low - bounds.low).abs() <= 0.05 * depth + 1e-9,
            "{step}: {back:?} {bounds:?}"
        );
        hits += 1;
        exact += usize::from(-bounds.low < 1.01 * depth);
    }
    assert!(hits > 20 && 10 * exact > 9 * hits, "{exact} of {hits}");
}

/// A longer unit and another place change nothing but the digits that they cost.
#[test]
fn verdicts_forces_and_volumes_know_no_unit() {
    let pose = Pose::from_parts([0.615, 0.113, -0.729, 0.279], [-0.767, 0.2, 0.212]);
    let at_scale = |scale: f64| {
        let block = |half: [f64; 3]| solid(&[(half.map(|side| side * scale), false)], 16);
        let scene = [block([1.5, 1.0, 0.5]), block([1.0; 3])];
        let pose = Pose {
            translation: pose.translation * scale,
            ..pose
        };
        collision(&scene)
            .force(true)
            .at(&pose)
            .unwrap()
            .contact
            .unwrap()
    };
    let (metres, millimetres) = (at_scale(1.0), at_scale(1e3));
    let close = |a: f64, b: f64, size: f64| (a - b).abs() <= 1e-11 * size;
    assert!(close(metres.energy * 1e9, millimetres.energy, 1e9));
    for axis in 0..3 {
        assert!(close(
            metres.force[axis] * 1e6,
            millimetres.force[axis],
            1e6
        ));
        assert!(close(
            metres.torque[axis] * 1e9,
            millimetres.torque[axis],
            1e9
        ));
    }
    assert!(metres.energy > 1.0);
}

/// Modes and pairs are two ways to one energy: within the bound, whichever is taken.
#[test]
fn modes_agree_with_pairs_and_certify_hits_only() {
    let block = solid(&[([1.0, 0.6, 0.4], false)], 16);
    let other = solid(&[([0.7, 0.3, 0.9], false)], 16);
    let scene = [block, other];
    let by = |method| collision(&scene).method(method).max_modes(6000).force(true);
    let [pairs, modes] = [Method::Tree, Method::Modes].map(by);
    let mut hits = 0;
    for step in 0..100 {
        let part = |by: f64| 2.0 * (f64::from(step) * by).fract() - 1.0;
        let rotation = [part(0.8191), part(0.671), part(0.5497), part(0.4503)];
        let pose = Pose::from_parts(rotation, [part(0.31), 0.7 * part(0.77), 0.7 * part(0.19)]);
        let [by_pairs, by_modes] = [&pairs, &modes].map(|way| way.at(&pose).unwrap());
        let [exact, summed] = [by_pairs, by_modes].map(|report| report.contact.unwrap());
        assert!(
            (exact.energy - summed.energy).abs() <= exact.bound + summed.bound,
            "{step}"
        );
        assert_ne!(by_modes.verdict, Verdict::Free);
        if by_modes.verdict == Verdict::Hit {
            assert_eq!(by_pairs.verdict, Verdict::Hit, "{step}");
            hits += 1;
        }
    }
    assert!(hits > 20, "{hits}");
}

/// A ball that flies at another one: contact at the time of the closed form.
#[test]
fn the_time_of_impact_of_two_balls() {
    let scene = [ball(1.0), ball(0.5)];
    let path = [
        at([5.0, 0.9, 0.0]),
        at([3.0, 0.9, 0.0]),
        at([-3.0, 0.9, 0.0]),
    ];
    let found = collision(&scene).first_impact(&path);
    // Contact at x = 1.2.
    assert!((found.free_until - 1.3).abs() < 1e-6, "{found:?}");
    assert!(found.pose.is_some() && found.steps < 200);
    let hit_by = found.hit_by.unwrap();
    assert!(hit_by > 1.3 && hit_by < 1.3 + 1e-6, "{found:?}");
    let past = [at([5.0, 1.6, 0.0]), at([-5.0, 1.6, 0.0])];
    let found = collision(&scene).first_impact(&past);
    assert_eq!((found.pose, found.free_until), (None, 1.0));
    assert_eq!(found.hit_by, None);
}

/// A bar in a hollow box hits its wall: the true time is between the bounds, which a finer grid narrows.
#[test]
fn the_time_of_impact_of_meshes_is_between_bounds() {
    let slot = solid(&[([2.0; 3], false), ([1.0, 1.0, 1.5], true)], 20);
    // Along z the bar has 0.9 to go.
    let path = [at([0.0; 3]), at([0.0, 0.0, 2.0])];
    let mut widths = Vec::new();
    for per_axis in [12, 24] {
        let bar = solid(&[([0.4, 0.4, 0.6], false)], per_axis);
        let scene = [slot.clone(), bar];
        for method in [Method::Tree, Method::Auto] {
            let found = collision(&scene).method(method).first_impact(&path);
            let (low, high) = (found.free_until, found.hit_by.unwrap());
            assert!(low <= 0.45 && 0.45 <= high, "{found:?}");
            widths.push(high - low);
        }
    }
    assert!(widths[2] < widths[0], "{widths:?}");
    // Triangles know it on any grid.
    assert!(widths[1] < 1e-5 && widths[3] < 1e-5, "{widths:?}");
}

#[test]
fn shared_volume_of_two_balls_is_the_lens() {
    let scene = [ball(1.0), ball(0.8)];
    let d = 1.1f64;
    let volume = |x: f64, time: Option<Duration>| {
        let volumes = collision(&scene).shared_volume(true).deadline(time);
        let report = volumes.at(&at([x, 0.0, 0.0])).unwrap();
        report.shared_volume.unwrap()
    };
    let shared = volume(d, None);
    let (r, s) = (1.0f64, 0.8f64);
    let exact = std::f64::consts::PI
        * (r + s - d).powi(2)
        * (d * d + 2.0 * d * (r + s) - 3.0 * (r - s).powi(2))
        / (12.0 * d);
    assert!(
        (shared.value - exact).abs() <= shared.bound && shared.bound < 1e-12,
        "{shared:?} {exact}"
    );
    // A deadline leaves bounds by balls, whether it comes or not.
    for time in [Duration::ZERO, Duration::from_secs(60)] {
        let quick = volume(d, Some(time));
        assert!(
            (quick.value - exact).abs() <= quick.bound + 1e-12,
            "{quick:?} {exact}"
        );
    }
    assert_eq!(volume(1.9, None).value, 0.0);
}

/// A translation is in the obstacle if collide finds a hit, and only then: two ways to one question (eq. 29 and 50),
/// over 10,000 poses at 20 rotations, for inner and outer balls.
#[test]
fn the_obstacle_agrees_with_the_verdicts() {
    let (block, other) = (
        solid(&[([1.0, 0.6, 0.4], false)], 8),
        solid(&[([0.7, 0.3, 0.9], false)], 8),
    );
    let [a, b] = [&block, &other].map(Bracket::from);
    let scene = [block, other];
    let mut counts = [0; 3];
    for turn in 0..20 {
        let part = |by: f64| 2.0 * (f64::from(turn) * by).fract() - 1.0;
        let rotation = [0.3 + part(0.8191), part(0.671), part(0.5497), part(0.4503)];
        let turned = Pose::from_parts(rotation, [0.0; 3]);
        let found = sum(&a, &mirrored(&b, &turned), 0.0);
        let trees = [&found.inner, &found.outer].map(|balls| BallTree::new(balls));
        for step in 0..500 {
            let part = |by: f64| 2.2 * (2.0 * (f64::from(500 * turn + step) * by).fract() - 1.0);
            let place = [part(0.7548), part(0.5698), part(0.3333)];
            let pose = Pose {
                rotation: turned.rotation,
                translation: place.into(),
            };
            let relative = [0, 1, 2].map(|axis| place[axis] - found.origin[axis]);
            let [inner, outer] = [0, 1].map(|set| trees[set].distance(relative, f64::NEG_INFINITY));
            if inner.abs().min(outer.abs()) < 1e-9 {
                continue;
            }
            let expected = match (inner < 0.0, outer < 0.0) {
                (true, _) => Verdict::Hit,
                (false, true) => Verdict::Undecided,
                (false, false) => Verdict::Free,
            };
            let balls = collision(&scene).method(Method::Tree);
            let verdict = balls.at(&pose).unwrap().verdict;
            assert_eq!(verdict, expected, "{turn} {step}: {inner} {outer}");
            counts[verdict as usize] += 1;
        }
    }
    assert!(counts.iter().all(|&count| count > 300), "{counts:?}");
}
