//! Rescoring: what a pose is worth beside its score, by terms that are too dear for all translations at once.
//!
//! A search ranks poses by a correlation, in which every term is one radial function times a class matrix of low rank. Of the few thousand
//! poses that it keeps, more can be asked. [`FineContacts`] asks which atoms meet at which distance: a potential of three
//! ranges over all pairs of the types of [`crate::effect::contact`], summed over the atoms themselves.
//!
//! As everywhere a higher score is better, lengths are in Å, and positions are taken relative to the middles of the two bodies.

mod contacts;
mod potential;

pub use contacts::FineContacts;
pub use potential::{FinePotential, RANGES};
