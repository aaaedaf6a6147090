//! Records in JSON that the program writes or reads again.

pub mod ensemble_record;
pub mod recorded_run;
pub mod tradeoff;

use serde_json::Value;

/// The entries of several JSON objects as one object.
pub fn joined(parts: impl IntoIterator<Item = Value>) -> Value {
    let objects = parts.into_iter().filter_map(|part| match part {
        Value::Object(entries) => Some(entries),
        _ => None,
    });
    Value::Object(objects.flatten().collect())
}
