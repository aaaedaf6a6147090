//! Rotation sets: near-uniform, of any size, closed under the turns of a grid, the same on every machine.
//!
//! [`rotation_set`] starts from a super-Fibonacci spiral (Alexa, CVPR 2022) and relaxes it. [`covering_radius`]
//! measures how far from its nearest rotation of a set a rotation can lie. Rotations are unit quaternions, angles
//! radians.

mod covering;
mod relaxation;
mod spiral;

pub use covering::covering_radius;

use crate::grid_turn::GridTurn;
use nalgebra::{Quaternion, UnitQuaternion};
use relaxation::relax;
use spiral::{Point, domain};

/// Rotations that share a transform of the ligand at the most.
const IMAGES: usize = GridTurn::ALL.len();

/// `count` rotations, closed under the eight turns of [`GridTurn`].
///
/// Rotation 8 i + f is turn f of [`GridTurn::ALL`] after rotation 8 i, so that one transform of the ligand serves eight
/// rotations, or four where the grid has no quarter turns. Where `count` is no multiple of eight the last images are
/// left out.
///
/// The spiral's rotations within one domain of the turns, about the identity, are taken. Up to [`MAX_RELAXED`] rotations, they and their images are relaxed like charges that repel each other. This evens out the
/// domain's edges: the nearest rotation of the set is closer, on average, than in the spiral itself.
pub fn rotation_set(count: usize) -> Vec<UnitQuaternion<f64>> {
    if count > MAX_RELAXED {
        return spiral_set(count);
    }
    let mut base = domain(count.div_ceil(IMAGES));
    base.truncate(count.div_ceil(IMAGES));
    relax(&mut base);
    with_images(&base, count)
}

/// `count` rotations as of [`rotation_set`], but never relaxed: quickly made, less even at the edges of the domain.
pub fn spiral_set(count: usize) -> Vec<UnitQuaternion<f64>> {
    let (points, wanted) = (domain(count.div_ceil(IMAGES)), count.div_ceil(IMAGES));
    // Thinned evenly: without its last points a spiral has a hole.
    let kept: Vec<Point> = (0..wanted)
        .map(|index| points[index * points.len() / wanted])
        .collect();
    with_images(&kept, count)
}

/// Each rotation followed by its images, `count` in all.
fn with_images(base: &[Point], count: usize) -> Vec<UnitQuaternion<f64>> {
    base.iter()
        .flat_map(|&point| {
            let rotation = UnitQuaternion::from_quaternion(Quaternion::from(
                nalgebra::Vector4::new(point[1], point[2], point[3], point[0]),
            ));
            GridTurn::ALL.map(|turn| turn.after(&rotation))
        })
        .take(count)
        .collect()
}

/// Largest set that is relaxed. Beyond it the spiral is fine enough, and no measurement shows a gain.
pub const MAX_RELAXED: usize = 100_000;

/// Bytes of memory that relaxing takes per rotation (points and images, sorted by cell).
pub const BYTES_RELAXED: u64 = 250;

/// Name of the set of `count` rotations.
pub fn set_name(count: usize) -> &'static str {
    if count <= MAX_RELAXED {
        "super-Fibonacci (Alexa 2022), closed under the grid's turns, relaxed"
    } else {
        "super-Fibonacci (Alexa 2022), closed under the grid's turns"
    }
}

#[cfg(test)]
mod tests {
    use super::spiral::rotation;
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn covers_as_evenly_as_the_field_expects() {
        for count in [60, 500, 3600] {
            let set = rotation_set(count);
            let radius = covering_radius(&set);
            // A ball of angle a is the share (a - sin a) / pi of SO(3). No covering radius is below that of share 1 /
            // n.
            let mut least = 0.0f64;
            while (least - least.sin()) / PI < 1.0 / count as f64 {
                least += 1e-4;
            }
            assert!(
                radius > least && radius < 2.2 * least,
                "{count}: {radius} {least}"
            );
        }
    }

    #[test]
    fn turns_map_the_set_onto_itself_and_it_has_the_requested_size() {
        for count in [1, 2, 3, 5, 60, 1201] {
            let set = rotation_set(count);
            assert_eq!(set.len(), count);
            for (index, q) in set.iter().enumerate() {
                assert_eq!(*q, GridTurn::ALL[index % 8].after(&set[index - index % 8]));
                assert!((q.norm() - 1.0).abs() < 1e-12);
            }
        }
    }

    /// A spiral with too many points is thinned evenly, so that no removed point leaves a hole.
    #[test]
    fn spirals_have_no_hole() {
        let mut with_too_many = 0;
        for wanted in (4000..4040).chain([25_003, 25_100]) {
            let points = domain(wanted);
            with_too_many += usize::from(points.len() > wanted);
            let kept: Vec<Point> = spiral_set(8 * wanted)
                .iter()
                .step_by(8)
                .map(|q| [q.w, q.i, q.j, q.k])
                .collect();
            let spacing = (2.0 * PI * PI / (16.0 * wanted as f64)).cbrt();
            let last = points.iter().rev().take(points.len() - wanted);
            for point in last {
                let nearest = kept.iter().map(|other| {
                    let square = |i: usize| (point[i] - other[i]).powi(2);
                    (0..4).map(square).sum::<f64>()
                });
                assert!(
                    nearest.fold(9.0, f64::min).sqrt() < 2.0 * spacing,
                    "{wanted}"
                );
            }
        }
        assert!(with_too_many > 3);
    }

    /// The purpose of the relaxation: a random rotation's nearest neighbour is no farther than in the plain spiral, on
    /// average and at worst.
    #[test]
    fn relaxed_set_covers_no_worse_than_the_spiral() {
        let relaxed = rotation_set(1200);
        let spiral: Vec<_> = (0..1200).map(|i| rotation(i, 1200)).collect();
        let probes: Vec<_> = (0..5000).map(|i| rotation(i, 5000)).collect();
        let angles = |set: &[UnitQuaternion<f64>]| -> (f64, f64) {
            let nearest = probes.iter().map(|probe| {
                let angle = set.iter().map(|q| q.angle_to(probe));
                angle.fold(f64::INFINITY, f64::min)
            });
            nearest.fold((0.0, 0.0), |(sum, worst), angle| {
                (sum + angle / 5000.0, f64::max(worst, angle))
            })
        };
        let ((mean, worst), (spiral_mean, spiral_worst)) = (angles(&relaxed), angles(&spiral));
        assert!(mean < spiral_mean, "{mean} {spiral_mean}");
        assert!(worst < 1.02 * spiral_worst, "{worst} {spiral_worst}");
    }

    /// Uniform over SO(3): the mean of the rotation matrices vanishes.
    #[test]
    fn mean_rotation_vanishes() {
        let set = rotation_set(3600);
        let sum = set.iter().fold(nalgebra::Matrix3::zeros(), |sum, q| {
            sum + q.to_rotation_matrix().matrix()
        });
        assert!((sum / 3600.0).norm() < 0.02);
    }
}
