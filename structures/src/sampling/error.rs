//! Errors of sampling.

/// Why a solid could not be sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SampleError {
    /// No node of the grid is inside; for Algorithm 1, nor any point under the surface.
    #[error(
        "no ball fits inside the mesh: none of the grid's nodes is inside it, or it bounds no solid"
    )]
    NothingInside,
}
