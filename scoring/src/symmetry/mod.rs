//! Rings: n copies of one molecule about an axis, each the image of the one before it by the same pose.
//!
//! Such a pose M turns by 2 pi / n about an axis and does not slide along it, so that M^n is the identity. Let u be
//! the axis' direction, t the translation and p the axis' point nearest the origin. Then u.t = 0, t = p - R p and p =
//! (t + cot(pi / n) u x t) / 2.
//!
//! Its score is that of each pair of neighbours.
//!
//! If the molecule is moved by C under the axis, or the axis by C over the molecule, M becomes C M C^-1. This varies a
//! ring and keeps it a ring.
//!
//! Dihedral symmetry Dn is a ring of two whose molecule is itself a ring of n. A half-turn about an axis that crosses
//! the ring's own at a right angle ([`RingAxis`]) lays one ring face to face with the other.

mod ring_axis;

use std::fmt;
use std::str::FromStr;

use crate::rigid_move::PoseGradient;
use crate::se3::Pose;
use knotdock_structures::Error;
use nalgebra::{Unit, UnitQuaternion, Vector3};
pub use ring_axis::{NotARing, RingAxis};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Most copies in a ring: proteins with more are rare, and their neighbours are all but parallel.
const MAX_COPIES: usize = 24;
/// Most copies in each of two rings.
const MAX_FOLDS: usize = 12;
/// Largest departure of a pose from a ring's: in radians of its angle, and in Å of its slide along the axis. This share
/// of its translation is added, which is long where the file's origin is far.
const OFF: f64 = 1e-6;

/// Symmetry of the copies of a molecule: Cn, n of them about an axis, or Dn, two rings of n face to face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Symmetry {
    /// Molecules that a pose relates: of Dn the two rings.
    copies: usize,
    /// Copies in each molecule: 1 of Cn.
    folds: usize,
}

impl FromStr for Symmetry {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let wrong = || {
            Error::input(format!(
                "'{text}' is no symmetry that is known: C2 to C{MAX_COPIES} and D2 to D{MAX_FOLDS} are"
            ))
        };
        let (kind, digits) = text.split_at_checked(1).ok_or_else(wrong)?;
        let count = (digits.bytes().all(|byte| byte.is_ascii_digit()))
            .then(|| digits.parse().ok())
            .flatten();
        match (kind, count) {
            ("C" | "c", Some(copies @ 2..=MAX_COPIES)) => Ok(Self { copies, folds: 1 }),
            ("D" | "d", Some(folds @ 2..=MAX_FOLDS)) => Ok(Self { copies: 2, folds }),
            _ => Err(wrong()),
        }
    }
}

impl fmt::Display for Symmetry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.folds {
            1 => write!(f, "C{}", self.copies),
            folds => write!(f, "D{folds}"),
        }
    }
}

impl Serialize for Symmetry {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Symmetry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

impl Symmetry {
    /// Copies in each of the two rings of Dn; `None` of Cn, whose copies are single molecules.
    pub fn folds(self) -> Option<usize> {
        (self.folds > 1).then_some(self.folds)
    }

    /// Number of copies of the docked molecule: n for Cn, the two rings for Dn.
    pub fn copies(self) -> usize {
        self.copies
    }

    /// Angle in radians from one copy to the next, 2 pi / n.
    pub fn angle(self) -> f64 {
        std::f64::consts::TAU / self.copies as f64
    }

    /// The rotation from one copy to the next about an axis of this direction.
    pub fn rotation(self, axis: &Unit<Vector3<f64>>) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(axis, self.angle())
    }

    /// The nearest pose of a ring about the same axis: without the slide along it. `pose` turns by the ring's
    /// angle, rounding aside.
    pub fn nearest(self, pose: &Pose) -> Pose {
        let axis = direction(pose);
        let slide = axis.dot(&pose.translation);
        Pose {
            rotation: self.rotation(&axis),
            translation: pose.translation - slide * *axis,
        }
    }

    /// Poses of all copies, the first unmoved and the second at `pose`; `None` where `pose` is not one of such a ring.
    pub fn ring(self, pose: &Pose) -> Option<Vec<Pose>> {
        let axis = direction(pose);
        let t = pose.translation;
        let turn = pose.rotation.angle_to(&self.rotation(&axis));
        let slide = axis.dot(&t).abs();
        // A pose without rotation has no axis, and angles to it are no numbers.
        let fits = turn <= OFF && slide <= OFF * (1.0 + t.norm());
        fits.then(|| self.images(pose).collect())
    }

