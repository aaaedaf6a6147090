//! The volume that two solids share at a pose, between that of their inner and that of their outer balls.
//!
//! A point of both solids lies in a ball of either, and these two meet. So only balls that meet one of the other body's
//! count, and the volumes are those of [`ball_union::overlap_by_lines`] over these.
//!
//! That cannot stop halfway. Under a deadline the volume is bounded by balls alone: from below by the largest lens of two
//! inner balls, from above by the balls of either solid that meet one of the other.

use std::f64::consts::PI;

use knotdock_scoring::kernel::product::lens_volume;
use knotdock_structures::ball_solid::Motion;
use knotdock_structures::knots::Knots;
use knotdock_structures::{Ball, ball_union};

use super::scene::{CollisionScene, Deadline, PAIRS_A_LOOK, Workspace};

/// Spacing of the lines that measure volumes, as a share of both eps: what these leave open needs no closer ones.
const LINES: f64 = 0.25;

/// A volume and how far the true one may be from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SharedVolume {
    /// The middle of the range, in the cube of the files' unit.
    pub value: f64,
    /// Half of the range, with the errors of the lines by which volumes are measured.
    pub bound: f64,
}

impl CollisionScene {
    /// The volume of the region that lies in both solids.
    pub fn shared_volume(
        &self,
        motion: &Motion,
        deadline: Deadline,
        work: &mut Workspace,
    ) -> SharedVolume {
        if deadline.is_set() {
            return self.volume_by_pairs(motion, deadline, work);
        }
        let inner = self.shared(motion, 0.0, work);
        if self.band() == 0.0 {
            return SharedVolume {
                value: inner.0,
                bound: inner.1,
            };
        }
        let outer = self.shared(motion, self.band(), work);
        let (low, high) = ((inner.0 - inner.1).max(0.0), outer.0 + outer.1);
        SharedVolume {
            value: 0.5 * (low + high),
            bound: 0.5 * (high - low),
        }
    }

    /// Bounds from the pairs of balls that meet; of a visit that the deadline ends, from the balls about all of them.
    fn volume_by_pairs(
        &self,
        motion: &Motion,
        deadline: Deadline,
        work: &mut Workspace,
    ) -> SharedVolume {
        let trees = self.trees();
        let [a, b] = self.solids().each_ref().map(|solid| solid.epsilon());
        let Workspace { pairs, marks, .. } = work;
        for (marks, tree) in marks.iter_mut().zip(trees) {
            marks.clear();
            marks.resize(tree.balls().len(), false);
        }
        let (mut low, mut high, mut seen) = (0.0f64, [0.0f64; 2], 0usize);
        let all = pairs.visit(trees, motion, self.band(), |[i, j], moved, squared| {
            let first = trees[0].balls()[i];
            let grown = [(0, i, first.radius + a), (1, j, moved.radius + b)];
            for (side, ball, radius) in grown {
                if !std::mem::replace(&mut marks[side][ball], true) {
                    high[side] += ball_volume(radius);
                }
            }
            low = low.max(lens_volume(first.radius, moved.radius, squared.sqrt()));
            seen += 1;
            !seen.is_multiple_of(PAIRS_A_LOOK) || !deadline.has_come()
        });
        let bounds = [0, 1].map(|side| match trees[side].bound() {
            Some(bound) if !all => ball_volume(bound.radius + self.band()),
            _ => high[side],
        });
        let high = bounds[0].min(bounds[1]);
        SharedVolume {
            value: 0.5 * (low + high),
            bound: 0.5 * (high - low),
        }
    }

    /// Shared volume of the inner balls, or where `band` is above zero of the outer ones, and its error.
    fn shared(&self, motion: &Motion, band: f64, work: &mut Workspace) -> (f64, f64) {
        let trees = self.trees();
        let Workspace { pairs, marks, .. } = work;
        for (marks, tree) in marks.iter_mut().zip(trees) {
            marks.clear();
            marks.resize(tree.balls().len(), false);
        }
        pairs.visit(trees, motion, band, |[i, j], _, _| {
            marks[0][i] = true;
            marks[1][j] = true;
            true
        });
        let grown = |solid: usize| {
            if band > 0.0 {
                self.solids()[solid].epsilon()
            } else {
                0.0
            }
        };
        let first = marked(trees[0].balls(), &marks[0], grown(0), |center| center);
        let second = marked(trees[1].balls(), &marks[1], grown(1), |center| {
            motion.apply(center)
        });
        match (first, second) {
            (Some(first), Some(second)) => {
                let overlap = ball_union::overlap_by_lines(&first, &second, LINES * self.band());
                (overlap.shared.max(0.0), overlap.error)
            }
            _ => (0.0, 0.0),
        }
    }
}

fn ball_volume(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

/// The marked balls, grown and moved; `None` where none is marked.
fn marked(
    balls: &[Ball],
    marks: &[bool],
    grown: f64,
    moved: impl Fn([f64; 3]) -> [f64; 3],
) -> Option<Knots> {
    let marked = balls.iter().zip(marks).filter(|(_, mark)| **mark);
    let (centers, radii) = marked
        .map(|(ball, _)| (moved(ball.center), ball.radius + grown))
        .unzip();
    Knots::new(centers, radii).ok()
}
