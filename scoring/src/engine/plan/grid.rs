//! The grid of a plan: spacing, spreading window, and a box that holds both bodies wherever they touch.

use super::EngineOptions;
use super::error::PlanError;
use crate::kernel::product::peak_score_and_reach;
use crate::kernel::table::Table;
use crate::kernel::{Band, ProductKernel, RankingKernel};
use crate::rigid_move::center;
use crate::terms::effect::ActiveTerm;
use crate::transform::fast_size;
use crate::transform::modes::ModeSet;
use crate::transform::spreading::{MAX_WIDTH, SpreadingKernel};
use knotdock_structures::Knots;
use nalgebra::{UnitQuaternion, Vector3};
use std::sync::Arc;

/// Centres and extents of two bodies, in Å.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extents {
    /// Middle of the receptor's bounding box along the grid's axes.
    pub receptor_center: Vector3<f64>,
    /// Half the receptor's bounding box.
    pub receptor_extent: [f64; 3],
    /// Middle of the ligand's bounding box.
    pub ligand_center: Vector3<f64>,
    /// Distance of the farthest ligand knot from it.
    pub ligand_radius: f64,
}

/// Most points of a grid: voxels are numbered in 32 bits.
const MAX_POINTS: f64 = u32::MAX as f64;
/// Most points along an axis: transforms of that length are planned without delay.
const MAX_ALONG: f64 = 1e6;
/// Most pairs (y, z) of points, half of which become columns of modes: these are made before anyone can ask how much
/// memory a plan takes, and are 400 MB by then.
const MAX_ROWS: f64 = (1u32 << 25) as f64;

impl Extents {
    pub fn of(receptor: &Knots, ligand: &Knots) -> Self {
        let ligand_center = center(ligand);
        let (low, high) = receptor.bounds();
        let distances = ligand
            .centers
            .iter()
            .map(|&x| (Vector3::from(x) - ligand_center).norm());
        Self {
            receptor_center: center(receptor),
            receptor_extent: [0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis])),
            ligand_center,
            ligand_radius: distances.fold(0.0, f64::max),
        }
    }

    /// The same with the receptor's knots, or the outermost of them, turned by `frame`, in a box as long in y as in z.
    pub fn turned(&self, receptor: &[[f64; 3]], frame: UnitQuaternion<f64>) -> Self {
        let matrix = frame.to_rotation_matrix();
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &x in receptor {
            let x = matrix * Vector3::from(x);
            for axis in 0..3 {
                low[axis] = low[axis].min(x[axis]);
                high[axis] = high[axis].max(x[axis]);
            }
        }
        let middle = Vector3::from([0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis])));
        let [x, y, z] = [0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis]));
        Self {
            receptor_center: matrix.inverse() * middle,
            receptor_extent: [x, y.max(z), y.max(z)],
            ..*self
        }
    }

    /// Points per axis of a grid that holds the receptor, the ligand turned however, and the kernel's reach between
    /// them; `width` is that of the spreading window.
    ///
    /// # Errors
    /// [`PlanError::TooLarge`] where the points cannot be numbered, or the columns of modes held.
    pub fn grid(&self, reach: f64, width: usize, spacing: f64) -> Result<[usize; 3], PlanError> {
        let counts = self.receptor_extent.map(|extent| {
            let length = 2.0 * (extent + self.ligand_radius + reach);
            // The larger body's spread block, its window and the cells lost to rounding up included, must fit into the
            // box, which a kernel shorter than that window would make too small.
            let block = 2.0 * extent.max(self.ligand_radius) + (width as f64 + 6.0) * spacing;
            (length.max(block) / spacing).ceil().max(4.0)
        });
        let points: f64 = counts.iter().product();
        // Good sizes are sought for such alone as can be: that would not end for absurd ones. Written so that NaN is
        // refused with the rest.
        if !counts.iter().all(|count| (0.0..MAX_ALONG).contains(count)) || points > MAX_POINTS {
            return Err(PlanError::TooLarge(points));
        }
        let size = counts.map(|count| fast_size(count as usize));
        let [nx, ny, nz] = size.map(|n| n as f64);
        if nx * ny * nz > MAX_POINTS || ny * nz > MAX_ROWS {
            return Err(PlanError::TooLarge(nx * ny * nz));
        }
        Ok(size)
    }
}

