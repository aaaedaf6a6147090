//! The plan of a correlation: box, grid, modes, lifted modes and spreading window, chosen from the knots and a tolerance.
//!
//! # Conventions
//!
//! Receptor and ligand are recentred on the middles of their bounding boxes. A voxel (ix, iy, iz) of the grid stands for a
//! position t of the ligand's centre relative to the receptor's: `Plan` and the engine share the map between the two.
//!
//! A plan correlates one of two pair kernels ([`PairKernel`]): the lifted cone that ranks poses, or the product kernel of rasterised
//! bumps, for comparison with grid engines. All that follows a plan takes its kernel from [`Plan::coupling`] alone.

use crate::effect::{ActiveTerm, EffectKernel, Term};
use crate::exact::center;
use crate::kernel::product::rim_and_reach;
use crate::kernel::ranking::KernelError;
use crate::kernel::table::Table;
use crate::kernel::{Band, KernelOptions, ProductKernel, RankingKernel};
use crate::lifted_axis::{Fold, LiftedAxis, RadiusBasis};
use crate::transform::fast_size;
use crate::transform::modes::ModeSet;
use crate::transform::spreading::{MAX_WIDTH, SpreadingKernel};
use crate::transform::truncation::ball;
use knotdock_structures::Knots;
use knotdock_structures::knots::KnotsError;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What a user may set; every approximation is a knob.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EngineOptions {
    /// The kernel that is correlated.
    pub kernel: KernelOptions,
    /// Grid spacing in Å; `None`: as the tolerance needs, resolution / 2 at most.
    pub spacing: Option<f64>,
    /// Error of the fast path that is aimed at, relative to the best score.
    pub tolerance: f64,
    /// Rank of the lifted axis; `None`: as the tolerance needs.
    pub rank: Option<usize>,
}

/// Why no plan could be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// The knots are not usable.
    #[error(transparent)]
    Knots(#[from] KnotsError),
    /// The kernel's options are not usable.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// A number is out of its range.
    #[error("{name} is {value}; it must be {bound}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its range.
        bound: &'static str,
    },
    /// A weight has an imaginary part.
    #[error("the fast engine takes real weights; knot {0} has a complex one")]
    ComplexWeight(usize),
    /// A body's weights are so large or small that scores would leave the range of single precision.
    #[error(
        "a body's weights add up to {0:.1e} in size; multiply them by a common factor that brings this between 1e-9 and 1e9"
    )]
    WeightRange(f64),
    /// The box would need more grid points than any machine holds.
    #[error("a grid of {0:.2e} points is needed; use a coarser spacing")]
    TooLarge(f64),
}

/// The function of two balls that a plan correlates.
#[derive(Clone, Debug)]
pub enum PairKernel {
    /// The lifted cone at r + s + rho, low-passed and windowed: `Plan::kernel`.
    Lifted,
    /// The overlap of the two balls' bumps, whose transform factorises: no lifted axis is needed, radii meet as they are.
    Product(Box<ProductKernel>),
}

/// A planned correlation.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The options it was made from.
    pub options: EngineOptions,
    /// Which kernel is correlated.
    pub pair: PairKernel,
    /// The ranking kernel.
    pub kernel: RankingKernel,
    /// Terms beside shape, each with its filtered kernel.
    pub effects: Vec<ActiveTerm>,
    /// Its lifted modes; of a product kernel the mean alone, which nothing uses.
    pub axis: LiftedAxis,
    /// Largest relative error of the lifted series at the radius sums in use, or of the product kernel's interpolation over radii.
    pub axis_error: f64,
    /// How radii meet the lifted axis.
    pub basis: RadiusBasis,
    /// The modes kept.
    pub modes: Arc<ModeSet>,
    /// Grid spacing in Å.
    pub spacing: f64,
    /// Fine grid of the nonequispaced transforms, points per axis.
    pub fine: [usize; 3],
    /// Width of the spreading window, fine cells.
    pub width: usize,
    /// Distance in Å beyond which the kernel stays below the tolerance: what the box allows for.
    pub effective_reach: f64,
    /// Middle of the receptor's bounding box, Å.
    pub receptor_center: Vector3<f64>,
    /// Half the receptor's bounding box, Å.
    pub receptor_extent: [f64; 3],
    /// Middle of the ligand's bounding box, Å.
    pub ligand_center: Vector3<f64>,
    /// Distance of the farthest ligand knot from it, Å.
    pub ligand_radius: f64,
}

