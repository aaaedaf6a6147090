//! A solid between two sets of balls.

use knotdock_scoring::se3::Pose;
use knotdock_structures::ball_solid::BallSolid;
use knotdock_structures::ball_union::volume_of_union;
use knotdock_structures::sampling::Ball;
use knotdock_structures::sampling::grid::Grid;

use super::morphology::held_cells::HeldCells;

/// A solid S between balls: S(inner) in S in S(outer). The same holds for the result of every operation here.
#[derive(Clone, Debug, PartialEq)]
pub struct Bracket {
    /// Origin of the balls' coordinates, in the frame of the files.
    pub origin: [f64; 3],
    /// Balls inside the solid, relative to the origin. An empty set says that no point is known to be inside.
    pub inner: Vec<Ball>,
    /// Balls whose union holds the solid, relative to the origin.
    pub outer: Vec<Ball>,
    /// Bound of the Hausdorff distance from the solid to either set; infinite if none is known, for
    /// instance if one of two sets is empty.
    pub epsilon: f64,
}

impl From<&BallSolid> for Bracket {
    fn from(solid: &BallSolid) -> Self {
        Self {
            origin: solid.origin(),
            inner: solid.inner().to_vec(),
            outer: solid.outer(),
            epsilon: solid.epsilon(),
        }
    }
}

impl Bracket {
    /// A solid that is a union of balls.
    pub fn exact(balls: Vec<Ball>) -> Self {
        Self {
            origin: [0.0; 3],
            inner: balls.clone(),
            outer: balls,
            epsilon: 0.0,
        }
    }

    /// A ball about the origin.
    pub fn ball(radius: f64) -> Self {
        let center = [0.0; 3];
        Self::exact(vec![Ball { center, radius }])
    }

    /// Whether inner and outer balls are the same, and the solid is their union.
    pub fn is_exact(&self) -> bool {
        self.inner == self.outer
    }

    /// The box around the outer balls: its lowest and highest corner, relative to the origin.
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        bounds(&self.outer)
    }

    /// This solid in a pose: the images of the balls, about the image of the origin.
    #[must_use]
    pub fn moved(&self, pose: &Pose) -> Self {
        Self {
            origin: pose.apply(self.origin),
            ..self.map(|balls| balls.iter().map(|ball| turned(ball, pose)).collect())
        }
    }

    /// This solid with both sets changed: `change` gets each set.
    #[must_use]
    pub fn map(&self, mut change: impl FnMut(&[Ball]) -> Vec<Ball>) -> Self {
        Self {
            origin: self.origin,
            inner: change(&self.inner),
            outer: change(&self.outer),
            epsilon: self.epsilon,
        }
    }

    /// This solid with balls relative to another origin.
    #[must_use]
    pub fn about(&self, origin: [f64; 3]) -> Self {
        let shift = [0, 1, 2].map(|axis| self.origin[axis] - origin[axis]);
        Self {
            origin,
            ..self.map(|balls| balls.iter().map(|ball| shifted(ball, shift)).collect())
        }
    }
}

/// A ball moved by a vector.
pub fn shifted(ball: &Ball, by: [f64; 3]) -> Ball {
    Ball {
        center: [0, 1, 2].map(|axis| ball.center[axis] + by[axis]),
        radius: ball.radius,
    }
}

/// A ball turned about its origin by the rotation of a pose.
pub fn turned(ball: &Ball, pose: &Pose) -> Ball {
    let center = pose.rotation * nalgebra::Vector3::from(ball.center);
    Ball {
        center: center.into(),
        radius: ball.radius,
    }
}

/// The box around balls: its lowest and highest corner; infinite the wrong way round without balls.
pub fn bounds(balls: &[Ball]) -> ([f64; 3], [f64; 3]) {
    let empty = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    balls.iter().fold(empty, |(low, high), ball| {
        (
            [0, 1, 2].map(|axis| low[axis].min(ball.center[axis] - ball.radius)),
            [0, 1, 2].map(|axis| high[axis].max(ball.center[axis] + ball.radius)),
        )
    })
}

/// Nodes an axis of the grid by which balls deep in a union are left out of its volume.
const VOLUME_GRID: usize = 64;

/// Volume of the union of balls and a bound of its error, in the cube of their unit; zero without balls.
pub fn volume(balls: &[Ball]) -> (f64, f64) {
    let (low, high) = bounds(balls);
    let middle = [0, 1, 2].map(|axis| -0.5 * (low[axis] + high[axis]));
    let edge = (0..3)
        .map(|axis| high[axis] - low[axis])
        .fold(0.0, f64::max);
    let mut cells = HeldCells::new(Grid::of_edge(edge, VOLUME_GRID));
    let mut largest_first: Vec<Ball> = balls.iter().map(|ball| shifted(ball, middle)).collect();
    largest_first.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    let needed = largest_first.iter().filter(|ball| cells.takes(ball));
    let needed: Vec<Ball> = needed.copied().collect();
    let volume = volume_of_union(&needed);
    (volume.value, volume.error)
}
