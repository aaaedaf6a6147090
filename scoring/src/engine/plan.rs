//! The plan of a correlation: box, grid, modes, lifted modes and spreading window, chosen from the knots and a tolerance.
//!
//! # Conventions
//!
//! Receptor and ligand are recentred on the middles of their bounding boxes. A voxel (ix, iy, iz) of the grid stands for a
//! position t of the ligand's centre relative to the receptor's: `Plan` and the engine share the map between the two.

use crate::exact::center;
use crate::kernel::ranking::KernelError;
use crate::kernel::{KernelOptions, RankingKernel};
use crate::lifted_axis::{LiftedAxis, RadiusBasis};
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
    /// A weight has an imaginary part, or the grid is beyond what can be indexed.
    #[error("the fast engine takes real weights; knot {0} has a complex one")]
    ComplexWeight(usize),
    /// The box would need more grid points than any machine holds.
    #[error("a grid of {0:.2e} points is needed; use a coarser spacing")]
    TooLarge(f64),
}

/// A planned correlation.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The options it was made from.
    pub options: EngineOptions,
    /// The kernel.
    pub kernel: RankingKernel,
    /// Its lifted modes.
    pub axis: LiftedAxis,
    /// Largest relative error of the lifted series at the radius sums in use.
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
    /// Plans the correlation of two sets of knots.
    ///
    /// # Errors
    /// [`PlanError`] on knots or options that cannot be used.
    pub fn new(
        receptor: &Knots,
        ligand: &Knots,
        options: EngineOptions,
    ) -> Result<Self, PlanError> {
        Self::with_kernel_of(receptor, ligand, options, options.tolerance)
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
        for knots in [receptor, ligand] {
            knots.check()?;
            if let Some(index) = knots.weights.iter().position(|c| c.im != 0.0) {
                return Err(PlanError::ComplexWeight(index));
            }
        }
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
        let reach_factor = 1.15 + 0.75 * (1e-2 / kernel_tolerance).log10().max(0.0);
        let kernel =
            RankingKernel::new(options.kernel, r_low + s_low, r_high + s_high, reach_factor)?;
        let widest = r_high + s_high;
        let rim = kernel.rim(widest).max(f64::MIN_POSITIVE);
        let spacing = match options.spacing {
            Some(spacing) if spacing.is_finite() && spacing > 0.0 => spacing,
            Some(value) => {
                return Err(PlanError::Option {
                    name: "spacing",
                    value,
                    bound: "above 0 and finite",
                });
            }
            None => {
                let stop = kernel.stop();
                let cut = if tolerance >= 1e-2 {
                    stop
                } else {
                    (0..100)
                        .map(|i| stop * (1.0 + 0.02 * f64::from(i)))
                        .find(|&f| kernel.leak_beyond(widest, f) <= tolerance * rim)
                        .unwrap_or(2.0 * stop)
                };
                0.5 / cut
            }
        };
        let effective_reach = kernel.effective_reach(widest, tolerance * rim);
        let receptor_center = center(receptor);
        let ligand_center = center(ligand);
        let (low, high) = receptor.bounds();
        let receptor_extent = [0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis]));
        let ligand_radius = ligand
            .centers
            .iter()
            .map(|&x| (Vector3::from(x) - ligand_center).norm())
            .fold(0.0, f64::max);
        let ratio = oversampling(tolerance);
        // Errors of the transform are relative to the largest |G|, that of overlapping centres, some fifty times the best score.
        // The modes that matter there are the low ones, which the window serves better: a tenth is enough for docking.
        let share = if tolerance >= 1e-2 { 0.1 } else { 0.01 };
        let width =
            SpreadingKernel::<f64>::width_for(share * tolerance, ratio * 1.2).min(MAX_WIDTH);
        let mut points = 1.0;
        let size = [0, 1, 2].map(|axis| {
            let length = 2.0 * (receptor_extent[axis] + ligand_radius + effective_reach);
            // The receptor's spread block must fit into the box.
            let block = 2.0 * receptor_extent[axis] + (width as f64 + 3.0) * spacing;
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
        let (axis, axis_error) = LiftedAxis::for_tolerance(&kernel, 1e-3 * tolerance);
        let basis = RadiusBasis::choose(&axis, receptor_radii, ligand_radii);
        Ok(Self {
            options,
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
        })
    }

    /// The same correlation with at most `most` modes, conjugates counted, those of lowest frequency: the grid stays, and the
    /// transforms shrink with the modes.
    pub fn truncated(&self, most: usize) -> Self {
        Self {
            modes: Arc::new(ball(&self.modes, most)),
            ..self.clone()
        }
    }

    /// Grid points per axis.
    pub fn size(&self) -> [usize; 3] {
        self.modes.size
    }
}
