//! Force and torque of the overlap energy of two solids.
//!
//! # Meshes whose triangles decide
//!
//! The energy is the volume that the solids share, exact but for rounding, and so are its slopes
//! ([`knotdock_structures::mesh::SharedRegion`]).
//!
//! # Other solids: pairs of balls or Fourier modes (B&I, eq. 50)
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
use knotdock_structures::ball_solid::{BallHierarchy, BallSolid, Motion};
use knotdock_structures::{Ball, Error};
use nalgebra::Vector3;

use super::{Certificate, Collision, CollisionQuery, Verdict, has_come};

/// How verdicts and forces are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Verdicts by balls, and by triangles where balls leave them open. Forces are those of the shared volume if triangles
    /// decide, else as for [`Self::Hybrid`] if the bodies have enough balls for modes to cost less.
    #[default]
    Auto,
    /// Verdicts by triangles if they decide, forces as for [`Self::Auto`].
    Exact,
    /// Verdicts by balls, forces by all pairs of balls that meet.
    Tree,
    /// Verdicts and forces by modes alone, which never certify that a pose is free.
    Modes,
    /// Verdicts as for [`Self::Auto`]; forces of the densities, by pairs or by modes, whichever cost less at the pose.
    Hybrid,
}

/// Overlap energy, force and torque at a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Contact {
    /// The overlap energy, in the cube of the files' unit.
    pub energy: f64,
    /// Minus its slope by B's translation: the force on B, in A's frame. That on A is its negative.
    pub force: [f64; 3],
    /// Minus its slope by B's rotation about its centre of mass, in A's frame.
    pub torque: [f64; 3],
    /// How far the energy may be from the shared volume of meshes, or from the sum over all pairs of balls: by modes left
    /// out, and by rounding.
    pub bound: f64,
    /// Pairs of balls that were summed.
    pub ball_pairs: usize,
    /// Modes that were summed instead; zero where pairs were.
    pub modes: usize,
}

/// The densities of two solids, ready for many poses.
#[derive(Clone, Debug)]
pub(super) struct Densities {
    trees: [BallHierarchy; 2],
    /// Weights in the order of the trees.
    weights: [Vec<f64>; 2],
    kernel: PairOverlap,
    modes: Option<OverlapModes>,
    /// Those of the largest balls alone, for early hits.
    largest: Option<OverlapModes>,
}

impl Densities {
    /// The densities that a collision needs, with modes if its method takes any.
    ///
    /// # Errors
    /// [`Error`] if a margin or a ball cannot be taken.
    pub fn new(collision: &Collision) -> Result<Self, Error> {
        let [(first, a), (second, b)] = collision.solids.map(tree_of);
        let kernel = PairOverlap::new(ALPHA).map_err(Error::lasting)?;
        let balls = |tree: &BallHierarchy, weights: &[f64]| -> Vec<WeightedBall> {
            let pairs = tree.balls().iter().zip(weights);
            pairs
                .map(|(ball, &weight)| weighted(ball, weight))
                .collect()
        };
        let prepared = |largest: bool| {
            let mut bodies = [balls(&first, &a), balls(&second, &b)];
            if largest {
                for body in &mut bodies {
                    let volume = |ball: &WeightedBall| ball.weight * ball.radius.powi(3);
                    body.sort_by(|a, b| volume(b).total_cmp(&volume(a)));
                    body.truncate(LARGEST);
                }
            }
            let [a, b] = bodies;
            OverlapModes::with_margin(&kernel, &a, &b, collision.max_modes, collision.margin)
                .map_err(|error| error.help("give finite balls, or use the method tree"))
        };
        let all_pairs = pairs_nanoseconds((a.len() * b.len()) as u64);
        let modes = match collision.method {
            Method::Tree => None,
            Method::Modes | Method::Hybrid => Some(prepared(false)?),
            // Forces are those of the solids themselves: with a margin the modes are of grown ones.
            Method::Auto | Method::Exact if collision.margin > 0.0 || all_pairs < WORTH_MODES => {
                None
            }
            Method::Auto | Method::Exact => {
                Some(prepared(false)?).filter(|modes| modes.nanoseconds() < all_pairs)
            }
        };
        let largest = match collision.method {
            Method::Modes => Some(prepared(true)?),
            _ => None,
        };
        Ok(Self {
            trees: [first, second],
            weights: [a, b],
            kernel,
            modes,
            largest,
        })
    }
}

