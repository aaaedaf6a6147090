//! A ball.

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
    /// Whether this ball holds all of `other`.
    pub fn holds(&self, other: &Ball) -> bool {
        distance(self.center, other.center) + other.radius <= self.radius
    }

    /// This ball grown by `margin`.
    #[must_use]
    pub fn grown(&self, margin: f64) -> Self {
        Self {
            center: self.center,
            radius: self.radius + margin,
        }
    }

    /// Signed distance to another ball: of the spheres where the balls are apart, minus the depth where they meet.
    pub fn gap(&self, other: &Ball) -> f64 {
        distance(self.center, other.center) - self.radius - other.radius
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [x, y, z] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    (x * x + y * y + z * z).sqrt()
}
