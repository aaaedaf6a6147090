//! Values of the pose terms at one pose, in the order of the registry.

use super::{POSE_TERMS, TermDefinition};
use serde::{Serialize, Serializer};

/// Weighted values of the pose terms at one pose; higher is better. A term that does not act has no value.
///
/// It serialises to a map from ids to values, with `null` for the terms that do not act.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TermValues([Option<f64>; POSE_TERMS.len()]);

impl TermValues {
    /// Every term with its value, in the order of [`POSE_TERMS`].
    pub fn iter(&self) -> impl Iterator<Item = (&'static TermDefinition, Option<f64>)> {
        POSE_TERMS.iter().zip(self.0)
    }

    /// Value of the term with this id; `None` if the term does not act.
    pub fn get(&self, id: &str) -> Option<f64> {
        debug_assert!(TermDefinition::with_id(id).is_some(), "no pose term '{id}'");
        let (_, value) = self.iter().find(|(term, _)| term.id == id)?;
        value
    }

    /// Sets the value of the term at `index` of [`POSE_TERMS`].
    pub(super) fn set(&mut self, index: usize, value: f64) {
        self.0[index] = Some(value);
    }

    /// The same values, with one more or another by its id.
    ///
    /// # Panics
    /// If no term has this id.
    #[must_use]
    pub fn with(mut self, id: &str, value: f64) -> Self {
        let Some(index) = POSE_TERMS.iter().position(|term| term.id == id) else {
            unreachable!("no pose term '{id}'");
        };
        self.set(index, value);
        self
    }

    /// Sum of all values, in the order of [`POSE_TERMS`].
    pub fn sum(&self) -> f64 {
        let [first, others @ ..] = self.0.map(|value| value.unwrap_or(0.0));
        others.into_iter().fold(first, |sum, value| sum + value)
    }
}

impl Serialize for TermValues {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(self.iter().map(|(term, value)| (term.id, value)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums run in the order of the registry, so that every table holds the same digits.
    #[test]
    fn values_add_up_in_the_order_of_the_registry() {
        let numbers = [1e16, 1.0, -1e16, 0.5, 0.25, 0.125, 0.0625];
        let values = POSE_TERMS
            .iter()
            .zip(numbers)
            .fold(TermValues::default(), |values, (term, number)| {
                values.with(term.id, number)
            });
        // 1e16 + 1 rounds to 1e16.
        assert_eq!(values.sum(), 0.9375);
        assert_eq!(TermValues::default().sum(), 0.0);
    }

    #[test]
    fn values_are_found_by_id() {
        let id = POSE_TERMS[1].id;
        let values = TermValues::default().with(id, -2.5);
        assert_eq!(values.get(id), Some(-2.5));
        let mut others = POSE_TERMS.iter().filter(|term| term.id != id);
        assert!(others.all(|term| values.get(term.id).is_none()));
        assert_eq!(values.sum(), -2.5);
    }
}