impl CollisionQuery<'_> {
    /// Energy, force and torque: of the shared volume if the triangles of meshes decide, else, and with
    /// [`Method::Hybrid`], of the bumps, by pairs or by modes if these cost less. `None` if there are no densities, which
    /// [`Collision::prepare`] reports.
    pub fn contact(&mut self) -> Option<Contact> {
        let collision = self.collision;
        let about = self.motion.apply(collision.solids[1].centroid());
        let takes_region = collision.method != Method::Hybrid;
        if takes_region
            && collision.exact().is_some()
            && self.certificate_by_search().verdict() == Verdict::Free
        {
            return Some(Contact::default());
        }
        if let Some(region) = takes_region.then(|| self.region()).flatten() {
            let force = region.by_shift.map(|part| 0.0 - part);
            let torque = Vector3::from(about).cross(&Vector3::from(region.by_shift))
                - Vector3::from(region.by_turn);
            return Some(Contact {
                energy: region.volume,
                force,
                torque: torque.into(),
                bound: region.bound,
                ball_pairs: 0,
                modes: 0,
            });
        }
        let densities = collision.densities().ok()?;
        let mut sum = Accumulator::new(&densities.kernel, about);
        let takes_pairs = collision.method != Method::Modes;
        // With a margin the modes are of grown solids, and no substitute for pairs.
        let modes = densities.modes.as_ref();
        let instead = modes.filter(|modes| !takes_pairs || modes.margin() == 0.0);
        let worth = match instead {
            Some(_) if !takes_pairs => 0.0,
            Some(modes) => modes.nanoseconds(),
            None => f64::INFINITY,
        };
        let [first, second] = &densities.trees;
        let weights = &densities.weights;
        let mut seen = 0;
        let all = takes_pairs
            && self
                .work
                .pairs
                .visit([first, second], &self.motion, 0.0, |[i, j], moved, _| {
                    let a = weighted(&first.balls()[i], weights[0][i]);
                    let b = weighted(moved, weights[1][j]);
                    sum.add(&a, &b);
                    seen += 1;
                    pairs_nanoseconds(seen) <= worth
                });
        let contact = match instead {
            Some(modes) if !all => {
                let buffers = buffers(&mut self.work.modes[1], modes);
                let summed = modes.evaluate(&pose_of(&self.motion), about, buffers);
                Contact {
                    energy: summed.energy,
                    force: summed.force.into(),
                    torque: summed.torque.into(),
                    bound: summed.tail + summed.rounding,
                    ball_pairs: seen as usize,
                    modes: summed.modes,
                }
            }
            _ => {
                let sum = sum.sum();
                Contact {
                    energy: sum.energy,
                    force: sum.force.into(),
                    torque: sum.torque.into(),
                    bound: densities.kernel.error() * sum.energy,
                    ball_pairs: sum.pairs as usize,
                    modes: 0,
                }
            }
        };
        self.ball_pairs += contact.ball_pairs;
        self.modes += contact.modes;
        Some(contact)
    }

    /// The certificate by modes alone: that of a hit, or none. First the integral is limited to the largest balls of both
    /// solids, whose modes are few and fall fast (the early hit test of B&I 4.1), then to nothing.
    pub(super) fn certificate_by_modes(&mut self) -> Certificate {
        let densities = self.collision.densities.get();
        let [Some(few), Some(all)] = [
            densities.and_then(|densities| densities.largest.as_ref()),
            densities.and_then(|densities| densities.modes.as_ref()),
        ] else {
            return Certificate::None;
        };
        let pose = pose_of(&self.motion);
        for (modes, kept) in [few, all].into_iter().zip(&mut self.work.modes) {
            let mut sum = modes.start(&pose, buffers(kept, modes));
            let summed = sum.advance(|sum| sum.certifies_hit() || has_come(self.end));
            self.modes += summed.modes;
            if summed.certifies_hit() {
                return Certificate::Modes;
            }
            if !summed.complete {
                return Certificate::Deadline;
            }
        }
        Certificate::None
    }
}

/// Balls of either solid that early hits are sought among.
const LARGEST: usize = 16;
/// Exponent of the bumps of densities: that for which weights are fitted.
const ALPHA: f64 = 2.0;
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
