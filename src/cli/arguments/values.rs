//! Values of options, checked as they are read.

use knotdock::mesh::MAX_PER_AXIS;

/// The field's count of rotations at an angle of 15 degrees.
const ROTATIONS_AT_15_DEGREES: f64 = 3600.0;

/// The number of rotations that the field takes for an angle in degrees: N = round(3600 (15/D)^3).
///
/// # Errors
/// When the angle is not above 0.1 (12 thousand million rotations) and at most 180 degrees.
pub fn rotations_of_angle(text: &str) -> Result<usize, String> {
    let angle = above_zero(text)?;
    if !(0.1..=180.0).contains(&angle) {
        return Err("the angle must lie between 0.1 and 180 degrees".to_owned());
    }
    let rotations = (ROTATIONS_AT_15_DEGREES * (15.0 / angle).powi(3)).round();
    Ok((rotations as usize).max(1))
}

/// A finite number above zero.
pub fn above_zero(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("a finite number above zero is needed".to_owned()),
    }
}

/// A time in seconds, from text such as `5s`, `90`, `2min` or `1h`.
pub fn duration(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let end = text
        .find(|c: char| c.is_ascii_alphabetic() && c != 'e')
        .unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let unit = match unit.trim() {
        "" | "s" => 1.0,
        "min" => 60.0,
        "h" => 3600.0,
        other => return Err(format!("`{other}` is no unit of time; write s, min or h")),
    };
    above_zero(number.trim())
        .map(|value| value * unit)
        .map_err(|_| "write a number above zero and a unit, such as 5s or 2min".to_owned())
}

/// A finite number, zero or above.
pub fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value + 0.0),
        _ => Err("a finite number, zero or above, is needed".to_owned()),
    }
}

/// Nodes an axis of a grid of M nodes, M given as 2^18 or 262144: the cube root, to the nearest whole number.
///
/// # Errors
/// When M is no whole number from 8 to 512^3.
pub fn grid(text: &str) -> Result<usize, String> {
    let nodes = match text.split_once('^') {
        Some((base, power)) => match (base.trim().parse::<u64>(), power.trim().parse::<u32>()) {
            (Ok(base), Ok(power)) => base.checked_pow(power),
            _ => None,
        },
        None => text.parse::<u64>().ok(),
    };
    let most = (MAX_PER_AXIS as u64).pow(3);
    match nodes.filter(|nodes| (8..=most).contains(nodes)) {
        Some(nodes) => Ok((nodes as f64).cbrt().round() as usize),
        None => Err(format!(
            "a whole number of nodes from 8 to {most} is needed, such as 2^18 or 262144"
        )),
    }
}

/// A protrusion factor, from 0 to 1.
pub fn protrusion(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value + 0.0),
        _ => Err("a number from 0 to 1 is needed".to_owned()),
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
        _ => Err("a number above 0 and up to 100 is needed".to_owned()),
    }
}

/// A whole number above zero.
pub fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(value) if value > 0 => Ok(value),
        _ => Err("a whole number above zero is needed".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_give_the_counts_of_the_field() {
        assert_eq!(rotations_of_angle("15"), Ok(3600));
        assert_eq!(rotations_of_angle("6"), Ok(56_250));
        assert_eq!(rotations_of_angle("180"), Ok(2));
        for text in ["0", "-15", "nan", "inf", "0.01", "200", "x"] {
            assert!(rotations_of_angle(text).is_err(), "{text}");
        }
    }

    #[test]
    fn times_have_units() {
        for (text, seconds) in [
            ("5s", 5.0),
            ("90", 90.0),
            ("1.5 min", 90.0),
            ("2h", 7200.0),
            ("1e2s", 100.0),
        ] {
            assert_eq!(duration(text), Ok(seconds), "{text}");
        }
        for text in ["", "s", "0s", "-5s", "5 parsecs", "inf", "nan"] {
            assert!(duration(text).is_err(), "{text}");
        }
    }

    #[test]
    fn grids_are_cubes() {
        for (text, per_axis) in [
            ("2^12", 16),
            ("2^21", 128),
            ("262144", 64),
            ("64^3", 64),
            ("1000", 10),
            ("8", 2),
        ] {
            assert_eq!(grid(text), Ok(per_axis), "{text}");
        }
        for text in ["", "7", "2^28", "9^99", "2^x", "-8", "1e6", "2^", "nan"] {
            assert!(grid(text).is_err(), "{text}");
        }
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
    }
}
