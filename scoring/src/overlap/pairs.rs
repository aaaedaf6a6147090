//! Overlap of two ball sets at a pose from a list of pairs.

use super::accumulator::{Accumulator, Overlap, WeightedBall};
use super::pair::PairOverlap;
use crate::se3::Pose;
use nalgebra::Vector3;

/// Nanoseconds a pair of balls that meets, with force and torque, at alpha 2; infinity takes half, quadrature some
/// microseconds. As measured (`overlap_costs_of_pairs`) on one thread of a busy 2.8 GHz Xeon: what counts is the ratio
/// to the modes.
const PAIR: f64 = 50.0;

/// Nanoseconds that a sum over pairs is expected to take, to be held against [`super::OverlapModes::nanoseconds`].
pub fn pairs_nanoseconds(pairs: u64) -> f64 {
    PAIR * pairs as f64
}

/// Overlap of body A with body B moved by `pose`, over the pairs (ball of A, ball of B) given; pairs that do not meet
/// add nothing. Torque about `about`, in A's frame. Indices beyond the slices are left out.
///
/// B&I eq. 50 with the product kernel, as a sum over pairs: exact up to [`PairOverlap::error`].
pub fn overlap_of_pairs(
    kernel: &PairOverlap,
    a: &[WeightedBall],
    b: &[WeightedBall],
    pose: &Pose,
    about: [f64; 3],
    pairs: impl IntoIterator<Item = (usize, usize)>,
) -> Overlap {
    let rotation = pose.rotation.to_rotation_matrix();
    let mut sum = Accumulator::new(kernel, about);
    for (i, j) in pairs {
        if let (Some(a), Some(b)) = (a.get(i), b.get(j)) {
            let center = rotation * Vector3::from(b.center) + pose.translation;
            sum.add(
                a,
                &WeightedBall {
                    center: center.into(),
                    ..*b
                },
            );
        }
    }
    sum.sum()
}

/// Overlap over all pairs of two ball sets: the plain double sum, for small sets and as a reference.
pub fn overlap_of_all(
    kernel: &PairOverlap,
    a: &[WeightedBall],
    b: &[WeightedBall],
    pose: &Pose,
    about: [f64; 3],
) -> Overlap {
    let pairs = (0..b.len()).flat_map(|j| (0..a.len()).map(move |i| (i, j)));
    overlap_of_pairs(kernel, a, b, pose, about, pairs)
}
