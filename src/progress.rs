//! Progress of a run.

/// Receives how far a run has come.
pub trait Progress: Sync {
    /// A stage of `total` steps begins.
    fn stage(&self, name: &str, total: u64);
    /// So many steps more are done.
    fn advance(&self, by: u64);
    /// Fails where the run is to end before its end: asked between its stages and rotations.
    ///
    /// # Errors
    /// Why it is to end.
    fn go_on(&self) -> Result<(), Ended> {
        Ok(())
    }
}

/// Why a run ended before its end.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Ended {
    /// Its user stopped it.
    #[error("the run was interrupted")]
    Interrupted,
    /// It took longer than it was allowed: so many seconds.
    #[error("the run took longer than its limit of {0} s")]
    TimeLimit(f64),
}

/// Progress that nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProgress;

impl Progress for NoProgress {
    fn stage(&self, _: &str, _: u64) {}

    fn advance(&self, _: u64) {}
}
