//! Fields, placements and surfaces as the scripts of a report read them.

use csv::StringRecord;
use serde_json::{Value, json};

use crate::report::columns::ShownColumn;
use knotdock::output::files::assemblies::Surface;
use knotdock_scoring::se3::Pose;

const MAX_TRIANGLES: usize = 100_000;

/// The rows of a table as its columns show them.
pub(super) fn rows(columns: &[ShownColumn], records: &[StringRecord]) -> Vec<Vec<Value>> {
    let row = |record: &StringRecord| columns.iter().zip(record).map(cell).collect();
    records.iter().map(row).collect()
}

/// A field as its column shows it.
fn cell((column, field): (&ShownColumn, &str)) -> Value {
    match (field, column.digits, field.parse::<f64>()) {
        ("", _, _) => Value::Null,
        (_, Some(_), Ok(value)) if value.is_finite() => json!(value),
        (text, _, _) => json!(text),
    }
}

/// A number with `digits` decimals.
pub(super) fn rounded(value: f64, digits: i32) -> f64 {
    let scale = 10_f64.powi(digits);
    (value * scale).round() / scale
}

/// A pose: qw, qx, qy, qz, tx, ty, tz.
pub(super) fn placement(pose: &Pose) -> Vec<f64> {
    let rotation = pose.quaternion().map(|part| rounded(part, 7));
    let translation = [0, 1, 2].map(|axis| significant(pose.translation[axis]));
    rotation.into_iter().chain(translation).collect()
}

/// A length with eight digits: four decimals for a body of 1,000 units.
fn significant(value: f64) -> f64 {
    match value.abs() > 0.0 && value.is_finite() {
        true => rounded(value, (7 - value.abs().log10().floor() as i32).clamp(0, 15)),
        false => value,
    }
}

/// A surface, flat; without triangles if it has too many to be shown.
pub fn solid(surface: &Surface) -> Value {
    let count = surface.triangles.len();
    if count > MAX_TRIANGLES {
        return json!({ "format": "mesh", "triangle_count": count });
    }
    let parts = || surface.positions.iter().flatten().copied();
    let size = parts().fold(f64::MIN, f64::max) - parts().fold(f64::MAX, f64::min);
    // A millionth of its size is less than a pixel.
    let digits = match size > 0.0 {
        true => (6 - size.log10().floor() as i32).clamp(0, 15),
        false => 6,
    };
    let positions: Vec<f64> = parts().map(|part| rounded(part, digits)).collect();
    json!({
        "format": "mesh",
        "triangle_count": count,
        "positions": positions,
        "triangles": surface.triangles.as_flattened(),
    })
}
