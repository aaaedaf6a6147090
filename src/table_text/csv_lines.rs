//! Line numbers of a CSV file, by which faults in it are reported.

/// The 1-based line on which a record begins, whose position is where the reader stood before it passed over empty
/// lines and, where a byte begins comments, over theirs.
pub fn line_of(text: &[u8], position: &csv::Position, comment: Option<u8>) -> u64 {
    let from = usize::try_from(position.byte()).unwrap_or(usize::MAX);
    let rest = text.get(from..).unwrap_or_default();
    position.line() + passed_over(rest.split(|&byte| byte == b'\n'), comment)
}

/// How many of the lines before a record the reader passes over. No line after the record's is read: rows that each
/// went through the rest of their file would be quadratic.
fn passed_over<'a>(
    lines: impl DoubleEndedIterator<Item = &'a [u8]> + Clone,
    comment: Option<u8>,
) -> u64 {
    let is_passed = |line: &[u8]| {
        line.strip_suffix(b"\r").unwrap_or(line).is_empty()
            || comment.is_some_and(|comment| line.starts_with(&[comment]))
    };
    let passed = lines
        .clone()
        .position(|line| !is_passed(line))
        .unwrap_or_else(|| {
            // A record there is, if only a last line that the reader took for one.
            let rest = lines.rev().skip_while(|line| line.is_empty());
            rest.count().saturating_sub(1)
        });
    passed as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every row went through the rest of the file for its line: 40,000 rows took 79 s, and 80,000 four times as long.
    #[test]
    fn no_line_after_the_record_is_read() {
        let read = std::cell::Cell::new(0);
        let text = "\n# no\n1,2\n".to_owned() + &"3,4\n".repeat(40_000);
        let lines = text.as_bytes().split(|&byte| byte == b'\n');
        let counted = lines.inspect(|_| read.set(read.get() + 1));
        assert_eq!(passed_over(counted, Some(b'#')), 2);
        assert_eq!(read.get(), 3);
    }

    #[test]
    fn what_the_reader_passes_over_counts() {
        let text = "a,b\n\n1,2\n# no\n \n\n3,4\n5,6\n";
        let lines = |text: &str, comment| {
            let reader = csv::ReaderBuilder::new()
                .comment(comment)
                .flexible(true)
                .from_reader(text.as_bytes());
            let records = reader.into_records();
            let lines = records.map(|record| {
                let record = record.unwrap();
                line_of(text.as_bytes(), record.position().unwrap(), comment)
            });
            lines.collect::<Vec<_>>()
        };
        // A line of blanks is a record of one field.
        for text in [text, &text.replace('\n', "\r\n")] {
            assert_eq!(lines(text, Some(b'#')), [3, 5, 7, 8]);
            assert_eq!(lines(text, None), [3, 4, 5, 7, 8]);
        }
    }
}
