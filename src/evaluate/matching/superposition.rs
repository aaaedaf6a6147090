//! Sums of squared distances of moved points to fixed ones as closed forms of the motion, and the best motion.
//!
//! For pairs (x_k, y_k) let A0 x + b0 be the best superposition of the x on the y. Let x' = x - mean(x). The
//! residuals e_k = A0 x_k + b0 - y_k add up to zero. For any motion A x + b, with D = A - A0 and d = A mean(x) + b -
//! mean(y),
//!
//! ```text
//! sum_k |A x_k + b - y_k|^2 = sum |e|^2 + 2 D : sum e x'^T + (D sum x' x'^T) : D + n |d|^2,
//! ```
//!
//! which costs the same for any number of points. Written about the best motion it has no cancellation: equal points
//! give zero to rounding, where sums over x and y themselves would leave the root of the rounding, 1e-6 Å.
//!
//! The best rotation is the eigenvector to the largest eigenvalue of Horn's 4 x 4 matrix (J. Opt. Soc. Am. A 4 (1987)
//! 629-642), which is a rotation for mirrored and for flat point sets too.

use knotdock_scoring::se3::Pose;
use nalgebra::{Matrix3, Matrix4, Point3, Quaternion, SymmetricEigen, UnitQuaternion, Vector3};

/// Largest backbone RMSD in Å of a side that fits the native.
pub(in crate::evaluate) const MAX_FIT_RMSD: f64 = 15.0;

/// A moving point and the fixed point that it is compared with, in Å.
pub(in crate::evaluate) type PointPair = (Point3<f64>, Point3<f64>);

/// The sum of squared distances of a set of point pairs as a function of the motion of the first points.
#[derive(Clone, Debug)]
pub(in crate::evaluate) struct Superposition {
    /// Number n of pairs.
    pub count: f64,
    /// The motion with the smallest sum of squared distances.
    pub best: Pose,
    best_rotation: Matrix3<f64>,
    moving_center: Vector3<f64>,
    fixed_center: Vector3<f64>,
    /// sum y' x'^T, in Å^2.
    covariance: Matrix3<f64>,
    /// sum x' x'^T, in Å^2.
    spread: Matrix3<f64>,
    /// sum e x'^T, in Å^2.
    residual_moment: Matrix3<f64>,
    /// sum |e|^2, in Å^2.
    residual: f64,
}

impl Superposition {
    /// The form of these pairs; without any pair it is zero for every motion.
    pub fn new(pairs: &[PointPair]) -> Self {
        let count = pairs.len() as f64;
        let shares = count.max(1.0);
        let moving_center: Vector3<f64> =
            pairs.iter().map(|(x, _)| x.coords).sum::<Vector3<f64>>() / shares;
        let fixed_center: Vector3<f64> =
            pairs.iter().map(|(_, y)| y.coords).sum::<Vector3<f64>>() / shares;
        let centered = || {
            pairs
                .iter()
                .map(|(x, y)| (x.coords - moving_center, y.coords - fixed_center))
        };
        let covariance: Matrix3<f64> = centered().map(|(x, y)| y * x.transpose()).sum();
        let spread: Matrix3<f64> = centered().map(|(x, _)| x * x.transpose()).sum();
        let rotation = best_rotation(&covariance);
        let best_rotation = *rotation.to_rotation_matrix().matrix();
        let mut residual_moment = Matrix3::zeros();
        let mut residual = 0.0;
        for (x, y) in centered() {
            let error = best_rotation * x - y;
            residual_moment += error * x.transpose();
            residual += error.norm_squared();
        }
        Self {
            count,
            best: Pose {
                rotation,
                translation: fixed_center - best_rotation * moving_center,
            },
            best_rotation,
            moving_center,
            fixed_center,
            covariance,
            spread,
            residual_moment,
            residual,
        }
    }

