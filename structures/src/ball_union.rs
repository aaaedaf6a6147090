//! Volumes of unions of balls, and what two such unions share.
//!
//! Parallel lines cross the balls on a square grid; the pieces that a line has inside are known exactly, and their
//! summed length times the area of a cell is the volume. Three sets of lines, along x, y and z, give three values:
//! their mean is what is reported, and the farthest of them from it is the error. Volumes are in the cube of the knots'
//! unit (Å^3); weights play no part. O(balls x lines through one).

use super::Knots;

/// A volume as measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// The volume.
    pub value: f64,
    /// The largest difference between lines of one direction and the mean over three.
    pub error: f64,
}

/// Volumes of two unions of balls and of what they share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Of the first.
    pub first: f64,
    /// Of the second.
    pub second: f64,
    /// Of the region that lies in both.
    pub shared: f64,
    /// The largest difference of these between lines of one direction and the mean over three.
    pub error: f64,
}

impl Overlap {
    /// Tanimoto similarity of the two: the shared volume over that of both together, 0 to 1.
    pub fn tanimoto(&self) -> f64 {
        self.shared / (self.first + self.second - self.shared)
    }

    /// Share of the smaller one that lies outside the other, 0 to 1.
    pub fn protrusion(&self) -> f64 {
        1.0 - self.shared / self.first.min(self.second)
    }
}

/// Lines a mean radius, an axis: unions of a thousand atoms come within about 1e-5 of their volume.
const LINES_A_RADIUS: f64 = 16.0;
/// Balls up to which there are so many: of more the errors cancel, and fewer lines do as well.
const MANY: f64 = 10_000.0;
/// Most lines an axis across all balls, so that a huge ball among small ones ends in a larger error, not in a longer
/// wait.
const MAX_LINES: f64 = 4096.0;

/// Volume of the union of balls.
pub fn union_volume(balls: &Knots) -> Volume {
    let [values, ..] = measure(&[balls], 0.0);
    let value = mean(values);
    Volume {
        value,
        error: deviation(values, value),
    }
}

/// Volumes of two unions of balls, in one frame, and of what they share.
pub fn overlap(first: &Knots, second: &Knots) -> Overlap {
    overlap_by_lines(first, second, 0.0)
}

/// As [`overlap`], by lines no closer than `spacing`, which takes less time where that is more than a sixteenth of the
/// mean radius.
pub fn overlap_by_lines(first: &Knots, second: &Knots, spacing: f64) -> Overlap {
    let [a, b, both] = if are_disjoint(first, second) {
        let ([a, ..], [b, ..]) = (measure(&[first], spacing), measure(&[second], spacing));
        [a, b, std::array::from_fn(|axis| a[axis] + b[axis])]
    } else {
        measure(&[first, second], spacing)
    };
    let shared: [f64; 3] = std::array::from_fn(|axis| a[axis] + b[axis] - both[axis]);
    let (a_mean, b_mean, shared_mean) = (mean(a), mean(b), mean(shared));
    Overlap {
        first: a_mean,
        second: b_mean,
        // A difference of sums: what touches nowhere leaves a last digit.
        shared: if shared_mean.abs() < 1e-12 * (a_mean + b_mean) {
            0.0
        } else {
            shared_mean
        },
        error: deviation(a, a_mean)
            .max(deviation(b, b_mean))
            .max(deviation(shared, shared_mean)),
    }
}

/// Whether the boxes about two sets do not meet.
fn are_disjoint(first: &Knots, second: &Knots) -> bool {
    let largest = |set: &Knots| set.radii.iter().copied().fold(0.0, f64::max);
    let reach = largest(first) + largest(second);
    let ((low, high), (other_low, other_high)) = (first.bounds(), second.bounds());
    (0..3).any(|axis| other_low[axis] - high[axis] > reach || low[axis] - other_high[axis] > reach)
}

fn mean(values: [f64; 3]) -> f64 {
    values.iter().sum::<f64>() / 3.0
}

fn deviation(values: [f64; 3], mean: f64) -> f64 {
    let off = values.iter().map(|value| (value - mean).abs());
    off.fold(0.0, f64::max)
}

/// A ball about the middle of all, and the set that it belongs to.
struct Ball {
    center: [f64; 3],
    radius: f64,
    second: bool,
}

