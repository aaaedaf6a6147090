//! Tables that people fill in, as spreadsheets save them: which byte separates columns, and what a column is called.

/// The text without a byte order mark, and the byte that separates its columns.
pub fn plain(bytes: Vec<u8>) -> Result<(String, u8), String> {
    let text = String::from_utf8(bytes)
        .map_err(|_| "it is not text in UTF-8, as which spreadsheets can save it".to_owned())?;
    let mut text = match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    };
    let first = text.lines().next().unwrap_or_default().trim_end();
    if let Some([delimiter]) = first.strip_prefix("sep=").map(str::as_bytes) {
        let delimiter = *delimiter;
        // A comment, so that lines keep their numbers.
        text.replace_range(..1, "#");
        return Ok((text, delimiter));
    }
    let header = text
        .lines()
        .find(|line| !line.is_empty() && !line.starts_with('#'))
        .unwrap_or_default();
    let count = |byte: &u8| header.bytes().filter(|other| other == byte).count();
    // The last of equals is taken.
    let delimiter = *b"\t;,"
        .iter()
        .max_by_key(|&byte| count(byte))
        .unwrap_or(&b',');
    Ok((text, delimiter))
}

/// A column's name as options of the command line are spelled, but for `_` in place of `-`.
pub fn column_name(name: &str) -> String {
    name.to_lowercase().replace(['-', ' '], "_")
}
