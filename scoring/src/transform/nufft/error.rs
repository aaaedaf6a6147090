//! Errors of planning and executing a transform.

use thiserror::Error;

/// A transform that cannot be planned.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PlanError {
    /// An axis has no modes.
    #[error("axis {axis} has no modes; ask for at least 1 on each axis")]
    NoModes {
        /// The axis, from 0.
        axis: usize,
    },
    /// The tolerance is no number between the precision's least and 1.
    #[error(
        "tolerance {requested} is out of reach: it must be at least {least} and below 1 in this precision"
    )]
    Tolerance {
        /// The requested value.
        requested: f64,
        /// What this precision or the widest window can do.
        least: f64,
    },
    /// The grid does not fit into the address space.
    #[error(
        "{modes:?} modes need a grid of more points than can be addressed; ask for fewer modes"
    )]
    TooLarge {
        /// Modes per axis.
        modes: Vec<usize>,
    },
    /// An oversampling that is not above 1, or not finite.
    #[error("oversampling {requested} must be above 1 and at most 4")]
    Oversampling {
        /// The requested value.
        requested: f64,
    },
}

/// Input that does not suit the plan.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TransformError {
    /// A coordinate is NaN or infinite.
    #[error("coordinate {axis} of point {index} is {value}; coordinates must be finite")]
    Point {
        /// The point, from 0.
        index: usize,
        /// The axis, from 0.
        axis: usize,
        /// Its value.
        value: f64,
    },
    /// More points than 32-bit places can number.
    #[error("{count} points are too many; split them into sets of at most 4294967295")]
    TooManyPoints {
        /// Points given.
        count: usize,
    },
    /// An array has a length other than the plan or the points need.
    #[error("{what} holds {got} numbers where {expected} are needed")]
    Length {
        /// The array.
        what: &'static str,
        /// Length needed.
        expected: usize,
        /// Length given.
        got: usize,
    },
    /// Points or workspace were made by a plan of another shape.
    #[error("{what} belongs to another plan; make it anew from this one")]
    Foreign {
        /// The points or the workspace.
        what: &'static str,
    },
}
