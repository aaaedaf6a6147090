//! Ensembles: several conformations of receptor and ligand, a run for each pair of them, and one ranking of all.
//!
//! A member is the run of one conformation of the receptor with one of the ligand. Its poses are of its files. To
//! cluster across members, each conformation is superposed on the first of its side, which takes every pose into the
//! frame of the first two (`joined`).

mod joined;
pub mod table;