    /// The sum of squared distances, in Å^2, when the first points are moved so.
    pub fn at(&self, motion: &Pose) -> f64 {
        let rotation = *motion.rotation.to_rotation_matrix().matrix();
        let turn = rotation - self.best_rotation;
        let shift = rotation * self.moving_center + motion.translation - self.fixed_center;
        let sum = self.residual
            + 2.0 * turn.dot(&self.residual_moment)
            + (turn * self.spread).dot(&turn)
            + self.count * shift.norm_squared();
        sum.max(0.0)
    }

    /// The root mean square distance, in Å, when the first points are moved so.
    pub fn rmsd(&self, motion: &Pose) -> f64 {
        (self.at(motion) / self.count.max(1.0)).sqrt()
    }

    /// Best common superposition of two sets of points, and the RMSD in Å that remains.
    ///
    /// The motion brings the points of `self` as they are, and those of `other` after `pose`, as near their fixed
    /// points as a rigid motion can.
    pub fn superpose_with(&self, other: &Self, pose: &Pose) -> (Pose, f64) {
        let count = (self.count + other.count).max(1.0);
        let turned = pose.rotation.to_rotation_matrix();
        let other_center = turned * other.moving_center + pose.translation;
        let between_moving = self.moving_center - other_center;
        let between_fixed = self.fixed_center - other.fixed_center;
        let covariance = self.covariance
            + other.covariance * turned.matrix().transpose()
            + between_fixed * between_moving.transpose() * (self.count * other.count / count);
        let rotation = best_rotation(&covariance);
        let mean = |a: Vector3<f64>, b: Vector3<f64>| (a * self.count + b * other.count) / count;
        let motion = Pose {
            rotation,
            translation: mean(self.fixed_center, other.fixed_center)
                - rotation * mean(self.moving_center, other_center),
        };
        let sum = self.at(&motion) + other.at(&motion.after(pose));
        (motion, (sum / count).sqrt())
    }
}

