//! Terms of a score: the effects that a search correlates, and the terms that score the poses which it keeps.
//!
//! Each term is one file and one line of a registry. Everything that shows terms walks the registries.
//!
//! | registry | what it holds | when it acts |
//! |---|---|---|
//! | [`effect::Effect::ALL`] | sums of one radial function times a class matrix | at every translation of every rotation |
//! | [`pose::POSE_TERMS`] | any function of a pose | at the poses that the search keeps |

pub mod effect;
pub mod pose;
mod potential_table;
pub mod weight;

use effect::Effect;
use pose::POSE_TERMS;
use weight::Weight;

/// The weights of all terms by their ids: those of effects, then those of pose terms, each in the order of the registry.
pub fn weights() -> impl Iterator<Item = (&'static str, &'static Weight)> {
    let effects = Effect::ALL.into_iter().filter_map(|effect| {
        let definition = effect.definition();
        let weight = definition.weight.as_ref()?;
        Some((definition.id, weight))
    });
    effects.chain(POSE_TERMS.iter().map(|term| (term.id, &term.weight)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// Options, records and files name each weight by its option, and code by its term.
    #[test]
    fn ids_and_options_are_unique_and_well_formed() {
        let (mut ids, mut options) = (HashSet::new(), HashSet::new());
        for (id, weight) in weights() {
            assert!(ids.insert(id) && options.insert(weight.option), "{id}");
            let is_of_option = |c: char| c.is_ascii_lowercase() || c == '-';
            assert!(weight.option.chars().all(is_of_option), "{id}");
            assert!(weight.option.ends_with("-weight"), "{id}");
            assert!(weight.default >= 0.0 && weight.default.is_finite(), "{id}");
            assert!(!weight.help.is_empty() && !weight.unit.is_empty(), "{id}");
        }
        // All but shape have one.
        assert_eq!(ids.len(), Effect::ALL.len() - 1 + POSE_TERMS.len());
    }
}
