//! Text for people, and JSON for programs: results, progress, warnings and errors.

pub mod console;
pub mod dock;
pub mod event_lines;
pub mod shown;
pub mod suggestions;