/// Volumes by lines along each axis, `least` apart or more: of the first set, of the second, of both together.
fn measure(sets: &[&Knots], least: f64) -> [[f64; 3]; 3] {
    let bounds: Vec<_> = sets.iter().map(|set| set.bounds()).collect();
    let low: [f64; 3] = std::array::from_fn(|axis| {
        let all = bounds.iter().map(|(low, _)| low[axis]);
        all.fold(f64::INFINITY, f64::min)
    });
    let high: [f64; 3] = std::array::from_fn(|axis| {
        let all = bounds.iter().map(|(_, high)| high[axis]);
        all.fold(f64::NEG_INFINITY, f64::max)
    });
    let mut balls: Vec<Ball> = Vec::new();
    for (index, set) in sets.iter().enumerate() {
        for (center, &radius) in set.centers.iter().zip(&set.radii) {
            balls.push(Ball {
                // Halves first: the sum of two large coordinates may not overflow.
                center: std::array::from_fn(|axis| {
                    center[axis] - (0.5 * low[axis] + 0.5 * high[axis])
                }),
                radius,
                second: index > 0,
            });
        }
    }
    let total: f64 = balls.iter().map(|ball| ball.radius).sum();
    let largest = balls.iter().map(|ball| ball.radius).fold(0.0, f64::max);
    let edges = (0..3).map(|axis| high[axis] - low[axis]);
    let extent = edges.fold(0.0, f64::max) + 2.0 * largest;
    let count = balls.len() as f64;
    let lines_a_radius = LINES_A_RADIUS * (MANY / count.max(MANY)).powf(0.25);
    let spacing = (total / count / lines_a_radius)
        .max(extent / MAX_LINES)
        .max(least);
    let mut volumes = [[0.0; 3]; 3];
    for axis in 0..3 {
        let along = along_axis(&balls, axis, spacing);
        for (volume, along) in volumes.iter_mut().zip(along) {
            volume[axis] = along;
        }
    }
    volumes
}

/// A piece of a line inside a ball.
struct Piece {
    line: i64,
    from: f64,
    to: f64,
    second: bool,
}

fn along_axis(balls: &[Ball], axis: usize, spacing: f64) -> [f64; 3] {
    let (across, up) = ((axis + 1) % 3, (axis + 2) % 3);
    // Line k stands at (k + 1/2) spacing.
    let reached = |center: f64, radius: f64| {
        let first = ((center - radius) / spacing - 0.5).ceil() as i64;
        let last = ((center + radius) / spacing - 0.5).floor() as i64;
        (first, last)
    };
    let place = |line: i64| (line as f64 + 0.5) * spacing;
    let mut waiting: Vec<(i64, i64, usize)> = balls
        .iter()
        .enumerate()
        .map(|(index, ball)| {
            let (first, last) = reached(ball.center[up], ball.radius);
            (first, last, index)
        })
        .filter(|(first, last, _)| first <= last)
        .collect();
    // From the last to the first, so that the next one is popped.
    waiting.sort_unstable_by_key(|&(first, _, index)| std::cmp::Reverse((first, index)));
    let mut crossed: Vec<(i64, usize)> = Vec::new();
    let mut pieces: Vec<Piece> = Vec::new();
    let mut lengths = [0.0; 3];
    let mut row = i64::MIN;
    loop {
        if crossed.is_empty() {
            match waiting.last() {
                Some(&(first, ..)) => row = first,
                None => break,
            }
        }
        while let Some((_, last, index)) = waiting.pop_if(|(first, ..)| *first <= row) {
            crossed.push((last, index));
        }
        crossed.retain(|(last, _)| *last >= row);
        pieces.clear();
        for ball in crossed.iter().filter_map(|&(_, index)| balls.get(index)) {
            let height = place(row) - ball.center[up];
            let square = ball.radius * ball.radius - height * height;
            if square <= 0.0 {
                continue;
            }
            let (first, last) = reached(ball.center[across], square.sqrt());
            for line in first..=last {
                let side = place(line) - ball.center[across];
                let half = (square - side * side).max(0.0).sqrt();
                pieces.push(Piece {
                    line,
                    from: ball.center[axis] - half,
                    to: ball.center[axis] + half,
                    second: ball.second,
                });
            }
        }
        pieces.sort_unstable_by(|a, b| {
            (a.line.cmp(&b.line))
                .then(a.from.total_cmp(&b.from))
                .then(a.to.total_cmp(&b.to))
        });
        for line in pieces.chunk_by(|a, b| a.line == b.line) {
            lengths[0] += length(line.iter().filter(|piece| !piece.second));
            lengths[1] += length(line.iter().filter(|piece| piece.second));
            lengths[2] += length(line.iter());
        }
        row += 1;
    }
    lengths.map(|length| length * spacing * spacing)
}

