//! Balls without those that lie in another one.
//!
//! Balls come in blocks, the largest first. What the balls kept so far hold is dropped at once. The rest of a block is
//! held against itself and then waits; when as many wait as half of those kept, all are held against each other. So the
//! balls in memory are at most one and a half times the result and a block, and each is looked up a few times in a tree.
//!
//! "Lies in" is exact up to rounding (1e-16 of a coordinate). Of balls equal in all but rounding the first is kept.

use std::cmp::Ordering;

use knotdock_structures::sampling::Ball;
use knotdock_structures::sampling::ball_tree::BallTree;
use rayon::prelude::*;

use super::pairs::PairSums;

/// Balls of a block.
const BLOCK: usize = 1 << 16;

/// Most bytes that a ball takes while it is reduced: itself three times, its share of the tree, its mark.
pub const BYTES_REDUCED: u64 = 200;

/// Balls of which none holds another one that was pushed.
#[derive(Debug)]
pub struct Reduction {
    kept: Vec<Ball>,
    tree: BallTree,
    waiting: Vec<Ball>,
}

impl Default for Reduction {
    fn default() -> Self {
        Self {
            kept: Vec::new(),
            tree: BallTree::new(&[]),
            waiting: Vec::new(),
        }
    }
}

impl Reduction {
    /// Adds balls; about 2^16 at a time are best.
    pub fn push(&mut self, block: &[Ball]) {
        let tree = &self.tree;
        let fresh: Vec<Ball> = block
            .par_iter()
            .copied()
            .filter(|ball| !tree.holds(ball))
            .collect();
        self.waiting.extend(held_by_none(fresh));
        if self.waiting.len() > BLOCK.max(self.kept.len() / 2) {
            self.merge();
        }
    }

    /// Holds all balls against each other.
    fn merge(&mut self) {
        let mut all = std::mem::take(&mut self.kept);
        all.append(&mut self.waiting);
        self.kept = held_by_none(all);
        self.tree = BallTree::new(&self.kept);
    }

    /// The balls that are left, the larger first, then by centre: the same set for every order of pushing.
    pub fn finish(mut self) -> Vec<Ball> {
        self.merge();
        self.kept
    }
}

/// The balls that no other one of them holds, in order and once each.
fn held_by_none(mut balls: Vec<Ball>) -> Vec<Ball> {
    balls.par_sort_unstable_by(order);
    balls.dedup();
    let tree = BallTree::new(&balls);
    balls
        .into_par_iter()
        .filter(|ball| !tree.holds_before(ball))
        .collect()
}

/// The larger ball first, then the one of the lesser centre.
fn order(a: &Ball, b: &Ball) -> Ordering {
    let by_axis = |axis: usize| a.center[axis].total_cmp(&b.center[axis]);
    (b.radius.total_cmp(&a.radius))
        .then_with(|| by_axis(0))
        .then_with(|| by_axis(1))
        .then_with(|| by_axis(2))
}

/// The balls that no other one of them holds, the larger first.
pub fn reduced(balls: impl IntoIterator<Item = Ball>) -> Vec<Ball> {
    let mut reduction = Reduction::default();
    let mut block = Vec::with_capacity(BLOCK);
    for ball in balls {
        block.push(ball);
        if block.len() == BLOCK {
            reduction.push(&block);
            block.clear();
        }
    }
    reduction.push(&block);
    reduction.finish()
}

/// The balls of a sum that no other one of them holds, the larger first.
pub fn reduced_sum(sums: &PairSums) -> Vec<Ball> {
    let [first, second] = sums.sorted();
    reduced(PairSums::new(&first, &second, sums.offset()).iter())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(count: u32) -> Vec<Ball> {
        (1..=count)
            .map(|i| {
                let part = |step: f64| (f64::from(i) * step).fract();
                Ball {
                    center: [part(0.8191), part(0.6710), part(0.5497)],
                    radius: 0.001 + 0.2 * part(0.4503).powi(4),
                }
            })
            .collect()
    }

    #[test]
    fn what_is_dropped_lies_in_what_is_kept_and_nothing_else_goes() {
        let (a, b) = (cloud(150), cloud(120));
        let sums = PairSums::new(&a, &b, 0.0);
        let all: Vec<Ball> = sums.iter().collect();
        let kept = reduced_sum(&sums);
        assert!(
            kept.len() < all.len() / 2,
            "{} of {}",
            kept.len(),
            all.len()
        );
        for ball in &all {
            let slack = ball.grown(-1e-14);
            assert!(kept.iter().any(|other| other.holds(&slack)));
        }
        for (index, ball) in kept.iter().enumerate() {
            let holder = kept.iter().position(|other| other.holds(ball));
            assert_eq!(holder, Some(index));
        }
        // The order of the sets and blocks of another size change nothing.
        assert_eq!(kept.len(), reduced_sum(&PairSums::new(&b, &a, 0.0)).len());
        let mut small = Reduction::default();
        for block in all.chunks(777) {
            small.push(block);
            small.merge();
        }
        assert_eq!(small.finish(), reduced(all));
    }

    #[test]
    fn copies_leave_one() {
        let ball = cloud(1)[0];
        assert_eq!(reduced(vec![ball; 1000]), [ball]);
        assert!(reduced([]).is_empty());
    }
}
