//! Force and torque of the overlap energy of two solids, by pairs of balls or by Fourier modes (B&I, eq. 50).
//!
//! The energy is the integral of the product of both bodies' densities, sums of bumps that are about one inside
//! ([`BallSolid::density`]). It is about the shared volume, smooth, and zero unless inner balls meet. Force and torque
//! are minus its slopes ([`knotdock_scoring::overlap`]).
//!
//! Pairs cost what meets, modes the same at every pose. So the hybrid way sums the pairs that the trees leave, and turns
//! to the modes where these cost less. Modes above their error certify that inner balls meet, but never that none do.

use knotdock_scoring::overlap::{
    Accumulator, ModesWorkspace, OverlapModes, PairOverlap, WeightedBall, pairs_nanoseconds,
};
use knotdock_scoring::se3::Pose;
use knotdock_structures::Ball;
use knotdock_structures::ball_solid::{BallHierarchy, BallSolid, Motion};
use nalgebra::Vector3;

use super::scene::{Certificate, CollisionScene, Deadline, Found, Verdict, Workspace};

/// How verdicts and forces are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Verdicts by trees, forces as of [`Self::Hybrid`] where the bodies have so many balls that modes can cost less.
    #[default]
    Auto,
    /// Verdicts by trees, forces by all pairs of balls that meet.
    Tree,
    /// Verdicts and forces by modes alone: no pose is ever found free.
    Modes,
    /// Verdicts by trees, forces by pairs or by modes, whichever cost less at a pose.
    Hybrid,
}

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
    /// Modes that were summed instead; zero where pairs were.
    pub modes: usize,
}

/// The densities of two solids, ready for many poses.
#[derive(Clone, Debug)]
pub struct Densities {
    trees: [BallHierarchy; 2],
    /// Weights in the order of the trees.
    weights: [Vec<f64>; 2],
    kernel: PairOverlap,
    modes: Option<OverlapModes>,
    pairs: bool,
}

/// Why densities cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DensityError {
    /// The exponent of the bumps.
    #[error(transparent)]
    Alpha(#[from] knotdock_structures::numeric::bump::AlphaError),
    /// The modes.
    #[error(transparent)]
    Modes(#[from] knotdock_scoring::overlap::OverlapModesError),
}

impl Densities {
    /// Densities of bumps of exponent `alpha`; `modes` is the most Fourier modes, where the method takes any.
    ///
    /// # Errors
    /// [`DensityError`] unless alpha is above zero.
    pub fn new(
        scene: &CollisionScene,
        alpha: f64,
        method: Method,
        modes: usize,
    ) -> Result<Self, DensityError> {
        let [(first, a), (second, b)] = scene.solids().each_ref().map(tree_of);
        let kernel = PairOverlap::new(alpha)?;
        let listed = |tree: &BallHierarchy, weights: &[f64]| -> Vec<WeightedBall> {
            let balls = tree.balls().iter().zip(weights);
            balls
                .map(|(ball, &weight)| weighted(ball, weight))
                .collect()
        };
        let prepared = || {
            let (a, b) = (listed(&first, &a), listed(&second, &b));
            OverlapModes::with_margin(&kernel, &a, &b, modes, scene.margin())
        };
        let most = pairs_nanoseconds((a.len() * b.len()) as u64);
        let modes = match method {
            Method::Tree => None,
            Method::Modes | Method::Hybrid => Some(prepared()?),
            // Forces are those of the solids themselves: with a margin the modes are of grown ones.
            Method::Auto if scene.margin() > 0.0 || most < WORTH_MODES => None,
            Method::Auto => Some(prepared()?).filter(|modes| modes.nanoseconds() < most),
        };
        Ok(Self {
            trees: [first, second],
            weights: [a, b],
            kernel,
            modes,
            pairs: method != Method::Modes,
        })
    }

    /// Energy, force and torque by pairs of balls, or by modes where these cost less.
    pub fn contact(
        &self,
        scene: &CollisionScene,
        motion: &Motion,
        work: &mut Workspace,
    ) -> Contact {
        let about = motion.apply(scene.solids()[1].centroid());
        let mut sum = Accumulator::new(&self.kernel, about);
        // With a margin the modes are of grown solids, and no substitute for pairs.
        let modes = self.modes.as_ref();
        let instead = modes.filter(|modes| !self.pairs || modes.margin() == 0.0);
        let worth = match instead {
            Some(_) if !self.pairs => 0.0,
            Some(modes) => modes.nanoseconds(),
            None => f64::INFINITY,
        };
        let [first, second] = &self.trees;
        let mut seen = 0;
        let all = self.pairs
            && work
                .pairs
                .visit([first, second], motion, 0.0, |[i, j], moved, _| {
                    let a = weighted(&first.balls()[i], self.weights[0][i]);
                    let b = weighted(moved, self.weights[1][j]);
                    sum.add(&a, &b);
                    seen += 1;
                    pairs_nanoseconds(seen) <= worth
                });
        let (Some(modes), false) = (instead, all) else {
            let sum = sum.sum();
            return Contact {
                energy: sum.energy,
                force: sum.force.into(),
                torque: sum.torque.into(),
                bound: self.kernel.error() * sum.energy,
                ball_pairs: sum.pairs as usize,
                modes: 0,
            };
        };
        let buffers = buffers(&mut work.modes, modes);
        let found = modes.evaluate(&pose_of(motion), about, buffers);
        Contact {
            energy: found.energy,
            force: found.force.into(),
            torque: found.torque.into(),
            bound: found.tail + found.rounding,
            ball_pairs: seen as usize,
            modes: found.modes,
        }
    }

    /// A verdict by modes alone: a hit where they certify one.
    pub fn verdict(
        &self,
        motion: &Motion,
        deadline: Deadline,
        work: &mut Workspace,
    ) -> (Found, usize) {
        let mut found = Found {
            verdict: Verdict::Undecided,
            certificate: Certificate::None,
            ball_pairs: 0,
        };
        let Some(modes) = &self.modes else {
            return (found, 0);
        };
        let buffers = buffers(&mut work.modes, modes);
        let mut sum = modes.start(&pose_of(motion), buffers);
        let summed = sum.advance(|| deadline.has_come(), true);
        if summed.certifies_hit() {
            found.verdict = Verdict::Hit;
            found.certificate = Certificate::Modes;
        } else if !summed.complete {
            found.certificate = Certificate::Deadline;
        }
        (found, summed.modes)
    }
}

/// Nanoseconds of all pairs below which modes are not worth their preparation.
const WORTH_MODES: f64 = 1e6;

/// Buffers for modes, made at first use.
fn buffers<'a>(
    kept: &'a mut Option<ModesWorkspace>,
    modes: &OverlapModes,
) -> &'a mut ModesWorkspace {
    kept.get_or_insert_with(|| modes.workspace())
}

/// A motion as a pose.
fn pose_of(motion: &Motion) -> Pose {
    let rows = motion.rows;
    let matrix = nalgebra::Matrix3::from_fn(|row, column| rows[row][column]);
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(matrix);
    Pose {
        rotation: nalgebra::UnitQuaternion::from_rotation_matrix(&rotation),
        translation: Vector3::from(motion.shift),
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
