//! Operations whose results are known in closed form.

use std::f64::consts::PI;

use super::difference::difference;
use super::products::{product, quotient};
use super::sweep::{SweepOptions, sweep};
use super::*;
use crate::geometry::bracket::volume;
use knotdock_scoring::se3::Pose;
use knotdock_structures::sampling::ball_tree::BallTree;

const OPTIONS: MorphologyOptions = MorphologyOptions {
    per_axis: 18,
    memory: None,
};

/// The cube of an edge about `center` between balls: those of a grid of nodes at their depth, and the same grown by what
/// a node's cell reaches.
fn cube(center: [f64; 3], edge: f64) -> Bracket {
    let n = 8;
    let step = edge / f64::from(n);
    let balls = (0..n * n * n).map(|i| {
        let place = [i % n, i / n % n, i / (n * n)].map(|k| (f64::from(k) + 0.5) * step);
        Ball {
            center: [0, 1, 2].map(|axis| place[axis] - 0.5 * edge),
            radius: place.iter().map(|&x| x.min(edge - x)).fold(edge, f64::min),
        }
    });
    let inner: Vec<Ball> = balls.collect();
    let epsilon = 0.5 * 3f64.sqrt() * step;
    Bracket {
        origin: center,
        outer: inner.iter().map(|ball| ball.grown(epsilon)).collect(),
        inner,
        epsilon,
    }
}

fn in_cube(point: [f64; 3], edge: f64) -> bool {
    point.iter().all(|x| x.abs() <= 0.5 * edge)
}

fn norm(point: [f64; 3]) -> f64 {
    nalgebra::Vector3::from(point).norm()
}

/// Checks that no point of a box twice as wide as the outer balls contradicts, and that the exact volume is between the
/// two, which differ by `width` of it at most.
fn check(found: &Bracket, exact: f64, width: f64, is_in: impl Fn([f64; 3]) -> bool) {
    let [inner, outer] = [&found.inner, &found.outer].map(|balls| BallTree::new(balls));
    let (low, high) = found.bounds();
    for i in 1..5_000 {
        let share = [0.8191, 0.6710, 0.5497].map(|step| 2.0 * (f64::from(i) * step).fract() - 0.5);
        let place = [0, 1, 2].map(|axis| low[axis] + share[axis] * (high[axis] - low[axis]));
        let point = [0, 1, 2].map(|axis| place[axis] + found.origin[axis]);
        let is_in = is_in(point);
        assert!(
            is_in || inner.distance(place, f64::NEG_INFINITY) > -1e-9,
            "{point:?}"
        );
        assert!(
            !is_in || outer.distance(place, f64::NEG_INFINITY) < 1e-9,
            "{point:?}"
        );
    }
    let [(low, low_error), (high, high_error)] = [&found.inner, &found.outer].map(|b| volume(b));
    assert!(
        low - 4.0 * low_error <= exact && exact <= high + 4.0 * high_error,
        "{low} {exact} {high}"
    );
    assert!(high - low <= width * exact, "{low} {exact} {high}");
}

#[test]
fn a_cube_less_a_ball_is_a_smaller_cube() {
    let found = difference(&cube([7.0, 0.0, -2.0], 1.0), &Bracket::ball(0.2), &OPTIONS).unwrap();
    check(&found, 0.216, 4.0, |[x, y, z]| {
        in_cube([x - 7.0, y, z + 2.0], 0.6)
    });
    assert!(found.epsilon < 0.6, "{}", found.epsilon);
    let shrunk = offset(&cube([7.0, 0.0, -2.0], 1.0), -0.2, &OPTIONS).unwrap();
    assert_eq!(shrunk, found);
}

#[test]
fn a_cube_less_a_cube_is_a_cube() {
    let found = difference(&cube([1.0; 3], 1.0), &cube([0.5; 3], 0.4), &OPTIONS).unwrap();
    check(&found, 0.216, 4.0, |point| {
        in_cube(point.map(|x| x - 0.5), 0.6)
    });
}

#[test]
fn nothing_is_left_of_a_cube_less_a_larger_one() {
    let found = difference(&cube([0.0; 3], 1.0), &cube([0.0; 3], 1.5), &OPTIONS).unwrap();
    assert!(found.inner.is_empty() && found.outer.is_empty() && found.epsilon == 0.0);
}

#[test]
fn opening_a_ball_leaves_it_and_opening_a_cube_rounds_it() {
    let ball = |center: [f64; 3], radius: f64| Bracket::exact(vec![Ball { center, radius }]);
    let found = opened(&ball([3.0; 3], 1.0), &ball([0.1; 3], 0.4), &OPTIONS).unwrap();
    check(&found, 4.0 / 3.0 * PI, 1.2, |point| {
        norm(point.map(|x| x - 3.0)) <= 1.0
    });
    let found = opened(&cube([0.0; 3], 1.0), &Bracket::ball(0.25), &OPTIONS).unwrap();
    let (l, r) = (0.5f64, 0.25f64);
    let exact = l.powi(3) + 6.0 * l * l * r + 3.0 * PI * l * r * r + 4.0 / 3.0 * PI * r.powi(3);
    check(&found, exact, 2.5, |point| {
        norm(point.map(|x| (x.abs() - 0.5 * l).max(0.0))) <= r
    });
}

