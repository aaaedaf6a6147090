//! A ball.

use std::cmp::Ordering;

use crate::vector::{compare, distance};

/// Largest coordinate, radius or translation of a solid that is read: squares and cubes of lengths, and products of
/// two cubes, stay finite.
pub const LARGEST_LENGTH: f64 = 1e30;
/// Smallest radius of a ball that is read: squares and cubes stay above zero.
pub const SMALLEST_RADIUS: f64 = 1e-30;

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its centre.
    pub center: [f64; 3],
    /// Its radius, above zero, in the unit of `center`.
    pub radius: f64,
}

impl Ball {
    /// The ball of this centre and radius.
    pub fn new(center: [f64; 3], radius: f64) -> Self {
        Self { center, radius }
    }

    /// Whether this ball holds all of `other`.
    pub fn holds(&self, other: &Ball) -> bool {
        distance(self.center, other.center) + other.radius <= self.radius
    }

    /// This ball grown by `margin`.
    #[must_use]
    pub fn grown(&self, margin: f64) -> Self {
        Self::new(self.center, self.radius + margin)
    }

    /// Lowest and highest corner of its bounding box.
    #[cfg(feature = "mesh")]
    pub(crate) fn corners(&self) -> [[f64; 3]; 2] {
        [-self.radius, self.radius].map(|reach| self.center.map(|x| x + reach))
    }

    /// Signed distance of the two spheres, below zero if the balls meet.
    pub fn gap(&self, other: &Ball) -> f64 {
        distance(self.center, other.center) - self.radius - other.radius
    }
}

/// Order of balls: the largest first, then by the centre's x, y and z.
pub(crate) fn largest_first(a: &Ball, b: &Ball) -> Ordering {
    (b.radius.total_cmp(&a.radius)).then_with(|| compare(a.center, b.center))
}
