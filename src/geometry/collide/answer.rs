//! All that is asked about one pose, and about many at once.

use std::time::{Duration, Instant};

use knotdock_scoring::se3::Pose;
use knotdock_structures::numeric::bump::AlphaError;
use rayon::prelude::*;

use super::contact::{Contact, Densities};
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
    quantities: Quantities,
    deadline: Option<Duration>,
}

impl Questions {
    /// Prepares a scene. `deadline` bounds the time of one pose.
    ///
    /// # Errors
    /// [`AlphaError`] never happens for the exponent in use.
    pub fn new(
        scene: CollisionScene,
        quantities: Quantities,
        deadline: Option<Duration>,
    ) -> Result<Self, AlphaError> {
        let densities = quantities.force.then(|| Densities::new(&scene, ALPHA));
        Ok(Self {
            densities: densities.transpose()?,
            scene,
            quantities,
            deadline,
        })
    }

    /// The scene.
    pub fn scene(&self) -> &CollisionScene {
        &self.scene
    }

    /// Answers for one pose.
    pub fn answer(&self, pose: &Pose, work: &mut Workspace) -> Answer {
        let start = Instant::now();
        let deadline = Deadline::after(self.deadline);
        let motion = self.scene.motion(pose);
        let found = self.scene.verdict(&motion, deadline, work);
        let mut ball_pairs = found.ball_pairs;
        let contact = self.densities.as_ref().map(|densities| {
            let contact = densities.contact(&self.scene, &motion, &mut work.pairs);
            ball_pairs += contact.ball_pairs;
            contact
        });
        let bounds = self.quantities.distance.then(|| {
            let bounds = self.scene.distance(&motion, deadline, work);
            ball_pairs += bounds.ball_pairs;
            bounds
        });
        let volume = self.quantities.volume;
        let volume = volume.then(|| self.scene.shared_volume(&motion, work));
        Answer {
            found,
            bounds,
            volume,
            contact,
            ball_pairs,
            modes: 0,
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
