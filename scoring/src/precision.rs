//! The two floating-point types of the fast path: one of them is chosen when a program runs.
//!
//! Code that is generic over the type stays inside this crate, so that it is compiled once for each type.

use serde::{Deserialize, Serialize};

/// Floating-point type of the fast path: spectra, engines and grids.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// 32 bits: tolerances down to 1e-4.
    #[default]
    Single,
    /// 64 bits: tolerances down to 1e-8.
    Double,
}

impl Precision {
    /// Finest tolerance that it serves: single precision loses digits in the transforms below 1e-4.
    pub fn finest_tolerance(self) -> f64 {
        match self {
            Self::Single => 1e-4,
            Self::Double => 1e-8,
        }
    }

    /// Distance of 1 from the next number.
    pub(crate) fn epsilon(self) -> f64 {
        match self {
            Self::Single => f64::from(f32::EPSILON),
            Self::Double => f64::EPSILON,
        }
    }

    /// Smallest normal number.
    pub(crate) fn least_positive(self) -> f64 {
        match self {
            Self::Single => f64::from(f32::MIN_POSITIVE),
            Self::Double => f64::MIN_POSITIVE,
        }
    }
}

/// A value in the precision in use.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum InPrecision<S, D> {
    Single(S),
    Double(D),
}

impl<S, D> InPrecision<S, D> {
    /// The precision.
    pub fn precision(&self) -> Precision {
        match self {
            Self::Single(_) => Precision::Single,
            Self::Double(_) => Precision::Double,
        }
    }
}

/// Evaluates an expression of a value in either precision.
macro_rules! of_precision {
    ($of:expr, $value:pat => $result:expr) => {
        match $of {
            $crate::precision::InPrecision::Single($value) => $result,
            $crate::precision::InPrecision::Double($value) => $result,
        }
    };
}

/// Evaluates an expression of a value in either precision, whose result is in the same one.
macro_rules! in_precision {
    ($of:expr, $value:pat => $result:expr) => {
        match $of {
            $crate::precision::InPrecision::Single($value) => {
                $crate::precision::InPrecision::Single($result)
            }
            $crate::precision::InPrecision::Double($value) => {
                $crate::precision::InPrecision::Double($result)
            }
        }
    };
}

pub(crate) use {in_precision, of_precision};
