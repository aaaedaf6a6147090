//! What a program is told that runs commands in its own process.

use std::fmt::Debug;

use knotdock::progress::Ended;
use serde_json::Value;

/// Receives what a command would write to the terminal, from whichever of its threads.
pub trait Listener: Sync + Debug {
    /// A paragraph of the report.
    fn say(&self, text: &str);
    /// A warning.
    fn warn(&self, text: &str);
    /// What went wrong and did not end the command.
    fn error(&self, text: &str);
    /// The JSON object of the command.
    fn result(&self, object: &Value);
    /// A stage of `total` steps begins.
    fn stage(&self, name: &str, total: u64);
    /// So many steps more are done.
    fn advance(&self, by: u64);
    /// Fails where the command is to end before its end.
    ///
    /// # Errors
    /// Why it is to end.
    fn go_on(&self) -> Result<(), Ended>;
}
