//! Progress of a run.

/// Receives how far a run has come.
pub trait Progress: Sync {
    /// A stage of `total` steps begins.
    fn stage(&self, name: &str, total: u64);
    /// So many steps more are done.
    fn advance(&self, by: u64);
}

/// Progress that nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProgress;

impl Progress for NoProgress {
    fn stage(&self, _: &str, _: u64) {}

    fn advance(&self, _: u64) {}
}
