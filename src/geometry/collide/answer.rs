//! All that is asked about one pose, and about many at once.

use std::time::{Duration, Instant};

use knotdock_scoring::se3::Pose;
use rayon::prelude::*;

use super::contact::{Contact, Densities, DensityError, Method};
use super::scene::{Bounds, CollisionScene, Deadline, Found, Workspace};
use super::shared_volume::SharedVolume;

/// Exponent of the bumps of densities: that for which weights are fitted.
const ALPHA: f64 = 2.0;
/// Poses that one thread takes at a time.
const POSES_A_TASK: usize = 64;

/// What is computed of a pose beside the verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantities {
    /// Bounds of the signed distance.
    pub distance: bool,
    /// The shared volume.
    pub volume: bool,
    /// Overlap energy, force and torque.
    pub force: bool,
}

/// What is known of a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// The verdict.
    pub found: Found,
    /// Bounds of the signed distance, where requested.
    pub bounds: Option<Bounds>,
    /// The shared volume, where requested.
    pub volume: Option<SharedVolume>,
    /// Energy, force and torque, where requested.
    pub contact: Option<Contact>,
    /// Pairs of balls that were looked at.
    pub ball_pairs: usize,
    /// Fourier modes that were summed.
    pub modes: usize,
    /// Wall time, in seconds.
    pub seconds: f64,
}

/// A scene with what its quantities need.
pub struct Questions {
    scene: CollisionScene,
    densities: Option<Densities>,
    ways: Ways,
    quantities: Quantities,
}

/// How questions are answered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ways {
    /// Trees, modes or both.
    pub method: Method,
    /// The most Fourier modes that are summed.
    pub modes: usize,
    /// Time for one pose.
    pub deadline: Option<Duration>,
}

impl Default for Ways {
    fn default() -> Self {
        Self {
            method: Method::Auto,
            modes: 4096,
            deadline: None,
        }
    }
}

impl Questions {
    /// Prepares a scene.
    ///
    /// # Errors
    /// [`DensityError`] where the bodies have no density.
    pub fn new(
        scene: CollisionScene,
        quantities: Quantities,
        ways: Ways,
    ) -> Result<Self, DensityError> {
        let needed = quantities.force || ways.method == Method::Modes;
        let densities = needed.then(|| Densities::new(&scene, ALPHA, ways.method, ways.modes));
        Ok(Self {
            densities: densities.transpose()?,
            scene,
            ways,
            quantities,
        })
    }

    /// The scene.
    pub fn scene(&self) -> &CollisionScene {
        &self.scene
    }

    /// Answers for one pose.
    pub fn answer(&self, pose: &Pose, work: &mut Workspace) -> Answer {
        let start = Instant::now();
        let deadline = Deadline::after(self.ways.deadline);
        let motion = self.scene.motion(pose);
        let densities = self.densities.as_ref();
        let (found, mut modes) = match densities.filter(|_| self.ways.method == Method::Modes) {
            Some(densities) => densities.verdict(&motion, deadline, work),
            None => (self.scene.verdict(&motion, deadline, work), 0),
        };
        let mut ball_pairs = found.ball_pairs;
        let contact = densities
            .filter(|_| self.quantities.force)
            .map(|densities| {
                let contact = densities.contact(&self.scene, &motion, work);
                ball_pairs += contact.ball_pairs;
                modes += contact.modes;
                contact
            });
        let bounds = self.quantities.distance.then(|| {
            let bounds = self.scene.distance(&motion, deadline, work);
            ball_pairs += bounds.ball_pairs;
            bounds
        });
        let volume = self.quantities.volume;
        let volume = volume.then(|| self.scene.shared_volume(&motion, deadline, work));
        Answer {
            found,
            bounds,
            volume,
            contact,
            ball_pairs,
            modes,
            seconds: start.elapsed().as_secs_f64(),
        }
    }

    /// Answers for many poses, in their order, on the threads of the caller's pool.
    pub fn answers(&self, poses: &[Pose]) -> Vec<Answer> {
        poses
            .par_chunks(POSES_A_TASK)
            .map_init(Workspace::new, |work, poses| {
                let answers = poses.iter().map(|pose| self.answer(pose, work));
                answers.collect::<Vec<_>>()
            })
            .flatten_iter()
            .collect()
    }
}
