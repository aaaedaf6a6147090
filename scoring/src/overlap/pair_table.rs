//! Overlap of two bumps as piecewise polynomials in the ratio of the radii and the squared distance.

use super::quadrature::Quadrature;
use crate::kernel::table::{PanelFit, TERMS};
use knotdock_structures::numeric::Bump;
use pulp::{Scalar, Simd};

/// Panels along the distance.
const ALONG_DISTANCE: usize = 48;
/// Panels along the ratio.
const ALONG_RATIO: usize = 16;
/// Largest error of a table that is used, as a share of the value at distance 0.
const TOLERANCE: f64 = 5e-7;
/// Exponents for which a table is tried: of those beyond none holds the tolerance.
const EXPONENTS: std::ops::RangeInclusive<f64> = 2.0..=4.0;
/// z at the largest distance of a pair that meets, that of equal balls.
const LAST: f64 = 2.0;

/// Polynomial of degree 7 by 7 of one cell: \[power along z\]\[power along the ratio\].
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Cell([[f64; TERMS]; TERMS]);

/// K(k, z): overlap over the smaller radius cubed, with k = smaller over larger radius, 0 to 1, and z = d^2 / (r^2 +
/// s^2).
///
/// The limit k -> 0, V psi(sqrt z), is part of the table. K is smooth in z at 0 for even exponents, so that the force,
/// -2 (dE / d(d^2)) times the difference of centres, is exact there.
///
/// Panels are equal in sqrt z. K changes fastest where the smaller ball touches the larger one from inside, at d = s -
/// r. For equal balls that is d = 0.
#[derive(Clone, Debug)]
pub(super) struct PairTable {
    /// \[panel along the distance\]\[panel along the ratio\].
    cells: Vec<Cell>,
    /// Share of the squared reach, counted from its end, over which the value underflows.
    end: f64,
    error: f64,
}

/// Place of a pair in the table.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// k.
    pub ratio: f64,
    /// z.
    pub square: f64,
    /// sqrt(z / 2).
    pub root: f64,
    /// 1 - d^2 / (r + s)^2, not above 0 for balls that do not meet.
    pub rest: f64,
}

impl Place {
    /// The place of radii `small` <= `large` and the squared distance of the centres.
    #[inline(always)]
    pub fn new(small: f64, large: f64, square: f64) -> Self {
        let unit = 1.0 / large;
        let ratio = small * unit;
        let square = square * unit * unit;
        let reach = 1.0 + ratio;
        let z = square / (1.0 + ratio * ratio);
        Self {
            ratio,
            square: z,
            root: (z * (1.0 / LAST)).sqrt(),
            rest: 1.0 - square / (reach * reach),
        }
    }
}

impl PairTable {
    /// The table of a bump; `None` where it would miss the tolerance.
    pub fn new(bump: Bump, quadrature: &Quadrature) -> Option<Self> {
        if !EXPONENTS.contains(&bump.alpha()) {
            return None;
        }
        let table = Self::fit(bump, quadrature);
        (table.error <= TOLERANCE).then_some(table)
    }

    fn fit(bump: Bump, quadrature: &Quadrature) -> Self {
        let fit = PanelFit::new();
        let half_ratio = 0.5 / ALONG_RATIO as f64;
        let mut cells = Vec::with_capacity(ALONG_DISTANCE * ALONG_RATIO);
        for a in 0..ALONG_DISTANCE {
            let (low, high) = (edge(a), edge(a + 1));
            for b in 0..ALONG_RATIO {
                let ratio = half_ratio * (2 * b + 1) as f64;
                cells.push(Cell(fit.coefficients(
                    0.5 * (low + high),
                    0.5 * (high - low),
                    |z| {
                        let along = fit
                            .coefficients(ratio, half_ratio, |ratio| [exact(quadrature, ratio, z)]);
                        along.map(|[coefficient]| coefficient)
                    },
                )));
            }
        }
        let mut table = Self {
            cells,
            end: 2.0 / (745.0 * bump.alpha()),
            error: 0.0,
        };
        table.error = table.measured(quadrature);
        table
    }

