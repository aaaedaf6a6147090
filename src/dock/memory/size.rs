//! Sizes of memory as they are named to the user.

/// Steps in which a size is named, and twice what is left for the process's own size to vary, in bytes.
const NAMED_STEP: u64 = 1_000_000;

/// A limit to name for what is needed: whole megabytes, with room for what the process itself takes to vary.
pub fn named(needed: u64) -> u64 {
    needed
        .saturating_add(NAMED_STEP / 2)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::values::size;

    /// What is named can be pasted, and leaves half a megabyte.
    #[test]
    fn named_sizes_are_read_back() {
        for (needed, text) in [
            (1, "1M"),
            (499_999, "1M"),
            (500_001, "2M"),
            (84_500_000, "85M"),
        ] {
            assert_eq!(as_size(named(needed)), text);
            assert_eq!(size(text), Ok(named(needed)));
        }
        assert_eq!(named(u64::MAX), u64::MAX);
        assert_eq!(size(&as_size(12_345)), Ok(12_345));
    }
}
