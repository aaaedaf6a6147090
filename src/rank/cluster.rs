//! Clusters of poses by the ligand's RMSD, in closed form.
//!
//! For two rigid poses of one body the mean square distance of its points is |c1 - c2|^2 + 2 (tr C - tr(R1 C R2')).
//! Here c1 and c2 are the images of the points' mean, and C is their covariance. The cost is O(1) for a pair of
//! poses.

use crate::pose_space::Equivalents;
use knotdock_scoring::se3::Pose;
use nalgebra::{Matrix3, Vector3};

/// The body whose RMSD is taken: mean and covariance of its points in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidBody {
    mean: Vector3<f64>,
    covariance: Matrix3<f64>,
    /// The equivalents of a pose.
    equivalents: Equivalents,
}

/// A placed body, prepared for its distances to others.
#[derive(Clone, Copy, Debug)]
pub struct PlacedBody {
    center: Vector3<f64>,
    rotation: Matrix3<f64>,
    /// R C.
    turned: Matrix3<f64>,
}

impl RigidBody {
    /// The body of some points (Å); without any it is a single point at the origin.
    pub fn new(points: &[[f64; 3]]) -> Self {
        let count = points.len().max(1) as f64;
        let points = points.iter().map(|&point| Vector3::from(point));
        let mean = points.clone().sum::<Vector3<f64>>() / count;
        let squares = points.map(|point| (point - mean) * (point - mean).transpose());
        let covariance = squares.sum::<Matrix3<f64>>() / count;
        Self {
            mean,
            covariance,
            equivalents: Equivalents::None,
        }
    }

    /// The body in a space in which poses have equivalents.
    pub(crate) fn with_equivalents(self, equivalents: Equivalents) -> Self {
        Self {
            equivalents,
            ..self
        }
    }

    /// The body at a pose and its equivalents, itself first.
    fn images(&self, pose: &Pose) -> Vec<PlacedBody> {
        let poses = self.equivalents.of(pose);
        poses.map(|pose| self.place(&pose)).collect()
    }

    /// The first of some placed bodies within `distance` (Å RMSD) of a pose or of its equivalents.
    pub fn first_within(&self, placed: &[PlacedBody], pose: &Pose, distance: f64) -> Option<usize> {
        let images = self.images(pose);
        placed.iter().position(|other| {
            let within = |image| self.mean_square(other, image) <= distance * distance;
            images.iter().any(within)
        })
    }

    /// RMSD in Å of a pose, or of the nearest of its equivalents, from a placed body.
    pub fn rmsd(&self, placed: &PlacedBody, pose: &Pose) -> f64 {
        let images = self.images(pose).into_iter();
        let squares = images.map(|image| self.mean_square(placed, &image));
        squares.fold(f64::INFINITY, f64::min).sqrt()
    }

    /// RMSD in Å between two poses that differ by `shift` (Å) and by a rotation of `angle` (radians) about the body's
    /// middle: root of the mean square over axes.
    ///
    /// About a unit axis n the rotation moves the points by 2 (1 - cos angle) (tr C - n' C n) in mean square. The
    /// mean of n' C n over axes is a third of tr C.
    pub fn step(&self, shift: f64, angle: f64) -> f64 {
        let turned = 4.0 / 3.0 * (1.0 - angle.cos()) * self.covariance.trace();
        (shift * shift + turned).sqrt()
    }

    /// Radius of gyration, Å.
    pub fn gyration(&self) -> f64 {
        self.covariance.trace().sqrt()
    }

    /// Places the body.
    pub fn place(&self, pose: &Pose) -> PlacedBody {
        let rotation = *pose.rotation.to_rotation_matrix().matrix();
        PlacedBody {
            center: rotation * self.mean + pose.translation,
            rotation,
            turned: rotation * self.covariance,
        }
    }

