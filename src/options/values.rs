//! Values of options, checked as they are read.

use std::ops::RangeInclusive;

use knotdock_structures::LARGEST_LENGTH;

/// How ranges are stated.
pub(super) const BOUND: &str = "it must be ";

/// The field's count of rotations at an angle of 15 degrees.
const ROTATIONS_AT_15_DEGREES: f64 = 3600.0;

/// Numbers of rotations in a range, each written as a number or as an angle, such as 15deg.
pub fn rotations(
    range: RangeInclusive<usize>,
) -> impl Fn(&str) -> Result<usize, String> + Clone + Send + Sync + 'static {
    move |text| match text.strip_suffix("deg") {
        Some(angle) => match rotations_of_text(angle)? {
            rotations if range.contains(&rotations) => Ok(rotations),
            rotations => Err(format!(
                "it must be an angle of at least {:.2} degrees, for {angle} degrees stand for {rotations} rotations and at \
                 most {} are searched",
                angle_of_rotations(*range.end()),
                range.end()
            )),
        },
        None => count(range.clone())(text)
            .map_err(|error| format!("{error}, or an angle such as 15deg")),
    }
}

/// As [`rotations_of_angle`], of an angle as it is typed.
fn rotations_of_text(text: &str) -> Result<usize, String> {
    rotations_of_angle(above_zero(text)?)
        .ok_or_else(|| "the angle must lie between 0.1 and 180 degrees".to_owned())
}

/// The number of rotations that the field takes for an angle in degrees: N = round(3600 (15/D)^3). `None` unless the
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

/// Numbers in a range.
pub fn number(
    range: RangeInclusive<f64>,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text| match text.parse::<f64>() {
        // A negative zero would be written as one.
        Ok(value) if range.contains(&value) => Ok(value + 0.0),
        _ => Err(format!(
            "{BOUND}between {} and {}",
            range.start(),
            range.end()
        )),
    }
}

/// Whole numbers in a range.
pub fn count(
    range: RangeInclusive<usize>,
) -> impl Fn(&str) -> Result<usize, String> + Clone + Send + Sync + 'static {
    move |text| match text.parse::<usize>() {
        Ok(value) if range.contains(&value) => Ok(value),
        _ => Err(format!(
            "{BOUND}a whole number between {} and {}",
            range.start(),
            range.end()
        )),
    }
}

/// A share: a number above zero and at most one.
pub fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value <= 1.0 => Ok(value),
        _ => Err(format!("{BOUND}above 0 and at most 1")),
    }
}

/// A finite number above zero.
pub fn above_zero(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("it must be a finite number above zero".to_owned()),
    }
}

/// A time in seconds, from text such as `5`, `5s`, `2min` or `1h`; a bare number is seconds, and a run says so.
///
/// # Errors
/// What is wrong with the text.
pub fn duration(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let end = text
        .find(|c: char| c.is_ascii_alphabetic() && c != 'e')
        .unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let unit = match unit.trim() {
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
    above_zero(number.trim())
        .map(|value| (value * unit).min(LONGEST))
        .map_err(|_| "write a number above zero and a unit, such as 5s or 2min".to_owned())
}

/// Seconds after which no run ends; longer times are no limits either, and clocks can add this one.
const LONGEST: f64 = 1e9;

/// A finite number, zero or above.
pub fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value + 0.0),
        _ => Err("it must be a finite number, zero or above".to_owned()),
    }
}

/// A length of at most [`LARGEST_LENGTH`], of either sign.
pub fn length(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.abs() <= LARGEST_LENGTH => Ok(value + 0.0),
        _ => Err("it must be a finite number from -1e30 to 1e30".to_owned()),
    }
}

/// A length of at most [`LARGEST_LENGTH`], zero or above.
pub fn distance(text: &str) -> Result<f64, String> {
    match length(text) {
        Ok(value) if value >= 0.0 => Ok(value),
        _ => Err("it must be a finite number from 0 to 1e30".to_owned()),
    }
}

/// A protrusion factor, from 0 to 1.
pub fn protrusion(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value + 0.0),
        _ => Err("it must be between 0 and 1".to_owned()),
    }
}

/// The name of a biological assembly.
pub fn assembly_name(text: &str) -> Result<String, String> {
    let text = text.trim();
    if text.is_empty() {
        return Err("the name of an assembly is needed, such as 1".to_owned());
    }
    Ok(text.to_owned())
}

