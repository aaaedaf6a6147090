//! CIF 1.1 tokens with their lines (Hall, Allen and Brown 1991; IUCr, CIF 1.1 syntax).

use crate::molecule::read::source::lines;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Token<'a> {
    pub(crate) line: usize,
    pub(crate) kind: Kind<'a>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind<'a> {
    /// `data_NAME`, with the name.
    Data(&'a str),
    /// `loop_`.
    Loop,
    /// `_category.item`, with the underscore.
    Tag(&'a str),
    /// A bare value; `.` and `?` mean that there is none.
    Bare(&'a str),
    /// A value in quotes, or a text field.
    Quoted(&'a str),
    /// A quote or a text field that is never closed.
    Unclosed,
}

impl<'a> Kind<'a> {
    /// The text of a value; `None` for `.`, `?` and other tokens.
    pub(crate) fn value(self) -> Option<&'a str> {
        match self {
            Self::Bare("." | "?") => None,
            Self::Bare(text) | Self::Quoted(text) => Some(text.trim()),
            _ => None,
        }
    }
}

/// Walks over the tokens of a CIF text, without copying it.
///
/// A text field (lines from one that starts with `;` to the next that does) is one quoted value, line ends within it
/// included.
pub(crate) fn tokens(text: &str) -> impl Iterator<Item = Token<'_>> {
    let mut source = lines(text);
    // Lines are pieces of the text: where one starts determines what lies between two.
    let text_start =
        move |line: &str| (line.as_ptr() as usize).wrapping_sub(text.as_ptr() as usize);
    let between = move |start: usize, end: usize| {
        let field = text.get(start..end).unwrap_or("");
        field.trim_end_matches(['\r', '\n'])
    };
    let mut rest: (usize, &str) = (0, "");
    std::iter::from_fn(move || {
        loop {
            let (line, remaining) = rest;
            let start = remaining.trim_start_matches([' ', '\t']);
            if start.is_empty() || start.starts_with('#') {
                let (line, text) = source.next()?;
                if let Some(head) = text.strip_prefix(';') {
                    rest = (line, "");
                    let closing = source.find(|(_, text)| text.starts_with(';'));
                    let kind = match closing {
                        Some((end, closing)) => {
                            rest = (end, closing.get(1..).unwrap_or(""));
                            Kind::Quoted(between(text_start(head), text_start(closing)))
                        }
                        None => Kind::Unclosed,
                    };
                    return Some(Token { line, kind });
                }
                rest = (line, text);
                continue;
            }
            let (kind, after) = match start.chars().next() {
                Some(quote @ ('\'' | '"')) => quoted(start, quote),
                _ => bare(start),
            };
            rest = (line, after);
            return Some(Token { line, kind });
        }
    })
}

/// A quoted value: the quote closes only before a blank or the end of the line, so that `'a'b'` is `a'b`.
fn quoted(start: &str, quote: char) -> (Kind<'_>, &str) {
    let body = start.get(1..).unwrap_or("");
    for (at, _) in body.match_indices(quote) {
        let after = body.get(at + 1..).unwrap_or("");
        if after.is_empty() || after.starts_with([' ', '\t']) {
            return (Kind::Quoted(body.get(..at).unwrap_or("")), after);
        }
    }
    (Kind::Unclosed, "")
}

fn bare(start: &str) -> (Kind<'_>, &str) {
    let end = start.find([' ', '\t']).unwrap_or(start.len());
    let (word, after) = start.split_at(end);
    let starts = |keyword: &str| {
        word.get(..keyword.len())
            .is_some_and(|head| head.eq_ignore_ascii_case(keyword))
    };
    let kind = if word.starts_with('_') {
        Kind::Tag(word)
    } else if starts("data_") {
        Kind::Data(word.get("data_".len()..).unwrap_or(""))
    } else if word.eq_ignore_ascii_case("loop_") {
        Kind::Loop
    } else {
        Kind::Bare(word)
    };
    (kind, after)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_text_fields_and_comments() {
        let text = "data_X # c\n_a.b 'O5'' \"it's\"\n;text\nloop_\n; 7\nLOOP_\n? . 'open";
        let found: Vec<_> = tokens(text).map(|token| (token.line, token.kind)).collect();
        assert_eq!(
            found,
            [
                (1, Kind::Data("X")),
                (2, Kind::Tag("_a.b")),
                (2, Kind::Quoted("O5'")),
                (2, Kind::Quoted("it's")),
                (3, Kind::Quoted("text\nloop_")),
                (5, Kind::Bare("7")),
                (6, Kind::Loop),
                (7, Kind::Bare("?")),
                (7, Kind::Bare(".")),
                (7, Kind::Unclosed),
            ]
        );
    }

    #[test]
    fn an_unclosed_text_field_says_where_it_starts() {
        let found: Vec<_> = tokens("_a.b\n;never\nclosed").collect();
        assert_eq!(
            found.last(),
            Some(&Token {
                line: 2,
                kind: Kind::Unclosed
            })
        );
    }
}
