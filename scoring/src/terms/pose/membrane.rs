//! Pose term `membrane`: depth of one side in the membrane of the other.
//!
//! A membrane is a slab between two planes across the z axis of one side's file. The depth is the way along z after
//! which no atom of the other side has its centre in the slab, and that whole side lies above or below.

use super::{TermDefinition, UNRELAXED};
use crate::se3::Pose;

/// Definition of the term.
pub(super) const TERM: TermDefinition = TermDefinition {
    id: "membrane",
    label: "membranes",
    unit: "score per Å",
    time_share: UNRELAXED,
    is_shown_always: false,
    reads: "membranes",
    count: |inputs| [0, 1].map(|side| usize::from(inputs.membrane.is_some_and(|m| m.side == side))),
    applies: |inputs| inputs.membrane.is_some(),
    build: |inputs, weight| {
        let Some(&membrane) = inputs.membrane else {
            unreachable!("the term applies where there is a membrane");
        };
        // Positions of the side that is to stay out of it, in its own file (Å).
        let positions = inputs.bodies[1 - membrane.side].centers.clone();
        Box::new(move |pose, _| score(&membrane, &positions, weight, pose))
    },
};

/// A slab across the z axis of one side's file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Membrane {
    /// The side: 0 for the receptor, 1 for the ligand.
    pub side: usize,
    /// Lowest z in Å.
    pub low: f64,
    /// Highest z in Å.
    pub high: f64,
}

impl Membrane {
    /// Depth in Å of atoms whose lowest and highest z in the frame of the membrane's side are given.
    pub fn depth(&self, lowest: f64, highest: f64) -> f64 {
        (self.high - lowest).min(highest - self.low).max(0.0)
    }
}

/// Minus the weight times the depth of some positions (Å) at a pose.
fn score(membrane: &Membrane, positions: &[[f64; 3]], weight: f64, pose: &Pose) -> f64 {
    let pose = match membrane.side {
        0 => *pose,
        _ => pose.inverse(),
    };
    let z = positions.iter().map(|at| pose.apply(*at)[2]);
    let range = (f64::INFINITY, f64::NEG_INFINITY);
    let (lowest, highest) = z.fold(range, |(low, high), z| (low.min(z), high.max(z)));
    // Outside the score is 0, not -0.
    0.0 - weight * membrane.depth(lowest, highest)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rod of 6 Å along z, and a membrane from -10 to 15 Å.
    #[test]
    fn depth_is_the_shorter_way_out() {
        let membrane = |side| Membrane {
            side,
            low: -10.0,
            high: 15.0,
        };
        let positions = [[1.0, 2.0, -3.0], [0.0, 0.0, 3.0]];
        let at = |side, z: f64, quaternion| {
            let pose = Pose::from_parts(quaternion, [4.0, 0.0, z]);
            score(&membrane(side), &positions, 2.0, &pose)
        };
        let straight = [1.0, 0.0, 0.0, 0.0];
        for (z, depth) in [
            (18.0, 0.0),
            (17.0, 1.0),
            (0.0, 13.0),
            (-12.0, 1.0),
            (-13.0, 0.0),
        ] {
            assert!((at(0, z, straight) + 2.0 * depth).abs() < 1e-9, "{z}");
            // In the frame of the ligand the receptor lies at -z.
            assert!((at(1, -z, straight) + 2.0 * depth).abs() < 1e-9, "{z}");
        }
        let outside = at(0, 30.0, straight);
        assert!(outside == 0.0 && outside.is_sign_positive());
        // A quarter turn about x lays the rod down: its atoms have z of 2 and 0.
        let half = 0.5f64.sqrt();
        assert!((at(0, 14.0, [half, half, 0.0, 0.0]) + 2.0).abs() < 1e-9);
    }
}
