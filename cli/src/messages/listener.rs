//! Callbacks for programs that run commands in-process.

use std::fmt::Debug;

use knotdock::progress::Ended;
use serde_json::Value;

/// Receives what a command would write to the terminal, from any of its threads. What is not implemented is dropped.
pub trait Listener: Sync + Debug {
    /// A paragraph of the report.
    fn say(&self, _text: &str) {}
    /// A warning.
    fn warn(&self, _text: &str) {}
    /// An error that does not end the command.
    fn error(&self, _text: &str) {}
    /// The JSON object of the command.
    fn result(&self, _object: &Value) {}
    /// A stage of `total` steps begins.
    fn stage(&self, _name: &str, _total: u64) {}
    /// `by` further steps are done.
    fn advance(&self, _by: u64) {}
    /// Fails if the command has to end now.
    ///
    /// # Errors
    /// The reason to end.
    fn go_on(&self) -> Result<(), Ended>;
}
