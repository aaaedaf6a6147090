//! Bytes of a file as text, where they are text.

use std::borrow::Cow;

/// Share of control characters above which bytes are no text.
const MAX_CONTROL: f64 = 0.01;

/// Whether a byte is one that text does not have.
fn is_control(byte: u8) -> bool {
    matches!(byte, 0..=8 | 14..=31 | 127)
}

/// UTF-16 made UTF-8. It is detected by a mark at the start or by a zero in every other byte; other bytes as they are.
pub fn unified(bytes: &[u8]) -> Cow<'_, [u8]> {
    let (is_little, body) = match bytes {
        [0xff, 0xfe, 0, 0, ..] => return Cow::Borrowed(bytes),
        [0xff, 0xfe, body @ ..] => (true, body),
        [0xfe, 0xff, body @ ..] => (false, body),
        _ => {
            let start = bytes.get(..16).unwrap_or_default();
            let zeros = |first| {
                let all = start.iter().skip(first).step_by(2).all(|&byte| byte == 0);
                let others = start.iter().skip(1 - first).step_by(2);
                all && others.clone().all(|&byte| byte != 0 && byte < 128) && !start.is_empty()
            };
            match (zeros(1), zeros(0)) {
                (true, _) => (true, bytes),
                (_, true) => (false, bytes),
                _ => return Cow::Borrowed(bytes),
            }
        }
    };
    let units = body.chunks_exact(2).map(|pair| {
        let pair = [pair[0], pair[1]];
        if is_little {
            u16::from_le_bytes(pair)
        } else {
            u16::from_be_bytes(pair)
        }
    });
    let text: String = char::decode_utf16(units)
        .map(|character| character.unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect();
    Cow::Owned(text.into_bytes())
}

/// A file's text, without the byte order mark that some begin with, and with blanks for the few control characters that
/// get into one; none for bytes that are no text.
///
/// Bytes that are no UTF-8 stand only in names and comments of real files, so they are replaced and not refused.
pub fn text_of(bytes: &[u8]) -> Option<Cow<'_, str>> {
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    // Zeros fill the end of a file up, and the 26th character marked it in old systems.
    let end = bytes
        .iter()
        .rposition(|&byte| byte != 0 && byte != 26)
        .map_or(0, |last| last + 1);
    let bytes = bytes.get(..end).unwrap_or_default();
    let control = bytes.iter().filter(|&&byte| is_control(byte)).count();
    if control as f64 > MAX_CONTROL * bytes.len() as f64 {
        return None;
    }
    if control == 0 {
        return Some(String::from_utf8_lossy(bytes));
    }
    let blank = |&byte: &u8| if is_control(byte) { b' ' } else { byte };
    let bytes: Vec<u8> = bytes.iter().map(blank).collect();
    Some(Cow::Owned(String::from_utf8_lossy(&bytes).into_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn utf16_is_read_with_and_without_its_mark() {
        let text = "solid a\nfacet\u{e9}";
        for little in [true, false] {
            let bytes: Vec<u8> = text
                .encode_utf16()
                .flat_map(|unit| {
                    if little {
                        unit.to_le_bytes()
                    } else {
                        unit.to_be_bytes()
                    }
                })
                .collect();
            assert_eq!(unified(&bytes), text.as_bytes());
            let mark = if little { [0xff, 0xfe] } else { [0xfe, 0xff] };
            assert_eq!(unified(&[&mark[..], &bytes].concat()), text.as_bytes());
        }
        assert_eq!(unified(text.as_bytes()), text.as_bytes());
        assert_eq!(unified(&[0; 32])[..], [0; 32]);
    }

    #[test]
    fn text_may_hold_a_few_control_characters() {
        assert_eq!(text_of(b"solid\0\0\0\x1a").as_deref(), Some("solid"));
        let long = "v 1 2 3\n".repeat(30);
        let marred = format!("{long}\0{long}");
        assert_eq!(
            text_of(marred.as_bytes()),
            Some(format!("{long} {long}").into())
        );
        assert_eq!(text_of(b"solid\0\0\x01\x02\x03x"), None);
        assert_eq!(text_of(b"").as_deref(), Some(""));
    }
}
