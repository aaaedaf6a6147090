//! Figure 5: two spherical samples, and their Minkowski sum for two rotations of the second.

use crate::minkowski::{Knot, write};
use crate::scene::Scene;
use knotdock_cli::plot::svg::Svg;
use nalgebra::{UnitQuaternion, Vector3};

/// Edge of a panel, in SVG units; also the number of cells along it in which a ball has to be seen.
const PANEL: f64 = 330.0;
/// How a ball looks.
const SEEN: &str = "fill=\"url(#ball)\" stroke=\"#703010\" stroke-width=\"0.2\"";

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
    // One scale for all, so that the sums look as much larger as they are.
    let reach = panels.iter().map(|(_, balls)| reach(balls));
    let scale = 0.5 * PANEL / reach.fold(0.0, f64::max);
    let mut svg = Svg::new(PANEL * panels.len() as f64, PANEL + 24.0);
    svg.ball_gradient("ball", "#fff4e0", "#b06030");
    for (index, (title, balls)) in panels.iter().enumerate() {
        svg.at([index as f64 * PANEL, 0.0], |svg| {
            svg.text([PANEL / 2.0, PANEL + 16.0], title);
            for [x, y, _, radius] in seen(balls, scale) {
                svg.circle([x, y], radius, SEEN);
            }
        });
    }
    svg.finish()
}

fn turned(turn: &UnitQuaternion<f64>, ball: &Knot) -> Knot {
    let center = turn * Vector3::new(ball[0], ball[1], ball[2]);
    [center.x, center.y, center.z, ball[3]]
}

/// Farthest that balls reach from the origin along x or y.
fn reach(balls: &[Knot]) -> f64 {
    let of = |ball: &Knot| ball[0].abs().max(ball[1].abs()) + ball[3];
    balls.iter().map(of).fold(0.0, f64::max)
}

/// The balls that are seen from +z, in the panel's units, the nearest to the viewer last.
fn seen(balls: &[Knot], scale: f64) -> Vec<Knot> {
    let placed = |ball: &Knot| {
        let [x, y, z, radius] = ball.map(|length| scale * length);
        [PANEL / 2.0 + x, PANEL / 2.0 - y, z, radius]
    };
    let balls: Vec<Knot> = balls.iter().map(placed).collect();
    let cells = PANEL as usize;
    let mut nearest = vec![(f64::NEG_INFINITY, usize::MAX); cells * cells];
    for (index, [x, y, z, radius]) in balls.iter().copied().enumerate() {
        let range = |middle: f64| {
            let end = (middle + radius).ceil().clamp(0.0, PANEL) as usize;
            (middle - radius).floor().max(0.0) as usize..end
        };
        for row in range(y) {
            for column in range(x) {
                let [right, down] = [column as f64 + 0.5 - x, row as f64 + 0.5 - y];
                let square = radius * radius - right * right - down * down;
                let front = z + square.max(0.0).sqrt();
                if square > 0.0 && front > nearest[row * cells + column].0 {
                    nearest[row * cells + column] = (front, index);
                }
            }
        }
    }
    let mut seen: Vec<usize> = nearest.into_iter().map(|(_, index)| index).collect();
    seen.sort_unstable();
    seen.dedup();
    let mut seen: Vec<Knot> = seen.iter().filter_map(|&i| balls.get(i).copied()).collect();
    seen.sort_by(|a, b| (a[2] + a[3]).total_cmp(&(b[2] + b[3])));
    seen
}
