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

use effect::Effect;
use knotdock_structures::Error;
use pose::POSE_TERMS;

/// The weights of all terms by their ids: those of effects, then those of pose terms, each in the order of the registry.
pub fn weights() -> impl Iterator<Item = (&'static str, &'static Weight)> {
    let effects = Effect::ALL.into_iter().filter_map(|effect| {
        let definition = effect.definition();
        let weight = definition.weight.as_ref()?;
        Some((definition.id, weight))
    });
    effects.chain(POSE_TERMS.iter().map(|term| (term.id, &term.weight)))
}

/// Weight of a term. The user sets it by an option.
#[derive(Clone, Copy, Debug)]
pub struct Weight {
    /// Name of the option: lower case with `-` between words, ending in `-weight`.
    pub option: &'static str,
    /// Description of the option: the quantity that the weight multiplies.
    pub help: &'static str,
    /// Unit of the weight.
    pub unit: &'static str,
    /// Value if the option is left out.
    pub default: f64,
}

/// The potential of a built-in table.
///
/// # Panics
/// If the table does not parse. Tests parse every built-in table, so a program with such a table is never released.
pub(crate) fn built_in<P>(file: &str, parsed: Result<P, Error>) -> P {
    parsed.unwrap_or_else(|error| {
        let line = error.line();
        unreachable!("the built-in table {file} is damaged on line {line:?}: {error}")
    })
}

/// Lines of a table with their 1-based numbers, without comments and empty lines.
pub(crate) fn table_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (1..)
        .zip(text.lines())
        .filter(|(_, line)| !line.starts_with('#') && !line.trim().is_empty())
}

/// Refuses lines after the last row of a table.
pub(crate) fn end<'a>(lines: &mut impl Iterator<Item = (usize, &'a str)>) -> Result<(), Error> {
    lines.next().map_or(Ok(()), |(line, _)| {
        Err(wrong(line, "the table has ended before this line"))
    })
}

/// Error of a table with a fault on a 1-based line.
pub(crate) fn wrong(line: usize, message: impl std::fmt::Display) -> Error {
    let remedy =
        "give a table as the scripts in scripts/potentials write it, or leave the option out";
    Error::input(message).on_line(line as u64).help(remedy)
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

#[cfg(test)]
mod potential_table_tests {
    use super::*;

    /// A damaged built-in table once became a potential of zeros: every pose scored, and wrongly.
    #[test]
    #[should_panic(expected = "the built-in table some.csv is damaged on line Some(7): no number")]
    fn a_damaged_built_in_table_is_no_zero_potential() {
        built_in::<()>("some.csv", Err(wrong(7, "no number")));
    }

    #[test]
    fn comments_and_empty_lines_are_skipped_and_counted() {
        let mut lines = table_lines("# head\n\na,1\n#\nb,2\n");
        assert_eq!(lines.next(), Some((3, "a,1")));
        assert_eq!(lines.next(), Some((5, "b,2")));
        assert_eq!(end(&mut lines), Ok(()));
        assert_eq!(end(&mut table_lines("\nc,3")).unwrap_err().line(), Some(2));
    }
}
