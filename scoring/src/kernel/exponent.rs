//! The exponent alpha of the bump function as text: a number, or `inf` for the indicator of the ball.
//!
//! JSON has no infinity. [`serialize`] and [`deserialize`] serve serde's attribute `with` and write it as `"inf"`.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serializer};

/// Reads an exponent above zero, `inf` among them.
///
/// # Errors
/// A message if the text is no such number.
pub fn parse(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value > 0.0 => Ok(value),
        _ => Err("a number above zero, or inf, is needed".to_owned()),
    }
}

/// Writes an exponent: a number, or `"inf"`.
///
/// # Errors
/// Those of the serializer.
pub fn serialize<S: Serializer>(alpha: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if alpha.is_infinite() {
        serializer.serialize_str("inf")
    } else {
        serializer.serialize_f64(*alpha)
    }
}

/// Reads what [`serialize`] writes.
///
/// # Errors
/// Those of the deserializer, and where the value is no exponent.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Exponent {
        Number(f64),
        Text(String),
    }
    match Exponent::deserialize(deserializer)? {
        Exponent::Number(value) => Ok(value),
        Exponent::Text(text) => parse(&text).map_err(D::Error::custom),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::KernelOptions;

    /// JSON has no infinity: it was written as null, which nothing read back.
    #[test]
    fn infinity_survives_json() {
        for alpha in [2.0, 0.1 + 0.2, f64::INFINITY] {
            let options = KernelOptions {
                alpha,
                ..KernelOptions::default()
            };
            let text = serde_json::to_string(&options).unwrap();
            assert_eq!(
                serde_json::from_str::<KernelOptions>(&text).unwrap(),
                options
            );
        }
        let text = serde_json::to_string(&KernelOptions::default()).unwrap();
        for alpha in ["null", "\"fast\"", "\"-1\""] {
            let text = text.replace("\"alpha\":2.0", &format!("\"alpha\":{alpha}"));
            assert!(
                serde_json::from_str::<KernelOptions>(&text).is_err(),
                "{text}"
            );
        }
    }

    #[test]
    fn reads_numbers_above_zero_and_infinity() {
        assert_eq!(parse("2"), Ok(2.0));
        assert_eq!(parse(" inf "), Ok(f64::INFINITY));
        for text in ["0", "-1", "nan", "-inf", "", "x"] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
