//! Words of a shell command, as a run prints commands to copy.

use std::borrow::Cow;

/// A word that a POSIX shell reads as the text itself: bare if nothing in it means anything to a shell, else in single
/// quotes.
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
    use proptest::prelude::*;

    #[test]
    fn plain_words_stay_as_they_are() {
        for plain in ["run", "a/b-2_c.pdb", "Å=1:2,3@4%+"] {
            assert_eq!(shell_word(plain), plain);
        }
        assert_eq!(shell_word("it's"), r"'it'\''s'");
        assert_eq!(shell_word(""), "''");
    }

    /// The shell itself says what a word means to it.
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
