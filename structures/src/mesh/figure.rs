//! Format of a measured figure of a mesh.

use std::fmt;

/// A length, area or volume as a person reads it: with six decimals, or in powers of ten where these would hide it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure(
    /// The value, in whatever unit.
    pub f64,
);

/// Sizes that six decimals show at least four digits of, and that a person still counts.
const PLAIN: std::ops::Range<f64> = 1e-3..1e9;

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = self;
        if *value == 0.0 || PLAIN.contains(&value.abs()) {
            write!(f, "{value:.6}")
        } else {
            write!(f, "{value:.6e}")
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::mesh::figure::Figure;

    #[test]
    fn small_and_large_figures_keep_their_digits() {
        let printed =
            [0.0, 0.25, -1234.5, 2.5e-7, -9.999e-4, 3.0e12].map(|v| Figure(v).to_string());
        let expected = [
            "0.000000",
            "0.250000",
            "-1234.500000",
            "2.500000e-7",
            "-9.999000e-4",
            "3.000000e12",
        ];
        assert_eq!(printed, expected);
    }
}
