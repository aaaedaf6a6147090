//! The volume of balls beyond a box.

use rayon::prelude::*;

use crate::ball::Ball;

/// Lines along x that are measured, each way, at most for each step across the box.
const WIDEST: f64 = 4.0;

/// The volume of the union of `balls` outside the cube from `low` to `high` along each axis, by lines along x that
/// are spaced by `step`, or more where balls reach very far.
pub(super) fn volume_beyond(balls: &[Ball], low: f64, high: f64, step: f64) -> f64 {
    let end = |axis: usize, sign: f64| {
        let ends = balls
            .iter()
            .map(|ball| sign * ball.center[axis] + ball.radius);
        sign * ends.fold(f64::NEG_INFINITY, f64::max)
    };
    let ends = [0, 1, 2].map(|axis| (end(axis, -1.0), end(axis, 1.0)));
    if ends
        .iter()
        .all(|&(first, last)| low <= first && last <= high)
    {
        return 0.0;
    }
    let longest = ends
        .iter()
        .map(|(first, last)| last - first)
        .fold(0.0, f64::max);
    let step = step.max(longest / (WIDEST * (high - low)) * step);
    let count = |axis: usize| ((ends[axis].1 - ends[axis].0) / step).ceil() as usize;
    let place = |axis: usize, number: usize| ends[axis].0 + (number as f64 + 0.5) * step;
    let is_in = |value: f64| (low..=high).contains(&value);
    let lengths: Vec<f64> = (0..count(2))
        .into_par_iter()
        .map(|z| {
            let z = place(2, z);
            let near: Vec<&Ball> = balls
                .iter()
                .filter(|ball| (ball.center[2] - z).abs() < ball.radius)
                .collect();
            let mut sum = 0.0;
            for y in 0..count(1) {
                let y = place(1, y);
                let mut spans: Vec<(f64, f64)> = near
                    .iter()
                    .filter_map(|ball| {
                        let [dy, dz] = [y - ball.center[1], z - ball.center[2]];
                        let squared = ball.radius * ball.radius - dy * dy - dz * dz;
                        let half = squared.sqrt();
                        (squared > 0.0).then_some((ball.center[0] - half, ball.center[0] + half))
                    })
                    .collect();
                spans.sort_by(|a, b| a.0.total_cmp(&b.0));
                let mut reached = f64::NEG_INFINITY;
                for (from, to) in spans {
                    let from = from.max(reached);
                    if to <= from {
                        continue;
                    }
                    reached = to;
                    let within = match is_in(y) && is_in(z) {
                        true => (to.min(high) - from.max(low)).max(0.0),
                        false => 0.0,
                    };
                    sum += to - from - within;
                }
            }
            sum
        })
        .collect();
    lengths.iter().sum::<f64>() * step * step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_of_balls_lies_beyond_a_box() {
        let ball = |x: f64, radius: f64| Ball::new([x, 0.0, 0.0], radius);
        let sphere = |radius: f64| 4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius;
        assert_eq!(volume_beyond(&[ball(0.0, 1.0)], -1.0, 1.0, 0.1), 0.0);
        // A ball about the box, once and twice; and half of one, beside the box.
        for balls in [vec![ball(0.0, 2.0)], vec![ball(0.0, 2.0), ball(0.1, 1.9)]] {
            let found = volume_beyond(&balls, -1.0, 1.0, 0.02);
            assert!((found / (sphere(2.0) - 8.0) - 1.0).abs() < 1e-2, "{found}");
        }
        let found = volume_beyond(&[ball(1.0, 0.5)], -1.0, 1.0, 0.01);
        assert!((found / (0.5 * sphere(0.5)) - 1.0).abs() < 1e-2, "{found}");
    }
}