/// The modes of such a grid, and the points per axis of the transforms' fine one, `ratio` times as fine.
pub(super) fn modes_at(
    spacing: f64,
    extents: &Extents,
    reach: f64,
    width: usize,
    ratio: f64,
) -> Result<(Arc<ModeSet>, [usize; 3]), PlanError> {
    let size = extents.grid(reach, width, spacing)?;
    let lengths = size.map(|n| n as f64 * spacing);
    let modes = ModeSet::new(size, lengths, 0.5 / spacing);
    let fine = size.map(|n| fast_size((n as f64 * ratio).ceil() as usize));
    Ok((Arc::new(modes), fine))
}

/// Oversampling of the fine grid against the mode grid. The low-pass takes the modes near the grid's own limit down to
/// nothing, so far less is needed than the 2 of a transform whose modes all count alike.
pub(super) fn oversampling(tolerance: f64, band: Option<Band>) -> f64 {
    match band {
        // Cut sharply, all modes count alike.
        Some(Band::Whole) => 2.0,
        _ if tolerance >= 1e-3 => 1.25,
        _ => 1.5,
    }
}

/// Width of the spreading window in fine cells; `dynamic_range` is by how much the largest |G| exceeds the best score
/// more than usual.
pub(super) fn window_width(tolerance: f64, dynamic_range: f64, oversampling: f64) -> usize {
    // Errors of the transform are relative to the largest |G|, that of overlapping centres, some fifty times the best
    // score. The modes that matter there are the low ones, which the window serves better: a tenth is enough for
    // docking.
    let usual = if tolerance >= 1e-2 { 0.1 } else { 0.01 };
    let share = usual / dynamic_range;
    SpreadingKernel::<f64>::width_for(share * tolerance, oversampling * 1.2).min(MAX_WIDTH)
}

/// The score kernel of the widest pair, by which what may be left out is measured.
pub(super) struct Widest {
    sum: f64,
    table: Table<4>,
    /// Largest score of that pair; not 0.
    peak_score: f64,
}

impl Widest {
    pub fn new(kernel: &RankingKernel, sum: f64) -> Self {
        let table = kernel.distance_table(sum);
        let peak_score = kernel.peak_score(&table).max(f64::MIN_POSITIVE);
        Self {
            sum,
            table,
            peak_score,
        }
    }
}

/// Distance in Å from which neither the ranking kernel nor that of an effect rises above the tolerance, for the widest
/// sum of radii.
pub(super) fn longest_reach(
    kernel: &RankingKernel,
    effects: &[ActiveTerm],
    widest: &Widest,
    tolerance: f64,
) -> f64 {
    let peak_score = widest.peak_score;
    let of_effects = effects.iter().map(|ActiveTerm { term, kernel }| {
        let largest = term.largest().max(f64::MIN_POSITIVE);
        kernel.effective_reach(tolerance * peak_score / largest)
    });
    of_effects.fold(
        kernel.effective_reach(&widest.table, tolerance * peak_score),
        f64::max,
    )
}

/// By how much the bound on the sum of dropped modes may exceed the tolerance. It has them in phase for a pair at its
/// worst, while whole sums were off by at most a tenth of it (1 to 160 balls, `cut_modes_stay_within_the_tolerance` in
/// tests/fast_path.rs).
const SLACK: f64 = 6.0;

