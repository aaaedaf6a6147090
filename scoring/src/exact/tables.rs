//! Kernels of all pairs of radii over distance, laid out for the pair sum: a polynomial of degree 7 is one cache line.
//!
//! Panel k of a table covers distances within half a panel of k panel widths, so that rounding finds the panel and leaves the
//! argument u in [-1/2, 1/2]; the kernel is even in the distance, so panel 0 sees it on both sides of 0. The last real panel
//! ends at the reach; one of zeros follows, in which all farther pairs end up. The score's table is the weighted sum of the slices' own
//! coefficients, so the score alone and the score from the slices differ by rounding only.

use super::blocks::LANES;
use crate::kernel::RankingKernel;
use crate::kernel::table::{PanelFit, TERMS};

/// Coefficients of one polynomial, by rising power of u.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Line(pub [f64; TERMS]);

/// 1.5 * 2^52: added to a number below 2^31 in size, it leaves that number, rounded, in the sum's low bits.
const ROUNDING: f64 = 6755399441055744.0;

/// Tables of all pairs of radii.
pub(super) struct PairTables {
    /// Score kernel by line: -lambda^2, 2 lambda, -1 times the slices.
    scores: Vec<Line>,
    /// Slices at rho = 0, r0, 2 r0 by line.
    slices: Vec<[Line; 3]>,
    /// [ligand class][receptor class]: line at which the pair's table starts.
    starts: Vec<Vec<u32>>,
    /// [ligand class][receptor class]: radius sum in Å.
    sums: Vec<Vec<f64>>,
    panels_per_unit: f64,
    /// The panel of zeros.
    last: f64,
}

/// Where eight distances fall in a table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Places {
    pub panels: [u32; LANES],
    /// Way from the middle of the panel, in panel widths, within [-1/2, 1/2].
    pub offsets: [f64; LANES],
}

impl PairTables {
    pub fn new(kernel: &RankingKernel, receptor_radii: &[f64], ligand_radii: &[f64]) -> Self {
        let sums: Vec<Vec<f64>> = ligand_radii
            .iter()
            .map(|s| receptor_radii.iter().map(|r| r + s).collect())
            .collect();
        let mut distinct: Vec<f64> = sums.iter().flatten().copied().collect();
        distinct.sort_by(f64::total_cmp);
        distinct.dedup();
        let panels = (kernel.reach() / kernel.panel() + 0.5).ceil().max(1.0);
        let panels_per_unit = (panels - 0.5) / kernel.reach();
        let lines = panels as usize + 1;
        let weights = kernel.options().slice_weights();
        let fit = PanelFit::new();
        let zero = Line([0.0; TERMS]);
        let mut slices = Vec::with_capacity(lines * distinct.len());
        for &sum in &distinct {
            let slices_at = kernel.slices_of(sum);
            for panel in 0..lines - 1 {
                let (middle, half) = (panel as f64 / panels_per_unit, 0.5 / panels_per_unit);
                let coefficients = fit.coefficients(middle, half, |d| slices_at(d.abs()));
                // From the fit's variable in [-1, 1] to u: exact, by powers of two.
                slices.push([0, 1, 2].map(|slice| {
                    let scaled =
                        |power: usize| coefficients[power][slice] * f64::from(1u32 << power as u32);
                    Line(std::array::from_fn(scaled))
                }));
            }
            slices.push([zero; 3]);
        }
        let weighted = |line: &[Line; 3]| {
            let term = |power: usize| (0..3).map(|i| weights[i] * line[i].0[power]).sum();
            Line(std::array::from_fn(term))
        };
        let start = |sum: &f64| (lines * distinct.partition_point(|other| other < sum)) as u32;
        Self {
            scores: slices.iter().map(weighted).collect(),
            slices,
            starts: sums
                .iter()
                .map(|row| row.iter().map(start).collect())
                .collect(),
            sums,
            panels_per_unit,
            last: panels,
        }
    }

    /// A radial function over the same panels, the one of zeros included.
    pub fn lines_of(&self, value: impl Fn(f64) -> f64) -> Vec<Line> {
        let fit = PanelFit::new();
        let panels = self.last as usize;
        let mut lines: Vec<Line> = (0..panels)
            .map(|panel| {
                let (middle, half) = (
                    panel as f64 / self.panels_per_unit,
                    0.5 / self.panels_per_unit,
                );
                let coefficients = fit.coefficients(middle, half, |d| [value(d.abs())]);
                let scaled =
                    |power: usize| coefficients[power][0] * f64::from(1u32 << power as u32);
                Line(std::array::from_fn(scaled))
            })
            .collect();
        lines.push(Line([0.0; TERMS]));
        lines
    }

    /// First lines of the tables that a ligand class needs, by receptor class.
    pub fn starts(&self, ligand_class: usize) -> &[u32] {
        self.starts.get(ligand_class).map_or(&[], Vec::as_slice)
    }

    /// Radius sums in Å of a ligand class, by receptor class.
    pub fn sums(&self, ligand_class: usize) -> &[f64] {
        self.sums.get(ligand_class).map_or(&[], Vec::as_slice)
    }

    /// Panels per Å.
    pub fn panels_per_unit(&self) -> f64 {
        self.panels_per_unit
    }

    /// Score lines.
    #[inline(always)]
    pub fn scores(&self) -> &[Line] {
        &self.scores
    }

    /// Slice lines.
    #[inline(always)]
    pub fn slices(&self) -> &[[Line; 3]] {
        &self.slices
    }

    /// Panels and arguments of squared distances.
    #[inline(always)]
    pub fn place(&self, squares: &[f64; LANES]) -> Places {
        let mut places = Places {
            panels: [0; LANES],
            offsets: [0.0; LANES],
        };
        for lane in 0..LANES {
            let scaled = squares[lane].sqrt() * self.panels_per_unit;
            // Not `min`: a comparison sends NaN to the zeros as well, in one instruction.
            let scaled = if scaled < self.last {
                scaled
            } else {
                self.last
            };
            let rounded = scaled + ROUNDING;
            places.panels[lane] = rounded.to_bits() as u32;
            places.offsets[lane] = scaled - (rounded - ROUNDING);
        }
        places
    }
}
