//! Solids of meshes are between their inner and their outer balls.
#![cfg(feature = "mesh")]

use std::path::Path;

use crate::solids::{cuboid, scattered};
use knotdock_structures::Ball;
use knotdock_structures::ball_solid::BallSolid;
use knotdock_structures::mesh::{self, Solid};
use knotdock_structures::sampling::ball_tree::BallTree;

fn block(half: [f64; 3]) -> Solid {
    cuboid(half.map(|side| -side), half).solid()
}

fn bunny() -> Solid {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bunny.obj");
    Solid::new(&mesh::read(&path).unwrap().0).unwrap()
}

#[test]
fn inner_balls_lie_in_the_solid_and_outer_balls_hold_it() {
    // A plate and a needle, too, in which no node of the grid lies.
    for (name, solid) in [
        ("box", block([1.0, 0.6, 0.3])),
        ("plate", block([1.0, 1.0, 0.002])),
        ("needle", block([1.0, 0.003, 0.002])),
        ("bunny", bunny()),
    ] {
        let (balls, sampling) = BallSolid::from_mesh(&solid, 16).unwrap();
        let unit = solid.frame().unit;
        assert!(balls.epsilon() >= sampling.grid_epsilon, "{name}");
        for ball in balls.inner() {
            let depth = unit * solid.depth(ball.center.map(|x| x / unit));
            assert!(depth >= ball.radius * (1.0 - 1e-12), "{name}: {ball:?}");
        }
        let outer: Vec<Ball> = balls.outer();
        let tree = BallTree::new(&outer);
        let mut inside = 0;
        for point in scattered(20_000, 1.0)
            .map(|point| [0, 1, 2].map(|axis| point[axis] * solid.half_sides()[axis]))
            .filter(|&point| solid.is_inside(point))
        {
            assert!(tree.contains(point.map(|x| x * unit)), "{name}: {point:?}");
            inside += 1;
        }
        assert!(inside > 20, "{name}: {inside}");
        for &corner in solid.mesh().positions() {
            let distance = tree.distance(corner.map(|x| x * unit), f64::NEG_INFINITY);
            assert!(distance <= 1e-12, "{name}: {corner:?} {distance}");
        }
        // The density's balls are inner ones, so that bumps which overlap show a hit.
        let density = balls.density();
        assert!(density.weights.iter().all(|&weight| weight > 0.0), "{name}");
        for (center, radius) in density.centers.iter().zip(&density.radii) {
            let is_that = |ball: &&Ball| ball.center == *center && ball.radius == *radius;
            assert!(balls.inner().iter().find(is_that).is_some(), "{name}");
        }
    }
}

#[test]
fn the_centroid_of_a_closed_mesh_is_exact() {
    let solid = block([1.0, 0.6, 0.3]);
    let (balls, _) = BallSolid::from_mesh(&solid, 12).unwrap();
    assert!(balls.centroid().iter().all(|x| x.abs() < 1e-14));
    // A tetrahedron's is the mean of its corners.
    let corners = [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 3.0]];
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let (mesh, _) = mesh::from_triangles(&corners, &faces).unwrap();
    assert!(mesh.centroid().iter().all(|x| (x - 0.75).abs() < 1e-14));
}

#[test]
fn a_far_solid_keeps_its_digits() {
    let near = [
        Ball {
            center: [0.0; 3],
            radius: 1.0,
        },
        Ball {
            center: [1.5, 0.0, 0.25],
            radius: 0.5,
        },
    ];
    let far = near.map(|ball| Ball {
        center: ball.center.map(|x| x + 1048576.0),
        radius: ball.radius,
    });
    let [near, far] = [near, far].map(|balls| BallSolid::from_balls(&balls, None).unwrap());
    assert_eq!(near.inner(), far.inner());
    assert_eq!(near.reach(), far.reach());
}
