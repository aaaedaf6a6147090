//! Poses that are one with a pose.

use knotdock_scoring::se3::Pose;

/// Poses that describe the same complex as a pose M.
#[derive(Clone, Debug, PartialEq)]
pub enum Equivalents {
    /// No others.
    None,
    /// Its inverse: a ring with its copies counted the other way.
    Inverse,
    /// M after a rotation of the body onto itself: a second ring with its copies counted from another one.
    Rotated(Vec<Pose>),
}

impl Equivalents {
    /// The pose and all that are one with it, itself first.
    pub fn of(&self, pose: &Pose) -> impl Iterator<Item = Pose> {
        let inverse = matches!(self, Self::Inverse).then(|| pose.inverse());
        let rotations = match self {
            Self::Rotated(rotations) => rotations.as_slice(),
            _ => &[],
        };
        let rotated = rotations.iter().map(|rotation| pose.after(rotation));
        std::iter::once(*pose).chain(inverse).chain(rotated)
    }
}
