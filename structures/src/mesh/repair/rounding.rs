//! Rounding of a file's numbers: the most that two copies of one vertex may differ by.
//!
//! The unit of rounding is the largest of these that holds, at the mesh's largest coordinate in magnitude:
//!
//! - the last digit written, in a text format;
//! - the last bit of a `float`, where all coordinates are `float`s (binary STL, most PLY) or have no more than nine
//!   digits;
//! - the last bit of a `double`.

/// Units of rounding by which two copies of a vertex may differ: one up, the other down.
const UNITS: f64 = 2.0;

/// Largest unit of rounding, as a share of the longest edge of the bounding box. Beyond it the digits say how coarse
/// the shape is, and not how much copies of a vertex differ: a cube from 0 to 10 is not rounded to whole numbers.
const LARGEST_UNIT: f64 = 1e-4;

/// Decimal digits that hold every `float`.
const FLOAT_DIGITS: i32 = 9;

/// Decades on either side of one that are distinguished.
const DECADES: i32 = 80;

/// The finest digit written, for each decade of the number that it belongs to.
#[derive(Clone, Debug)]
pub struct Digits {
    finest: Vec<i32>,
}

impl Default for Digits {
    fn default() -> Self {
        Self {
            finest: vec![i32::MAX; 2 * DECADES as usize + 1],
        }
    }
}

impl Digits {
    /// Takes note of a number as it is written.
    pub fn note(&mut self, word: &str) {
        let Some((lead, last)) = places(word) else {
            return;
        };
        let index = usize::try_from(lead + DECADES).ok();
        if let Some(finest) = index.and_then(|index| self.finest.get_mut(index)) {
            *finest = last.min(*finest);
        }
    }

    /// The decimal place of the last digit of the largest numbers, and how many digits these have; none but for text.
    ///
    /// A writer of a fixed number of digits drops zeros at the end, so numbers a tenth as large are looked at too.
    fn last_place(&self) -> Option<(i32, i32)> {
        let top = self.finest.iter().rposition(|&place| place != i32::MAX)?;
        let at = |index: Option<usize>| index.and_then(|index| self.finest.get(index)).copied();
        let below = at(top.checked_sub(1)).filter(|&place| place != i32::MAX);
        let place = at(Some(top))?.min(below.map_or(i32::MAX, |place| place + 1));
        Some((place, top as i32 - DECADES - place + 1))
    }
}

/// The decimal places of the first digit that is not zero and of the last one written: 1 and -2 of `-012.30`.
fn places(word: &str) -> Option<(i32, i32)> {
    let (mantissa, exponent) = match word.find(['e', 'E']) {
        Some(end) => (word.get(..end)?, word.get(end + 1..)?.parse().ok()?),
        None => (word, 0),
    };
    let mantissa = mantissa.trim_start_matches(['+', '-']);
    let point = mantissa.find('.').unwrap_or(mantissa.len()) as i32;
    let mut ends = None;
    let mut last = 0;
    for (index, byte) in (0..).zip(mantissa.bytes()) {
        if byte.is_ascii_digit() {
            last = if index < point {
                point - 1 - index
            } else {
                point - index
            };
            if byte != b'0' && ends.is_none() {
                ends = Some(last);
            }
        }
    }
    let shifted = |place: i32| place.saturating_add(exponent);
    Some((shifted(ends?), shifted(last)))
}

/// Largest difference between copies of one vertex along each axis; zero where the numbers are too coarse to say.
///
/// `extent` is the longest edge of the bounding box. It and the result are in the file's unit.
pub fn reach(positions: &[[f64; 3]], digits: &Digits, extent: f64) -> f64 {
    let coordinates = || positions.iter().flatten();
    let largest = coordinates().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let last_place = digits.last_place();
    let is_float = coordinates().all(|&value| f64::from(value as f32) == value)
        || last_place.is_some_and(|(_, count)| count <= FLOAT_DIGITS);
    // A power of two, at most the largest coordinate and more than half of it.
    let binade = f64::from_bits(largest.to_bits() & !((1 << 52) - 1));
    let bits = if is_float { 23 } else { 52 };
    let mut unit = binade * 2f64.powi(-bits);
    if let Some((place, _)) = last_place {
        let digit = 10f64.powi(place);
        if digit <= LARGEST_UNIT * extent {
            unit = unit.max(digit);
        }
    }
    if unit > LARGEST_UNIT * extent {
        return 0.0;
    }
    // Differences of decimal numbers are themselves rounded.
    UNITS * unit * (1.0 + 1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_of_digits() {
        for (word, expected) in [
            ("-012.30", Some((1, -2))),
            ("5", Some((0, 0))),
            ("100.", Some((2, 0))),
            (".5", Some((-1, -1))),
            ("+1.250e-3", Some((-3, -6))),
            ("0.000", None),
            ("nan", None),
            ("1e999999999999", None),
        ] {
            assert_eq!(places(word), expected, "{word}");
        }
    }

    /// Fixed decimals, six significant digits with zeros dropped, a `float` printed, a `double` printed, whole numbers.
    #[test]
    fn the_unit_follows_the_numbers() {
        let of = |words: &[&str]| {
            let mut digits = Digits::default();
            let values: Vec<f64> = words.iter().map(|word| word.parse().unwrap()).collect();
            for word in words {
                digits.note(word);
            }
            let positions: Vec<[f64; 3]> = values.iter().map(|&x| [x, 0.0, 0.0]).collect();
            let extent = values.iter().fold(0.0, |a: f64, &b| a.max(b));
            reach(&positions, &digits, extent) / UNITS
        };
        let about = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-5);
        about(of(&["0.100000", "103.250000", "0.000001"]), 2f64.powi(-17));
        about(of(&["0.1000", "103.2500", "0.0001"]), 1e-4);
        about(of(&["0.123456", "123.4", "98.1234"]), 1e-3);
        about(of(&["0.33333334", "1.5"]), 2f64.powi(-23));
        about(of(&["0.30000000000000004", "1.1"]), 2f64.powi(-52));
        about(of(&["0", "10", "7"]), 2f64.powi(-20));
    }
}
