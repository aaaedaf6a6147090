//! Overlap energy by Fourier modes (B&I eq. 50), with a bound on the modes left out.
//!
//! In a cube of edge L that holds both bodies wherever they meet, with f^ the transform of a body's summed bumps at its
//! pose,
//!
//! E = L^-3 sum over w of f_A^(w) conj(f_B^(w)).
//!
//! Body A's transform is computed once, that of body B at each pose, O(modes x balls of B); three more sums give the
//! torque.
//!
//! # Bounds
//!
//! By Cauchy and Schwarz the modes left out add at most sqrt(T_A T_B). By Parseval T, the energy of a body's function in
//! these modes, is the self-overlap of the body (a sum over pairs) less the energy in the modes kept, which is known at
//! every pose. The error of the pair kernel is added to T. The rounding bound counts all roundings of phases, amplitudes
//! and sums as if they were in phase. So [`ModesOverlap::certifies_hit`] is never wrong: bumps with weights that are not
//! negative and have an energy above 0 meet. Modes never certify a miss.

mod lattice;
mod spectrum;
mod sum;
#[cfg(test)]
mod tests;

pub use sum::{ModesOverlap, ModesSum, ModesWorkspace};

use super::{Accumulator, PairOverlap, WeightedBall};
use crate::se3::Pose;
use crate::vectorized::vectorize;
use knotdock_structures::Error;
use lattice::Lattice;
use nalgebra::{Rotation3, Vector3};
use spectrum::{Body, Phases, Sums, Transform};
use std::f64::consts::PI;

/// Nanoseconds a mode and ball of B, torque included: a quarter of it without. As measured (`overlap_costs_of_modes`),
/// on the machine of [`super::pairs_nanoseconds`].
const MODE_BALL: f64 = 1.2;

/// The modes of two bodies, ready for one pose at a time.
#[derive(Clone, Debug)]
pub struct OverlapModes {
    lattice: Lattice,
    a: Body,
    b: Body,
    /// By block of shells: transform of A, smoothed, at +k and -k of each entry, over the volume.
    spectra: Vec<Vec<[[f64; 2]; 2]>>,
    /// Energy of A's function, smoothed, beyond each number of blocks.
    tails_a: Vec<f64>,
    /// Self-overlap of B and its error.
    norm_b: [f64; 2],
    /// Bound of all roundings of each number of blocks.
    rounding: Vec<f64>,
    /// Bound of the rounding of B's own energy in each number of blocks.
    rounding_b: Vec<f64>,
    not_negative: bool,
    margin: f64,
    /// Distance of the middles from which on nothing meets.
    reach: f64,
}

impl OverlapModes {
    /// The modes of two ball sets: the lowest, at most `most` of them, conjugates counted.
    ///
    /// Takes O(n^2) for the self-overlap of each body and O(modes x balls of A). Memory: 8 bytes per ball and shell, of
    /// which there are about 0.4 `most`^(2/3).
    ///
    /// # Errors
    /// [`Error`] on a body without balls, or a ball without a finite centre and weight and a radius above zero.
    pub fn new(
        kernel: &PairOverlap,
        a: &[WeightedBall],
        b: &[WeightedBall],
        most: usize,
    ) -> Result<Self, Error> {
        Self::with_margin(kernel, a, b, most, 0.0)
    }