/// Oversampling of the fine grid against the mode grid. The low-pass takes the modes near the grid's own limit down to
/// nothing, so far less is needed than the 2 of a transform whose modes all count alike.
fn oversampling(tolerance: f64) -> f64 {
    if tolerance >= 1e-3 { 1.25 } else { 1.5 }
}

impl Plan {
    /// Plans the correlation of two sets of knots by the ranking kernel.
    ///
    /// # Errors
    /// [`PlanError`] on knots or options that cannot be used.
    pub fn new(
        receptor: &Knots,
        ligand: &Knots,
        options: EngineOptions,
    ) -> Result<Self, PlanError> {
        Self::with_effects(receptor, ligand, options, options.tolerance, Vec::new())
    }

    /// Plans the correlation of shape and further terms, with the kernel of a tolerance as [`Plan::with_kernel_of`] does.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn with_effects(
        receptor: &Knots,
        ligand: &Knots,
        options: EngineOptions,
        kernel_tolerance: f64,
        terms: Vec<Term>,
    ) -> Result<Self, PlanError> {
        Self::build(receptor, ligand, options, kernel_tolerance, None, terms)
    }

    /// Plans a correlation whose kernel is that of another tolerance, so that its values compare with those of a coarser run:
    /// the kernel's window is part of its definition.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn with_kernel_of(
        receptor: &Knots,
        ligand: &Knots,
        options: EngineOptions,
        kernel_tolerance: f64,
    ) -> Result<Self, PlanError> {
        Self::with_effects(receptor, ligand, options, kernel_tolerance, Vec::new())
    }

    /// Plans the correlation of two sets of knots by the product kernel (`options.kernel.trim` has no meaning there).
    ///
    /// Under [`Band::LowPass`] the modes below the stop frequency are all there is. Under [`Band::Whole`] the grid cuts the kernel
    /// sharply at 1 / (2 spacing), by default where less than the tolerance lies beyond.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn product(
        receptor: &Knots,
        ligand: &Knots,
        options: EngineOptions,
        band: Band,
    ) -> Result<Self, PlanError> {
        Self::build(
            receptor,
            ligand,
            options,
            options.tolerance,
            Some(band),
            Vec::new(),
        )
    }

    fn build(
        receptor: &Knots,
        ligand: &Knots,
        options: EngineOptions,
        kernel_tolerance: f64,
        band: Option<Band>,
        terms: Vec<Term>,
    ) -> Result<Self, PlanError> {
        check_bodies(receptor, ligand)?;
        let tolerance = options.tolerance;
        for value in [tolerance, kernel_tolerance] {
            if !(1e-8..=0.1).contains(&value) {
                return Err(PlanError::Option {
                    name: "tolerance",
                    value,
                    bound: "between 1e-8 and 0.1",
                });
            }
        }
        let (receptor_radii, _) = receptor.radius_classes();
        let (ligand_radii, _) = ligand.radius_classes();
        let ends = |radii: &[f64]| match (radii.first(), radii.last()) {
            (Some(&low), Some(&high)) => (low, high),
            _ => (0.0, 0.0),
        };
        let (r_low, r_high) = ends(&receptor_radii);
        let (s_low, s_high) = ends(&ligand_radii);
        // A longer window leaks less past the stop frequency; the shortest serves docking (1e-2).
        // With a penalty beyond the usual the largest |G| grows by lambda^2 and the best score, the measure of errors, by lambda.
        let severity = (options.kernel.lambda.abs() / 20.0).max(1.0);
        let reach_factor = 1.15 + 0.75 * (1e-2 * severity / kernel_tolerance).log10().max(0.0);
        let kernel =
            RankingKernel::new(options.kernel, r_low + s_low, r_high + s_high, reach_factor)?;
        let chosen = match options.spacing {
            Some(spacing) if spacing.is_finite() && spacing > 0.0 => Some(spacing),
            Some(value) => {
                return Err(PlanError::Option {
                    name: "spacing",
                    value,
                    bound: "above 0 and finite",
                });
            }
            None => None,
        };
        let effects: Vec<ActiveTerm> = terms
            .into_iter()
            .map(|term| ActiveTerm {
                kernel: EffectKernel::new(kernel.filter(), &term.radial),
                term,
            })
            .collect();
        let (pair, spacing, effective_reach) = match band {
            None => {
                let widest = r_high + s_high;
                let rim = kernel.rim(widest).max(f64::MIN_POSITIVE);
                let spacing = chosen.unwrap_or_else(|| ranking_spacing(&kernel, widest, tolerance));
                let reach = effects.iter().fold(
                    kernel.effective_reach(widest, tolerance * rim),
                    |reach, ActiveTerm { term, kernel }| {
                        let largest = term.largest().max(f64::MIN_POSITIVE);
                        reach.max(kernel.effective_reach(tolerance * rim / largest))
                    },
                );
                (PairKernel::Lifted, spacing, reach)
            }
            Some(band) => {
                let ends = [r_low, s_low, r_high, s_high];
                let (product, spacing, reach) = product_kernel(options, band, ends, chosen)?;
                (PairKernel::Product(Box::new(product)), spacing, reach)
            }
        };
        let receptor_center = center(receptor);
        let ligand_center = center(ligand);
        let (low, high) = receptor.bounds();
        let receptor_extent = [0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis]));
        let ligand_radius = ligand
            .centers
            .iter()
            .map(|&x| (Vector3::from(x) - ligand_center).norm())
            .fold(0.0, f64::max);
        let ratio = match band {
            // Cut sharply, all modes count alike.
            Some(Band::Whole) => 2.0,
            _ => oversampling(tolerance),
        };
        // Errors of the transform are relative to the largest |G|, that of overlapping centres, some fifty times the best score.
        // The modes that matter there are the low ones, which the window serves better: a tenth is enough for docking.
        let share = if tolerance >= 1e-2 { 0.1 } else { 0.01 };
        let share = share / severity;
        let width =
            SpreadingKernel::<f64>::width_for(share * tolerance, ratio * 1.2).min(MAX_WIDTH);
        let mut points = 1.0;
        let size = [0, 1, 2].map(|axis| {
            let length = 2.0 * (receptor_extent[axis] + ligand_radius + effective_reach);
            // The larger body's spread block, its window and the cells lost to rounding up included, must fit into the box, which
            // a kernel shorter than that window would make too small.
            let extent = receptor_extent[axis].max(ligand_radius);
            let block = 2.0 * extent + (width as f64 + 6.0) * spacing;
            let count = (length.max(block) / spacing).ceil().max(4.0);
            points *= count;
            if count < 1e6 {
                fast_size(count as usize)
            } else {
                0
            }
        });
        if points > 1e11 || size.contains(&0) {
            return Err(PlanError::TooLarge(points));
        }
        let lengths = size.map(|n| n as f64 * spacing);
        let modes = Arc::new(ModeSet::new(size, lengths, 0.5 / spacing));
        let fine = size.map(|n| fast_size((n as f64 * ratio).ceil() as usize));
        let (axis, basis, axis_error) = match &pair {
            PairKernel::Lifted => {
                let (axis, error) = LiftedAxis::for_tolerance(&kernel, 1e-3 * tolerance);
                let basis = RadiusBasis::choose(&axis, receptor_radii, ligand_radii);
                (axis, basis, error)
            }
            PairKernel::Product(product) => {
                let cut = 0.5 / spacing;
                let (basis, error) = RadiusBasis::for_product(
                    product,
                    receptor_radii,
                    ligand_radii,
                    cut,
                    1e-3 * tolerance,
                );
                (LiftedAxis::new(&kernel, 0), basis, error)
            }
        };
        Ok(Self {
            options,
            pair,
            axis,
            axis_error,
            basis,
            modes,
            spacing,
            fine,
            width,
            effective_reach,
            receptor_center,
            receptor_extent,
            ligand_center,
            ligand_radius,
            kernel,
            effects,
        })
    }

    /// Number of functions in which the ligand meets the receptor: those of the lifted axis, and one for each class of a further term.
    pub fn functions(&self) -> usize {
        let classes = self.effects.iter().map(|ActiveTerm { term, .. }| {
            let mut seen: Vec<usize> = term
                .ligand
                .iter()
                .filter(|label| label.value != 0.0)
                .map(|label| label.class)
                .collect();
            seen.sort_unstable();
            seen.dedup();
            seen.len()
        });
        self.basis.sizes(&self.axis).1 + classes.sum::<usize>()
    }

    /// The same correlation with at most `most` modes, conjugates counted, those of lowest frequency: the grid stays, and the
    /// transforms shrink with the modes.
    pub fn truncated(&self, most: usize) -> Self {
        Self {
            modes: Arc::new(ball(&self.modes, most)),
            ..self.clone()
        }
    }

    /// Radial spectrum that couples receptor function a with ligand function b of [`Plan::basis`] in the folded kernel, on all modes
    /// kept; `None` where it is zero.
    pub fn coupling(&self, fold: Fold, (a, b): (usize, usize)) -> Option<Table<1>> {
        let w_max = self.modes.cut;
        match &self.pair {
            PairKernel::Lifted => {
                self.basis
                    .coupling(&self.kernel, &self.axis, fold, (a, b), w_max)
            }
            PairKernel::Product(product) => {
                self.basis.product_coupling(product, fold, (a, b), w_max)
            }
        }
    }

    /// Distance in Å beyond which two knots do not feel each other.
    pub fn reach(&self) -> f64 {
        match self.pair {
            PairKernel::Lifted => self.kernel.reach(),
            PairKernel::Product(_) => self.effective_reach,
        }
    }

    /// Grid points per axis.
    pub fn size(&self) -> [usize; 3] {
        self.modes.size
    }
}

