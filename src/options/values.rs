//! Values of options: numbers in a range, counts, angles, times and sizes.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use knotdock_structures::{Error, LARGEST_LENGTH};

use super::definition::Rule;

/// Numbers that an option may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    low: f64,
    high: f64,
    /// Whether `low` itself is out of range.
    is_open: bool,
}

/// Finite numbers above zero.
pub const ABOVE_ZERO: Range = Range::above(0.0, f64::MAX);
/// Finite numbers, zero or above.
pub const NOT_NEGATIVE: Range = Range::between(0.0, f64::MAX);
/// Shares: above zero and at most one.
pub const SHARE: Range = Range::above(0.0, 1.0);
/// Lengths of either sign.
pub const LENGTH: Range = Range::between(-LARGEST_LENGTH, LARGEST_LENGTH);
/// Lengths, zero or above.
pub const DISTANCE: Range = Range::between(0.0, LARGEST_LENGTH);
/// Counts of one or more.
pub const AT_LEAST_ONE: Range = Range::between(1.0, f64::MAX);

impl Range {
    /// Numbers from `low` to `high`.
    pub const fn between(low: f64, high: f64) -> Self {
        Self {
            low,
            high,
            is_open: false,
        }
    }

    /// Numbers above `low` and up to `high`.
    pub const fn above(low: f64, high: f64) -> Self {
        Self {
            is_open: true,
            ..Self::between(low, high)
        }
    }

    fn contains(self, value: f64) -> bool {
        let is_above = value > self.low || (!self.is_open && value == self.low);
        is_above && value <= self.high
    }
}

impl fmt::Display for Range {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { low, high, is_open } = self;
        let number = |value: f64| match value.abs() {
            0.0 => "0".to_owned(),
            1e-3..1e9 => value.to_string(),
            _ => format!("{value:e}"),
        };
        let (low, is_bounded, high) = (number(*low), *high < f64::MAX, number(*high));
        match (is_open, is_bounded) {
            (true, true) => write!(to, "above {low} and at most {high}"),
            (true, false) => write!(to, "above {low}"),
            (false, true) => write!(to, "between {low} and {high}"),
            (false, false) => write!(to, "of {low} or more"),
        }
    }
}

/// Types of numbers that options have.
pub trait Number: FromStr + fmt::Display + Copy {
    /// The kind of number.
    const KIND: &'static str;

    /// The number as a float, to be compared with a range.
    fn float(self) -> f64;

    /// The number without the sign of a zero.
    fn plain(self) -> Self {
        self
    }
}

impl Number for f64 {
    const KIND: &'static str = "a finite number";

    fn float(self) -> f64 {
        self
    }

    // A negative zero would be written as one.
    fn plain(self) -> Self {
        self + 0.0
    }
}

impl Number for usize {
    const KIND: &'static str = "a whole number";

    fn float(self) -> f64 {
        self as f64
    }
}

impl<N: Number> Rule<N> for Range {
    fn read(&self, text: &str, _: &Path) -> Result<N, Error> {
        let value: Option<N> = text.parse().ok();
        let value = value.filter(|value| self.contains(value.float()));
        let refused = || Error::input(format!("it must be {} {self}", N::KIND));
        value.map(N::plain).ok_or_else(refused)
    }

    fn check(&self, value: &N) -> Result<(), Error> {
        match self.contains(value.float()) {
            true => Ok(()),
            false => Err(Error::input(format!("it must be {} {self}", N::KIND))),
        }
    }

    fn text(&self, value: &N) -> Option<String> {
        Some(value.to_string())
    }
}

/// The parser of numbers in a range, for arguments of command lines.
pub fn in_range<N: Number>(
    range: Range,
) -> impl Fn(&str) -> Result<N, Error> + Clone + Send + Sync + 'static {
    move |text| range.read(text, Path::new(""))
}

/// Numbers of rotations, each written as a number or as an angle, such as 15deg.
pub(super) struct Rotations(pub(super) Range);

impl Rule<usize> for Rotations {
    fn read(&self, text: &str, folder: &Path) -> Result<usize, Error> {
        let Some(angle) = text.strip_suffix("deg") else {
            let count = self.0.read(text, folder);
            return count.map_err(|error: Error| {
                Error::input(format!("{error}, or an angle such as 15deg"))
            });
        };
        let degrees: f64 = ABOVE_ZERO.read(angle, folder)?;
        let rotations = rotations_of_angle(degrees)
            .ok_or_else(|| Error::input("the angle must lie between 0.1 and 180 degrees"))?;
        self.check(&rotations).map(|()| rotations).map_err(|_| {
            let most = self.0.high as usize;
            Error::input(format!(
                "it must be an angle of at least {:.2} degrees, for {angle} degrees stand for {rotations} rotations \
                 and at most {most} are searched",
                angle_of_rotations(most),
            ))
        })
    }