    /// The same with A's function smoothed by a bump of radius `margin` and integral 1: A grown by one more ball, which
    /// is a product in the frequency domain (B&I 4.1). A certified hit then means that A and B are nearer than the
    /// margin. Margin 0 smooths nothing.
    ///
    /// # Errors
    /// As [`Self::new`], and on a margin that is negative or not finite.
    pub fn with_margin(
        kernel: &PairOverlap,
        a: &[WeightedBall],
        b: &[WeightedBall],
        most: usize,
        margin: f64,
    ) -> Result<Self, Error> {
        check('A', a)?;
        check('B', b)?;
        if !(margin.is_finite() && margin >= 0.0) {
            return Err(Error::input(
                "the margin must be a finite number, 0 or above",
            ));
        }
        let ((_, radius_a), (_, radius_b)) = (Body::extent(a), Body::extent(b));
        let reach = radius_a + radius_b + margin;
        // Bodies that meet have their middles within the reach: the next image is another reach away then.
        let lattice = Lattice::new(2.0 * reach, most);
        let radii = a.iter().chain(b).map(|ball| ball.radius);
        let largest = radii.fold(margin, f64::max);
        let highest = (lattice.shells() as f64).sqrt() / lattice.length;
        let transform = Transform::new(kernel.bump(), largest * highest);
        let smoothing = Smoothing::new(margin, &lattice, &transform, kernel.bump().volume());
        let mut modes = Self {
            a: Body::new(a, &lattice, &transform),
            b: Body::new(b, &lattice, &transform),
            spectra: Vec::new(),
            tails_a: Vec::new(),
            norm_b: self_overlap(kernel, b),
            rounding: vec![0.0],
            rounding_b: vec![0.0],
            not_negative: a.iter().chain(b).all(|ball| ball.weight >= 0.0),
            margin,
            reach,
            lattice,
        };
        modes.transform_a(self_overlap(kernel, a), &smoothing);
        Ok(modes)
    }

    /// Transforms A, with the bounds of every block.
    fn transform_a(&mut self, [norm, error]: [f64; 2], smoothing: &Smoothing) {
        let volume = self.lattice.length.powi(3);
        let mut phases = Phases::new(&self.a, &self.lattice);
        let (turn, middle) = (Rotation3::identity(), Vector3::zeros());
        vectorize!(phases.place(&self.a, &self.lattice, &turn, &middle));
        let mut sums: Vec<Sums> = vec![[0.0; 4]; self.lattice.widest()];
        let (mut energy, mut rounding_a) = (0.0, 0.0);
        let (mut rounding, mut rounding_b) = (0.0, 0.0);
        self.tails_a = vec![norm + error];
        for block in &self.lattice.blocks {
            vectorize!(phases.gather(&self.a, block, None, &mut sums));
            let mut spectrum = Vec::with_capacity(block.entries.len());
            for (entry, sums) in block.entries.iter().zip(&sums) {
                let values = both_signs(sums);
                let bounds = |body: &Body| (body.envelope[entry.shell], body.errors[entry.shell]);
                let ((a, error_a), (b, error_b)) = (bounds(&self.a), bounds(&self.b));
                let product = a * error_b + b * error_a + error_a * error_b;
                for (value, count) in values.iter().zip(entry.counts) {
                    let share = count / volume;
                    energy += share * (value[0] * value[0] + value[1] * value[1]);
                    rounding += share * (product + smoothing.error * a * b);
                    rounding_a += share * error_a * (2.0 * a + error_a);
                    rounding_b += share * error_b * (2.0 * b + error_b);
                }
                let factor = smoothing.factors[entry.shell] / volume;
                spectrum.push(values.map(|value| value.map(|part| part * factor)));
            }
            self.spectra.push(spectrum);
            let tail = (norm - energy).max(0.0) + error + rounding_a;
            self.tails_a.push(tail * smoothing.beyond(block.end));
            self.rounding.push(rounding);
            self.rounding_b.push(rounding_b);
        }
    }

    /// Modes, conjugates counted.
    pub fn modes(&self) -> usize {
        self.lattice.modes()
    }

    /// Nanoseconds that [`Self::evaluate`] is expected to take, to be held against [`super::pairs_nanoseconds`].
    pub fn nanoseconds(&self) -> f64 {
        MODE_BALL * self.modes() as f64 * self.b.balls as f64
    }

    /// The margin.
    pub fn margin(&self) -> f64 {
        self.margin
    }

    /// Buffers of one evaluation at a time: nothing else is allocated at a pose.
    pub fn workspace(&self) -> ModesWorkspace {
        ModesWorkspace::new(&self.b, &self.lattice)
    }

