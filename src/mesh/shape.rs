//! What a part that docks is made of: a solid that is sampled, or balls that are docked as they are.

use knotdock_structures::Ball;
use knotdock_structures::mesh::Solid;

/// What a part is made of.
#[derive(Clone, Copy)]
pub enum Shape<'a> {
    /// What a mesh bounds.
    Solid(&'a Solid),
    /// Balls of a file.
    Balls(&'a BallPart),
}

/// Balls of a file, in its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct BallPart {
    /// The balls, one at least.
    pub balls: Vec<Ball>,
    /// A weight a ball; `None`: they are fitted.
    pub weights: Option<Vec<f64>>,
}

impl BallPart {
    /// Middle of the bounding box, and its longest edge.
    pub(super) fn bounds(&self) -> ([f64; 3], f64) {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for ball in &self.balls {
            for axis in 0..3 {
                low[axis] = low[axis].min(ball.center[axis] - ball.radius);
                high[axis] = high[axis].max(ball.center[axis] + ball.radius);
            }
        }
        let edges = [0, 1, 2].map(|axis| high[axis] - low[axis]);
        let middle = [0, 1, 2].map(|axis| low[axis] + 0.5 * edges[axis]);
        (middle, edges.into_iter().fold(0.0, f64::max))
    }

    /// Median radius.
    pub(super) fn feature_size(&self) -> f64 {
        let mut radii: Vec<f64> = self.balls.iter().map(|ball| ball.radius).collect();
        radii.sort_by(f64::total_cmp);
        radii.get(radii.len() / 2).copied().unwrap_or(0.0)
    }
}

impl<'a> From<&'a Solid> for Shape<'a> {
    fn from(solid: &'a Solid) -> Self {
        Self::Solid(solid)
    }
}
