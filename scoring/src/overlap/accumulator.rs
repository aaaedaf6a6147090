//! Energy, force and torque summed pair by pair.

use super::pair::{PairOverlap, meet};
use super::pair_table::Place;
use crate::se3::Pose;
use crate::vectorized::with_simd;
use nalgebra::Vector3;
use pulp::Simd;
use std::ops::AddAssign;

/// Pairs that are handled together.
const LANES: usize = 8;
type Lane = [f64; LANES];

/// A ball with the weight of its bump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedBall {
    /// Its centre.
    pub center: [f64; 3],
    /// Its radius, above zero, in the unit of `center`.
    pub radius: f64,
    /// The factor of its bump.
    pub weight: f64,
}

/// Overlap energy of two bodies with its force and torque. Sums add.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overlap {
    /// E = sum over pairs of w_i v_j <psi_ri, psi_sj>, a volume.
    pub energy: f64,
    /// -dE/dt: the force on body B. That on A is its negative.
    pub force: Vector3<f64>,
    /// Minus the slope of E by a turn of B about the chosen point, in the receptor's frame.
    pub torque: Vector3<f64>,
    /// Pairs of balls that meet, d < r + s. Above 0 the balls meet, whatever the energy.
    pub pairs: u64,
}

impl AddAssign for Overlap {
    fn add_assign(&mut self, other: Self) {
        self.energy += other.energy;
        self.force += other.force;
        self.torque += other.torque;
        self.pairs += other.pairs;
    }
}

/// A running sum over pairs of balls, all in the receptor's frame. It allocates nothing.
///
/// Pairs that meet are summed in eights. The same pairs in the same order give the same bits, one by one or by leaves.
#[derive(Clone, Debug)]
pub struct Accumulator<'a> {
    kernel: &'a PairOverlap,
    about: Vector3<f64>,
    sum: Overlap,
    waiting: Batch,
}

impl<'a> Accumulator<'a> {
    /// An empty sum, with the torque about a point.
    pub fn new(kernel: &'a PairOverlap, about: [f64; 3]) -> Self {
        Self {
            kernel,
            about: Vector3::from(about),
            sum: Overlap::default(),
            waiting: Batch::default(),
        }
    }

    /// Adds ball `a` of body A and ball `b` of body B, moved to its pose; whether they meet.
    #[inline]
    pub fn add(&mut self, a: &WeightedBall, b: &WeightedBall) -> bool {
        let meets = self.waiting.push(a, b, &self.about);
        if self.waiting.count == LANES {
            self.flush();
        }
        meets
    }

    /// Adds ball `a` of body A with every ball of a leaf of body B, moved to its pose; how many of them it meets.
    pub fn add_leaf(&mut self, a: &WeightedBall, leaf: &[WeightedBall]) -> u64 {
        leaf.iter().map(|b| u64::from(self.add(a, b))).sum()
    }

    /// The sum so far.
    pub fn sum(&mut self) -> Overlap {
        self.flush();
        self.sum
    }

    fn flush(&mut self) {
        let (kernel, batch) = (self.kernel, &self.waiting);
        self.sum += with_simd!(
            <'a>(kernel: &'a PairOverlap, batch: &'a Batch) -> Overlap,
            |simd| batch.sum(simd, kernel)
        );
        self.waiting.count = 0;
    }
}

/// Up to eight pairs that meet.
#[derive(Clone, Debug, Default)]
struct Batch {
    /// Of B's ball from A's.
    arms: [Lane; 3],
    /// Of B's ball from the point that the torque is about.
    levers: [Lane; 3],
    squares: Lane,
    radii: [Lane; 2],
    weights: Lane,
    count: usize,
}

impl Batch {
    /// Writes a pair to the next place, which counts only if the balls meet: a branch would be a coin toss. There must
    /// be room.
    #[inline(always)]
    fn push(&mut self, a: &WeightedBall, b: &WeightedBall, about: &Vector3<f64>) -> bool {
        let next = self.count % LANES;
        let mut square = 0.0;
        for axis in 0..3 {
            let arm = b.center[axis] - a.center[axis];
            self.arms[axis][next] = arm;
            self.levers[axis][next] = b.center[axis] - about[axis];
            square += arm * arm;
        }
        self.squares[next] = square;
        self.radii[0][next] = a.radius;
        self.radii[1][next] = b.radius;
        self.weights[next] = a.weight * b.weight;
        let meets = meet(a.radius, b.radius, square);
        self.count += usize::from(meets);
        meets
    }

    /// The sum over the pairs.
    #[inline(always)]
    fn sum<S: Simd>(&self, simd: S, kernel: &PairOverlap) -> Overlap {
        let (arms, levers) = (&self.arms, &self.levers);
        let zero = [0.0; LANES];
        let (mut small, mut large) = (zero, zero);
        let (mut ratios, mut scaled, mut roots, mut rests) = (zero, zero, zero, zero);
        for lane in 0..LANES {
            let [r, s] = [self.radii[0][lane], self.radii[1][lane]];
            (small[lane], large[lane]) = (r.min(s), r.max(s));
            let place = Place::new(small[lane], large[lane], self.squares[lane]);
            ratios[lane] = place.ratio;
            scaled[lane] = place.square;
            roots[lane] = place.root;
            rests[lane] = place.rest;
        }
        let mut sum = Overlap::default();
        for lane in 0..self.count.min(LANES) {
            let place = Place {
                ratio: ratios[lane],
                square: scaled[lane],
                root: roots[lane],
                rest: rests[lane],
            };
            let radii = [small[lane], large[lane]];
            let [value, slope] = kernel.placed(simd, radii, self.squares[lane], &place);
            let weight = self.weights[lane];
            let push = -2.0 * weight * slope;
            let (x, y, z) = (
                push * arms[0][lane],
                push * arms[1][lane],
                push * arms[2][lane],
            );
            let (u, v, w) = (levers[0][lane], levers[1][lane], levers[2][lane]);
            sum.energy += weight * value;
            sum.force[0] += x;
            sum.force[1] += y;
            sum.force[2] += z;
            sum.torque[0] += v * z - w * y;
            sum.torque[1] += w * x - u * z;
            sum.torque[2] += u * y - v * x;
        }
        sum.pairs = self.count as u64;
        sum
    }
}

/// Nanoseconds a pair of balls that meets, with force and torque, at alpha 2; infinity takes half, quadrature some
/// microseconds. As measured (`overlap_costs_of_pairs`) on one thread of a busy 2.8 GHz Xeon: what counts is the ratio
/// to the modes.
const PAIR: f64 = 50.0;

/// Nanoseconds that a sum over pairs is expected to take, to be held against [`super::OverlapModes::nanoseconds`].
pub fn pairs_nanoseconds(pairs: u64) -> f64 {
    PAIR * pairs as f64
}

/// Overlap of body A with body B moved by `pose`, the torque about `about`, in A's frame: the plain double sum.
///
/// B&I eq. 50 with the product kernel, exact up to [`PairOverlap::error`].
pub fn overlap_of_all(
    kernel: &PairOverlap,
    a: &[WeightedBall],
    b: &[WeightedBall],
    pose: &Pose,
    about: [f64; 3],
) -> Overlap {
    let rotation = pose.rotation.to_rotation_matrix();
    let mut sum = Accumulator::new(kernel, about);
    for ball in b {
        let center = (rotation * Vector3::from(ball.center) + pose.translation).into();
        let moved = WeightedBall { center, ..*ball };
        for ball in a {
            sum.add(ball, &moved);
        }
    }
    sum.sum()
}