/// Grid spacing that keeps all modes of the ranking kernel that count; `dynamic_range` as for [`window_width`].
pub(super) fn ranking_spacing(
    kernel: &RankingKernel,
    widest: &Widest,
    tolerance: f64,
    dynamic_range: f64,
) -> f64 {
    // With a cusp at its middle (alpha below 1) the kernel rewards so little that what the window leaks counts at any
    // tolerance.
    let cut = if tolerance >= 1e-2 && kernel.options().alpha >= 1.0 {
        kernel.stop()
    } else {
        // Beyond the usual penalty there is none: with it, lambda = 1,000 misses 1e-3 by a twentieth
        // (tests/hard_cases/kernel.rs).
        let slack = if dynamic_range > 1.0 { 1.0 } else { SLACK };
        kernel.band_end(widest.sum, slack * tolerance * widest.peak_score)
    };
    0.5 / cut
}

/// The product kernel for the smallest and largest radii of receptor and ligand, a spacing that keeps the modes that
/// count, and the distance beyond which a pair stays below the tolerance.
pub(super) fn product_kernel(
    options: EngineOptions,
    (band, unit): (Band, f64),
    [r_low, s_low, r_high, s_high]: [f64; 4],
    chosen: Option<f64>,
) -> Result<(ProductKernel, f64, f64), PlanError> {
    let largest = r_high.max(s_high);
    // No grid is planned finer than an eighth of the smallest ball unasked.
    let finest = 4.0 / r_low.min(s_low);
    let w_max = chosen.map_or(finest, |spacing| 0.5 / spacing);
    let kernel = ProductKernel::new(options.kernel, band, largest, w_max)?.in_unit(unit)?;
    let spacing = chosen.unwrap_or_else(|| match band {
        Band::LowPass => 0.5 * options.kernel.resolution,
        Band::Whole => {
            let (peak_score, _) = peak_score_and_reach(&kernel.pair_table(r_high, s_high), 0.0);
            // The bound has all modes of a pair in phase: the errors of whole sums were a hundredth of it (tests, 1e-2
            // to 1e-4).
            let allowed = 10.0 * options.tolerance * peak_score;
            let cut = (1..100)
                .map(|i| 0.01 * f64::from(i) * finest)
                .find(|&f| kernel.leak_beyond(r_low, s_low, f) <= allowed)
                .unwrap_or(finest);
            0.5 / cut
        }
    });
    let reach = match band {
        Band::Whole => kernel.reach(r_high, s_high),
        Band::LowPass => {
            peak_score_and_reach(&kernel.pair_table(r_high, s_high), options.tolerance).1
        }
    };
    Ok((kernel, spacing, reach))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two atoms at (0, 0, 0) and (0, 120000, 60000) against two near each other: a grid of a few points along x had
    /// nearly 1e9 columns of modes. The process was killed for lack of memory before the memory was checked. Voxels
    /// beyond 2^32 were numbered wrongly.
    #[test]
    fn grids_that_cannot_be_numbered_or_held_are_refused_before_anything_is_made() {
        let grid = |extent: [f64; 3], spacing: f64| {
            let bodies = Extents {
                receptor_center: Vector3::zeros(),
                receptor_extent: extent,
                ligand_center: Vector3::zeros(),
                ligand_radius: 3.0,
            };
            bodies.grid(15.0, 6, spacing)
        };
        let refused =
            |extent, spacing| matches!(grid(extent, spacing), Err(PlanError::TooLarge(_)));
        assert!(refused([0.0, 6e4, 3e4], 2.0));
        // Rather few points, but all of them columns.
        assert!(refused([0.0, 1e4, 1e4], 2.0));
        // Just short of 2^32 points as requested, and beyond with sizes that suit the transforms.
        let half = 0.5 * 1625.0 - 18.0;
        assert!(refused([half; 3], 1.0));
        assert!(
            refused([f64::MAX; 3], 1.0)
                && refused([1e12, 0.0, 0.0], 1.0)
                && refused([10.0; 3], 1e-300)
        );
        for fits in [
            [780.0; 3],
            [4e5, 0.0, 0.0],
            [0.0, 0.0, 4e5],
            [0.0, 4e5, 0.0],
        ] {
            let size = grid(fits, 1.0).unwrap();
            assert!(
                size.iter().product::<usize>() <= u32::MAX as usize,
                "{size:?}"
            );
        }
    }
}
