//! Bounds of a restraint, checked.

use crate::restraints::error::RestraintFault;
use crate::table_text::named_columns::shortened;

/// Largest distance that is taken, in Å: far beyond any molecule, and its sixth power is a number.
const MAX_DISTANCE: f64 = 1e10;

/// Bounds of an effective distance, in Å: 0 <= lower <= target <= upper, and upper is above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) lower: f64,
    pub(super) target: Option<f64>,
    pub(super) upper: f64,
}

impl Bounds {
    /// Bounds as a table gives them.
    pub(super) fn new(lower: f64, target: Option<f64>, upper: f64) -> Result<Self, RestraintFault> {
        let wrong = |message: String| Err(RestraintFault::Bounds(message));
        if lower > upper {
            return wrong(format!("lower is {lower}, above upper, which is {upper}"));
        }
        if upper == 0.0 {
            return wrong("the upper bound is 0, and atoms cannot be in one place".to_owned());
        }
        match target {
            Some(target) if !(lower..=upper).contains(&target) => wrong(format!(
                "target is {target}, outside the bounds {lower} and {upper}"
            )),
            target => Ok(Self {
                lower,
                target,
                upper,
            }),
        }
    }

    /// Bounds of an assign statement: `minus` below the distance, but not below 0, to `plus` above it.
    pub(super) fn about(distance: f64, minus: f64, plus: f64) -> Result<Self, RestraintFault> {
        Self::new((distance - minus).max(0.0), Some(distance), distance + plus)
    }
}

/// A distance as written, in Å.
pub(super) fn distance(what: &'static str, text: &str) -> Result<f64, RestraintFault> {
    let number = text.parse().ok();
    number
        .filter(|number| (0.0..=MAX_DISTANCE).contains(number))
        .map(|number: f64| number + 0.0) // + 0.0 turns a negative zero into 0
        .ok_or_else(|| RestraintFault::Distance {
            what,
            text: shortened(text),
            max: MAX_DISTANCE,
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_statement_gives_a_distance_and_its_tolerances() {
        let bounds = |lower, target, upper| {
            Ok(Bounds {
                lower,
                target: Some(target),
                upper,
            })
        };
        assert_eq!(Bounds::about(2.0, 2.0, 0.0), bounds(0.0, 2.0, 2.0));
        assert_eq!(Bounds::about(5.0, 1.0, 2.5), bounds(4.0, 5.0, 7.5));
        // No distance is below 0, so this bound excludes nothing.
        assert_eq!(Bounds::about(2.0, 3.0, 0.0), bounds(0.0, 2.0, 2.0));
    }

    #[test]
    fn bounds_that_nothing_satisfies_are_refused() {
        for (lower, target, upper) in [
            (3.0, None, 2.0),
            (0.0, None, 0.0),
            (1.0, Some(0.5), 2.0),
            (1.0, Some(2.5), 2.0),
        ] {
            let bounds = Bounds::new(lower, target, upper);
            assert!(matches!(bounds, Err(RestraintFault::Bounds(_))));
        }
        assert!(Bounds::new(2.0, Some(2.0), 2.0).is_ok());
    }

    #[test]
    fn only_numbers_are_distances() {
        for text in [
            "nan", "inf", "-inf", "-1", "1e11", "1e999", "", "8 Å", "8,5", "0x10",
        ] {
            let fault = distance("upper", text).unwrap_err();
            assert!(fault.to_string().starts_with("upper is `"), "{fault}");
        }
        assert_eq!(distance("upper", "+8.5e0"), Ok(8.5));
        assert!(distance("upper", "-0").unwrap().is_sign_positive());
    }
}
