//! A run and its files: the table, the complexes, the record, and the same bytes again.

pub mod run;

mod bodies;
mod folder;
mod record;
mod table;
