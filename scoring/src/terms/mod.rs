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

use knotdock_structures::Error;

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
    use super::effect::Effect;
    use super::pose::POSE_TERMS;
    use std::collections::HashSet;

    /// Columns, records and options name each term by its id.
    #[test]
    fn ids_are_unique() {
        let effects = Effect::ALL.map(|effect| effect.definition().id);
        let ids = effects
            .into_iter()
            .chain(POSE_TERMS.iter().map(|term| term.id));
        let ids: Vec<&str> = ids.collect();
        assert_eq!(ids.iter().collect::<HashSet<_>>().len(), ids.len());
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
