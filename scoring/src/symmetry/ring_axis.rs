//! The axis of a ring that a file holds, and the half turns about axes across it that lay two such rings face to face
//! (Dn).
//!
//! The mean of an atom's places in all copies of an exact ring is on its axis, so the axis is the line through the
//! means of all atoms. An axis across it has a direction u at a right angle to the ring's and meets it at a height h.
//! These are two degrees of freedom; moves along and about the ring's axis span them.

use super::{conjugated, direction};
use crate::rigid_move::PoseGradient;
use crate::se3::Pose;
use nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3};
use std::f64::consts::{PI, TAU};

/// Largest RMSD in Å between a copy and the first one turned about the axis. Copies in crystals differ by as much, and
/// the second ring still fits whichever of its copies faces whichever.
const SAME: f64 = 2.0;

/// The axis of a ring of copies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingAxis {
    folds: usize,
    point: Vector3<f64>,
    direction: Unit<Vector3<f64>>,
}

/// Copies that no turns about an axis take into each other.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "a copy is {off:.1} Å (RMSD) from where a turn by {degrees:.0} degrees about their axis takes the first"
)]
pub struct NotARing {
    /// RMSD of the copy that comes nearest, Å.
    pub off: f64,
    /// The turn.
    pub degrees: f64,
}

impl RingAxis {
    /// The axis of copies, each the same atoms in the same order (Å). The order of copies does not matter.
    ///
    /// # Errors
    /// [`NotARing`] where they make none.
    pub fn of(copies: &[Vec<[f64; 3]>]) -> Result<Self, NotARing> {
        let folds = copies.len();
        let atoms = copies.iter().map(Vec::len).min().unwrap_or(0);
        let mean_of = |atom: usize| {
            let sum: Vector3<f64> = copies.iter().map(|copy| Vector3::from(copy[atom])).sum();
            sum / folds as f64
        };
        let means: Vec<Vector3<f64>> = (0..atoms).map(mean_of).collect();
        let point = means.iter().sum::<Vector3<f64>>() / atoms.max(1) as f64;
        let spread = means.iter().fold(Matrix3::zeros(), |sum, mean| {
            sum + (mean - point) * (mean - point).transpose()
        });
        let eigen = spread.symmetric_eigen();
        let longest = eigen.eigenvectors.column(eigen.eigenvalues.imax());
        let axis = Self {
            folds,
            point,
            direction: Unit::new_normalize(longest.into_owned()),
        };
        axis.check(copies)?;
        Ok(axis)
    }

    /// Each turn must take the first copy to another one.
    fn check(&self, copies: &[Vec<[f64; 3]>]) -> Result<(), NotARing> {
        let mut left: Vec<&Vec<[f64; 3]>> = copies.iter().skip(1).collect();
        for turn in self.turns() {
            let off = |copy: &[[f64; 3]]| {
                let pairs = copies[0].iter().zip(copy);
                let squares = pairs.map(|(&from, &to)| {
                    (Vector3::from(turn.apply(from)) - Vector3::from(to)).norm_squared()
                });
                (squares.sum::<f64>() / copy.len().max(1) as f64).sqrt()
            };
            let nearest = (0..left.len())
                .map(|place| (place, off(left[place])))
                .min_by(|(_, a), (_, b)| a.total_cmp(b));
            match nearest {
                Some((place, off)) if off <= SAME => drop(left.swap_remove(place)),
                found => {
                    let degrees = turn.rotation.angle().to_degrees();
                    let off = found.map_or(f64::INFINITY, |(_, off)| off);
                    return Err(NotARing { off, degrees });
                }
            }
        }
        Ok(())
    }

    /// The turns that take the ring onto itself, the least first.
    pub fn turns(&self) -> impl Iterator<Item = Pose> + use<> {
        let Self {
            folds,
            point,
            direction,
        } = *self;
        (1..folds).map(move |fold| {
            let angle = TAU * fold as f64 / folds as f64;
            let rotation = UnitQuaternion::from_axis_angle(&direction, angle);
            Pose::about(rotation, point, point)
        })
    }

    /// Directions of `count` axes across the ring's, evenly over pi / n radians: the others lay the same two rings
    /// together, their copies counted from another one.
    pub fn across(&self, count: usize) -> Vec<Unit<Vector3<f64>>> {
        let axis = self.direction;
        let first = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
        let second = axis.cross(&first);
        let direction = |index: usize| {
            let angle = (index as f64 + 0.5) / count as f64 * PI / self.folds as f64;
            Unit::new_normalize(angle.cos() * first + angle.sin() * second)
        };
        (0..count).map(direction).collect()
    }