/// The name of a residue.
pub fn residue_name(text: &str) -> Result<String, String> {
    let text = text.trim();
    if text.is_empty() {
        return Err("the name of a residue is needed, such as HEM".to_owned());
    }
    Ok(text.to_owned())
}

/// A pLDDT, above 0 and up to 100.
pub fn plddt(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value <= 100.0 => Ok(value),
        _ => Err("it must be above 0 and up to 100".to_owned()),
    }
}

/// A whole number above zero.
pub fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(value) if value > 0 => Ok(value),
        _ => Err("it must be a whole number above zero".to_owned()),
    }
}

/// A number of things, or all of them (`None`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AllOr(pub Option<usize>);

/// A whole number above zero, or `all`.
///
/// # Errors
/// What is wrong with the text.
pub fn all_or_at_least_one(text: &str) -> Result<AllOr, String> {
    if text == "all" {
        return Ok(AllOr(None));
    }
    match at_least_one(text) {
        Ok(count) => Ok(AllOr(Some(count))),
        Err(error) => Err(format!("{error}, or `all`")),
    }
}

/// A size in bytes from text such as `800000000`, `1.5G` (1000^3) or `512MiB` (1024^2).
///
/// # Errors
/// What is wrong with the text.
pub fn size(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let end = text
        .find(|c: char| !c.is_ascii_digit() && c != '.')
        .unwrap_or(text.len());
    let (digits, unit) = text.split_at(end);
    let unit = unit.trim().to_ascii_lowercase();
    let scale = match unit.as_str() {
        "" | "b" => 1.0,
        "k" | "kb" => 1e3,
        "m" | "mb" => 1e6,
        "g" | "gb" => 1e9,
        "t" | "tb" => 1e12,
        "ki" | "kib" => 1024.0,
        "mi" | "mib" => 1024.0 * 1024.0,
        "gi" | "gib" => 1024.0 * 1024.0 * 1024.0,
        "ti" | "tib" => 1024.0 * 1024.0 * 1024.0 * 1024.0,
        _ => {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_give_the_counts_of_the_field() {
        let rotations = rotations(1..=10_000_000);
        // An angle out of range was answered with "a whole number between 1 and 10000000".
        let least = rotations("1deg").unwrap_err();
        assert!(
            least.contains("an angle of at least 1.07 degrees"),
            "{least}"
        );
        assert!(rotations("1.07deg").is_ok());
        assert_eq!(angle_of_rotations(3600), 15.0);
        assert_eq!(rotations("17"), Ok(17));
        assert_eq!(rotations("15deg"), Ok(3600));
        for text in ["0", "0deg", "15 rad", "deg", "10000001", "-3", "1.5"] {
            assert!(rotations(text).is_err(), "{text}");
        }
        assert_eq!(rotations_of_text("15"), Ok(3600));
        assert_eq!(rotations_of_text("6"), Ok(56_250));
        assert_eq!(rotations_of_text("180"), Ok(2));
        for text in ["0", "-15", "nan", "inf", "0.01", "200", "x"] {
            assert!(rotations_of_text(text).is_err(), "{text}");
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
    fn shares_of_one_and_of_a_hundred() {
        assert_eq!(protrusion("1"), Ok(1.0));
        assert_eq!(plddt("100"), Ok(100.0));
        for text in ["0", "-1", "100.1", "nan", ""] {
            assert!(plddt(text).is_err(), "{text}");
        }
        assert!(
            ["-0.1", "1.1", "nan", ""]
                .iter()
                .all(|text| protrusion(text).is_err())
        );
    }

    #[test]
    fn numbers_that_no_option_can_take_are_refused() {
        for text in ["nan", "inf", "-1", "", "1e999"] {
            assert!(above_zero(text).is_err(), "{text}");
            assert!(not_negative(text).is_err(), "{text}");
        }
        assert!(above_zero("0").is_err());
        assert_eq!(not_negative("-0").map(f64::to_bits), Ok(0));
        assert!(at_least_one("0").is_err());
        for text in ["nan", "-1", "14.1", "", "inf"] {
            assert!(number(0.0..=14.0)(text).is_err(), "{text}");
        }
        assert_eq!(number(0.0..=14.0)("-0").map(f64::to_bits), Ok(0));
        assert!(["0", "1.1", "nan"].iter().all(|text| share(text).is_err()));
    }
}
