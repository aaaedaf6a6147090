//! All pairs of balls of two solids that meet.

use super::Motion;
use super::hierarchy::BallHierarchy;
use crate::ball::Ball;

/// Finds pairs that meet. Buffers are kept from one search to the next.
#[derive(Debug, Default)]
pub struct MeetingPairs {
    open: Vec<[u32; 2]>,
}

impl MeetingPairs {
    /// A search without buffers.
    pub fn new() -> Self {
        Self::default()
    }

    /// Calls `found` with the numbers of two balls, the second one as moved, and their distance squared, for every
    /// pair with d < r + s + `margin`. Ends early where `found` says so, by `false`; whether it went to the end.
    pub fn visit(
        &mut self,
        trees: [&BallHierarchy; 2],
        motion: &Motion,
        margin: f64,
        mut found: impl FnMut([usize; 2], &Ball, f64) -> bool,
    ) -> bool {
        self.open.clear();
        if trees.iter().all(|tree| !tree.nodes().is_empty()) {
            self.open.push([0, 0]);
        }
        while let Some(nodes) = self.open.pop() {
            let [a, b] = [0, 1].map(|side| &trees[side].nodes()[nodes[side] as usize]);
            let center = motion.apply(b.bound.center);
            if !meet(&a.bound, center, b.bound.radius, margin).1 {
                continue;
            }
            if a.second == 0 && b.second == 0 {
                for (second, ball) in (b.first as usize..).zip(trees[1].members(b)) {
                    let moved = Ball::new(motion.apply(ball.center), ball.radius);
                    for (first, other) in (a.first as usize..).zip(trees[0].members(a)) {
                        let (squared, meets) = meet(other, moved.center, moved.radius, margin);
                        if meets && !found([first, second], &moved, squared) {
                            return false;
                        }
                    }
                }
                continue;
            }
            let split_second = a.second == 0 || (b.second != 0 && b.bound.radius > a.bound.radius);
            let side = usize::from(split_second);
            let parent = nodes[side];
            for child in [trees[side].nodes()[parent as usize].second, parent + 1] {
                let mut next = nodes;
                next[side] = child;
                self.open.push(next);
            }
        }
        true
    }
}

/// Squared distance of the centres, and whether the balls come within `margin`.
#[inline(always)]
fn meet(ball: &Ball, center: [f64; 3], radius: f64, margin: f64) -> (f64, bool) {
    let [x, y, z] = [0, 1, 2].map(|axis| ball.center[axis] - center[axis]);
    let squared = x * x + y * y + z * z;
    let reach = ball.radius + radius + margin;
    (squared, reach > 0.0 && squared < reach * reach)
}

#[cfg(test)]
mod tests {
    use super::super::hierarchy::tests::jumbled;
    use super::*;

    #[test]
    fn the_pairs_are_those_of_all_pairs() {
        let (a, b) = (
            BallHierarchy::new(&jumbled(200, 0.2)),
            BallHierarchy::new(&jumbled(90, 0.5)),
        );
        let mut search = MeetingPairs::new();
        for step in 0..20 {
            let motion = Motion::IDENTITY.shifted([0.1 * f64::from(step), 0.05, 0.0]);
            for margin in [0.0, 0.05, -0.05] {
                let mut found = Vec::new();
                let all = search.visit([&a, &b], &motion, margin, |pair, _, _| {
                    found.push(pair);
                    true
                });
                found.sort_unstable();
                let mut expected = Vec::new();
                for (i, one) in a.balls().iter().enumerate() {
                    for (j, other) in b.balls().iter().enumerate() {
                        let center = motion.apply(other.center);
                        if meet(one, center, other.radius, margin).1 {
                            expected.push([i, j]);
                        }
                    }
                }
                assert!(all && found == expected, "{step}, {margin}");
                let ended = search.visit([&a, &b], &motion, margin, |_, _, _| false);
                assert_eq!(ended, expected.is_empty());
            }
        }
    }
}
