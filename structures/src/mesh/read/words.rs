//! Lines of words of a text format, with their numbers, and numbers of words.

use crate::error::Error;
use crate::mesh::read::soup::broken;
use crate::mesh::repair::rounding::Digits;

/// A line that has words: its 1-based number, and its text up to a comment.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// 1-based number in the file.
    pub number: usize,
    /// The text, without comment and surrounding blanks.
    pub text: &'a str,
}

impl<'a> Line<'a> {
    /// The words.
    pub fn words(&self) -> std::str::SplitAsciiWhitespace<'a> {
        self.text.split_ascii_whitespace()
    }

    /// A fault on this line.
    pub fn fault(&self, what: impl std::fmt::Display) -> Error {
        broken(self.number, what)
    }

    /// A number; `what` is its role, for messages.
    pub fn number<T: std::str::FromStr>(&self, word: Option<&str>, what: &str) -> Result<T, Error> {
        let word =
            word.ok_or_else(|| self.fault(format!("the line ends where {what} is needed")))?;
        word.parse().map_err(|_| self.misplaced(word, what))
    }

    /// The error of a word in place of something else.
    pub fn misplaced(&self, word: &str, what: &str) -> Error {
        self.fault(format!(
            "'{}' stands where {what} is needed",
            shortened(word)
        ))
    }

    /// Three coordinates from the next words; what is written for no number is NaN.
    pub fn point<'w>(
        &self,
        words: &mut impl Iterator<Item = &'w str>,
        digits: &mut Digits,
    ) -> Result<[f64; 3], Error> {
        let mut point = [0.0; 3];
        for value in &mut point {
            let word = words.next();
            *value = match word.and_then(real) {
                Some(value) => value,
                None => self.number(word, "a coordinate")?,
            };
            digits.note(word.unwrap_or_default());
        }
        Ok(point)
    }
}

/// A number, or NaN for the words that programs write in place of one: `nan`, `-nan(ind)`, `1.#QNAN`.
pub fn real(word: &str) -> Option<f64> {
    word.parse().ok().or_else(|| {
        let word = word.trim_start_matches(['+', '-']);
        let is_nan = word
            .get(..3)
            .is_some_and(|start| start.eq_ignore_ascii_case("nan"));
        (is_nan || word.starts_with("1.#")).then_some(f64::NAN)
    })
}

/// A word as far as a message needs it.
pub fn shortened(word: &str) -> String {
    word.chars().take(40).collect()
}

/// The lines of a text that are not blank, ended by LF, CR LF, or the lone CR of old systems; what follows `#` is a
/// comment where the format has them.
pub fn lines(text: &str, comments: bool) -> impl Iterator<Item = Line<'_>> + Clone {
    let end = if text.contains('\n') { '\n' } else { '\r' };
    text.split(end)
        .enumerate()
        .filter_map(move |(index, text)| {
            let text = match text.find('#') {
                Some(end) if comments => text.get(..end).unwrap_or_default(),
                _ => text,
            };
            let text = text.trim();
            (!text.is_empty()).then_some(Line {
                number: index + 1,
                text,
            })
        })
}

/// Records of a text, one per line or all in one stream of words.
///
/// Most files have one line per record, often with more words than are needed. Some wrap lines, or have but one.
pub struct Records<'a, L> {
    lines: L,
    /// The line of the last word.
    pub line: Line<'a>,
    words: std::str::SplitAsciiWhitespace<'a>,
    /// Whether lines mean nothing.
    is_stream: bool,
}

impl<'a, L: Iterator<Item = Line<'a>>> Records<'a, L> {
    pub fn new(lines: L, is_stream: bool) -> Self {
        Self {
            lines,
            line: Line {
                number: 0,
                text: "",
            },
            words: "".split_ascii_whitespace(),
            is_stream,
        }
    }

    /// Goes to the next record, named `what` in messages.
    pub fn begin(&mut self, what: impl FnOnce() -> String) -> Result<(), Error> {
        if self.is_stream && self.words.clone().next().is_some() {
            return Ok(());
        }
        self.line = self
            .lines
            .next()
            .ok_or_else(|| broken(None, format!("the file ends where {} is needed", what())))?;
        self.words = self.line.words();
        Ok(())
    }

    /// Whether nothing is left.
    pub fn is_done(&mut self) -> bool {
        let rest = !self.is_stream || self.words.next().is_none();
        rest && self.lines.next().is_none()
    }
}

impl<'a, L: Iterator<Item = Line<'a>>> Iterator for Records<'a, L> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        let mut word = self.words.next();
        if word.is_none() && self.is_stream {
            self.line = self.lines.next()?;
            self.words = self.line.words();
            word = self.words.next();
        }
        word
    }
}

/// Reads records one per line, and if that fails or leaves lines over as a stream of words, by each of `attempts` in
/// turn, until one takes every word there is.
pub fn by_line_or_stream<'a, L, A, T>(
    lines: &L,
    by_line: A,
    attempts: &[A],
    read: impl Fn(&mut Records<'a, L>, &A) -> Result<T, Error>,
) -> Result<T, Error>
where
    L: Iterator<Item = Line<'a>> + Clone,
{
    let mut records = Records::new(lines.clone(), false);
    let found = read(&mut records, &by_line);
    if found.is_ok() && records.is_done() {
        return found;
    }
    for attempt in attempts {
        let mut records = Records::new(lines.clone(), true);
        if let Ok(found) = read(&mut records, attempt)
            && records.is_done()
        {
            return Ok(found);
        }
    }
    found
}
