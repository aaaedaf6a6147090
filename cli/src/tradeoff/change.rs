//! Changes of single options: what settings of a sweep are made of.

use knotdock::options::definition::Definition;
use knotdock::options::{DockOptions, option_named};
use knotdock_structures::Error;

/// A change of one option.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Change {
    /// The option's name.
    option: &'static str,
    /// Its value as it is typed.
    value: String,
}

impl Change {
    /// The change of an option to a value.
    pub fn new(option: &'static str, value: impl ToString) -> Self {
        Self {
            option,
            value: value.to_string(),
        }
    }

    /// The options with the change.
    ///
    /// # Errors
    /// [`Error`] for a value out of range.
    pub fn apply(&self, options: &DockOptions) -> Result<DockOptions, Error> {
        let mut changed = options.with(self.option, &self.value)?;
        match self.option {
            // A pass length that was given goes along with the resolution, as the default one does.
            "resolution" => {
                let scale = changed.kernel.resolution / options.kernel.resolution;
                let length = &mut changed.kernel.pass_length;
                *length = length.map(|length| length * scale);
            }
            // A finer set is no coarser.
            "rotations" => {
                let rotations = changed.search.rotations;
                let finer = &mut changed.search.fine_rotations;
                *finer = finer.map(|finer| finer.max(rotations));
            }
            _ => {}
        }
        Ok(changed)
    }

    /// Further arguments that a run with the `default` options needs to have `changed` ones. They give lengths that
    /// would follow from the change otherwise, and a finer set of rotations that it has made finer still.
    pub fn companions(&self, default: &DockOptions, changed: &DockOptions) -> String {
        let (pass_length, finer) = (changed.kernel.pass_length, changed.search.fine_rotations);
        match (self.option, pass_length, finer) {
            ("resolution", Some(length), _) => format!(" --pass-length {length}"),
            ("rotations", _, Some(finer)) if default.search.fine_rotations != Some(finer) => {
                format!(" --fine-rotations {finer}")
            }
            ("sample_grid", ..) => format!(" --offset {}", changed.kernel.offset),
            _ => String::new(),
        }
    }

    /// As it is typed.
    pub fn argument(&self) -> String {
        let long = option_named(self.option).map_or(self.option, Definition::long);
        format!("--{long} {}", self.value)
    }
}

/// The nearest multiple of four, for rotations share their work in fours; at least four.
pub(super) fn rounded_to_fours(count: f64) -> usize {
    4 * ((count / 4.0).round() as usize).max(1)
}

/// A length above zero to three significant digits, so that it can be typed.
pub(super) fn three_digits(length: f64) -> f64 {
    let digits = 2 - length.log10().floor() as i32;
    // Through text, which gives the double nearest to the decimal.
    if digits >= 0 {
        let text = format!("{length:.0$}", digits as usize);
        text.parse().unwrap_or(length)
    } else {
        let unit = 10f64.powi(-digits);
        (length / unit).round() * unit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_three_digits_in_any_unit() {
        for (length, rounded) in [
            (3.500_000_1, 3.5),
            (0.004_567_8, 0.004_57),
            (98_765.0, 98_800.0),
        ] {
            assert_eq!(three_digits(length), rounded);
        }
        assert_eq!(rounded_to_fours(1.0), 4);
        assert_eq!(rounded_to_fours(601.0), 600);
    }
}