    /// Half the angle in radians between two of as many directions.
    pub fn half_step(&self, count: usize) -> f64 {
        0.5 * PI / self.folds as f64 / count as f64
    }

    /// Half a turn about the axis of a direction across that meets the ring's at a height (Å).
    fn half_turn(&self, across: &Unit<Vector3<f64>>, height: f64) -> Pose {
        let point = self.point + height * *self.direction;
        let rotation = UnitQuaternion::from_axis_angle(across, PI);
        Pose::about(rotation, point, point)
    }

    /// The half turn about an axis across the ring's that is nearest to a pose of about half a turn.
    pub fn nearest(&self, pose: &Pose) -> Pose {
        let about = direction(pose);
        let across = Unit::new_normalize(*about - about.dot(&self.direction) * *self.direction);
        let level = self.half_turn(&across, 0.0);
        // The second ring's height is twice that of the axis.
        let height = 0.5 * self.direction.dot(&(pose.translation - level.translation));
        self.half_turn(&across, height)
    }

    /// The direction across both the ring's axis and that of a half turn, and how far along it (Å) the half turn shifts
    /// a point at the origin.
    pub fn sideways(&self, rotation: &UnitQuaternion<f64>) -> (Unit<Vector3<f64>>, f64) {
        let across = Unit::new_normalize(rotation.imag());
        let sideways = Unit::new_normalize(self.direction.cross(&across));
        let level = self.half_turn(&across, 0.0);
        (sideways, sideways.dot(&level.translation))
    }

    /// The pose that a half turn becomes when the molecule is turned about the ring's axis and shifted along it, by as
    /// much as a move has of either.
    pub fn moved(&self, pose: &Pose, turn: UnitQuaternion<f64>, shift: Vector3<f64>) -> Pose {
        let [turned, shifted] = [turn.scaled_axis(), shift].map(|of| self.direction.dot(&of));
        let turn = UnitQuaternion::from_axis_angle(&self.direction, turned);
        conjugated(pose, self.point, turn, shifted * *self.direction)
    }

