//! Collisions beside parry3d's: no verdict contradicts it, none is open, and distances are the same. Verdicts by balls alone
//! do not contradict it either, and their bounds hold the distance. `scripts/checks/check_solids.py` does the same with coal and
//! Manifold, and more poses.

#[path = "../benches/collide/path.rs"]
#[allow(dead_code)]
mod path;
#[path = "../benches/collide/peers.rs"]
#[allow(dead_code)]
mod peers;

use crate::docking_parts::{Part, linked_torus, peg_and_hole};
use knotdock::Collision;
use knotdock::geometry::collide::{Method, Verdict};
use knotdock_scoring::se3::Pose;
use knotdock_structures::ball_solid::BallSolid;
use knotdock_structures::mesh::{Mesh, Solid, from_triangles, read};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use peers::Parry;
use std::f64::consts::TAU;
use std::path::Path;

/// Numbers that look random, each from -1 to 1 (a Weyl sequence of each axis).
fn number(index: usize, axis: usize) -> f64 {
    const STEPS: [f64; 7] = [
        0.618_034, 0.754_878, 0.819_173, 0.856_675, 0.881_272, 0.898_654, 0.911_591,
    ];
    2.0 * (index as f64 * STEPS[axis]).fract() - 1.0
}

fn vector(index: usize, first: usize) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| number(index, first + axis))
}

/// Poses about the place where both stand: every other one just off contact, the rest anywhere.
fn poses(parry: &Parry, size: f64, count: usize) -> Vec<Pose> {
    let pose = |index: usize| {
        let turn = vector(index, 0);
        let quaternion = Quaternion::new(number(index, 6), turn.x, turn.y, turn.z);
        let rotation = UnitQuaternion::from_quaternion(quaternion);
        let away = vector(index, 3).normalize();
        let at = |reach: f64| Pose {
            rotation,
            translation: reach * away,
        };
        if index.is_multiple_of(2) {
            return at(0.6 * size * (1.0 + number(index, 5)));
        }
        // Toward the other until the surfaces are close.
        let mut reach = 2.5 * size;
        for _ in 0..12 {
            let gap = parry.distance(&at(reach)).unwrap();
            reach -= gap;
            if gap < 0.01 * size {
                break;
            }
        }
        at(reach + 0.03 * size * number(index, 2))
    };
    (1..=count).map(pose).collect()
}

/// Whether a point is inside a closed mesh, by the solid angle of each triangle (van Oosterom and Strackee).
fn holds(mesh: &Mesh, point: Vector3<f64>) -> bool {
    let angle = |triangle: &[u32; 3]| {
        let [a, b, c] =
            triangle.map(|corner| Vector3::from(mesh.positions()[corner as usize]) - point);
        let [x, y, z] = [a, b, c].map(|edge| edge.norm());
        let over = a.dot(&b.cross(&c));
        2.0 * over.atan2(x * y * z + a.dot(&b) * z + b.dot(&c) * x + c.dot(&a) * y)
    };
    mesh.triangles().iter().map(angle).sum::<f64>() > TAU
}

