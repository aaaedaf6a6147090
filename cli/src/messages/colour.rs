//! Colour, where the terminal has it: none in a pipe, with NO_COLOR or with TERM=dumb.

use std::borrow::Cow;
use std::io;

use anstream::{AutoStream, ColorChoice};
use anstyle::{AnsiColor, Style};

/// First words of messages, with their colours: those of clap's own errors.
const PAINTED: [(&str, AnsiColor); 2] =
    [("error:", AnsiColor::Red), ("warning:", AnsiColor::Yellow)];

/// A message for standard error, its first word in colour where colours are shown.
pub fn painted(text: &str) -> Cow<'_, str> {
    if AutoStream::choice(&io::stderr()) == ColorChoice::Never {
        return Cow::Borrowed(text);
    }
    in_colour(text)
}

fn in_colour(text: &str) -> Cow<'_, str> {
    for (word, colour) in PAINTED {
        if let Some(rest) = text.strip_prefix(word) {
            let style = Style::new().fg_color(Some(colour.into())).bold();
            return Cow::Owned(format!("{style}{word}{style:#}{rest}"));
        }
    }
    Cow::Borrowed(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_word_alone_has_a_colour() {
        let painted = in_colour("error: no warning: at all");
        assert_eq!(
            painted,
            "\u{1b}[1m\u{1b}[31merror:\u{1b}[0m no warning: at all"
        );
        assert_eq!(in_colour("no error: here"), "no error: here");
    }
}
