//! Text for people, and JSON for programs: results, progress, warnings and errors.

pub mod brief;
pub mod console;
pub mod dock;
pub mod failure;
pub mod leftovers;
pub mod listener;
pub mod shown;
pub mod suggestions;
pub mod timings;
