//! Collision of two solids at a pose (B&I, section 4.1): a verdict with what certifies it, bounds of the signed
//! distance, the shared volume, and the force and torque of an overlap energy.
//!
//! # Conventions
//!
//! - Body A stands, body B moves: a point of its file at x goes to R x + t in A's frame. Lengths are in the files' unit.
//! - The **signed distance** is the distance of the solids where they are apart. Where they meet it is minus their
//!   penetration depth, the length of the shortest translation that parts them.
//! - A **margin** D asks whether the solids come closer than D.
//!
//! # What certifies what
//!
//! Inner balls lie inside the solids and outer balls hold them ([`knotdock_structures::ball_solid`]). So
//!
//! - inner balls closer than the margin certify a hit, containment included, and outer balls that are not certify that
//!   the pose is free;
//! - the least signed distance over pairs of inner balls is never below the signed distance of the solids: no
//!   translation shorter than the depth of one pair parts that pair;
//! - the least over pairs of outer balls is never above it where they are apart. Where they meet, a translation that
//!   parts them parts the solids too ([`separation`]).
//!
//! Between the two the pose is undecided, and the gap of the solids is known to `eps_A` + `eps_B`.

pub mod answer;
pub mod contact;
pub mod impact;
pub mod scene;
pub mod separation;
pub mod shared_volume;

#[cfg(test)]
mod obstacle_tests;
#[cfg(test)]
mod tests;

pub use answer::{Answer, Quantities, Questions, Ways};
pub use contact::{Contact, Method};
pub use scene::{Bounds, Certificate, CollisionScene, Deadline, Found, Verdict, Workspace};
