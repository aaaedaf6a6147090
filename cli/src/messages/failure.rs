//! Errors as text for people and as JSON for programs.

use knotdock_structures::Error;

use crate::messages::shown::shown_name;

/// The lines for a person.
pub fn text(error: &Error) -> String {
    let mut text = format!("error: {}", error.message());
    if let Some(file) = error.file() {
        text += &format!("\n  in {}", shown_name(&file.display().to_string()));
        if let Some(line) = error.line() {
            text += &format!(", line {line}");
        }
    }
    if let Some(remedy) = error.remedy() {
        text += &format!("\n  help: {remedy}");
    }
    text
}

/// The object for a program: `{"error": {"file", "line", "message", "remedy"}}`.
pub fn json(error: &Error) -> serde_json::Value {
    serde_json::json!({ "error": {
        "file": error.file().map(|file| file.display().to_string()),
        "line": error.line(),
        "message": error.message(),
        "remedy": error.remedy(),
    }})
}
