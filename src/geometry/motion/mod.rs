//! Rigid motions as points of SE(3) with a distance: geodesics and sets of tolerated poses (B&I, appendix B).

pub mod geodesic;
pub mod tolerance;
