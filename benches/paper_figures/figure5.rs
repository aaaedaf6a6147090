//! Figure 5: two spherical samples, and their Minkowski sum for two rotations of the second.

use crate::panels::drawn;
use crate::scene::Scene;
use knotdock_scoring::minkowski::{Knot, write};
use nalgebra::{UnitQuaternion, Vector3};

/// Rotations of the peg from its place in the scene, as Euler angles in radians.
const ROTATIONS: [[f64; 3]; 2] = [[0.0, 0.0, 0.0], [1.1, 0.5, -0.9]];

/// The picture, as SVG.
pub fn picture(scene: &Scene) -> String {
    let bodies = [&scene.bunny, &scene.peg].map(|body| body.knots());
    let mut panels = vec![
        (
            format!("(a) bunny: {} balls", bodies[0].len()),
            bodies[0].clone(),
        ),
        (
            format!("(b) peg: {} balls", bodies[1].len()),
            bodies[1].clone(),
        ),
    ];
    for ([roll, pitch, yaw], name) in ROTATIONS.into_iter().zip(["c", "d"]) {
        let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let turned: Vec<Knot> = bodies[1].iter().map(|ball| turned(&turn, ball)).collect();
        let mut sum = Vec::new();
        write(&bodies[0], &turned, &mut sum);
        panels.push((format!("({name}) their sum: {} balls", sum.len()), sum));
    }
    drawn(&panels, panels.len())
}

fn turned(turn: &UnitQuaternion<f64>, ball: &Knot) -> Knot {
    let center = turn * Vector3::new(ball[0], ball[1], ball[2]);
    [center.x, center.y, center.z, ball[3]]
}