/// Refuses knots that no engine can correlate: unusable ones, complex weights, and weights that leave single precision.
pub(super) fn check_bodies(receptor: &Knots, ligand: &Knots) -> Result<(), PlanError> {
    for knots in [receptor, ligand] {
        knots.check()?;
        if let Some(index) = knots.weights.iter().position(|c| c.im != 0.0) {
            return Err(PlanError::ComplexWeight(index));
        }
        let size: f64 = knots.weights.iter().map(|c| c.re.abs()).sum();
        // No weight at all is a body that scores nothing, which every precision holds.
        if size != 0.0 && !(1e-9..=1e9).contains(&size) {
            return Err(PlanError::WeightRange(size));
        }
    }
    Ok(())
}

/// Grid spacing that keeps all modes of the ranking kernel that count.
fn ranking_spacing(kernel: &RankingKernel, widest: f64, tolerance: f64) -> f64 {
    let stop = kernel.stop();
    // With a cusp at its middle (alpha below 1) the kernel rewards so little that what the window leaks counts at any tolerance.
    let cut = if tolerance >= 1e-2 && kernel.options().alpha >= 1.0 {
        stop
    } else {
        let rim = kernel.rim(widest).max(f64::MIN_POSITIVE);
        (0..100)
            .map(|i| stop * (1.0 + 0.02 * f64::from(i)))
            .find(|&f| kernel.leak_beyond(widest, f) <= tolerance * rim)
            .unwrap_or(2.0 * stop)
    };
    0.5 / cut
}

