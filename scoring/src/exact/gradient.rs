//! The score's gradient over the six degrees of freedom of a pose.

use super::blocks::LANES;
use super::tables::Line;
use super::{ExactScorer, PoseGradient};
use crate::se3::Pose;
use crate::vectorized::vectorized;
use nalgebra::Vector3;

impl ExactScorer {
    /// Score of one pose and its gradient over translation (Å) and rotation (radians) about the ligand's centre.
    pub fn gradient(&self, pose: &Pose) -> (f64, PoseGradient) {
        vectorized(
            #[inline(always)]
            || self.gradient_inline(pose),
        )
    }

    #[inline(always)]
    fn gradient_inline(&self, pose: &Pose) -> (f64, PoseGradient) {
        let (rotation, center) = self.placed(pose);
        let mut score = 0.0;
        let mut gradient = PoseGradient::default();
        for (index, knot) in self.ligand.iter().enumerate() {
            let arm = rotation * knot.position;
            let x: [f64; 3] = (arm + center).into();
            let starts = self.tables.starts(knot.class);
            let mut value = 0.0;
            let mut force = [0.0; 3];
            self.receptor.near(
                &x,
                self.kernel.reach(),
                #[inline(always)]
                |number, block| {
                    let squares = block.squares(&x);
                    let places = self.tables.place(&squares);
                    for lane in 0..LANES {
                        let (panel, u) = (places.panels[lane], places.offsets[lane]);
                        let start = starts.get(block.classes[lane] as usize).copied();
                        let line = self
                            .tables
                            .scores()
                            .get((start.unwrap_or(0) + panel) as usize);
                        let Some(line) = line else {
                            continue;
                        };
                        let (kernel, slope) = value_and_slope(line, u);
                        let weight = knot.weight * block.weights[lane];
                        let (mut kernel, mut slope) = (weight * kernel, weight * slope);
                        for term in &self.effects {
                            let weight = term.weight(index, number, lane);
                            let (more, steeper) = value_and_slope(term.line(panel), u);
                            kernel += weight * more;
                            slope += weight * steeper;
                        }
                        value += kernel;
                        let distance = squares[lane].sqrt();
                        // Coincident knots: the kernel is even and smooth there, so its force is zero.
                        if distance > 0.0 {
                            let pull = slope / distance;
                            for axis in 0..3 {
                                force[axis] += (x[axis] - block.positions[axis][lane]) * pull;
                            }
                        }
                    }
                },
            );
            score += value;
            let force = Vector3::from(force) * self.tables.panels_per_unit();
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
