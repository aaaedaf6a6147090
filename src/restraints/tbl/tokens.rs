//! Words and signs of a `.tbl` file, with their places.

use knotdock_structures::Error;

use crate::table_text::named_columns::shortened;

/// A word or a sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Token<'a> {
    Open,
    Close,
    Colon,
    /// A keyword, a name or a number.
    Word(&'a str),
    /// A word between double quotes: wildcards in it are plain characters.
    Quoted(&'a str),
}

impl Token<'_> {
    /// As a message names it.
    pub(super) fn shown(self) -> String {
        match self {
            Self::Open => "`(`".to_owned(),
            Self::Close => "`)`".to_owned(),
            Self::Colon => "`:`".to_owned(),
            Self::Word(word) | Self::Quoted(word) => format!("`{}`", shortened(word)),
        }
    }

    /// Whether it is this keyword, of which at least the first four letters are needed.
    pub(super) fn is_keyword(self, keyword: &str) -> bool {
        let Self::Word(word) = self else {
            return false;
        };
        let start = keyword.get(..word.len());
        word.len() >= keyword.len().min(4)
            && start.is_some_and(|start| start.eq_ignore_ascii_case(word))
    }
}

/// Place of a token in the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// Byte of the text.
    pub(super) byte: usize,
    /// 1-based line.
    pub(super) line: u64,
    /// 1-based character of the line.
    pub(super) column: usize,
}

impl Place {
    /// An error with this place.
    pub(super) fn fault(self, error: Error) -> Error {
        let message = format!("{error} (column {})", self.column);
        Error::input(message)
            .on_line(self.line)
            .help(error.remedy().unwrap_or_default())
    }
}

/// A token that does not continue a statement.
pub(super) fn unexpected(expected: &str, found: &str) -> Error {
    Error::input(format!("there must be {expected}, not {found}")).help(
        "write `assign (selection) (selection) distance minus plus`. A selection is made of resid, resname, name, \
         segid, chain, atom, hydrogen, all, and, or, not and parentheses",
    )
}

/// A comment or a quoted word that does not end.
fn unclosed(part: &str) -> Error {
    Error::input(format!("the {part} that begins here does not end"))
        .help("close it: a comment with }, a quoted word with \" on its line")
}

/// Reads tokens one by one: a list of all would be many times as large as the file.
pub(super) struct Tokens<'a> {
    text: &'a str,
    place: Place,
}

impl<'a> Tokens<'a> {
    /// The tokens of a text whose lines end with LF.
    pub(super) fn new(text: &'a str) -> Self {
        let place = Place {
            byte: 0,
            line: 1,
            column: 1,
        };
        Self { text, place }
    }

