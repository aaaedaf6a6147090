//! Morphological operations on solids known by balls (B&I, section 4.3).
//!
//! | operation | points |
//! |---|---|
//! | sum A + B | a + b for a in A, b in B |
//! | difference A - B | t with B + t inside A |
//! | opening | (A - B) + B |
//! | closing | (A + B) - B |
//! | product over poses | all M x for a pose M and x in A |
//! | quotient over poses | points in M A for every pose M |
//! | sweep | the product over all poses of a path |
//!
//! Sums and products of balls are balls. Differences and quotients, which the paper leaves open, go by duality: A - B is
//! the complement of (complement of A) + (-B), and a quotient the complement of the product of the complement
//! ([`complement`]). Every result is a [`Bracket`] about the true one. If A is a mesh, its exact depth bounds the volume
//! closer than the balls do ([`exact_volume`]).

pub mod complement;
pub mod difference;
pub mod exact_volume;
pub mod held_cells;
pub mod products;
pub mod sweep;

use knotdock_structures::Error;
use knotdock_structures::sampling::Ball;

use super::bracket::Bracket;
use super::obstacle::reduce::BYTES_REDUCED;
use super::obstacle::sum;
use crate::memory_size::{as_size, named};
use difference::difference;

/// Fineness of sampled complements, and limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MorphologyOptions {
    /// Nodes along each edge of the grid that complements are sampled on.
    pub per_axis: usize,
    /// Bytes that the balls of an operation may take.
    pub memory: Option<u64>,
}

impl MorphologyOptions {
    /// Refuses more balls than memory has room for.
    ///
    /// # Errors
    /// [`Error`] with the memory that they need.
    pub fn room_for(&self, balls: u64) -> Result<(), Error> {
        let needed = balls.saturating_mul(BYTES_REDUCED);
        match self.memory {
            Some(allowed) if needed > allowed => Err(Error::input(format!(
                "{balls} balls come about, which need {needed} bytes of memory, and {allowed} are allowed"
            ))
            .help(format!(
                "use a coarser --grid or --complement-grid, or fewer poses, or allow at least --memory {}",
                as_size(named(needed))
            ))),
            _ => Ok(()),
        }
    }

    /// Refuses the pairs of two solids, inner and outer, if memory has no room for them.
    ///
    /// # Errors
    /// [`Error`] if memory has no room for the balls.
    pub fn room_for_pairs(&self, a: &Bracket, b: &Bracket) -> Result<(), Error> {
        let pairs = |a: &[Ball], b: &[Ball]| a.len() as u64 * b.len() as u64;
        self.room_for(pairs(&a.inner, &b.inner).max(pairs(&a.outer, &b.outer)))
    }
}

/// A + B.
///
/// # Errors
/// [`Error`] if memory has no room for the balls.
pub fn dilated(a: &Bracket, b: &Bracket, options: &MorphologyOptions) -> Result<Bracket, Error> {
    options.room_for_pairs(a, b)?;
    Ok(sum(a, b, 0.0))
}

/// The points within `distance` >= 0 of A, or, below zero, those of A at least that deep.
///
/// # Errors
/// [`Error`] if memory has no room for the balls.
pub fn offset(a: &Bracket, distance: f64, options: &MorphologyOptions) -> Result<Bracket, Error> {
    if distance < 0.0 {
        return difference(a, &Bracket::ball(-distance), options);
    }
    Ok(a.map(|balls| balls.iter().map(|ball| ball.grown(distance)).collect()))
}

/// The union of all copies of B that fit into A: (A - B) + B.
///
/// # Errors
/// [`Error`] if memory has no room for the balls.
pub fn opened(a: &Bracket, b: &Bracket, options: &MorphologyOptions) -> Result<Bracket, Error> {
    let fitting = difference(a, b, options)?;
    let mut opened = dilated(&fitting, b, options)?;
    opened.epsilon = complement::hausdorff_bound(&opened.inner, &opened.outer, options.per_axis);
    Ok(opened)
}

/// The complement of all copies of -B that fit outside A: (A + B) - B. It holds A.
///
/// # Errors
/// [`Error`] if memory has no room for the balls.
pub fn closed(a: &Bracket, b: &Bracket, options: &MorphologyOptions) -> Result<Bracket, Error> {
    let grown = dilated(a, b, options)?;
    let mut closed = difference(&grown, b, options)?;
    closed.inner.extend(a.about(closed.origin).inner);
    closed.inner = super::obstacle::reduce::reduced(closed.inner);
    closed.epsilon = complement::hausdorff_bound(&closed.inner, &closed.outer, options.per_axis);
    Ok(closed)
}

#[cfg(test)]
mod tests;
