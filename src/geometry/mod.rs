//! Questions of geometry that ball sets answer: collision.

pub mod collide;
pub mod motion;
