//! Energy, force and torque summed pair by pair.

use super::pair::{PairOverlap, meet};
use super::pair_table::Place;
use nalgebra::Vector3;
use pulp::{Arch, Simd, WithSimd};
use std::ops::AddAssign;

/// Balls of a leaf that are handled together.
const LANES: usize = 8;

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
/// The same pairs in the same order give the same bits, one by one or by leaves of the same size.
#[derive(Clone, Debug)]
pub struct Accumulator<'a> {
    kernel: &'a PairOverlap,
    about: Vector3<f64>,
    sum: Overlap,
}

impl<'a> Accumulator<'a> {
    /// An empty sum, with the torque about a point.
    pub fn new(kernel: &'a PairOverlap, about: [f64; 3]) -> Self {
        Self {
            kernel,
            about: Vector3::from(about),
            sum: Overlap::default(),
        }
    }

    /// Adds ball `a` of body A and ball `b` of body B, moved to its pose; whether they meet.
    #[inline]
    pub fn add(&mut self, a: &WeightedBall, b: &WeightedBall) -> bool {
        let arm = Vector3::from(b.center) - Vector3::from(a.center);
        let square = arm.norm_squared();
        if !meet(a.radius, b.radius, square) {
            return false;
        }
        let [value, slope] = self.kernel.by_square(a.radius, b.radius, square);
        let weight = a.weight * b.weight;
        let force = arm * (-2.0 * weight * slope);
        self.sum.energy += weight * value;
        self.sum.force += force;
        self.sum.torque += (Vector3::from(b.center) - self.about).cross(&force);
        self.sum.pairs += 1;
        true
    }

    /// Adds ball `a` of body A with every ball of a leaf of body B, moved to its pose; how many of them it meets.
    pub fn add_leaf(&mut self, a: &WeightedBall, leaf: &[WeightedBall]) -> u64 {
        let sum = self.leaf(a, leaf);
        self.sum += sum;
        sum.pairs
    }

    /// Adds ball `b` of body B, moved to its pose, with every ball of a leaf of body A; how many of them it meets.
    pub fn add_to_leaf(&mut self, leaf: &[WeightedBall], b: &WeightedBall) -> u64 {
        let mut sum = self.leaf(b, leaf);
        // The roles are exchanged: the force on the other body, along the same line.
        sum.force = -sum.force;
        sum.torque = -sum.torque;
        self.sum += sum;
        sum.pairs
    }

    fn leaf(&self, ball: &WeightedBall, leaf: &[WeightedBall]) -> Overlap {
        Arch::new().dispatch(Leaf {
            kernel: self.kernel,
            about: self.about,
            ball,
            leaf,
        })
    }

    /// The sum so far.
    pub fn sum(&self) -> Overlap {
        self.sum
    }

    /// Adds a sum made elsewhere about the same point.
    pub fn merge(&mut self, other: Overlap) {
        self.sum += other;
    }
}

/// One ball and those of a leaf.
struct Leaf<'a> {
    kernel: &'a PairOverlap,
    about: Vector3<f64>,
    ball: &'a WeightedBall,
    leaf: &'a [WeightedBall],
}

impl WithSimd for Leaf<'_> {
    type Output = Overlap;

    /// Overlap of the ball with those of the leaf: force on the leaf. Those that meet it are collected, without a
    /// branch that would be a coin toss, and handled by eights.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Overlap {
        let mut sum = Overlap::default();
        let mut met = Met::new();
        for (index, other) in self.leaf.iter().enumerate() {
            met.push(self.ball, other, index);
            if met.count == LANES {
                self.flush(simd, &mut met, &mut sum);
            }
        }
        self.flush(simd, &mut met, &mut sum);
        sum
    }
}

impl Leaf<'_> {
    /// Adds the pairs collected and forgets them.
    #[inline(always)]
    fn flush<S: Simd>(&self, simd: S, met: &mut Met, sum: &mut Overlap) {
        let mut ratios = [0.0; LANES];
        let mut scaled = [0.0; LANES];
        let mut roots = [0.0; LANES];
        let mut rests = [0.0; LANES];
        for lane in 0..LANES {
            let radius = met.radii[lane];
            let (small, large) = (radius.min(self.ball.radius), radius.max(self.ball.radius));
            let place = Place::new(small, large, met.squares[lane]);
            ratios[lane] = place.ratio;
            scaled[lane] = place.square;
            roots[lane] = place.root;
            rests[lane] = place.rest;
        }
        for lane in 0..met.count.min(LANES) {
            let Some(other) = self.leaf.get(met.indices[lane]) else {
                continue;
            };
            let place = Place {
                ratio: ratios[lane],
                square: scaled[lane],
                root: roots[lane],
                rest: rests[lane],
            };
            let radii = [
                other.radius.min(self.ball.radius),
                other.radius.max(self.ball.radius),
            ];
            let [value, slope] = self.kernel.placed(simd, radii, met.squares[lane], &place);
            let weight = self.ball.weight * other.weight;
            let arm = Vector3::from(other.center) - Vector3::from(self.ball.center);
            let force = arm * (-2.0 * weight * slope);
            sum.energy += weight * value;
            sum.force += force;
            sum.torque += (Vector3::from(other.center) - self.about).cross(&force);
        }
        sum.pairs += met.count as u64;
        met.count = 0;
    }
}

/// Balls of a leaf that meet the one.
struct Met {
    squares: [f64; LANES],
    radii: [f64; LANES],
    indices: [usize; LANES],
    count: usize,
}

impl Met {
    fn new() -> Self {
        Self {
            squares: [0.0; LANES],
            radii: [1.0; LANES],
            indices: [0; LANES],
            count: 0,
        }
    }

    /// Writes a ball to the next place, which counts only if it meets the one. There must be room.
    #[inline(always)]
    fn push(&mut self, ball: &WeightedBall, other: &WeightedBall, index: usize) {
        let square = (Vector3::from(other.center) - Vector3::from(ball.center)).norm_squared();
        let next = self.count % LANES;
        self.squares[next] = square;
        self.radii[next] = other.radius;
        self.indices[next] = index;
        self.count += usize::from(meet(ball.radius, other.radius, square));
    }
}
