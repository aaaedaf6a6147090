//! The ligand's knots in blocks, a vector lane each.

use crate::rigid_move::PoseGradient;
use knotdock_structures::Knots;
use nalgebra::{Rotation3, Vector3};

/// Knots in a block.
pub(super) const LANES: usize = 8;

/// One number of each knot of a block.
pub(super) type Lane = [f64; LANES];

/// Up to `LANES` knots that read the same component; places without a knot have weight 0.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// The component.
    pub component: usize,
    /// Relative to the ligand's centre, Å.
    positions: [Vector3<f64>; LANES],
    pub weights: Lane,
}

/// What the knots of a block read: value and slope along each axis, per Å.
pub(super) struct Read {
    pub value: Lane,
    pub slope: [Lane; 3],
}

/// Positions by axis, relative to a centre, Å.
pub(super) type Arms = [Lane; 3];

impl Block {
    /// The blocks of a component.
    pub fn of(
        component: usize,
        knots: &[(usize, f64)],
        ligand: &Knots,
        center: Vector3<f64>,
    ) -> Vec<Self> {
        let fill = |chunk: &[(usize, f64)]| {
            let mut block = Self {
                component,
                positions: [Vector3::zeros(); LANES],
                weights: [0.0; LANES],
            };
            for (lane, &(knot, weight)) in chunk.iter().enumerate() {
                block.positions[lane] = Vector3::from(ligand.centers[knot]) - center;
                block.weights[lane] = weight;
            }
            block
        };
        knots.chunks(LANES).map(fill).collect()
    }

    /// Positions after a rotation about the ligand's centre.
    #[inline(always)]
    pub fn turned(&self, rotation: &Rotation3<f64>) -> Arms {
        let mut arms = [[0.0; LANES]; 3];
        for (lane, position) in self.positions.iter().enumerate() {
            let arm = rotation * position;
            for axis in 0..3 {
                arms[axis][lane] = arm[axis];
            }
        }
        arms
    }

    /// Adds what the knots read to a score and its gradient.
    #[inline(always)]
    pub fn gather(&self, read: &Read, arms: &Arms, score: &mut f64, gradient: &mut PoseGradient) {
        for (lane, &weight) in self.weights.iter().enumerate() {
            let force = Vector3::from([0, 1, 2].map(|axis| weight * read.slope[axis][lane]));
            let arm = Vector3::from([0, 1, 2].map(|axis| arms[axis][lane]));
            *score += weight * read.value[lane];
            gradient.force += force;
            gradient.torque += arm.cross(&force);
        }
    }
}

/// exp(i k theta) for k = 0, 1, ...: cosines and sines, by multiplication; the error grows as k times the rounding.
#[inline(always)]
pub(super) fn powers(theta: Lane) -> impl Iterator<Item = [Lane; 2]> {
    let (mut cos, mut sin) = ([0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        (sin[lane], cos[lane]) = theta[lane].sin_cos();
    }
    let mut next = [[1.0; LANES], [0.0; LANES]];
    std::iter::from_fn(
        #[inline(always)]
        move || {
            let now = next;
            for lane in 0..LANES {
                next[0][lane] = now[0][lane] * cos[lane] - now[1][lane] * sin[lane];
                next[1][lane] = now[0][lane] * sin[lane] + now[1][lane] * cos[lane];
            }
            Some(now)
        },
    )
}