    /// Largest error between the nodes over the value at distance 0.
    fn measured(&self, quadrature: &Quadrature) -> f64 {
        let mut worst = 0.0f64;
        // Panels' ends and middles, where errors are among the largest.
        for b in 0..2 * ALONG_RATIO {
            let ratio = 0.5 * b as f64 / ALONG_RATIO as f64;
            let scale = quadrature.value(ratio, 0.0);
            for a in 0..2 * ALONG_DISTANCE {
                let (low, high) = (edge(a / 2), edge(a / 2 + 1));
                let z = low + 0.5 * (a % 2) as f64 * (high - low);
                let place = Place::new(ratio, 1.0, z * (1.0 + ratio * ratio));
                let [ours, _] = self.value(Scalar::new(), &place);
                worst = worst.max((ours - exact(quadrature, ratio, z)).abs() / scale);
            }
        }
        worst
    }

    /// Largest error of a value over that at distance 0, as measured where the table was built.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// K and its slope by z; 0 for balls that do not meet.
    ///
    /// K falls along z: noise of the polynomials near the end makes neither a negative energy nor a pull.
    #[inline(always)]
    pub fn value<S: Simd>(&self, simd: S, place: &Place) -> [f64; 2] {
        if place.rest <= self.end {
            return [0.0; 2];
        }
        let a = (place.root * ALONG_DISTANCE as f64) as usize;
        let scaled = place.ratio * ALONG_RATIO as f64;
        let b = (scaled as usize).min(ALONG_RATIO - 1);
        let Some(Cell(cell)) = self.cells.get(a * ALONG_RATIO + b) else {
            return [0.0; 2];
        };
        let panel = a as f64;
        let per_unit = (ALONG_DISTANCE * ALONG_DISTANCE) as f64 / LAST;
        // (z - middle) / half, with the edges a^2 and (a + 1)^2 over `per_unit`.
        let inverse_half = 2.0 / (2.0 * panel + 1.0);
        let u = (place.square * per_unit - panel * panel) * inverse_half - 1.0;
        let v = 2.0 * (scaled - b as f64) - 1.0;
        let [sum, slope] = cell_at(simd, cell, u, v);
        let value = sum.max(0.0);
        let slope = (per_unit * inverse_half * slope).min(0.0);
        // The noise beyond the kernel's own underflow ends without a step.
        let share = (0.25 / self.end * place.rest).min(1.0);
        let fade = if share < 1.0 { share * share } else { 1.0 };
        [fade * value, fade * slope]
    }
}

/// A cell's polynomial and its slope along the first variable: Horner's rule along it, all powers of the second side by
/// side.
#[inline(always)]
fn cell_at<S: Simd>(simd: S, cell: &[[f64; TERMS]; TERMS], u: f64, v: f64) -> [f64; 2] {
    let square = v * v;
    let (third, fourth) = (square * v, square * square);
    let powers = [
        1.0,
        v,
        square,
        third,
        fourth,
        fourth * v,
        fourth * square,
        fourth * third,
    ];
    let u = simd.splat_f64s(u);
    let mut totals = [simd.splat_f64s(0.0); 2];
    for (index, &power) in S::as_simd_f64s(&powers).0.iter().enumerate() {
        let row = |power: usize| S::as_simd_f64s(&cell[power]).0[index];
        let mut slope = row(TERMS - 1);
        let mut sum = simd.mul_add_e_f64s(slope, u, row(TERMS - 2));
        for power in (0..TERMS - 2).rev() {
            slope = simd.mul_add_e_f64s(slope, u, sum);
            sum = simd.mul_add_e_f64s(sum, u, row(power));
        }
        totals[0] = simd.mul_add_e_f64s(sum, power, totals[0]);
        totals[1] = simd.mul_add_e_f64s(slope, power, totals[1]);
    }
    [
        simd.reduce_sum_f64s(totals[0]),
        simd.reduce_sum_f64s(totals[1]),
    ]
}

/// z where a panel along the distance begins.
fn edge(panel: usize) -> f64 {
    LAST * (panel * panel) as f64 / (ALONG_DISTANCE * ALONG_DISTANCE) as f64
}

#[inline(always)]
fn exact(quadrature: &Quadrature, ratio: f64, z: f64) -> f64 {
    quadrature.value(ratio, (z * (1.0 + ratio * ratio)).sqrt())
}