    /// Mean square distance in Å^2 of the body's points between two poses.
    pub fn mean_square(&self, a: &PlacedBody, b: &PlacedBody) -> f64 {
        let between = (a.center - b.center).norm_squared();
        // Rounding may leave a hair below zero for equal rotations.
        (between + 2.0 * (self.covariance.trace() - a.turned.component_mul(&b.rotation).sum()))
            .max(0.0)
    }
}

/// Greedy clusters of poses given best first: each pose joins the first cluster whose best pose is within `radius`
/// (Å RMSD), or becomes the centre of a new one. Returns each pose's cluster, numbered from 0 in that order.
pub fn greedy(body: &RigidBody, poses: &[Pose], radius: f64) -> Vec<usize> {
    let mut centres: Vec<PlacedBody> = Vec::new();
    let cluster = |pose: &Pose| {
        let near = body.first_within(&centres, pose, radius);
        near.unwrap_or_else(|| {
            centres.push(body.place(pose));
            centres.len() - 1
        })
    };
    poses.iter().map(cluster).collect()
}

/// Figures of a cluster: of the scores of its poses, and of their distances from its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClusterFigures {
    /// Number of poses.
    pub size: usize,
    /// Best score: that of the centre.
    pub best: f64,
    /// Mean score.
    pub mean: f64,
    /// Standard deviation of the scores about their mean.
    pub deviation: f64,
    /// Mean and largest RMSD of the other poses from the centre, Å; `None` if there are none.
    pub rmsd: Option<[f64; 2]>,
}