    fn check(&self, rotations: &usize) -> Result<(), Error> {
        self.0.check(rotations)
    }

    fn text(&self, rotations: &usize) -> Option<String> {
        Some(rotations.to_string())
    }
}

/// The field's count of rotations at an angle of 15 degrees.
const ROTATIONS_AT_15_DEGREES: f64 = 3600.0;

/// The number of rotations of the field for an angle in degrees: N = round(3600 (15/D)^3). `None` unless the
/// angle is at least 0.1 (12 thousand million rotations) and at most 180.
pub fn rotations_of_angle(angle: f64) -> Option<usize> {
    let rotations = (ROTATIONS_AT_15_DEGREES * (15.0 / angle).powi(3)).round();
    let is_angle = (0.1..=180.0).contains(&angle);
    is_angle.then_some((rotations as usize).max(1))
}

/// The angle in degrees that stands for a number of rotations, rounded up to hundredths.
pub fn angle_of_rotations(rotations: usize) -> f64 {
    let angle = 15.0 * (ROTATIONS_AT_15_DEGREES / rotations.max(1) as f64).cbrt();
    (100.0 * angle).ceil() / 100.0
}

/// The exponent of the bump kernel, `inf` included.
pub(super) struct Exponent;

impl Rule<f64> for Exponent {
    fn read(&self, text: &str, _: &Path) -> Result<f64, Error> {
        knotdock_scoring::kernel::exponent::parse(text).map_err(Error::input)
    }

    fn check(&self, alpha: &f64) -> Result<(), Error> {
        match *alpha > 0.0 {
            true => Ok(()),
            false => Err(Error::input("it must be a finite number above 0, or inf")),
        }
    }

    fn text(&self, alpha: &f64) -> Option<String> {
        Some(alpha.to_string())
    }
}

/// A size in bytes.
pub(super) struct Size;

impl Rule<u64> for Size {
    fn read(&self, text: &str, _: &Path) -> Result<u64, Error> {
        size(text).map_err(Error::input)
    }

    fn text(&self, bytes: &u64) -> Option<String> {
        Some(bytes.to_string())
    }
}

/// A number of things, or all of them (`None`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AllOr(pub Option<usize>);

/// A whole number above zero, or `all`.
pub fn all_or_at_least_one(text: &str) -> Result<AllOr, Error> {
    if text == "all" {
        return Ok(AllOr(None));
    }
    let count = in_range(AT_LEAST_ONE)(text).map(|count| AllOr(Some(count)));
    count.map_err(|error| Error::input(format!("{error}, or `all`")))
}

/// A number and the unit after it, which begins at the first character for which `is_unit` holds.
fn split_unit(text: &str, is_unit: impl Fn(char) -> bool) -> (&str, &str) {
    let text = text.trim();
    let (number, unit) = text.split_at(text.find(is_unit).unwrap_or(text.len()));
    (number.trim(), unit.trim())
}

/// A time in seconds, from text such as `5`, `5s`, `2min` or `1h`; a bare number is seconds, and a run says so.
pub fn duration(text: &str) -> Result<f64, String> {
    let (digits, unit) = split_unit(text, |c| c.is_ascii_alphabetic() && c != 'e');
    let unit = match unit {
        "" | "s" => 1.0,
        "us" | "µs" => 1e-6,
        "ms" => 1e-3,
        "min" => 60.0,
        "h" => 3600.0,
        other => {
            return Err(format!(
                "`{other}` is no unit of time; write us, ms, s, min or h"
            ));
        }
    };
    in_range::<f64>(ABOVE_ZERO)(digits)
        .map(|value| (value * unit).min(LONGEST))
        .map_err(|_| "write a number above zero and a unit, such as 5s or 2min".to_owned())
}

/// Seconds after which no run ends; longer times are no limits either, and clocks can add this one.
const LONGEST: f64 = 1e9;

/// A size in bytes from text such as `800000000`, `1.5G` (1000^3) or `512MiB` (1024^2).
pub fn size(text: &str) -> Result<u64, String> {
    let (digits, unit) = split_unit(text, |c| !c.is_ascii_digit() && c != '.');
    let scale = match unit.to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "k" | "kb" => 1e3,
        "m" | "mb" => 1e6,
        "g" | "gb" => 1e9,
        "t" | "tb" => 1e12,
        "ki" | "kib" => 1024.0,
        "mi" | "mib" => 1024.0 * 1024.0,
        "gi" | "gib" => 1024.0 * 1024.0 * 1024.0,
        "ti" | "tib" => 1024.0 * 1024.0 * 1024.0 * 1024.0,
        unit => {
            return Err(format!(
                "`{unit}` is no unit; write bytes, K, M, G, KiB, MiB or GiB"
            ));
        }
    };
    let number: f64 = digits
        .parse()
        .map_err(|_| "write a number and a unit, such as 800M or 4GiB".to_owned())?;
    let bytes = number * scale;
    if bytes < 1.0 || bytes >= u64::MAX as f64 {
        return Err("the size must be at least one byte and below 2^64".to_owned());
    }
    Ok(bytes as u64)
}

