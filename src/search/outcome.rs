//! What a docking search hands on: ranked poses, the plan it followed, the errors it measured and what it cost.

use knotdock_scoring::se3::Pose;
use serde::Serialize;

/// One row of `poses.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct RankedPose {
    /// From the ligand's file frame to the receptor's.
    pub pose: Pose,
    /// Exact f64 pair sum of the ranking kernel at `pose`; higher is better.
    pub score: f64,
    /// 1-based cluster number, best cluster first; `None` when clustering is off.
    pub cluster: Option<usize>,
    /// Number of poses in that cluster.
    pub cluster_size: Option<usize>,
    /// Whether `pose` was moved off the grid by refinement.
    pub refined: bool,
    /// Index in the rotation set of the grid pose that this row came from.
    pub rotation: usize,
    /// Score of that grid pose as the fast path computed it.
    pub score_grid: f64,
    /// B&I's own sum (no low-pass) at `pose`.
    pub score_unfiltered: f64,
    /// Weighted shape term at `pose`; the terms add up to `score`.
    pub shape: f64,
    /// Unweighted slices of the low-passed correlation at rho = 0, r0 and 2 r0, at `pose`.
    pub slices: [f64; 3],
}

/// The fast path's error as measured in this run, relative to the best exact score.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MeasuredError {
    /// Grid poses over which it was measured.
    pub poses: usize,
    /// Root mean square of |fast - exact| / |best exact score|.
    pub rms: f64,
    /// Largest of the same.
    pub worst: f64,
    /// Mean share of the unfiltered score that the low-pass removed over the same poses, |G - G_unfiltered| / |best exact score|.
    pub low_pass_share: f64,
}
