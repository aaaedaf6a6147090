//! The recorded path: ten seconds of a bunny moved about another at a thousand poses a second.
//!
//! It comes from a closed formula, so that every run and every program sees the same poses. About a third of the bunny's
//! are in contact; in one of twelve the bunnies share more than a tenth of their volume.

use knotdock_scoring::se3::Pose;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Poses of the path.
pub const POSES: usize = 10_000;

/// The path of a body about another, from the middles of both and the longest edge of the standing one.
pub fn path(middles: [Vector3<f64>; 2], edge: f64, poses: usize) -> Vec<Pose> {
    (0..poses)
        .map(|index| pose(middles, edge, index as f64 / 1000.0))
        .collect()
}

/// The pose at a time in seconds: the body tumbles while its middle comes and goes.
fn pose([standing, moving]: [Vector3<f64>; 2], edge: f64, t: f64) -> Pose {
    let axis = on_sphere(0.9 * t, 0.37 * t);
    let (sin, cos) = (0.765 * t).sin_cos();
    let quaternion = Quaternion::new(cos, sin * axis.x, sin * axis.y, sin * axis.z);
    let rotation = UnitQuaternion::from_quaternion(quaternion);
    let plunge = (0.8 * t).sin().max(0.0).powi(12);
    let reach = 0.94 + 0.24 * (4.2 * t).sin() - 0.66 * plunge;
    let translation = standing + reach * edge * on_sphere(0.7 * t, 1.3 * t) - rotation * moving;
    Pose {
        rotation,
        translation,
    }
}

fn on_sphere(latitude: f64, longitude: f64) -> Vector3<f64> {
    let (up, out) = latitude.sin_cos();
    Vector3::new(out * longitude.cos(), up, out * longitude.sin())
}

/// The path as CSV, as `knotdock collide --poses` reads it.
pub fn csv(path: &[Pose]) -> String {
    let mut text = "qw,qx,qy,qz,tx,ty,tz\n".to_owned();
    for pose in path {
        let q = pose.rotation.quaternion();
        let t = pose.translation;
        let row = [q.w, q.i, q.j, q.k, t.x, t.y, t.z].map(|number| number.to_string());
        text += &row.join(",");
        text.push('\n');
    }
    text
}
