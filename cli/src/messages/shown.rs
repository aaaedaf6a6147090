//! Text as a terminal may show it: control characters escaped.
//!
//! The names and excerpts in messages come from files that may be anyone's. Written as they stand, an escape sequence
//! among them could clear the screen, retitle the window or hide the text before it.

use std::borrow::Cow;

/// Whether a character moves the cursor, changes the terminal, or turns the direction of writing.
fn is_active(character: char) -> bool {
    let is_own = matches!(character, '\n' | '\t');
    let turns = matches!(
        character,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
    );
    turns || character.is_control() && !is_own
}

pub fn shown(text: &str) -> Cow<'_, str> {
    escaped(text, |character| character.escape_unicode().to_string())
}

/// JSON text with those escaped that JSON allows in strings as they are.
pub fn shown_json(text: &str) -> Cow<'_, str> {
    escaped(text, |character| format!("\\u{:04x}", u32::from(character)))
}

fn escaped(text: &str, escape: impl Fn(char) -> String) -> Cow<'_, str> {
    if !text.contains(is_active) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len() + 16);
    for character in text.chars() {
        if is_active(character) {
            escaped.push_str(&escape(character));
        } else {
            escaped.push(character);
        }
    }
    Cow::Owned(escaped)
}

/// The name of a file on one line.
pub fn shown_name(name: &str) -> String {
    shown(name).replace('\n', "\\u{a}")
}

/// A word that a POSIX shell reads as the text itself: bare if possible, else in single quotes.
pub(crate) fn shell_word(text: &str) -> Cow<'_, str> {
    let is_bare = |c: char| c.is_alphanumeric() || "/._-+=:,@%".contains(c);
    match !text.is_empty() && text.chars().all(is_bare) {
        true => Cow::Borrowed(text),
        false => Cow::Owned(format!("'{}'", text.replace('\'', r"'\''"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_obeys_is_escaped_and_the_rest_stays() {
        let plain = "chain A: 3.5 Å²,\n\tand λ — done";
        assert!(matches!(shown(plain), Cow::Borrowed(text) if text == plain));
        for (text, expected) in [
            ("a\u{1b}[2Jb", "a\\u{1b}[2Jb"),
            ("a\rb\u{7}\u{8}", "a\\u{d}b\\u{7}\\u{8}"),
            ("\u{7f}\u{9b}31m", "\\u{7f}\\u{9b}31m"),
            ("a\u{202e}b\u{2066}", "a\\u{202e}b\\u{2066}"),
        ] {
            assert_eq!(shown(text), expected);
        }
        let name = "\u{1b}\u{9b}\u{202e}é";
        let object = serde_json::json!({ "a": name }).to_string();
        assert_eq!(shown_json(&object), r#"{"a":"\u001b\u009b\u202eé"}"#);
        let read: serde_json::Value = serde_json::from_str(&shown_json(&object)).unwrap();
        assert_eq!(read["a"], name);
        assert_eq!(shown_name("a\nerror: b"), "a\\u{a}error: b");
    }

    use proptest::prelude::*;

    #[test]
    fn plain_words_stay_as_they_are() {
        for plain in ["run", "a/b-2_c.pdb", "Å=1:2,3@4%+"] {
            assert_eq!(shell_word(plain), plain);
        }
        assert_eq!(shell_word("it's"), r"'it'\''s'");
        assert_eq!(shell_word(""), "''");
    }

    /// The shell itself reads each word back.
    #[cfg(unix)]
    #[test]
    fn a_shell_reads_the_text_back() {
        let texts = proptest::collection::vec(r#"[ -~\n\t]{0,20}|[^\x00]{0,8}"#, 20);
        proptest!(ProptestConfig::with_cases(8), |(texts in texts)| {
            let words: Vec<_> = texts.iter().map(|text| shell_word(text)).collect();
            let script = format!(r"printf '%s\0' {}", words.join(" "));
            let output = std::process::Command::new("sh").arg("-c").arg(script).output().unwrap();
            let read: Vec<&[u8]> = output.stdout.split_inclusive(|byte| *byte == 0).collect();
            let wanted: Vec<Vec<u8>> = texts.iter().map(|text| format!("{text}\0").into_bytes()).collect();
            prop_assert_eq!(read, wanted);
        });
    }
}
