//! Copies of one atom that lie on each other.

use crate::molecule::model::atom::squared_distance;
use crate::neighbours::SpatialHash;

/// Copies nearer than this, in Å, are one: it lies on an axis of symmetry.
const ON_AXIS: f64 = 0.5;

/// Copies up to which a new one is compared with each; more are looked up by their place.
const FEW: usize = 64;

/// Where the copies of one atom lie (Å), and what each belongs to.
#[derive(Clone)]
pub(crate) struct Copies<T> {
    first: Vec<(T, [f64; 3])>,
    /// All of them, where they are many.
    cells: Option<SpatialHash<(T, [f64; 3])>>,
}

impl<T> Default for Copies<T> {
    fn default() -> Self {
        Self {
            first: Vec::new(),
            cells: None,
        }
    }
}

impl<T: Copy> Copies<T> {
    /// Whether there is no copy.
    pub(crate) fn is_empty(&self) -> bool {
        self.first.is_empty()
    }

    /// Whether a position lies on a copy, of those that count.
    pub(crate) fn has(&self, position: [f64; 3], counts: impl Fn(T) -> bool) -> bool {
        let lies_on = |(owner, place): &(T, [f64; 3])| {
            counts(*owner) && squared_distance(*place, position) < ON_AXIS * ON_AXIS
        };
        match &self.cells {
            None => self.first.iter().any(lies_on),
            Some(cells) => cells.around(position).any(lies_on),
        }
    }

    /// Adds a copy.
    pub(crate) fn push(&mut self, owner: T, position: [f64; 3]) {
        match &mut self.cells {
            Some(cells) => cells.push(position, (owner, position)),
            None => self.first.push((owner, position)),
        }
        if self.cells.is_none() && self.first.len() == FEW {
            let mut cells = SpatialHash::new(ON_AXIS);
            for &(owner, place) in &self.first {
                cells.push(place, (owner, place));
            }
            self.cells = Some(cells);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each copy was compared with all before it: 100,000 operators of a file, or as many models, took minutes.
    #[test]
    fn many_copies_are_looked_up_by_their_place() {
        let mut copies = Copies::default();
        for number in 0..200_000 {
            let place = [0.6 * number as f64, -3.0, 0.0];
            assert!(!copies.has(place, |_| true));
            copies.push(number, place);
        }
        for number in [0, 63, 64, 199_999] {
            let place = [0.6 * number as f64 + 0.1, -3.0, 0.2];
            assert!(copies.has(place, |owner| owner == number));
            assert!(!copies.has(place, |owner| owner > number + 1));
        }
    }
}
