//! Kernels of all pairs of radii over distance, laid out for the pair sum: a polynomial of degree 7 is one cache line.
//!
//! Panel k of a table covers distances within half a panel of k panel widths, so that rounding finds the panel and
//! leaves the argument u in [-1/2, 1/2]. The kernel is even in the distance: panel 0 covers both sides of 0. The last
//! real panel ends at the reach. One of zeros follows, in which all farther pairs end up. The score's table is the
//! weighted sum of the slices' own coefficients, so the score alone and the score from the slices differ by rounding
//! only.

use crate::blocks::{Blocks, LANES, vectors, vectors_mut};
use crate::kernel::RankingKernel;
use crate::kernel::table::{PanelFit, TERMS};
use crate::lanes::ROUNDING;
use crate::terms::effect::{ActiveTerm, Effect, Label};
use pulp::Simd;

/// Coefficients of one polynomial, by rising power of u.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Line(pub [f64; TERMS]);

/// Tables of all pairs of radii.
pub(super) struct PairTables {
    /// Score kernel by line: -lambda^2, 2 lambda, -1 times the slices.
    pub scores: Vec<Line>,
    /// Slices at rho = 0, r0, 2 r0 by line.
    pub slices: Vec<[Line; 3]>,
    /// [ligand class][receptor class]: line at which the pair's table starts.
    pub starts: Vec<Vec<u32>>,
    /// [ligand class][receptor class]: radius sum in Å.
    pub sums: Vec<Vec<f64>>,
    /// Panels per Å.
    pub panels_per_unit: f64,
    /// The panel of zeros.
    last: f64,
}

/// Places of eight distances in a table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Places {
    /// Numbers of panels, in the low bits.
    panels: [f64; LANES],
    /// Ways u from the middle of the panel, in panel widths, within [-1/2, 1/2], and u^2, u^4.
    powers: [[f64; LANES]; 3],
}

impl Places {
    #[inline(always)]
    pub fn panel(&self, lane: usize) -> u32 {
        self.panels[lane].to_bits() as u32
    }

    /// u.
    #[inline(always)]
    pub fn first(&self, lane: usize) -> f64 {
        self.powers[0][lane]
    }

    /// u^2.
    #[inline(always)]
    pub fn square(&self, lane: usize) -> f64 {
        self.powers[1][lane]
    }

    /// u^4.
    #[inline(always)]
    pub fn fourth(&self, lane: usize) -> f64 {
        self.powers[2][lane]
    }
}

/// Panels of a kernel's tables, without that of zeros.
fn panels_of(kernel: &RankingKernel) -> f64 {
    (kernel.reach() / kernel.panel() + 0.5).ceil().max(1.0)
}

/// Bytes of the tables of one radius sum.
pub(super) fn bytes_of(kernel: &RankingKernel) -> u64 {
    (panels_of(kernel) as u64 + 1) * size_of::<[Line; 4]>() as u64
}

/// Functions of a distance on a number of panels, and the panel of zeros after them.
fn lines_of<const COUNT: usize>(
    panels: f64,
    panels_per_unit: f64,
    values: impl Fn(f64) -> [f64; COUNT],
) -> impl Iterator<Item = [Line; COUNT]> {
    let fit = PanelFit::new();
    let half = 0.5 / panels_per_unit;
    let lines = (0..panels as usize).map(move |panel| {
        let middle = panel as f64 / panels_per_unit;
        let coefficients = fit.coefficients(middle, half, |d| values(d.abs()));
        // From the fit's variable in [-1, 1] to u: exact, by powers of two.
        std::array::from_fn(|index| {
            let scaled =
                |power: usize| coefficients[power][index] * f64::from(1u32 << power as u32);
            Line(std::array::from_fn(scaled))
        })
    });
    lines.chain(std::iter::once([Line([0.0; TERMS]); COUNT]))
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
        let panels = panels_of(kernel);
        let panels_per_unit = (panels - 0.5) / kernel.reach();
        let lines = panels as usize + 1;
        let weights = kernel.options().slice_weights();
        let mut slices = Vec::with_capacity(lines * distinct.len());
        for &sum in &distinct {
            slices.extend(lines_of(panels, panels_per_unit, kernel.slices_of(sum)));
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
        let lines = lines_of(self.last, self.panels_per_unit, |d| [value(d)]);
        lines.map(|[line]| line).collect()
    }

    /// Panels and arguments of squared distances.
    #[inline(always)]
    pub fn place<S: Simd>(&self, simd: S, squares: &[f64; LANES]) -> Places {
        let mut places = Places {
            panels: [0.0; LANES],
            powers: [[0.0; LANES]; 3],
        };
        let [first, second, fourth] = places.powers.each_mut();
        let per_unit = simd.splat_f64s(self.panels_per_unit);
        let last = simd.splat_f64s(self.last);
        let rounding = simd.splat_f64s(ROUNDING);
        for (index, &square) in vectors::<S>(squares).iter().enumerate() {
            let scaled = simd.mul_f64s(simd.sqrt_f64s(square), per_unit);
            let scaled = simd.min_f64s(scaled, last);
            let rounded = simd.add_f64s(scaled, rounding);
            let u = simd.sub_f64s(scaled, simd.sub_f64s(rounded, rounding));
            let square = simd.mul_f64s(u, u);
            vectors_mut::<S>(&mut places.panels)[index] = rounded;
            vectors_mut::<S>(first)[index] = u;
            vectors_mut::<S>(second)[index] = square;
            vectors_mut::<S>(fourth)[index] = simd.mul_f64s(square, square);
        }
        places
    }
}

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
    /// A term without knots.
    pub const NONE: Self = Self {
        effect: Effect::Shape,
        receptor: Vec::new(),
        ligand: Vec::new(),
        rows: Vec::new(),
        lines: Vec::new(),
    };

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

    /// Value and matrix row of a ligand knot; `None` if it takes no part.
    #[inline(always)]
    pub fn of(&self, knot: usize) -> Option<(f64, &[f64])> {
        let label = self.ligand.get(knot)?;
        let row = self.rows.get(label.class)?;
        (label.value != 0.0).then_some((label.value, row.as_slice()))
    }

    /// Weight of a receptor knot by a ligand knot's row of the class matrix, without the ligand knot's value.
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