/// The figures of [`greedy`] clusters, in an order of them. `scored` gives each pose and its score, which falls from pose to
/// pose: nothing is copied, for there may be many.
pub fn figures(
    body: &RigidBody,
    scored: impl Fn(usize) -> (Pose, f64),
    clusters: &[usize],
    order: &[usize],
) -> Vec<ClusterFigures> {
    let mut places: Vec<usize> = (0..clusters.len()).collect();
    places.sort_by_key(|&place| clusters[place]);
    let members = places.chunk_by(|&a, &b| clusters[a] == clusters[b]);
    let members: Vec<&[usize]> = members.collect();
    let of_cluster = |&cluster: &usize| {
        let members = members[cluster];
        let count = members.len() as f64;
        let (centre, best) = scored(members[0]);
        let centre = body.place(&centre);
        let scores = || members.iter().map(|&place| scored(place).1);
        let mean = scores().sum::<f64>() / count;
        let square = scores().map(|score| (score - mean).powi(2)).sum::<f64>() / count;
        let others = members[1..].iter();
        let rmsds = others.map(|&place| body.rmsd(&centre, &scored(place).0));
        let (sum, largest) = rmsds.fold((0.0, 0.0), |(sum, largest): (f64, f64), rmsd| {
            (sum + rmsd, largest.max(rmsd))
        });
        ClusterFigures {
            size: members.len(),
            best,
            mean,
            deviation: square.sqrt(),
            rmsd: (members.len() > 1).then(|| [sum / (count - 1.0), largest]),
        }
    };
    order.iter().map(of_cluster).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_scoring::symmetry::RingAxis;

    #[test]
    fn closed_form_is_the_rmsd_of_the_points() {
        let points = [
            [1.0, 2.0, 3.0],
            [-4.0, 0.5, 2.0],
            [7.0, -1.0, 0.0],
            [0.0, 3.0, -5.0],
        ];
        let body = RigidBody::new(&points);
        let a = Pose::from_parts([0.9, 0.1, -0.3, 0.2], [5.0, 6.0, -7.0]);
        let b = Pose::from_parts([-0.2, 0.7, 0.3, 0.4], [4.0, -6.0, 1.0]);
        let direct = points
            .iter()
            .map(|&p| (Vector3::from(a.apply(p)) - Vector3::from(b.apply(p))).norm_squared())
            .sum::<f64>()
            / 4.0;
        assert!((body.mean_square(&body.place(&a), &body.place(&b)) - direct).abs() < 1e-10);
        assert!(body.mean_square(&body.place(&a), &body.place(&a)) < 1e-10);
    }

    /// A third of a turn back is the same ring as a third forward, and only where rings are requested.
    #[test]
    fn rings_are_one_with_their_inverses() {
        let body = RigidBody::new(&[[9.0, 0.0, 0.0], [10.0, 3.0, 0.0], [9.0, 1.0, 5.0]]);
        let half = std::f64::consts::FRAC_PI_3;
        let forward = Pose::from_parts([half.cos(), 0.0, 0.0, half.sin()], [0.0; 3]);
        let poses = [forward, forward.inverse()];
        assert_eq!(greedy(&body, &poses, 5.0), [0, 1]);
        assert_eq!(
            greedy(
                &body.clone().with_equivalents(Equivalents::Inverse),
                &poses,
                5.0
            ),
            [0, 0]
        );
        let body = body.with_equivalents(Equivalents::Inverse);
        assert!(body.rmsd(&body.place(&poses[0]), &poses[1]) < 1e-6);
    }

    /// A second ring is the same whichever of its copies is called the first.
    #[test]
    fn second_rings_are_one_with_their_turns() {
        let copy = vec![[9.0, 0.0, 0.0], [10.0, 3.0, 0.0], [9.0, 1.0, 5.0]];
        let other = copy
            .iter()
            .map(|&[x, y, z]: &[f64; 3]| [-x, -y, z])
            .collect();
        let copies = [copy, other];
        let axis = RingAxis::of(&copies).unwrap();
        let body = RigidBody::new(&copies.concat());
        let pose = Pose::from_parts([0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 12.0]);
        let turned = pose.after(&axis.turns().next().unwrap());
        assert_eq!(greedy(&body, &[pose, turned], 5.0), [0, 1]);
        let body = body.with_equivalents(Equivalents::Rotated(axis.turns().collect()));
        assert_eq!(greedy(&body, &[pose, turned], 5.0), [0, 0]);
    }

    /// Turns about the three axes of a frame have the mean over all axes, since n' C n is quadratic in n.
    #[test]
    fn a_step_is_the_rmsd_of_a_turn_and_a_shift() {
        let body = RigidBody::new(&[[9.0, 1.0, 0.0], [10.0, -3.0, 2.0], [-4.0, 1.0, 5.0]]);
        let place = |pose: &Pose| body.place(pose);
        let (angle, shift) = (0.7f64, 1.3);
        let squares = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| {
            let turn = nalgebra::UnitQuaternion::new(angle * axis);
            let middle = body.mean + shift * axis;
            let moved = Pose::about(turn, body.mean, middle);
            body.mean_square(&place(&Pose::identity()), &place(&moved))
        });
        let expected = (squares.iter().sum::<f64>() / 3.0).sqrt();
        assert!((body.step(shift, angle) - expected).abs() < 1e-12);
    }

    #[test]
    fn greedy_takes_the_best_as_centre() {
        let body = RigidBody::new(&[[0.0; 3], [1.0, 0.0, 0.0]]);
        let at = |x: f64| Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
        let poses = [0.0, 8.0, 4.0, 6.0, 20.0].map(at);
        let clusters = greedy(&body, &poses, 5.0);
        assert_eq!(clusters, [0, 1, 0, 1, 2]);
        let scored: Vec<_> = poses.into_iter().zip([9.0, 8.0, 5.0, 4.0, 1.0]).collect();
        let figures = figures(&body, |place| scored[place], &clusters, &[0, 1, 2]);
        assert_eq!(figures.len(), 3);
        let expected = ClusterFigures {
            size: 2,
            best: 9.0,
            mean: 7.0,
            deviation: 2.0,
            rmsd: Some([4.0, 4.0]),
        };
        assert_eq!(figures[0], expected);
        assert_eq!(
            (figures[1].deviation, figures[1].rmsd),
            (2.0, Some([2.0; 2]))
        );
        assert_eq!((figures[2].deviation, figures[2].rmsd), (0.0, None));
    }
}
