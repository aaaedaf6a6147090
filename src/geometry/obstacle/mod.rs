//! Minkowski sums and obstacles of solids known by balls.
//!
//! B&I, eq. 29 to 44: the obstacle of B to A at a rotation R is the set of translations t at which A and R B + t meet,
//! A + (-R B). For balls it is a union of balls again, one for each pair: (a - R b, r + s). In the lifted picture that
//! is the 4D sum of A's knots with the r-mirrored and reflected ones of B.
//!
//! Inner with inner balls lie inside the true sum, outer with outer ones hold it, and the Hausdorff bounds add.
//!
//! - [`pair_sums`]: the n1 n2 balls, one after another, none stored.
//! - [`reduce`]: the same union by fewer balls.
//! - [`regions`]: connected free regions.

pub mod reduce;
pub mod regions;

use knotdock_scoring::se3::Pose;
use knotdock_structures::sampling::Ball;

use super::bracket::Bracket;

/// -R B: a solid turned by the rotation of a pose and reflected in the frame's origin, one summand of an obstacle.
pub fn mirrored(solid: &Bracket, rotation: &Pose) -> Bracket {
    let turn = rotation.rotation;
    let mirror = |point| (turn * nalgebra::Vector3::from(point)).map(|part| 0.0 - part);
    let reflected = |ball: &Ball| Ball {
        center: mirror(ball.center).into(),
        radius: ball.radius,
    };
    Bracket {
        origin: mirror(solid.origin).into(),
        ..solid.map(|balls| balls.iter().map(reflected).collect())
    }
}

/// The n1 n2 balls (a + b, r + s + offset) of two sets, in the order of the first set. Balls without a radius above zero
/// are left out.
///
/// B&I, eq. 41 and 44: the offset takes another slice of the lifted sum.
pub fn pair_sums<'a>(
    first: &'a [Ball],
    second: &'a [Ball],
    offset: f64,
) -> impl Iterator<Item = Ball> + use<'a> {
    first.iter().flat_map(move |a| {
        second.iter().filter_map(move |b| {
            let radius = a.radius + b.radius + offset;
            (radius > 0.0).then(|| Ball {
                center: [0, 1, 2].map(|axis| a.center[axis] + b.center[axis]),
                radius,
            })
        })
    })
}

/// A + B, reduced, with `offset` added to each radius.
pub fn sum(first: &Bracket, second: &Bracket, offset: f64) -> Bracket {
    let inner = reduce::reduced_sum(&first.inner, &second.inner, offset);
    // Unions of balls are known exactly: one set is enough.
    let outer = match first.is_exact() && second.is_exact() {
        true => inner.clone(),
        false => reduce::reduced_sum(&first.outer, &second.outer, offset),
    };
    Bracket {
        origin: [0, 1, 2].map(|axis| first.origin[axis] + second.origin[axis]),
        inner,
        outer,
        epsilon: first.epsilon + second.epsilon,
    }
}

#[cfg(test)]
mod tests {
    use super::super::bracket::volume;
    use super::*;
    use knotdock_structures::sampling::ball_tree::BallTree;

    fn ball(center: [f64; 3], radius: f64) -> Ball {
        Ball { center, radius }
    }

    fn obstacle(fixed: &Bracket, moved: &Bracket, rotation: &Pose, offset: f64) -> Bracket {
        sum(fixed, &mirrored(moved, rotation), offset)
    }

    #[test]
    fn the_obstacle_of_two_balls_is_a_ball() {
        let a = Bracket::exact(vec![ball([1.0, 2.0, 3.0], 2.0)]);
        let b = Bracket::exact(vec![ball([0.0, 1.0, 0.0], 0.5)]);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        // A quarter turn about z takes y to -x.
        let quarter = Pose::from_parts([half, 0.0, 0.0, half], [9.0; 3]);
        let found = obstacle(&a, &b, &quarter, 0.25);
        let [only] = found.inner.as_slice() else {
            panic!("{found:?}")
        };
        assert_eq!(found.inner, found.outer);
        assert!((only.radius - 2.75).abs() < 1e-15);
        for (part, exact) in only.center.into_iter().zip([2.0, 2.0, 3.0]) {
            assert!((part - exact).abs() < 1e-15, "{only:?}");
        }
        assert!(obstacle(&a, &b, &quarter, -2.5).inner.is_empty());
    }

    /// A translation is in the obstacle if and only if some two balls meet there.
    #[test]
    fn membership_is_contact_of_balls() {
        let cloud = |count: u32, step: f64| -> Vec<Ball> {
            (1..=count)
                .map(|i| {
                    let part = |factor: f64| (f64::from(i) * factor * step).fract();
                    ball([part(0.8191), part(0.671), part(0.5497)], 0.2 * part(0.3))
                })
                .filter(|ball| ball.radius > 0.0)
                .collect()
        };
        let (a, b) = (cloud(60, 1.0), cloud(40, 1.7));
        let rotation = Pose::from_parts([0.9, -0.2, 0.3, 0.1], [0.0; 3]);
        let found = obstacle(
            &Bracket::exact(a.clone()),
            &Bracket::exact(b.clone()),
            &rotation,
            0.0,
        );
        let tree = BallTree::new(&found.inner);
        let mut inside = 0;
        for i in 0..4000 {
            let part = |factor: f64| 3.0 * (f64::from(i) * factor).fract() - 1.0;
            let t = [part(0.7548), part(0.5698), part(0.3333)];
            let pose = Pose {
                translation: t.into(),
                ..rotation
            };
            let gap = a.iter().flat_map(|a| {
                b.iter().map(|b| {
                    let moved = pose.apply(b.center);
                    let square: f64 = (0..3).map(|k| (a.center[k] - moved[k]).powi(2)).sum();
                    square.sqrt() - a.radius - b.radius
                })
            });
            let gap = gap.fold(f64::INFINITY, f64::min);
            assert!((tree.distance(t, f64::NEG_INFINITY) - gap).abs() < 1e-12);
            inside += u32::from(gap < 0.0);
        }
        assert!((400..3600).contains(&inside), "{inside}");
    }

    /// Steiner's formula: a unit cube grown by r has the volume 1 + 6 r + 3 pi r^2 + 4/3 pi r^3.
    #[test]
    fn a_box_of_balls_and_a_ball() {
        let mut balls = Vec::new();
        // Every point of the cube is within 0.0867 of a node, and each node has a ball.
        for i in 0..10 * 10 * 10 {
            let place = [i % 10, i / 10 % 10, i / 100].map(|k| (f64::from(k) + 0.5) / 10.0);
            let depth = place.iter().map(|&x| x.min(1.0 - x)).fold(1.0, f64::min);
            balls.push(ball(place, depth));
        }
        let cube = Bracket {
            origin: [0.0; 3],
            outer: balls.iter().map(|ball| ball.grown(0.0867)).collect(),
            inner: balls,
            epsilon: 0.0867,
        };
        let found = sum(&cube, &Bracket::ball(0.3), 0.0);
        let r: f64 = 0.3;
        let pi = std::f64::consts::PI;
        let exact = 1.0 + 6.0 * r + 3.0 * pi * r * r + 4.0 / 3.0 * pi * r.powi(3);
        let [low, high] = [&found.inner, &found.outer].map(|balls| volume(balls).0);
        assert!(low < exact && exact < high, "{low} {exact} {high}");
        assert!(high - low < 0.5 * exact);
    }
}