/// A count of at least one, or `all`, which is `None`.
pub(super) struct CountOrAll;

impl Rule<Option<usize>> for CountOrAll {
    fn read(&self, text: &str, _: &Path) -> Result<Option<usize>, Error> {
        all_or_at_least_one(text).map(|AllOr(count)| count)
    }

    fn check(&self, count: &Option<usize>) -> Result<(), Error> {
        count.map_or(Ok(()), |count| AT_LEAST_ONE.check(&count))
    }

    fn text(&self, count: &Option<usize>) -> Option<String> {
        Some(count.map_or_else(|| "all".to_owned(), |count| count.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read<T>(rule: &impl Rule<T>, text: &str) -> Result<T, String> {
        let read = rule.read(text, Path::new(""));
        read.map_err(|error| error.to_string())
    }

    #[test]
    fn angles_give_the_counts_of_the_field() {
        let rotations = |text: &str| read(&Rotations(Range::between(1.0, 1e7)), text);
        // An angle out of range was answered with "a whole number between 1 and 10000000".
        let least = rotations("1deg").unwrap_err();
        assert!(
            least.contains("an angle of at least 1.07 degrees"),
            "{least}"
        );
        assert!(rotations("1.07deg").is_ok());
        assert_eq!(angle_of_rotations(3600), 15.0);
        for (text, count) in [("17", 17), ("15deg", 3600), ("6deg", 56_250), ("180deg", 2)] {
            assert_eq!(rotations(text), Ok(count), "{text}");
        }
        for text in [
            "0", "0deg", "15 rad", "deg", "10000001", "-3", "1.5", "-15deg", "nandeg", "infdeg",
            "0.01deg", "200deg",
        ] {
            assert!(rotations(text).is_err(), "{text}");
        }
    }

    #[test]
    fn times_have_units() {
        for (text, seconds) in [
            ("5s", 5.0),
            ("1.5 min", 90.0),
            ("2h", 7200.0),
            ("1e2s", 100.0),
            ("90", 90.0),
            ("1e2", 100.0),
        ] {
            assert_eq!(duration(text), Ok(seconds), "{text}");
        }
        for text in ["", "s", "0s", "-5s", "5 parsecs", "inf", "nan"] {
            assert!(duration(text).is_err(), "{text}");
        }
    }

    #[test]
    fn sizes_are_decimal_or_binary_as_written() {
        for (text, bytes) in [
            ("123", 123),
            ("4G", 4_000_000_000),
            ("1.5 kB", 1_500),
            ("512MiB", 512 << 20),
            ("2gib", 2 << 30),
        ] {
            assert_eq!(size(text), Ok(bytes), "{text}");
        }
        for text in [
            "",
            "G",
            "-1G",
            "1.2.3",
            "4 parsecs",
            "0",
            "1e9",
            "99999999T",
        ] {
            assert!(size(text).is_err(), "{text}");
        }
    }

    #[test]
    fn numbers_out_of_range_are_refused_and_zeros_have_no_sign() {
        let real = |range: Range, text: &str| read::<f64>(&range, text);
        for text in ["nan", "inf", "-1", "", "1e999"] {
            assert!(real(ABOVE_ZERO, text).is_err(), "{text}");
            assert!(real(NOT_NEGATIVE, text).is_err(), "{text}");
        }
        assert_eq!(
            real(ABOVE_ZERO, "0"),
            Err("it must be a finite number above 0".to_owned())
        );
        assert_eq!(
            real(SHARE, "1.1"),
            Err("it must be a finite number above 0 and at most 1".to_owned())
        );
        assert_eq!(
            read::<usize>(&AT_LEAST_ONE, "0"),
            Err("it must be a whole number of 1 or more".to_owned())
        );
        assert_eq!(real(NOT_NEGATIVE, "-0").map(f64::to_bits), Ok(0));
        let ph = Range::between(0.0, 14.0);
        for text in ["nan", "-1", "14.1", "", "inf"] {
            assert!(real(ph, text).is_err(), "{text}");
        }
        assert_eq!(real(ph, "-0").map(f64::to_bits), Ok(0));
        assert!(Rule::<f64>::check(&ph, &f64::NAN).is_err());
        assert!(["0", "nan"].iter().all(|text| real(SHARE, text).is_err()));
    }
}
