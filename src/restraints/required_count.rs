//! How many of several restraints have to be satisfied.

use std::fmt;

use serde::{Deserialize, Serialize};

/// How many of several restraints have to be satisfied: a number of them, or a share.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum RequiredCount {
    /// A number, at least one.
    Count(usize),
    /// A share above 0, up to 1 for all.
    Share(f64),
}

/// The forms of its text.
const FORMS: &str = "a number of restraints such as 3, or a share of them such as 60% or 0.6";

impl RequiredCount {
    /// The number of `count` restraints that have to be satisfied, at least one if there are any. `None` if there are
    /// fewer.
    pub fn of(self, count: usize) -> Option<usize> {
        let needed = match self {
            Self::Count(needed) => needed,
            // Rounding must not add one, as for 0.6 of 5.
            Self::Share(share) => ((share * count as f64 - 1e-9).ceil() as usize).max(count.min(1)),
        };
        (needed <= count).then_some(needed)
    }
}

impl Default for RequiredCount {
    fn default() -> Self {
        Self::Share(1.0)
    }
}

impl TryFrom<String> for RequiredCount {
    type Error = &'static str;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        let share = |text: &str, whole: f64| {
            let share = text.trim().parse().map(|number: f64| number / whole);
            let share = share.ok().filter(|share| *share > 0.0 && *share <= 1.0);
            share.map(Self::Share).ok_or(FORMS)
        };
        match text.strip_suffix('%') {
            Some(percent) => share(percent, 100.0),
            None if text.contains('.') => share(&text, 1.0),
            None => match text.trim().parse() {
                Ok(0) | Err(_) => Err(FORMS),
                Ok(count) => Ok(Self::Count(count)),
            },
        }
    }
}

impl fmt::Display for RequiredCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(count) => count.fmt(f),
            Self::Share(share) => write!(f, "{}%", 100.0 * share),
        }
    }
}

impl From<RequiredCount> for String {
    fn from(needed: RequiredCount) -> Self {
        needed.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_shares_are_read_and_written() {
        for (text, of_five, written) in [
            ("3", Some(3), "3"),
            ("60%", Some(3), "60%"),
            ("0.6", Some(3), "60%"),
            ("61%", Some(4), "61%"),
            ("100%", Some(5), "100%"),
            ("0.001", Some(1), "0.1%"),
            ("6", None, "6"),
        ] {
            let needed = RequiredCount::try_from(text.to_owned()).unwrap();
            assert_eq!(needed.of(5), of_five, "{text}");
            assert_eq!(needed.to_string(), written);
            assert_eq!(written.to_owned().try_into(), Ok(needed));
        }
        assert_eq!(RequiredCount::default().of(0), Some(0));
        for text in [
            "", "0", "0%", "0.0", "-1", "101%", "1.5", "nan", "all", "3 of 5", "inf%",
        ] {
            let read = RequiredCount::try_from(text.to_owned());
            assert_eq!(read, Err(FORMS), "{text}");
        }
    }
}
