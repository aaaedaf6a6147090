//! Sizes of memory in messages.

/// Steps of the sizes in messages, and twice the allowance for the process's own size, in bytes.
const NAMED_STEP: u64 = 1_000_000;

/// The inverse share of the needed memory that is the allowance for several reading threads.
const VARIES: u64 = 50;

/// A limit for a message about needed memory: whole megabytes, with the allowances.
pub fn named(needed: u64) -> u64 {
    needed
        .saturating_add(NAMED_STEP / 2 + needed / VARIES)
        .checked_next_multiple_of(NAMED_STEP)
        .unwrap_or(u64::MAX)
}

/// A size as `--memory` takes it.
pub fn as_size(bytes: u64) -> String {
    match bytes % NAMED_STEP {
        0 => format!("{}M", bytes / NAMED_STEP),
        _ => bytes.to_string(),
    }
}

/// A size in the unit that people use for it, to four digits: `87 MB`, or `512 MiB` for whole MiB.
pub fn in_words(bytes: u64) -> String {
    let is_binary = !bytes.is_multiple_of(NAMED_STEP) && bytes.is_multiple_of(1 << 20);
    let (step, units): (f64, [&str; 5]) = if is_binary {
        (1024.0, ["bytes", "KiB", "MiB", "GiB", "TiB"])
    } else {
        (1000.0, ["bytes", "kB", "MB", "GB", "TB"])
    };
    let (mut size, mut unit) = (bytes as f64, 0);
    while size >= step && unit + 1 < units.len() {
        (size, unit) = (size / step, unit + 1);
    }
    let decimals = 3usize.saturating_sub(size.max(1.0).log10() as usize);
    let text = format!("{size:.decimals$}");
    let text = match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    format!("{text} {}", units[unit])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::values::size;

    #[test]
    fn sizes_have_units() {
        for (bytes, text) in [
            (0, "0 bytes"),
            (999, "999 bytes"),
            (12_345, "12.35 kB"),
            (87_000_000, "87 MB"),
            (1_234_000_000, "1.234 GB"),
            (4_000_000_000, "4 GB"),
            (512 << 20, "512 MiB"),
            (256 << 30, "256 GiB"),
        ] {
            assert_eq!(in_words(bytes), text);
        }
    }

    /// What is named can be pasted, and leaves half a megabyte and 2%.
    #[test]
    fn named_sizes_are_read_back() {
        for (needed, text) in [
            (1, "1M"),
            (490_000, "1M"),
            (500_001, "2M"),
            (84_500_000, "87M"),
        ] {
            assert_eq!(as_size(named(needed)), text);
            assert_eq!(size(text), Ok(named(needed)));
        }
        assert_eq!(named(u64::MAX), u64::MAX);
        assert_eq!(size(&as_size(12_345)), Ok(12_345));
    }
}