    /// Poses of all copies, as [`Self::ring`] has them, of a pose that is known to be a ring's.
    fn images(self, pose: &Pose) -> impl Iterator<Item = Pose> + use<> {
        let axis = direction(pose);
        let t = pose.translation;
        let foot = (t + axis.cross(&t) / (0.5 * self.angle()).tan()) / 2.0;
        (0..self.copies).map(move |copy| {
            let rotation = UnitQuaternion::from_axis_angle(&axis, copy as f64 * self.angle());
            Pose {
                rotation,
                translation: foot - rotation * foot,
            }
        })
    }

    /// Poses of the copies beyond the second, relative to the first, each kind of pair once.
    ///
    /// With each comes the number of such pairs for each pair of neighbours: one, and a half across an even ring.
    pub fn beyond(self, pose: &Pose) -> impl Iterator<Item = (Pose, f64)> + use<> {
        let copies = self.copies;
        let half = copies / 2 + 1;
        let images = self.images(pose).enumerate().take(half).skip(2);
        images.map(move |(copy, pose)| (pose, if 2 * copy == copies { 0.5 } else { 1.0 }))
    }

    /// Whether a ring has copies that are not neighbours.
    pub fn has_beyond(self) -> bool {
        self.copies > 3
    }
}

/// Direction of the axis that a pose turns about.
fn direction(pose: &Pose) -> Unit<Vector3<f64>> {
    let [_, x, y, z] = pose.quaternion();
    Unit::new_normalize(Vector3::new(x, y, z))
}

/// The pose C M C^-1 that a pose M becomes when C, a turn about `center` and then a shift, moves the molecule under the
/// axis.
pub fn conjugated(
    pose: &Pose,
    center: Vector3<f64>,
    turn: UnitQuaternion<f64>,
    shift: Vector3<f64>,
) -> Pose {
    let motion = Pose::about(turn, center, center + shift);
    motion.after(pose).after(&motion.inverse())
}

