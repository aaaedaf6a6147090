//! Geometry of solids as sets of balls: collision, obstacles and Minkowski operations.
//!
//! # Conventions
//!
//! - A solid is bounded by two sets of balls, a [`Bracket`]: inner balls are in it, outer balls hold it.
//! - Balls are stored relative to an origin, in the unit of the files, so that far coordinates cost no digits.
//! - A pose is x -> R x + t, from the file's frame of the moved solid to that of the fixed one.

pub mod ball_field;
pub mod bracket;
pub mod collide;
pub mod gap;
pub mod morphology;
pub mod motion;
pub mod obstacle;

pub use bracket::Bracket;
