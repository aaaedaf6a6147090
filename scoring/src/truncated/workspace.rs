//! The buffers of one evaluation.

use super::columns::Layout;
use super::gather::GatherTables;
use super::place::PlaceTables;
use super::read::ReadTables;

/// Tables of phases: one evaluation at a time, for any configuration of the same pair and no more modes.
#[derive(Clone, Debug)]
pub struct Workspace {
    pub(super) read: ReadTables,
    pub(super) place: PlaceTables,
    pub(super) gather: GatherTables,
}

impl Workspace {
    pub(super) fn new(layout: &Layout, blocks: usize) -> Self {
        Self {
            read: ReadTables::new(layout),
            place: PlaceTables::new(layout),
            gather: GatherTables::new(layout, blocks),
        }
    }
}
