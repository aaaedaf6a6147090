//! Progress of a run.

/// Receives how far a run has come.
pub trait Progress: Sync {
    /// A stage of `total` steps begins.
    fn stage(&self, _name: &str, _total: u64) {}
    /// Reports that further steps are done.
    fn advance(&self, _by: u64) {}
    /// Called between stages and rotations: an error ends the run.
    ///
    /// # Errors
    /// The reason for the end.
    fn go_on(&self) -> Result<(), Interruption> {
        Ok(())
    }
}

/// The reason why a run ended early.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Interruption {
    /// Its user stopped it.
    #[error("the run was interrupted")]
    Interrupted,
    /// It took longer than its limit in seconds.
    #[error("the run took longer than its limit of {0} s")]
    TimeLimit(f64),
}

/// Progress that nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProgress;

impl Progress for NoProgress {}