/// Holds the answers on two meshes at poses to parry's; how many poses meet, are nested, and are undecided by balls.
fn compare(meshes: [&Mesh; 2], poses: &[Pose], per_axis: usize) -> [usize; 3] {
    let parry = Parry::new(meshes).unwrap();
    let solids = meshes.map(|mesh| {
        BallSolid::from_mesh(&Solid::new(mesh).unwrap(), per_axis)
            .unwrap()
            .0
    });
    let exact = Collision::new(&solids[0], &solids[1]).distance(true);
    let balls = exact.clone().method(Method::Tree);
    let triangles = exact.clone().method(Method::Exact);
    let mut counts = [0; 3];
    for pose in poses {
        let corner = Vector3::from(meshes[1].positions()[0]);
        let back =
            |point: [f64; 3]| pose.rotation.inverse() * (Vector3::from(point) - pose.translation);
        let meet = parry.meet(pose).unwrap();
        let nested = !meet
            && (holds(meshes[0], pose.rotation * corner + pose.translation)
                || holds(meshes[1], back(meshes[0].positions()[0])));
        let apart = parry.distance(pose).unwrap();
        let rounding = 1e-9;
        for collision in [&exact, &triangles, &balls] {
            let report = collision.at(pose).unwrap();
            let (verdict, bounds) = (report.verdict, report.distance.unwrap());
            let case = format!(
                "{pose:?}: {verdict:?} {bounds:?}, meet {meet}, nested {nested}, {apart} apart"
            );
            match verdict {
                Verdict::Hit => assert!(meet || nested, "{case}"),
                Verdict::Free => assert!(!meet && !nested, "{case}"),
                Verdict::Undecided => {
                    assert!(apart <= collision.undecided_band() + rounding, "{case}");
                    counts[2] += 1;
                }
            }
            assert!(bounds.low <= bounds.high, "{case}");
            if meet || nested {
                assert!(bounds.low <= rounding, "{case}");
            } else {
                assert!(
                    bounds.low <= apart + rounding && apart <= bounds.high + rounding,
                    "{case}"
                );
            }
        }
        let report = exact.at(pose).unwrap();
        let bounds = report.distance.unwrap();
        assert_ne!(report.verdict, Verdict::Undecided, "{pose:?}");
        if report.verdict == Verdict::Free {
            assert!(bounds.high - bounds.low < 1e-6, "{pose:?}: {bounds:?}");
        }
        counts[0] += usize::from(meet || nested);
        counts[1] += usize::from(nested);
    }
    counts
}

fn mesh(part: &Part) -> Mesh {
    from_triangles(&part.positions, &part.triangles).unwrap().0
}

fn bunny() -> Mesh {
    let file =
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("structures/examples/bunny.obj");
    read(&file).unwrap().0
}

/// The bench's path of two bunnies: a third of it is in contact, and no verdict is wrong.
#[test]
fn the_path_of_two_bunnies() {
    let bunny = bunny();
    let (low, high) = bunny.bounds();
    let middle = 0.5 * (Vector3::from(low) + Vector3::from(high));
    let path = path::path([middle; 2], bunny.extent(), path::POSES);
    let poses: Vec<Pose> = path.into_iter().step_by(50).collect();
    let [meet, _, undecided] = compare([&bunny, &bunny], &poses, 32);
    assert!((50..90).contains(&meet), "{meet}");
    assert!(undecided < 40, "{undecided}");
}

/// Parts with flat faces, a hole, and linked rings.
#[test]
fn parts_that_fit() {
    for pair in [peg_and_hole(0.05), linked_torus(0.05)] {
        let meshes = [mesh(&pair.receptor), mesh(&pair.ligand)];
        let meshes = meshes.each_ref();
        let parry = Parry::new(meshes).unwrap();
        let poses = poses(&parry, meshes[0].extent(), 24);
        let [meet, _, undecided] = compare(meshes, &poses, 24);
        assert!((3..22).contains(&meet), "{}: {meet}", pair.name);
        assert!(undecided < 18, "{}: {undecided}", pair.name);
    }
}

/// A small bunny in a large one: surfaces apart, and a hit.
#[test]
fn a_solid_within_another_is_a_hit() {
    let bunny = bunny();
    let (low, high) = bunny.bounds();
    let middle = 0.5 * (Vector3::from(low) + Vector3::from(high));
    let small: Vec<[f64; 3]> = bunny
        .positions()
        .iter()
        .map(|place| (0.15 * (Vector3::from(*place) - middle)).into())
        .collect();
    let (small, _) = from_triangles(&small, bunny.triangles()).unwrap();
    let poses: Vec<Pose> = (1..=40)
        .map(|index| {
            let turn = vector(index, 0);
            let quaternion = Quaternion::new(number(index, 6), turn.x, turn.y, turn.z);
            Pose {
                rotation: UnitQuaternion::from_quaternion(quaternion),
                translation: middle + 0.4 * bunny.extent() * vector(index, 3),
            }
        })
        .collect();
    let [meet, nested, _] = compare([&bunny, &small], &poses, 24);
    assert!(meet > nested && nested > 3, "{meet} {nested}");
}
