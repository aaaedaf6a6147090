//! Force and torque of the overlap energy of two solids.
//!
//! The energy is the integral of the product of both bodies' densities, sums of bumps that are about one inside
//! ([`BallSolid::density`]). It is about the shared volume, smooth, and zero unless inner balls meet. Force and torque
//! are minus its slopes ([`knotdock_scoring::overlap`]).

use knotdock_scoring::overlap::{Accumulator, PairOverlap, WeightedBall};
use knotdock_structures::Ball;
use knotdock_structures::ball_solid::{BallHierarchy, BallSolid, MeetingPairs, Motion};
use knotdock_structures::numeric::bump::AlphaError;

use super::scene::CollisionScene;

/// Overlap energy, force and torque at a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// The overlap energy, in the cube of the files' unit.
    pub energy: f64,
    /// Minus its slope by B's translation: the force on B, in A's frame. That on A is its negative.
    pub force: [f64; 3],
    /// Minus its slope by B's rotation about its centre of mass, in A's frame.
    pub torque: [f64; 3],
    /// How far the energy may be from that of all pairs of balls: by modes left out, and by rounding.
    pub bound: f64,
    /// Pairs of balls that were summed.
    pub ball_pairs: usize,
}

/// The densities of two solids, ready for many poses.
#[derive(Clone, Debug)]
pub struct Densities {
    trees: [BallHierarchy; 2],
    /// Weights in the order of the trees.
    weights: [Vec<f64>; 2],
    kernel: PairOverlap,
}

impl Densities {
    /// Densities of bumps of exponent `alpha`.
    ///
    /// # Errors
    /// [`AlphaError`] unless alpha is above zero.
    pub fn new(scene: &CollisionScene, alpha: f64) -> Result<Self, AlphaError> {
        let parts = scene.solids().each_ref().map(tree_of);
        let [(first, a), (second, b)] = parts;
        Ok(Self {
            trees: [first, second],
            weights: [a, b],
            kernel: PairOverlap::new(alpha)?,
        })
    }

    /// Energy, force and torque by all pairs of balls that meet.
    pub fn contact(
        &self,
        scene: &CollisionScene,
        motion: &Motion,
        pairs: &mut MeetingPairs,
    ) -> Contact {
        let about = motion.apply(scene.solids()[1].centroid());
        let mut sum = Accumulator::new(&self.kernel, about);
        let [first, second] = &self.trees;
        pairs.visit([first, second], motion, 0.0, |[i, j], moved, _| {
            let a = weighted(&first.balls()[i], self.weights[0][i]);
            let b = weighted(moved, self.weights[1][j]);
            sum.add(&a, &b);
            true
        });
        let sum = sum.sum();
        Contact {
            energy: sum.energy,
            force: sum.force.into(),
            torque: sum.torque.into(),
            bound: self.kernel.error() * sum.energy,
            ball_pairs: sum.pairs as usize,
        }
    }
}

fn weighted(ball: &Ball, weight: f64) -> WeightedBall {
    WeightedBall {
        center: ball.center,
        radius: ball.radius,
        weight,
    }
}

/// A sphere tree over a solid's density, and the weights in its order.
fn tree_of(solid: &BallSolid) -> (BallHierarchy, Vec<f64>) {
    let density = solid.density();
    let balls: Vec<Ball> = density
        .centers
        .iter()
        .zip(&density.radii)
        .map(|(&center, &radius)| Ball { center, radius })
        .collect();
    let tree = BallHierarchy::new(&balls);
    let order = tree.order().iter();
    let weights = order.map(|&number| density.weights[number as usize]);
    let weights = weights.collect();
    (tree, weights)
}
