//! The ranking: candidates, clusters and the rows that are reported.

pub(crate) mod candidates;
pub mod cluster;
pub mod ranking;
pub mod rescoring;
pub mod sharp;
pub(crate) mod time_left;
