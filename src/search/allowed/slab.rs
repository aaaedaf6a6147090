//! A membrane as a slab of translations that are not allowed.
//!
//! At a rotation R the other side is above or below the membrane if the translation along the membrane's normal is
//! beyond one of two bounds, which its outermost atoms set. Bounds are wider by the steps between samples, as those of
//! balls are.

use knotdock_scoring::terms::pose;
use knotdock_structures::Knots;
use nalgebra::{Rotation3, Vector3};

use crate::search::allowed::lanes::Span;

/// A membrane of one side, and the atoms of the other.
#[derive(Clone, Debug)]
pub(super) struct Membrane {
    /// Relative to the centre of its side.
    membrane: pose::Membrane,
    /// Atoms of the other side relative to its centre, Å.
    atoms: Vec<Vector3<f64>>,
    /// Allowance for the steps between samples, Å.
    slack: f64,
}

impl Membrane {
    /// A membrane between knots, whose translations are those of their centres. Samples leave `between` Å between
    /// translations and `step` radians between rotations.
    pub fn new(
        membrane: &pose::Membrane,
        knots: [&Knots; 2],
        centers: [Vector3<f64>; 2],
        (between, step): (f64, f64),
    ) -> Self {
        let side = membrane.side;
        let atoms = knots[1 - side].centers.iter();
        let atoms: Vec<_> = atoms
            .map(|x| Vector3::from(*x) - centers[1 - side])
            .collect();
        let farthest = atoms.iter().map(|x| x.norm()).fold(0.0, f64::max);
        Self {
            membrane: pose::Membrane {
                low: membrane.low - centers[side].z,
                high: membrane.high - centers[side].z,
                ..*membrane
            },
            atoms,
            slack: between + 0.5 * step * farthest,
        }
    }

    /// The normal in the receptor's frame, and the bounds of the translation along it between which nothing is
    /// allowed, Å.
    pub fn at(&self, rotation: &Rotation3<f64>) -> (Vector3<f64>, [f64; 2]) {
        let pose::Membrane { side, low, high } = self.membrane;
        // Along z of the ligand the receptor's atoms lie at n (x - t), along z of the receptor the ligand's at
        // z R y + z t.
        let (normal, along) = match side {
            0 => (Vector3::z(), rotation.inverse() * Vector3::z()),
            _ => (rotation * Vector3::z(), rotation * Vector3::z()),
        };
        let places = self.atoms.iter().map(|atom| along.dot(atom));
        let range = (f64::INFINITY, f64::NEG_INFINITY);
        let (lowest, highest) = places.fold(range, |(l, h), at| (l.min(at), h.max(at)));
        let bounds = match side {
            0 => [low - highest, high - lowest],
            _ => [lowest - high, highest - low],
        };
        (normal, [bounds[0] + self.slack, bounds[1] - self.slack])
    }
}

/// A slab of voxels that are not allowed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slab {
    normal: [f32; 3],
    /// Nothing is allowed between these along the normal.
    bounds: [f32; 2],
}

impl Slab {
    /// The slab between two places along a normal, of which `normal` is a voxel's share and `low` the place of the
    /// first voxel.
    pub fn new(normal: Vector3<f64>, bounds: [f64; 2], low: f64) -> Self {
        Self {
            normal: normal.map(|part| part as f32).into(),
            bounds: bounds.map(|bound| (bound - low) as f32),
        }
    }

    /// Whether a part of a box of voxels is allowed.
    #[inline(always)]
    pub fn leaves(&self, spans: [Span; 3]) -> bool {
        let (mut lowest, mut highest) = (0.0, 0.0);
        for (part, span) in self.normal.iter().zip(spans) {
            let [a, b] = span.scaled(*part);
            lowest += if a < b { a } else { b };
            highest += if a < b { b } else { a };
        }
        lowest <= self.bounds[0] || highest >= self.bounds[1]
    }
}
