//! Tables of potentials: lines of comments, a header and rows, as scripts write them.

/// Error of a table that is no potential.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct PotentialError {
    /// 1-based line.
    pub line: usize,
    /// What is wrong with it.
    pub message: String,
}

/// The potential of a built-in table.
///
/// # Panics
/// If the table does not parse. Tests parse every built-in table, so a program with such a table is never released.
pub(super) fn built_in<P>(file: &str, parsed: Result<P, PotentialError>) -> P {
    parsed.unwrap_or_else(|PotentialError { line, message }| {
        unreachable!("the built-in table {file} is damaged on line {line}: {message}")
    })
}

/// Lines of a table with their 1-based numbers, without comments and empty lines.
pub(super) fn table_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (1..)
        .zip(text.lines())
        .filter(|(_, line)| !line.starts_with('#') && !line.trim().is_empty())
}

/// Refuses lines after the last row of a table.
pub(super) fn end<'a>(
    lines: &mut impl Iterator<Item = (usize, &'a str)>,
) -> Result<(), PotentialError> {
    lines.next().map_or(Ok(()), |(line, _)| {
        Err(PotentialError {
            line,
            message: "the table has ended before this line".to_owned(),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A damaged built-in table once became a potential of zeros: every pose scored, and wrongly.
    #[test]
    #[should_panic(expected = "the built-in table some.csv is damaged on line 7: no number")]
    fn a_damaged_built_in_table_is_no_zero_potential() {
        let error = PotentialError {
            line: 7,
            message: "no number".to_owned(),
        };
        built_in::<()>("some.csv", Err(error));
    }

    #[test]
    fn comments_and_empty_lines_are_skipped_and_counted() {
        let mut lines = table_lines("# head\n\na,1\n#\nb,2\n");
        assert_eq!(lines.next(), Some((3, "a,1")));
        assert_eq!(lines.next(), Some((5, "b,2")));
        assert_eq!(end(&mut lines), Ok(()));
        assert_eq!(end(&mut table_lines("\nc,3")).unwrap_err().line, 2);
    }
}
