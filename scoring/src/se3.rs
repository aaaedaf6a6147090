//! Poses: rigid motions of the ligand.
//!
//! A pose is a unit quaternion q and a translation t in Å: a ligand atom at x in its own file goes to R(q) x + t in the
//! receptor's file frame. Quaternions are Hamilton's, active and right-handed, written (w, x, y, z) with w >= 0.

use nalgebra::{Point3, Quaternion, UnitQuaternion, Vector3};

/// A rigid motion x -> R(q) x + t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The rotation R(q).
    pub rotation: UnitQuaternion<f64>,
    /// The translation t, in Å.
    pub translation: Vector3<f64>,
}

impl Pose {
    /// The motion that moves nothing.
    pub fn identity() -> Self {
        Self {
            rotation: UnitQuaternion::identity(),
            translation: Vector3::zeros(),
        }
    }

    /// A pose from quaternion (w, x, y, z), normalised here, and translation in Å.
    ///
    /// A quaternion that is normalised but for rounding is not changed, so that a pose that is read from a file is the one
    /// that was written.
    pub fn from_parts(quaternion: [f64; 4], translation: [f64; 3]) -> Self {
        let [w, x, y, z] = quaternion;
        let quaternion = Quaternion::new(w, x, y, z);
        let is_unit = (quaternion.norm_squared() - 1.0).abs() <= 8.0 * f64::EPSILON;
        Self {
            rotation: if is_unit {
                UnitQuaternion::new_unchecked(quaternion)
            } else {
                UnitQuaternion::from_quaternion(quaternion)
            },
            translation: Vector3::from(translation),
        }
    }

    /// Quaternion (w, x, y, z) of the two that stand for this rotation the one with w >= 0 (first nonzero component
    /// positive where w = 0).
    pub fn quaternion(&self) -> [f64; 4] {
        let q = self.rotation.quaternion();
        let parts = [q.w, q.i, q.j, q.k];
        let first = parts.into_iter().find(|&part| part != 0.0).unwrap_or(1.0);
        if first < 0.0 {
            parts.map(|part| 0.0 - part)
        } else {
            parts.map(|part| part + 0.0)
        }
    }

    /// The pose that turns the ligand about its centre `ligand_center` and puts that centre at `place`, in Å.
    pub fn about(
        rotation: UnitQuaternion<f64>,
        ligand_center: Vector3<f64>,
        place: Vector3<f64>,
    ) -> Self {
        Self {
            rotation,
            translation: place - rotation * ligand_center,
        }
    }

    /// The image of a point, in Å.
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        (self.rotation * Point3::from(point) + self.translation)
            .coords
            .into()
    }

    /// This motion after `first`: x -> self(first(x)).
    pub fn after(&self, first: &Pose) -> Pose {
        Pose {
            rotation: self.rotation * first.rotation,
            translation: self.rotation * first.translation + self.translation,
        }
    }

    /// The motion that undoes this one.
    pub fn inverse(&self) -> Pose {
        let rotation = self.rotation.inverse();
        Pose {
            rotation,
            translation: -(rotation * self.translation),
        }
    }

    /// Angle in radians, 0 to pi, of the rotation from `other` to this one.
    pub fn angle_to(&self, other: &Pose) -> f64 {
        self.rotation.angle_to(&other.rotation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_and_composition_undo_each_other() {
        let pose = Pose::from_parts([0.1, -0.5, 0.7, 0.2], [3.0, -4.0, 1e3]);
        let point = [1.0, 2.0, 3.0];
        let back = pose.inverse().after(&pose).apply(point);
        for axis in 0..3 {
            assert!((back[axis] - point[axis]).abs() < 1e-12);
        }
    }

    #[test]
    fn quarter_turn_about_z_is_right_handed() {
        let half = std::f64::consts::FRAC_PI_4;
        let pose = Pose::from_parts([half.cos(), 0.0, 0.0, half.sin()], [0.0; 3]);
        let image = pose.apply([1.0, 0.0, 0.0]);
        assert!(
            (image[1] - 1.0).abs() < 1e-15,
            "x must go to y, went to {image:?}"
        );
    }

    /// Written and read, a pose is the same to the last bit, wherever it came from.
    #[test]
    fn parts_of_a_pose_give_it_back() {
        let mut numbers = crate::test_support::Numbers(3);
        for _ in 0..10_000 {
            let parts: [f64; 4] = std::array::from_fn(|_| numbers.next() - 0.5);
            let first = Pose::from_parts(parts, [0.0; 3]);
            let turned = first.after(&first);
            for pose in [first, Pose::from_parts(turned.quaternion(), [0.0; 3])] {
                let again = Pose::from_parts(pose.quaternion(), [0.0; 3]);
                assert_eq!(again.quaternion(), pose.quaternion());
            }
        }
    }

    #[test]
    fn quaternion_has_w_not_negative() {
        let pose = Pose::from_parts([-0.5, 0.5, -0.5, 0.5], [0.0; 3]);
        assert_eq!(pose.quaternion(), [0.5, -0.5, 0.5, -0.5]);
    }
}