/// Length of the union of pieces that come by where they begin.
fn length<'a>(pieces: impl Iterator<Item = &'a Piece>) -> f64 {
    let mut length = 0.0;
    let mut end = f64::NEG_INFINITY;
    for piece in pieces {
        if piece.to > end {
            length += piece.to - piece.from.max(end);
            end = piece.to;
        }
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn balls(list: &[([f64; 3], f64)]) -> Knots {
        let (centers, radii) = list.iter().copied().unzip();
        Knots::new(centers, radii).unwrap()
    }

    fn ball(radius: f64) -> f64 {
        4.0 / 3.0 * PI * radius.powi(3)
    }

    /// Volume that two balls share (Weisstein, "Sphere-Sphere Intersection", MathWorld, eq. 16).
    fn lens(r: f64, s: f64, d: f64) -> f64 {
        PI * (r + s - d).powi(2) * (d * d + 2.0 * d * (r + s) - 3.0 * (r - s).powi(2)) / (12.0 * d)
    }

    #[test]
    fn one_ball_anywhere_and_of_any_size() {
        for (center, radius) in [([0.0; 3], 1.0), ([1e6, -1e6, 3.3], 1.7), ([0.1; 3], 1e-9)] {
            let volume = union_volume(&balls(&[(center, radius)]));
            assert!((volume.value - ball(radius)).abs() < 2e-3 * ball(radius));
            assert!(volume.error < 2e-3 * ball(radius));
        }
    }

    #[test]
    fn two_balls_share_a_lens() {
        for (r, s, d) in [(1.0, 1.0, 0.5), (1.8, 1.4, 2.0), (3.0, 1.0, 2.5)] {
            let at = [0.6 * d + 0.3, 0.2, 0.8 * d - 7.0];
            let (a, b) = (balls(&[([0.3, 0.2, -7.0], r)]), balls(&[(at, s)]));
            let found = overlap(&a, &b);
            let exact = lens(r, s, d);
            assert!(
                (found.shared - exact).abs() < 1e-2 * exact,
                "{found:?} {exact}"
            );
            assert!(
                (found.shared - exact).abs() < 4.0 * found.error,
                "{found:?} {exact}"
            );
            let both = ball(r) + ball(s) - exact;
            assert!((found.tanimoto() - exact / both).abs() < 1e-2 * exact / both);
            let least = ball(r.min(s));
            assert!((found.protrusion() - (1.0 - exact / least)).abs() < 5e-3);
            let union = union_volume(&balls(&[([0.3, 0.2, -7.0], r), (at, s)]));
            assert!((union.value - both).abs() < 2e-3 * both);
        }
    }

    #[test]
    fn copies_and_balls_inside_add_nothing() {
        let outer = ([0.0; 3], 2.0);
        let one = union_volume(&balls(&[outer])).value;
        let many = balls(&[outer, outer, ([0.5, 0.0, 0.0], 1.0)]);
        assert!((union_volume(&many).value - one).abs() < 2e-3 * one);
        let same = overlap(&many, &many);
        assert!((same.tanimoto() - 1.0).abs() < 1e-12);
        assert!(same.protrusion().abs() < 1e-12);
    }

    /// Twice as many balls as have all lines, separate and off any lattice: their volumes add up.
    #[test]
    fn many_balls_need_fewer_lines() {
        let side = 28;
        let place =
            |i: usize, step: f64, height: f64| 4.4 * i as f64 + (step * i as f64).sin() * height;
        let list: Vec<([f64; 3], f64)> = (0..side * side * side)
            .map(|i| {
                let [x, y, z] = [i % side, i / side % side, i / side / side];
                let shift = (1.3 * i as f64).sin() * 0.2;
                (
                    [
                        place(x, 1.7, 0.2) + shift,
                        place(y, 2.3, 0.2) - shift,
                        place(z, 0.7, 0.2) + shift,
                    ],
                    1.7,
                )
            })
            .collect();
        assert!(list.len() as f64 > 2.0 * MANY);
        let exact = list.len() as f64 * ball(1.7);
        let found = union_volume(&balls(&list));
        assert!(
            (found.value - exact).abs() < 1e-4 * exact,
            "{found:?} {exact}"
        );
        assert!(
            (found.value - exact).abs() <= 4.0 * found.error,
            "{found:?} {exact}"
        );
    }

    /// A pose at the other end of the world costs no more than one beside it.
    #[test]
    fn far_sets_share_nothing_and_take_no_time() {
        let found = overlap(
            &balls(&[([0.0; 3], 1.5)]),
            &balls(&[([1e9, 5.0, 0.0], 1.5)]),
        );
        assert_eq!(found.shared, 0.0);
        assert_eq!((found.tanimoto(), found.protrusion()), (0.0, 1.0));
        assert!((found.first - ball(1.5)).abs() < 2e-3 * ball(1.5));
    }

    /// Random balls against points thrown at random (fixed seed): to four standard errors.
    #[test]
    fn a_cloud_of_balls_against_random_points() {
        let mut state = 1u64;
        let mut random = move || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let list: Vec<([f64; 3], f64)> = (0..60)
            .map(|_| {
                (
                    [8.0 * random(), 8.0 * random(), 8.0 * random()],
                    1.0 + random(),
                )
            })
            .collect();
        let inside = |x: [f64; 3]| {
            list.iter()
                .any(|(c, r)| (0..3).map(|k| (x[k] - c[k]).powi(2)).sum::<f64>() < r * r)
        };
        let throws = 400_000;
        let hits = (0..throws)
            .filter(|_| inside([0; 3].map(|_| 12.0 * random() - 2.0)))
            .count();
        let share = hits as f64 / throws as f64;
        let (expected, sigma) = (
            1728.0 * share,
            1728.0 * (share * (1.0 - share) / throws as f64).sqrt(),
        );
        let found = union_volume(&balls(&list));
        assert!(
            (found.value - expected).abs() < 4.0 * sigma,
            "{found:?} {expected} {sigma}"
        );
    }
}