/// The rotation R with the largest trace of R^T C, where C = sum y' x'^T: the one that turns the x' nearest the y'.
fn best_rotation(covariance: &Matrix3<f64>) -> UnitQuaternion<f64> {
    // Scaled so that neither tiny nor huge coordinates meet the limits of the eigenvalue iteration.
    let scale = covariance.amax();
    if !(scale > 0.0 && scale.is_finite()) {
        return UnitQuaternion::identity();
    }
    // Horn writes S = sum x' y'^T.
    let s = covariance.transpose() / scale;
    let (xx, xy, xz) = (s[(0, 0)], s[(0, 1)], s[(0, 2)]);
    let (yx, yy, yz) = (s[(1, 0)], s[(1, 1)], s[(1, 2)]);
    let (zx, zy, zz) = (s[(2, 0)], s[(2, 1)], s[(2, 2)]);
    #[rustfmt::skip]
    let horn = Matrix4::new(
        xx + yy + zz, yz - zy,      zx - xz,       xy - yx,
        yz - zy,      xx - yy - zz, xy + yx,       zx + xz,
        zx - xz,      xy + yx,      -xx + yy - zz, yz + zy,
        xy - yx,      zx + xz,      yz + zy,       -xx - yy + zz,
    );
    let Some(eigen) = SymmetricEigen::try_new(horn, f64::EPSILON, 1000) else {
        return UnitQuaternion::identity();
    };
    let largest = eigen.eigenvalues.imax();
    let q = eigen.eigenvectors.column(largest);
    UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn directly(pairs: &[PointPair], motion: &Pose) -> f64 {
        pairs
            .iter()
            .map(|(x, y)| (Point3::from(motion.apply((*x).into())) - y).norm_squared())
            .sum()
    }

    fn pose() -> impl Strategy<Value = Pose> {
        (
            prop::array::uniform4(-1.0..1.0f64),
            prop::array::uniform3(-50.0..50.0f64),
        )
            .prop_filter("a quaternion needs a length", |(q, _)| {
                q.iter().map(|part| part * part).sum::<f64>() > 0.01
            })
            .prop_map(|(q, t)| Pose::from_parts(q, t))
    }

    fn pairs(sizes: std::ops::Range<usize>) -> impl Strategy<Value = Vec<PointPair>> {
        let point = || prop::array::uniform3(-20.0..20.0f64).prop_map(Point3::from);
        prop::collection::vec((point(), point()), sizes)
    }

    proptest! {
        #[test]
        fn form_equals_the_direct_sum(pairs in pairs(1..30), motion in pose()) {
            let (form, sum) = (Superposition::new(&pairs).at(&motion), directly(&pairs, &motion));
            prop_assert!((form - sum).abs() <= 1e-9 * (1.0 + sum), "{form} against {sum}");
        }

        #[test]
        fn no_motion_beats_the_best(pairs in pairs(3..30), other in pose(), step in 1e-3..0.5f64) {
            let form = Superposition::new(&pairs);
            let small = Pose {
                rotation: UnitQuaternion::identity().slerp(&other.rotation, step),
                translation: other.translation * step,
            };
            let least = form.at(&form.best);
            prop_assert!(least <= form.at(&other) * (1.0 + 1e-9));
            prop_assert!(least <= form.at(&small.after(&form.best)) * (1.0 + 1e-9));
        }

        #[test]
        fn joint_superposition_is_that_of_all_points(
            a in pairs(2..20), b in pairs(2..20), pose in pose()
        ) {
            let all: Vec<_> = a.iter().copied()
                .chain(b.iter().map(|(x, y)| (Point3::from(pose.apply((*x).into())), *y)))
                .collect();
            let whole = Superposition::new(&all);
            let (motion, rmsd) = Superposition::new(&a).superpose_with(&Superposition::new(&b), &pose);
            prop_assert!((rmsd - whole.rmsd(&whole.best)).abs() < 1e-8);
            prop_assert!((rmsd - (directly(&all, &motion) / all.len() as f64).sqrt()).abs() < 1e-8);
        }
    }

    #[test]
    fn equal_points_leave_nothing_even_far_from_the_origin() {
        // Moments taken about the origin would lose all digits at 1e6 Å, and their difference would leave 1e-6 Å.
        let pairs: Vec<PointPair> = (0..50)
            .map(|k| {
                let k = f64::from(k);
                let x = Point3::new(1e6 + 9.0 * k.sin(), -1e6 + 7.0 * (2.0 * k).cos(), 0.1 * k);
                (x, x)
            })
            .collect();
        let form = Superposition::new(&pairs);
        assert!(form.rmsd(&Pose::identity()) < 1e-9);
        assert!(form.rmsd(&form.best) < 1e-9);
    }

    #[test]
    fn mirrored_and_flat_sets_get_a_rotation() {
        // Kabsch's determinant sign case: the best orthogonal map of a mirrored set is no rotation.
        let corners = [
            [1.0, 0.0, 0.0],
            [0.0, 2.0, 0.0],
            [0.0, 0.0, 3.0],
            [0.0, 0.0, 0.0],
        ];
        let mirrored: Vec<PointPair> = corners
            .iter()
            .map(|&c| (Point3::from(c), Point3::new(-c[0], c[1], c[2])))
            .collect();
        let form = Superposition::new(&mirrored);
        let rotation = form.best.rotation.to_rotation_matrix();
        assert!((rotation.matrix().determinant() - 1.0).abs() < 1e-12);
        assert!(form.rmsd(&form.best) > 0.1);
        let flat: Vec<PointPair> = corners[..2]
            .iter()
            .map(|&c| (Point3::from(c), Point3::new(c[1] + 5.0, c[0], c[2])))
            .collect();
        let form = Superposition::new(&flat);
        assert!(form.rmsd(&form.best) < 1e-7);
    }
}