/// Gradient of a score by small shifts (per Å) and turns about `center` (per radian) of [`conjugated`], given its
/// gradient at `pose` by the ligand's own.
pub fn conjugated_gradient(
    pose: &Pose,
    center: Vector3<f64>,
    gradient: &PoseGradient,
) -> PoseGradient {
    // A shift b moves the ligand's centre by b - R b; a turn a about the centre moves it by a x (its place less the
    // centre) and turns by a - R a.
    let back = pose.rotation.inverse();
    let arm = pose.rotation * center + pose.translation - center;
    let (force, torque) = (gradient.force, gradient.torque);
    PoseGradient {
        force: force - back * force,
        torque: arm.cross(&force) + torque - back * torque,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cyclic(text: &str) -> Symmetry {
        text.parse().unwrap()
    }

    /// A pose of a ring with an axis somewhere.
    fn some(symmetry: Symmetry) -> Pose {
        through(symmetry, Vector3::new(11.0, 4.0, -7.0))
    }

    /// A pose of a ring whose axis runs through a point.
    fn through(symmetry: Symmetry, point: Vector3<f64>) -> Pose {
        let axis = Unit::new_normalize(Vector3::new(0.3, -0.8, 0.5));
        let rotation = symmetry.rotation(&axis);
        Pose {
            rotation,
            translation: point - rotation * point,
        }
    }

    fn difference(a: &Pose, b: &Pose) -> f64 {
        a.angle_to(b) + (a.translation - b.translation).norm()
    }

    #[test]
    fn names_are_read_and_written() {
        for copies in [2, 3, 24] {
            let text = format!("C{copies}");
            assert_eq!(cyclic(&text).to_string(), text);
            assert_eq!(cyclic(&text.to_lowercase()).copies(), copies);
        }
        for folds in [2, 3, 12] {
            let dihedral = cyclic(&format!("D{folds}"));
            assert_eq!(dihedral.to_string(), format!("D{folds}"));
            assert_eq!((dihedral.folds(), dihedral.copies()), (Some(folds), 2));
        }
        assert_eq!(cyclic("C4").folds(), None);
        for wrong in [
            "", "C", "3", "C1", "C0", "C25", "D1", "D13", "E2", "C+3", "C 3", "Ｃ3", "é",
        ] {
            assert!(wrong.parse::<Symmetry>().is_err(), "{wrong}");
        }
    }

    /// Each image is the pose once more, and once around all is where it was.
    #[test]
    fn images_are_powers_and_close() {
        for copies in 2..=MAX_COPIES {
            let symmetry = Symmetry { copies, folds: 1 };
            let pose = some(symmetry);
            let images = symmetry.ring(&pose).unwrap();
            assert_eq!(images.len(), copies);
            let mut power = Pose::identity();
            for image in &images {
                assert!(difference(image, &power) < 1e-10, "{symmetry}");
                power = pose.after(&power);
            }
            assert!(difference(&power, &Pose::identity()) < 1e-10, "{symmetry}");
        }
    }

    /// A file's origin on the axis does not move, and one far off it moves far: either is a ring, as printed too.
    #[test]
    fn rings_are_known_wherever_the_origin_lies() {
        for copies in [2, 3, 7, MAX_COPIES] {
            let symmetry = Symmetry { copies, folds: 1 };
            for scale in [0.0, 1e-12, 1e-6, 1.0, 1e6] {
                let point = scale * Vector3::new(1.0, 0.7, -0.4);
                let pose = through(symmetry, point);
                let printed = Pose::from_parts(pose.quaternion(), pose.translation.into());
                let images = symmetry.ring(&symmetry.nearest(&printed)).unwrap();
                let last = pose.after(&images[copies - 1]);
                assert!(difference(&last, &Pose::identity()) < 1e-9 * (1.0 + scale));
            }
        }
    }

    /// All pairs of copies are counted once: each pair of neighbours with its share of the pairs beyond.
    #[test]
    fn pairs_beyond_neighbours_are_counted_once() {
        for copies in 2..=MAX_COPIES {
            let symmetry = Symmetry { copies, folds: 1 };
            let beyond: f64 = symmetry
                .beyond(&some(symmetry))
                .map(|(_, pairs)| pairs)
                .sum();
            // A ring of two has one pair of neighbours, any other as many as copies.
            let neighbours = if copies == 2 { 1.0 } else { copies as f64 };
            let pairs = copies as f64 * (copies as f64 - 1.0) / 2.0;
            assert_eq!(neighbours * (1.0 + beyond), pairs, "{symmetry}");
            assert_eq!(beyond > 0.0, symmetry.has_beyond());
        }
    }

    #[test]
    fn what_slides_or_turns_otherwise_is_no_ring() {
        let symmetry = cyclic("C3");
        let pose = some(symmetry);
        let mut slid = pose;
        slid.translation += 0.01 * *direction(&pose);
        assert_eq!(symmetry.ring(&slid), None);
        assert_eq!(symmetry.ring(&Pose::identity()), None);
        assert!(difference(&symmetry.nearest(&slid), &pose) < 1e-12);
        assert_eq!(cyclic("C4").ring(&pose), None);
    }

    /// A moved ring is a ring, and the gradient is the gain of finite moves.
    #[test]
    fn conjugation_keeps_rings_and_its_gradient_is_right() {
        let symmetry = cyclic("C5");
        let (pose, center) = (some(symmetry), Vector3::new(1.0, -2.0, 3.0));
        // A score of the place that a point goes to, with its gradient by the ligand's own motion.
        let (point, pull) = (Vector3::new(2.0, 0.5, -1.0), Vector3::new(0.7, -0.2, 0.4));
        let score = |pose: &Pose| {
            let place = pose.rotation * point + pose.translation;
            pull.dot(&place) - 0.05 * place.norm_squared()
        };
        let gradient = |pose: &Pose| {
            let place = pose.rotation * point + pose.translation;
            let force = pull - 0.1 * place;
            let arm = pose.rotation * (point - center);
            PoseGradient {
                force,
                torque: arm.cross(&force),
            }
        };
        let found = conjugated_gradient(&pose, center, &gradient(&pose));
        let step = 1e-5;
        for axis in 0..3 {
            let unit = Vector3::ith(axis, step);
            let slope = |turn: Vector3<f64>, shift: Vector3<f64>| {
                let at = |sign: f64| {
                    let turn = UnitQuaternion::new(sign * turn);
                    let there = conjugated(&pose, center, turn, sign * shift);
                    assert!(symmetry.ring(&there).is_some());
                    score(&there)
                };
                (at(1.0) - at(-1.0)) / (2.0 * step)
            };
            let shifted = slope(Vector3::zeros(), unit);
            let turned = slope(unit, Vector3::zeros());
            assert!((found.force[axis] - shifted).abs() < 1e-6);
            assert!((found.torque[axis] - turned).abs() < 1e-5);
        }
    }
}
