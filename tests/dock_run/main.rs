//! A run and what it leaves: the table, the complexes, the record, and the same bytes again.

#[path = "../molecules/mod.rs"]
mod molecules;
#[path = "../program/mod.rs"]
mod program;
mod run;

mod bodies;
mod record;
mod table;