    /// The text from one byte to another.
    pub(super) fn between(&self, from: usize, to: usize) -> &'a str {
        self.text.get(from..to).unwrap_or_default()
    }

    /// End of the last token.
    pub(super) fn place(&self) -> Place {
        self.place
    }

    /// The next token and its place; none at the end.
    pub(super) fn next(&mut self) -> Result<Option<(Token<'a>, Place)>, Error> {
        self.skip_blanks()?;
        let place = self.place;
        let Some(first) = self.rest().chars().next() else {
            return Ok(None);
        };
        let token = match first {
            '(' => self.sign(Token::Open),
            ')' => self.sign(Token::Close),
            ':' => self.sign(Token::Colon),
            '"' => self.quoted()?,
            '}' => return Err(place.fault(unexpected("a { before it", "`}`"))),
            _ => Token::Word(self.take_until(|c| c.is_whitespace() || "():\"!{}=".contains(c))),
        };
        Ok(Some((token, place)))
    }

    /// Passes over the next token if it is of a kind; whether it is.
    pub(super) fn skip(&mut self, is_of_kind: impl Fn(Token) -> bool) -> Result<bool, Error> {
        let before = self.place;
        let is_skipped = self.next()?.is_some_and(|(token, _)| is_of_kind(token));
        if !is_skipped {
            self.place = before;
        }
        Ok(is_skipped)
    }

    /// Passes over blanks and comments. `=` is a blank, too: `resid = 10` is `resid 10`.
    fn skip_blanks(&mut self) -> Result<(), Error> {
        loop {
            let place = self.place;
            match self.rest().chars().next() {
                Some('!') => {
                    self.take_until(|c| c == '\n');
                }
                Some('{') => {
                    self.take_until(|c| c == '}');
                    if self.rest().is_empty() {
                        return Err(place.fault(unclosed("comment")));
                    }
                    self.step();
                }
                Some(c) if c.is_whitespace() || c == '=' => self.step(),
                _ => return Ok(()),
            }
        }
    }

    /// A word in quotes, which ends on its line.
    fn quoted(&mut self) -> Result<Token<'a>, Error> {
        let place = self.place;
        self.step();
        let word = self.take_until(|c| c == '"' || c == '\n');
        if !self.rest().starts_with('"') {
            return Err(place.fault(unclosed("quoted word")));
        }
        self.step();
        Ok(Token::Quoted(word.trim()))
    }

    fn sign(&mut self, token: Token<'a>) -> Token<'a> {
        self.step();
        token
    }

    fn rest(&self) -> &'a str {
        self.text.get(self.place.byte..).unwrap_or_default()
    }

    /// Passes over characters up to one that ends them.
    fn take_until(&mut self, ends: impl Fn(char) -> bool) -> &'a str {
        let from = self.place.byte;
        while self.rest().chars().next().is_some_and(|c| !ends(c)) {
            self.step();
        }
        self.between(from, self.place.byte)
    }

    /// Passes over a character.
    fn step(&mut self) {
        let Some(passed) = self.rest().chars().next() else {
            return;
        };
        self.place.byte += passed.len_utf8();
        if passed == '\n' {
            self.place.line += 1;
            self.place.column = 1;
        } else {
            self.place.column += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Placed<'a> = (Token<'a>, (u64, usize));

    fn all(text: &str) -> Result<Vec<Placed<'_>>, Error> {
        let mut tokens = Tokens::new(text);
        let mut all = Vec::new();
        while let Some((token, place)) = tokens.next()? {
            all.push((token, (place.line, place.column)));
        }
        Ok(all)
    }

    #[test]
    fn words_and_signs_have_places() {
        let text = "assign!(x\n {a\n) !} (resid=10:20)\"A :(\" é O5'";
        let expected = [
            (Token::Word("assign"), (1, 1)),
            (Token::Open, (3, 6)),
            (Token::Word("resid"), (3, 7)),
            (Token::Word("10"), (3, 13)),
            (Token::Colon, (3, 15)),
            (Token::Word("20"), (3, 16)),
            (Token::Close, (3, 18)),
            (Token::Quoted("A :("), (3, 19)),
            (Token::Word("é"), (3, 26)),
            (Token::Word("O5'"), (3, 28)),
        ];
        assert_eq!(all(text).unwrap(), expected);
    }

    #[test]
    fn what_does_not_end_is_refused_where_it_begins() {
        for (text, line, message) in [
            (
                "a {b\nc",
                1,
                "the comment that begins here does not end (column 3)",
            ),
            (
                "a\n \"b\n\"",
                2,
                "the quoted word that begins here does not end (column 2)",
            ),
        ] {
            let error = all(text).unwrap_err();
            assert_eq!((error.line(), error.message()), (Some(line), message));
        }
        assert!(all("}").is_err());
    }

    #[test]
    fn keywords_may_be_cut_to_four_letters() {
        for word in ["resi", "RESID", "Residue"] {
            assert!(Token::Word(word).is_keyword("residue"));
        }
        for word in ["res", "resn", "residues", "résidu", ""] {
            assert!(!Token::Word(word).is_keyword("residue"));
        }
        assert!(Token::Word("OR").is_keyword("or"));
        assert!(!Token::Word("o").is_keyword("or"));
        assert!(!Token::Quoted("or").is_keyword("or"));
    }
}
