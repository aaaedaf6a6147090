//! Terms beside shape in the pair sum. They share the blocks, distances and panels of shape: a pair that is near is looked up once, and each
//! term adds a line of its own.

use super::blocks::{Blocks, LANES};
use super::tables::{Line, PairTables, Places};
use crate::effect::{ActiveTerm, Effect, Label};

/// Partial sums over the receptor's knots: four lanes, twice.
pub(super) type Sums = [[f64; 4]; 2];

/// One term, prepared.
pub(super) struct PairTerm {
    pub effect: Effect,
    /// The receptor's labels, by block.
    receptor: Vec<[Label; LANES]>,
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
            receptor: blocks.arranged(Label::default(), |index| {
                term.receptor.get(index).copied().unwrap_or_default()
            }),
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

    /// a M b of a pair.
    #[inline(always)]
    pub fn weight(&self, knot: usize, block: usize, lane: usize) -> f64 {
        let (Some((value, row)), Some(labels)) = (self.of(knot), self.receptor.get(block)) else {
            return 0.0;
        };
        let label = labels[lane];
        value * label.value * row.get(label.class).copied().unwrap_or(0.0)
    }

    /// The radial function on a panel.
    #[inline(always)]
    pub fn line(&self, panel: u32) -> &Line {
        self.lines.get(panel as usize).unwrap_or(&NOTHING)
    }

    /// Adds what the eight knots of a block are to a ligand knot, by its row of the class matrix; its own value comes later.
    #[inline(always)]
    pub fn add_block(&self, block: usize, places: &Places, row: &[f64], sums: &mut Sums) {
        let Some(labels) = self.receptor.get(block) else {
            return;
        };
        for lane in 0..LANES {
            let label = labels[lane];
            let weight = label.value * row.get(label.class).copied().unwrap_or(0.0);
            let Line(line) = self.line(places.panels[lane]);
            let u = places.offsets[lane];
            let square = u * u;
            let first = weight * u;
            let powers = [weight, first, weight * square, first * square];
            let fourth = square * square;
            let sum = &mut sums[lane % 2];
            for k in 0..4 {
                sum[k] += powers[k] * (line[k] + fourth * line[k + 4]);
            }
        }
    }
}
