//! Progress of a run.

/// Receives how far a run has come.
pub trait Progress: Sync {
    /// A stage of `total` steps begins.
    fn stage(&self, name: &str, total: u64);
    /// So many steps more are done.
    fn advance(&self, by: u64);
}
