//! Changes of single options: what settings of a sweep are made of.

use crate::options::DockOptions;
use crate::options::Precision;

/// A change of one option.
#[derive(Clone, Copy, Debug)]
pub(super) enum Change {
    Tolerance(f64),
    Precision(Precision),
    Spacing(f64),
    Resolution(f64),
    Rotations(usize),
    FineRotations(usize),
    PerRotation(usize),
    Refine(usize),
    SampleGrid(usize),
}

impl Change {
    /// Makes it.
    pub fn apply(self, options: &mut DockOptions) {
        match self {
            Self::Tolerance(value) => options.tolerance = value,
            Self::Precision(value) => options.precision = value,
            Self::Spacing(value) => options.spacing = Some(value),
            Self::Resolution(value) => {
                // A pass length that was given goes along with the resolution, as the default one does.
                options.pass_length = options
                    .pass_length
                    .map(|length| length * value / options.resolution);
                options.resolution = value;
            }
            Self::Rotations(value) => {
                options.rotations = value;
                // A finer set is no coarser.
                options.fine_rotations = options.fine_rotations.map(|finer| finer.max(value));
            }
            Self::FineRotations(value) => options.fine_rotations = Some(value),
            Self::PerRotation(value) => options.per_rotation = value,
            Self::Refine(value) => options.refine = Some(value),
            Self::SampleGrid(value) => options.sample_grid = Some(value),
        }
    }

    /// What else is typed for `changed` options of a run with `default` ones to have the change: lengths of molecules and meshes that would follow from
    /// it otherwise, and a finer set of rotations that it has made finer still.
    pub fn companions(&self, default: &DockOptions, changed: &DockOptions) -> String {
        match (self, changed.pass_length, changed.fine_rotations) {
            (Self::Resolution(_), Some(length), _) => format!(" --pass-length {length}"),
            (Self::Rotations(_), _, Some(finer)) if default.fine_rotations != Some(finer) => {
                format!(" --fine-rotations {finer}")
            }
            (Self::SampleGrid(_), ..) => format!(" --offset {}", changed.offset),
            _ => String::new(),
        }
    }

    /// As it is typed.
    pub fn argument(&self) -> String {
        match self {
            Self::Tolerance(value) => format!("--tolerance {value}"),
            Self::Precision(value) => format!("--precision {}", value.name()),
            Self::Spacing(value) => format!("--spacing {value}"),
            Self::Resolution(value) => format!("--resolution {value}"),
            Self::Rotations(value) => format!("--rotations {value}"),
            Self::FineRotations(value) => format!("--fine-rotations {value}"),
            Self::PerRotation(value) => format!("--per-rotation {value}"),
            Self::Refine(value) => format!("--refine {value}"),
            Self::SampleGrid(value) => format!("--sample-grid {value}^3"),
        }
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