#[test]
fn closing_fills_a_gap() {
    let found = closed(&cube([0.0; 3], 1.0), &Bracket::ball(0.3), &OPTIONS).unwrap();
    check(&found, 1.0, 2.0, |point| in_cube(point, 1.0));
    // A shell of balls about a hole that is narrower than the ball: the hole is filled.
    let shell = (0..600).map(|i| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 600.0;
        let angle = 2.399_963_229_728_653 * f64::from(i);
        let across = (1.0 - z * z).sqrt();
        Ball {
            center: [across * angle.cos(), across * angle.sin(), z].map(|x| 0.5 * x),
            radius: 0.12,
        }
    });
    let found = closed(
        &Bracket::exact(shell.collect()),
        &Bracket::ball(0.45),
        &OPTIONS,
    )
    .unwrap();
    let tree = BallTree::new(&found.inner);
    assert!(tree.contains([0.0; 3]) && tree.contains([0.2, -0.1, 0.15]));
}

#[test]
fn growing_a_cube_follows_steiner() {
    let r = 0.25f64;
    let found = offset(&cube([0.0; 3], 1.0), r, &OPTIONS).unwrap();
    let exact = 1.0 + 6.0 * r + 3.0 * PI * r * r + 4.0 / 3.0 * PI * r.powi(3);
    check(&found, exact, 0.6, |point| {
        norm(point.map(|x| (x.abs() - 0.5).max(0.0))) <= r
    });
}

#[test]
fn one_pose_moves_the_solid() {
    let pose = Pose::from_parts([0.8, 0.1, -0.5, 0.2], [3.0, -1.0, 0.5]);
    let solid = cube([1.0, 0.0, 2.0], 1.0);
    let inside = |point: [f64; 3]| {
        let [x, y, z] = pose.inverse().apply(point);
        in_cube([x - 1.0, y, z - 2.0], 1.0)
    };
    check(
        &product(&solid, &[pose], &OPTIONS).unwrap(),
        1.0,
        1.0,
        inside,
    );
    check(
        &quotient(&solid, &[pose], &OPTIONS).unwrap(),
        1.0,
        2.5,
        inside,
    );
}

#[test]
fn two_balls_share_a_lens() {
    let solid = Bracket::exact(vec![Ball {
        center: [1e4, 0.0, 0.0],
        radius: 1.0,
    }]);
    let poses = [0.0, 0.6].map(|x| Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]));
    // Weisstein, "Sphere-Sphere Intersection", MathWorld, eq. 18.
    let exact = PI * (4.0 + 0.6) * (2.0 - 0.6f64).powi(2) / 12.0;
    check(
        &quotient(&solid, &poses, &OPTIONS).unwrap(),
        exact,
        1.4,
        |[x, y, z]| norm([x - 1e4, y, z]) <= 1.0 && norm([x - 1e4 - 0.6, y, z]) <= 1.0,
    );
    let far = [0.0, 9.0].map(|x| Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]));
    assert!(quotient(&solid, &far, &OPTIONS).unwrap().outer.is_empty());
}

#[test]
fn a_ball_on_a_line_sweeps_a_capsule_and_on_a_circle_a_ring() {
    let ball = |x: f64| {
        Bracket::exact(vec![Ball {
            center: [x, 0.0, 0.0],
            radius: 0.5,
        }])
    };
    let options = SweepOptions {
        step: 0.05,
        tolerance: 0.0,
    };
    let line = [0.0, 2.0].map(|x| Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]));
    let found = sweep(&ball(0.0), &line, &options, &OPTIONS).unwrap();
    let exact = PI * 0.25 * 2.0 + 4.0 / 3.0 * PI * 0.125;
    check(&found, exact, 0.15, |[x, y, z]| {
        norm([x - x.clamp(0.0, 2.0), y, z]) <= 0.5
    });
    assert!((found.epsilon - 0.025).abs() < 1e-12);
    let turn = |quarter: i32| {
        let half = f64::from(quarter) * 0.25 * PI;
        Pose::from_parts([half.cos(), 0.0, 0.0, half.sin()], [0.0; 3])
    };
    let circle: Vec<Pose> = (0..=4).map(turn).collect();
    let found = sweep(&ball(2.0), &circle, &options, &OPTIONS).unwrap();
    check(&found, 2.0 * PI * PI * 2.0 * 0.25, 0.15, |[x, y, z]| {
        (x.hypot(y) - 2.0).hypot(z) <= 0.5
    });
}

/// A tolerated translation moves in every direction, a tolerated rotation moves far points farther.
#[test]
fn tolerances_hold_every_pose_of_the_geodesic_ball() {
    use crate::geometry::motion::geodesic_ball;
    let solid = Bracket::exact(vec![Ball {
        center: [3.0, 0.0, 0.0],
        radius: 0.5,
    }]);
    let pose = Pose::from_parts([0.9, 0.1, 0.2, -0.3], [1.0, 2.0, 3.0]);
    let options = SweepOptions {
        step: 1.0,
        tolerance: 0.2,
    };
    let found = sweep(&solid, &[pose], &options, &OPTIONS).unwrap();
    let [only] = found.outer.as_slice() else {
        panic!()
    };
    assert!((only.radius - 0.5 - 0.2 * 5.5f64.sqrt()).abs() < 1e-12);
    assert!((found.inner[0].radius - 0.7).abs() < 1e-12);
    for varied in geodesic_ball(&pose, 0.2, 500) {
        let moved = solid.moved(&varied).about(found.origin);
        assert!(moved.outer.iter().all(|ball| only.grown(1e-12).holds(ball)));
    }
}

#[test]
fn too_many_balls_are_refused_before_they_are_made() {
    let options = MorphologyOptions {
        memory: Some(1 << 20),
        ..OPTIONS
    };
    let solid = cube([0.0; 3], 1.0);
    let error = dilated(&solid, &solid, &options).unwrap_err();
    assert!(error.message().contains("262144 balls"), "{error}");
    assert!(
        error
            .remedy()
            .is_some_and(|remedy| remedy.contains("--memory 5")),
        "{error:?}"
    );
    let poses = vec![Pose::identity(); 1000];
    assert!(product(&solid, &poses, &options).is_err());
}
