//! The score's gradient over the six degrees of freedom of a pose.

use super::tables::Line;
use super::{ExactScorer, PoseGradient};
use crate::blocks::{LANES, NearPoints};
use crate::se3::Pose;
use crate::vectorized::with_simd;
use nalgebra::Vector3;
use pulp::Simd;

impl ExactScorer {
    /// Score of one pose and its gradient over translation (Å) and rotation (radians) about the ligand's centre.
    pub fn gradient(&self, pose: &Pose) -> (f64, PoseGradient) {
        let scorer = self;
        with_simd!(
            <'a>(scorer: &'a ExactScorer, pose: &'a Pose) -> (f64, PoseGradient),
            |simd| scorer.gradient_with(simd, pose)
        )
    }

    #[inline(always)]
    fn gradient_with<S: Simd>(&self, simd: S, pose: &Pose) -> (f64, PoseGradient) {
        let (rotation, center) = self.placed(pose);
        let mut score = 0.0;
        let mut gradient = PoseGradient::default();
        let mut near = NearPoints::default();
        for (index, knot) in self.ligand.iter().enumerate() {
            let arm = rotation * knot.position;
            let x: [f64; 3] = (arm + center).into();
            let starts = &self.tables.starts[knot.class];
            let mut value = 0.0;
            let mut force = [0.0; 3];
            self.receptor.near(
                simd,
                &x,
                self.kernel.reach(),
                &mut near,
                #[inline(always)]
                |near| {
                    for (squares, knots) in near.eights() {
                        let places = self.tables.place(simd, squares);
                        for lane in 0..LANES {
                            let (panel, u) = (places.panel(lane), places.first(lane));
                            let Some(other) = self.knots.get(knots[lane] as usize) else {
                                debug_assert!(false, "a knot that is not there is near");
                                continue;
                            };
                            let start = starts.get(other.class as usize).copied();
                            debug_assert!(start.is_some(), "every class has its tables");
                            let line = self
                                .tables
                                .scores
                                .get((start.unwrap_or(0) + panel) as usize);
                            let Some(line) = line else {
                                debug_assert!(false, "a panel beyond the table");
                                continue;
                            };
                            let (kernel, slope) = value_and_slope(line, u);
                            let weight = knot.weight * other.weight;
                            let (mut kernel, mut slope) = (weight * kernel, weight * slope);
                            for term in &self.effects {
                                let Some((value, row)) = term.of(index) else {
                                    continue;
                                };
                                let weight = value * term.weight(knots[lane], row);
                                let (more, steeper) = value_and_slope(term.line(panel), u);
                                kernel += weight * more;
                                slope += weight * steeper;
                            }
                            value += kernel;
                            let distance = squares[lane].sqrt();
                            // Coincident knots: the kernel is even and smooth there, so its force is zero.
                            if distance > 0.0 && distance.is_finite() {
                                let pull = slope / distance;
                                let position = self.receptor.position(knots[lane]);
                                for axis in 0..3 {
                                    force[axis] += (x[axis] - position[axis]) * pull;
                                }
                            }
                        }
                    }
                },
            );
            score += value;
            let force = Vector3::from(force) * self.tables.panels_per_unit;
            gradient.force += force;
            gradient.torque += arm.cross(&force);
        }
        (score, gradient)
    }
}

/// A polynomial and its slope at u, per panel.
#[inline(always)]
fn value_and_slope(Line(line): &Line, u: f64) -> (f64, f64) {
    let (mut value, mut slope) = (0.0, 0.0);
    for coefficient in line.iter().rev() {
        slope = slope * u + value;
        value = value * u + coefficient;
    }
    (value, slope)
}
