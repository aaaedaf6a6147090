//! Terms beside shape in the pair sum. They share the blocks, distances and panels of shape: a pair that is near is
//! looked up once, and each term adds a line of its own.

use super::tables::{Line, PairTables};
use crate::blocks::Blocks;
use crate::terms::effect::{ActiveTerm, Effect, Label};

/// One term, prepared.
pub(super) struct PairTerm {
    pub effect: Effect,
    /// The receptor's labels, in the order of its blocks.
    receptor: Vec<Label>,
    /// The ligand's, by knot.
    ligand: Vec<Label>,
    /// M by [ligand class][receptor class].
    rows: Vec<Vec<f64>>,
    /// The filtered radial function by panel, as the shape tables' panels lie.
    lines: Vec<Line>,
}

/// The line of a panel that is not there.
const NOTHING: Line = Line([0.0; 8]);

impl PairTerm {
    /// Prepares a term for blocks and tables that are there already.
    pub fn new(active: &ActiveTerm, tables: &PairTables, blocks: &Blocks) -> Self {
        let term = &active.term;
        let classes = term.matrix.first().map_or(0, Vec::len);
        Self {
            effect: term.effect,
            receptor: blocks
                .arranged(|index| term.receptor.get(index).copied().unwrap_or_default()),
            ligand: term.ligand.clone(),
            rows: (0..classes)
                .map(|b| term.matrix.iter().map(|row| row[b]).collect())
                .collect(),
            lines: tables.lines_of(|distance| active.kernel.value(distance)),
        }
    }

    /// What ligand knot `knot` is to the term; `None` where it takes no part.
    #[inline(always)]
    pub fn of(&self, knot: usize) -> Option<(f64, &[f64])> {
        let label = self.ligand.get(knot)?;
        let row = self.rows.get(label.class)?;
        (label.value != 0.0).then_some((label.value, row.as_slice()))
    }

    /// What a receptor knot is to a ligand knot by the latter's row of the class matrix; its own value comes later.
    #[inline(always)]
    pub fn weight(&self, knot: u32, row: &[f64]) -> f64 {
        let Some(label) = self.receptor.get(knot as usize) else {
            return 0.0;
        };
        label.value * row.get(label.class).copied().unwrap_or(0.0)
    }

    /// The radial function on a panel.
    #[inline(always)]
    pub fn line(&self, panel: u32) -> &Line {
        self.lines.get(panel as usize).unwrap_or(&NOTHING)
    }
}