    /// Energy, force and torque at a pose from all modes, the torque about `about` in A's frame.
    pub fn evaluate(
        &self,
        pose: &Pose,
        about: [f64; 3],
        work: &mut ModesWorkspace,
    ) -> ModesOverlap {
        let mut sum = ModesSum::new(self, pose, Some(about), work);
        sum.advance(|_| false)
    }

    /// Energy and force at a pose from ever more modes, lowest frequencies first: [`ModesSum::advance`] goes on where it
    /// stopped.
    pub fn start<'a>(&'a self, pose: &Pose, work: &'a mut ModesWorkspace) -> ModesSum<'a> {
        ModesSum::new(self, pose, None, work)
    }
}

/// Transform at +k and -k of an entry, (re, im) each.
#[inline(always)]
fn both_signs([cr, ci, sr, si]: &Sums) -> [[f64; 2]; 2] {
    [[cr + si, ci - sr], [cr - si, ci + sr]]
}

/// Factors of a margin on A's transform: psi^(D |w|) / psi^(0).
struct Smoothing {
    margin: f64,
    volume: f64,
    length: f64,
    /// By shell.
    factors: Vec<f64>,
    /// Error of a factor.
    error: f64,
}

impl Smoothing {
    fn new(margin: f64, lattice: &Lattice, transform: &Transform, volume: f64) -> Self {
        let length = lattice.length;
        let factor = |shell: usize| {
            let q = margin * (shell as f64).sqrt() / length;
            if margin > 0.0 {
                transform.value(q) / volume
            } else {
                1.0
            }
        };
        Self {
            margin,
            volume,
            length,
            factors: (0..lattice.shells()).map(factor).collect(),
            error: if margin > 0.0 { 1e-8 } else { 0.0 },
        }
    }

    /// Bound of the squared factor from a shell on.
    fn beyond(&self, shell: usize) -> f64 {
        let q = self.margin * (shell as f64).sqrt() / self.length;
        falling_bound(q, self.volume).powi(2)
    }
}

/// Bound of |psi^(q)| / psi^(0) from q on, for a bump of any exponent with integral `volume`.
///
/// A bump is a mean of sharp balls of radius rho up to 1. Their transforms are at most 4 pi rho^3 (1 + z) / z^3 with
/// z = 2 pi rho q: largest for rho = 1.
fn falling_bound(q: f64, volume: f64) -> f64 {
    let z = 2.0 * PI * q;
    (4.0 * PI * (1.0 + z) / (z * z * z) / volume).min(1.0)
}

/// <f, f> of a body by pairs, and the most that the error of the pair kernel can make of it.
fn self_overlap(kernel: &PairOverlap, balls: &[WeightedBall]) -> [f64; 2] {
    let mut sum = Accumulator::new(kernel, [0.0; 3]);
    let volume = kernel.bump().volume();
    let mut most = 0.0;
    for ball in balls {
        sum.add_leaf(ball, balls);
        for other in balls {
            let arm = Vector3::from(other.center) - Vector3::from(ball.center);
            if super::meet(ball.radius, other.radius, arm.norm_squared()) {
                let cube = ball.radius.min(other.radius).powi(3);
                most += (ball.weight * other.weight).abs() * volume * cube;
            }
        }
    }
    // Twice what the fit was measured to miss; sums round by less.
    [sum.sum().energy, (2.0 * kernel.error() + 1e-12) * most]
}

fn check(body: char, balls: &[WeightedBall]) -> Result<(), Error> {
    if balls.is_empty() {
        return Err(Error::input(format!(
            "body {body} has no balls; give it at least one"
        )));
    }
    let good = |ball: &WeightedBall| {
        ball.center.iter().all(|x| x.is_finite())
            && ball.weight.is_finite()
            && ball.radius.is_finite()
            && ball.radius > 0.0
    };
    match balls.iter().position(|ball| !good(ball)) {
        Some(index) => Err(Error::input(format!(
            "ball {index} of body {body} needs a finite centre and weight and a radius above zero"
        ))),
        None => Ok(()),
    }
}
