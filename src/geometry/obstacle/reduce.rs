//! Balls without those that are in another one.
//!
//! Balls come in blocks, the largest first. Balls inside those kept so far are dropped. The rest of a block is compared
//! with itself and then waits; when half as many wait as are kept, all are compared. So the balls in memory are at most
//! one and a half times the result and a block.
//!
//! "Lies in" is exact up to rounding (1e-16 of a coordinate). The first of balls equal in all but rounding is kept.

use std::cmp::Ordering;

use knotdock_structures::sampling::Ball;
use knotdock_structures::sampling::ball_tree::BallTree;
use rayon::prelude::*;

use super::pair_sums;

/// Balls of a block.
const BLOCK: usize = 1 << 16;

/// Most bytes that a ball takes while it is reduced: itself three times, its share of the tree, its mark.
pub const BYTES_REDUCED: u64 = 200;

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

/// The balls that no other one of them holds, the larger first, then by centre: the same for every order of the balls.
pub fn reduced(balls: impl IntoIterator<Item = Ball>) -> Vec<Ball> {
    reduced_by_blocks(balls, BLOCK)
}

fn reduced_by_blocks(balls: impl IntoIterator<Item = Ball>, size: usize) -> Vec<Ball> {
    let mut balls = balls.into_iter();
    let (mut kept, mut tree, mut waiting) = (Vec::new(), BallTree::new(&[]), Vec::new());
    loop {
        let block: Vec<Ball> = balls.by_ref().take(size).collect();
        let is_last = block.len() < size;
        let fresh: Vec<Ball> = block
            .into_par_iter()
            .filter(|ball| !tree.holds(ball))
            .collect();
        waiting.extend(held_by_none(fresh));
        if is_last || waiting.len() > size.max(kept.len() / 2) {
            kept.append(&mut waiting);
            kept = held_by_none(kept);
            if is_last {
                return kept;
            }
            tree = BallTree::new(&kept);
        }
    }
}

/// The balls of the sum of two sets, `offset` added to each radius, that no other one of them holds; the larger first.
pub fn reduced_sum(first: &[Ball], second: &[Ball], offset: f64) -> Vec<Ball> {
    let [first, second] = [first, second].map(|balls| {
        let mut balls = balls.to_vec();
        balls.sort_by(|a, b| b.radius.total_cmp(&a.radius));
        balls
    });
    reduced(pair_sums(&first, &second, offset))
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
        let all: Vec<Ball> = pair_sums(&a, &b, 0.0).collect();
        let kept = reduced_sum(&a, &b, 0.0);
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
        assert_eq!(kept.len(), reduced_sum(&b, &a, 0.0).len());
        assert_eq!(reduced_by_blocks(all.clone(), 777), reduced(all));
    }

    #[test]
    fn copies_leave_one() {
        let ball = cloud(1)[0];
        assert_eq!(reduced(vec![ball; 1000]), [ball]);
        assert!(reduced([]).is_empty());
    }
}
