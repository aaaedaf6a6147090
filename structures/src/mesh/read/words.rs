//! Lines of words of a text format, with their numbers, and numbers of words.

use std::borrow::Cow;

use super::super::error::MeshErrorKind;

/// A file's text, without the byte order mark that some begin with.
pub fn text_of(bytes: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes))
}

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
    pub fn fault(&self, what: impl Into<String>) -> MeshErrorKind {
        MeshErrorKind::Syntax {
            line: Some(self.number),
            what: what.into(),
        }
    }

    /// A number, whatever it is; the caller says what it is for.
    pub fn number<T: std::str::FromStr>(
        &self,
        word: Option<&str>,
        what: &str,
    ) -> Result<T, MeshErrorKind> {
        let word =
            word.ok_or_else(|| self.fault(format!("the line ends where {what} is needed")))?;
        word.parse().map_err(|_| {
            self.fault(format!(
                "'{}' stands where {what} is needed",
                shortened(word)
            ))
        })
    }

    /// Three coordinates from the next words.
    pub fn point<'w>(
        &self,
        words: &mut impl Iterator<Item = &'w str>,
    ) -> Result<[f64; 3], MeshErrorKind> {
        let mut point = [0.0; 3];
        for value in &mut point {
            *value = self.number(words.next(), "a coordinate")?;
        }
        Ok(point)
    }
}

/// A word as far as a message needs it.
fn shortened(word: &str) -> String {
    word.chars().take(40).collect()
}

/// The lines of a text that are not blank, ended by LF, CR LF, or the lone CR of old systems; what follows `#` is a comment where the format has them.
///
/// Bytes that are no UTF-8 stand only in names and comments of real files, so they are replaced and not refused.
pub fn lines(text: &str, comments: bool) -> impl Iterator<Item = Line<'_>> {
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