    /// The part of a gradient by moves of the molecule that [`Self::moved`] gains; turns are about `center`.
    pub fn along(&self, center: Vector3<f64>, gradient: &PoseGradient) -> PoseGradient {
        let axis = *self.direction;
        let torque = gradient.torque + (center - self.point).cross(&gradient.force);
        PoseGradient {
            force: axis * axis.dot(&gradient.force),
            torque: axis * axis.dot(&torque),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::Numbers;

    type Copies = Vec<Vec<[f64; 3]>>;

    /// Copies of a cloud about an axis somewhere, in no order, and a point and the direction of that axis.
    fn ring(folds: usize, at: f64) -> (Copies, Vector3<f64>, Unit<Vector3<f64>>) {
        let mut numbers = Numbers(11);
        let point = Vector3::new(at, -0.7 * at, 3.0);
        let axis = Unit::new_normalize(Vector3::new(0.4, -0.2, 0.7));
        let out = 20.0 * axis.cross(&Vector3::x()).normalize();
        let mut place = || 12.0 * Vector3::from_fn(|_, _| numbers.next() - 0.5) + point + out;
        let cloud: Vec<Vector3<f64>> = (0..40).map(|_| place()).collect();
        let copy = |fold: usize| {
            let angle = TAU * ((7 * fold) % folds) as f64 / folds as f64;
            let turn = Pose::about(UnitQuaternion::from_axis_angle(&axis, angle), point, point);
            cloud.iter().map(|&x| turn.apply(x.into())).collect()
        };
        ((0..folds).map(copy).collect(), point, axis)
    }

    fn difference(a: &Pose, b: &Pose) -> f64 {
        a.angle_to(b) + (a.translation - b.translation).norm()
    }

    /// A half turn about an axis across, somewhere along the ring's.
    fn some(axis: &RingAxis) -> Pose {
        axis.half_turn(&axis.across(7)[3], 8.5)
    }

    #[test]
    fn the_axis_of_a_ring_is_found_wherever_it_lies() {
        for folds in [2, 3, 4, 12] {
            for at in [0.0, 1e4] {
                let (copies, point, direction) = ring(folds, at);
                let axis = RingAxis::of(&copies).unwrap();
                assert!(axis.direction.cross(&direction).norm() < 1e-9);
                assert!((axis.point - point).cross(&direction).norm() < 1e-7);
                // Its turns are those that take copies to copies.
                let turns: Vec<Pose> = axis.turns().collect();
                assert_eq!(turns.len(), folds - 1);
                let first = turns[0].apply(copies[0][0]);
                assert!(
                    copies.iter().any(|copy| {
                        (Vector3::from(copy[0]) - Vector3::from(first)).norm() < 1e-7
                    })
                );
            }
        }
    }

    #[test]
    fn copies_that_make_no_ring_are_refused() {
        let (copies, ..) = ring(4, 0.0);
        // Two across the ring make one of two, three of the four none of three.
        let two = |other: usize| RingAxis::of(&[copies[0].clone(), copies[other].clone()]);
        assert!(two(2).is_ok());
        let error = two(1).unwrap_err();
        assert!(error.off > SAME && (error.degrees - 180.0).abs() < 1e-9);
        assert!(RingAxis::of(&copies[..3]).is_err());
        let mut bent = copies.clone();
        for place in &mut bent[3] {
            place[0] += 1.0;
        }
        assert!(RingAxis::of(&bent).is_ok(), "crystals differ by less");
        for place in &mut bent[3] {
            place[0] += 9.0;
        }
        assert!(RingAxis::of(&bent).is_err());
    }

    /// Dn: a half turn across undoes itself and turns the ring's own turns about, and the ring's turns take it to those
    /// about other axes across.
    #[test]
    fn half_turns_across_make_dihedral_groups() {
        for folds in [2, 3, 5] {
            let (copies, ..) = ring(folds, 50.0);
            let axis = RingAxis::of(&copies).unwrap();
            for across in axis.across(9) {
                assert!(across.dot(&axis.direction).abs() < 1e-12);
            }
            let half = some(&axis);
            assert!(difference(&half.after(&half), &Pose::identity()) < 1e-10);
            for turn in axis.turns() {
                let other = half.after(&turn);
                assert!(difference(&other.after(&other), &Pose::identity()) < 1e-10);
                assert!(difference(&axis.nearest(&other), &other) < 1e-10);
            }
        }
    }

    #[test]
    fn the_nearest_half_turn_keeps_angle_and_height() {
        let axis = RingAxis::of(&ring(3, -30.0).0).unwrap();
        let half = some(&axis);
        let (sideways, shift) = axis.sideways(&half.rotation);
        assert!((sideways.dot(&half.translation) - shift).abs() < 1e-10);
        let mut off = half;
        off.translation += 0.7 * *sideways + 0.4 * *direction(&half);
        assert!(difference(&axis.nearest(&off), &half) < 1e-10);
        off.translation += 0.6 * *axis.direction;
        let higher = axis.half_turn(&direction(&half), 8.5 + 0.3);
        assert!(difference(&axis.nearest(&off), &higher) < 1e-10);
    }

    /// Moves leave a half turn across the axis, and the gradient is their gain.
    #[test]
    fn moves_stay_across_and_the_gradient_is_theirs() {
        let axis = RingAxis::of(&ring(3, 20.0).0).unwrap();
        let (half, center) = (some(&axis), Vector3::new(1.0, -2.0, 3.0));
        let (point, pull) = (Vector3::new(9.0, 0.5, -1.0), Vector3::new(0.7, -0.2, 0.4));
        let place = |pose: &Pose| pose.rotation * point + pose.translation;
        let score = |pose: &Pose| pull.dot(&place(pose)) - 0.05 * place(pose).norm_squared();
        let force = pull - 0.1 * place(&half);
        let own = PoseGradient {
            force,
            torque: (half.rotation * (point - center)).cross(&force),
        };
        let gradient = axis.along(
            center,
            &super::super::conjugated_gradient(&half, center, &own),
        );
        let step = 1e-5;
        for unit in (0..3).map(|index| Vector3::ith(index, step)) {
            let slope = |turn: Vector3<f64>, shift: Vector3<f64>| {
                let at = |sign: f64| {
                    let moved = axis.moved(&half, UnitQuaternion::new(sign * turn), sign * shift);
                    assert!(difference(&axis.nearest(&moved), &moved) < 1e-9);
                    score(&moved)
                };
                (at(1.0) - at(-1.0)) / (2.0 * step)
            };
            let unit_of = |slope: Vector3<f64>| slope.dot(&unit) / step;
            let shifted = slope(Vector3::zeros(), unit);
            let turned = slope(unit, Vector3::zeros());
            assert!((unit_of(gradient.force) - shifted).abs() < 1e-6);
            assert!((unit_of(gradient.torque) - turned).abs() < 1e-4);
        }
    }
}