/// The product kernel for the smallest and largest radii of receptor and ligand, a spacing that keeps the modes that count, and the
/// distance beyond which a pair stays below the tolerance.
fn product_kernel(
    options: EngineOptions,
    band: Band,
    [r_low, s_low, r_high, s_high]: [f64; 4],
    chosen: Option<f64>,
) -> Result<(ProductKernel, f64, f64), PlanError> {
    let largest = r_high.max(s_high);
    // No grid is planned finer than an eighth of the smallest ball unasked.
    let finest = 4.0 / r_low.min(s_low);
    let w_max = chosen.map_or(finest, |spacing| 0.5 / spacing);
    let kernel = ProductKernel::new(options.kernel, band, largest, w_max)?;
    let spacing = chosen.unwrap_or_else(|| match band {
        Band::LowPass => 0.5 * options.kernel.resolution,
        Band::Whole => {
            let (rim, _) = rim_and_reach(&kernel.pair_table(r_high, s_high), 0.0);
            // The bound has all modes of a pair in phase: the errors of whole sums were a hundredth of it (tests, 1e-2 to 1e-4).
            let allowed = 10.0 * options.tolerance * rim;
            let cut = (1..100)
                .map(|i| 0.01 * f64::from(i) * finest)
                .find(|&f| kernel.leak_beyond(r_low, s_low, f) <= allowed)
                .unwrap_or(finest);
            0.5 / cut
        }
    });
    let reach = match band {
        Band::Whole => kernel.reach(r_high, s_high),
        Band::LowPass => rim_and_reach(&kernel.pair_table(r_high, s_high), options.tolerance).1,
    };
    Ok((kernel, spacing, reach))
}
