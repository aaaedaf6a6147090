//! Terms of a score: the effects that a search correlates, and the terms that score the poses which it keeps.
//!
//! Each term is one file and one line of a registry. Everything that shows terms walks the registries.
//!
//! | registry | what it holds | when it acts |
//! |---|---|---|
//! | [`effect::Effect::ALL`] | sums of one radial function times a class matrix | at every translation of every rotation |
//! | [`pose::POSE_TERMS`] | any function of a pose | at the poses that the search keeps |

pub mod effect;
pub mod pose;
mod potential_table;
