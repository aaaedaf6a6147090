//! The plan of a correlation: box, grid, modes, lifted modes and spreading window, chosen from the knots and a
//! tolerance.
//!
//! # Conventions
//!
//! Receptor and ligand are recentred on the middles of their bounding boxes. A voxel (ix, iy, iz) of the grid stands
//! for a position t of the ligand's centre relative to the receptor's: `Plan` and the engine share the map between the
//! two.
//!
//! A plan correlates one of two pair kernels ([`PairKernel`]): the lifted cone that ranks poses, or the product kernel
//! of rasterised bumps, for comparison with grid engines. All that follows a plan takes its kernel from
//! [`Plan::coupling`] alone.

mod error;
mod frame;
mod grid;

use crate::kernel::product::{Body, LAYERS};
use crate::kernel::table::Table;
use crate::kernel::{Band, KernelOptions, ProductKernel, RankingKernel};
use crate::lifted_axis::{LiftedAxis, RadiusBasis};
use crate::quantity::Quantity;
use crate::terms::effect::{ActiveTerm, EffectKernel, Term, classes};
use crate::transform::modes::ModeSet;
use crate::transform::truncation::ball;
use error::{check_bodies, check_terms, check_tolerance, checked_spacing};
use frame::best_frame;
use grid::{
    Extents, Widest, longest_reach, modes_at, oversampling, product_kernel, ranking_spacing,
    window_width,
};
use knotdock_structures::Knots;
use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

pub use error::PlanError;

/// Most by which the largest |G| is taken to exceed the best score more than usual: that of the largest lambda.
const WIDEST_RANGE: f64 = 5e4;

/// Share of the overlap of two coincident balls that must be left for them to count as resolved.
const RESOLVED_SHARE: f64 = 0.1;

/// Options of the engine: the kernel, and the parameters of the approximation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EngineOptions {
    /// The kernel that is correlated.
    pub kernel: KernelOptions,
    /// Grid spacing in Å; `None`: as the tolerance needs, resolution / 2 at most.
    pub spacing: Option<f64>,
    /// Error of the fast path that is aimed at, relative to the best score.
    pub tolerance: f64,
}

impl Default for EngineOptions {
    /// The kernel of `knotdock dock` on the grid that a tolerance of 1e-2 needs.
    fn default() -> Self {
        Self {
            kernel: KernelOptions::default(),
            spacing: None,
            tolerance: 1e-2,
        }
    }
}

/// The function of two balls that a plan correlates.
#[derive(Clone, Debug)]
pub enum PairKernel {
    /// The lifted cone at r + s + rho, low-passed and windowed: `Plan::kernel`.
    Lifted,
    /// The overlap of the two balls' bumps, whose transform factorises: no lifted axis is needed, radii meet as they
    /// are.
    Product(Box<ProductKernel>),
}

/// A planned correlation.
#[derive(Clone, Debug)]
pub struct Plan {
    options: EngineOptions,
    pair: PairKernel,
    kernel: RankingKernel,
    effects: Vec<ActiveTerm>,
    axis: LiftedAxis,
    axis_error: f64,
    basis: RadiusBasis,
    /// Whether grown balls have separate weights, so that each function of the radius counts twice.
    layered: bool,
    modes: Arc<ModeSet>,
    spacing: f64,
    fine: [usize; 3],
    width: usize,
    effective_reach: f64,
    /// Oversampling of the fine grid.
    ratio: f64,
    frame: UnitQuaternion<f64>,
    extents: Extents,
}

/// Decisions of the plan.
impl Plan {
    /// The options that it was made from.
    pub fn options(&self) -> &EngineOptions {
        &self.options
    }

    /// Choice of the kernel to correlate.
    pub fn pair(&self) -> &PairKernel {
        &self.pair
    }

    /// The ranking kernel.
    pub fn kernel(&self) -> &RankingKernel {
        &self.kernel
    }

    /// Terms beside shape, each with its filtered kernel.
    pub fn effects(&self) -> &[ActiveTerm] {
        &self.effects
    }

    /// The lifted modes; of a product kernel the mean alone, which nothing uses.
    pub fn axis(&self) -> &LiftedAxis {
        &self.axis
    }

    /// Largest relative error of the lifted series at the radius sums in use, or of the product kernel's interpolation
    /// over radii.
    pub fn axis_error(&self) -> f64 {
        self.axis_error
    }

    /// Functions of the radius on the lifted axis.
    pub fn basis(&self) -> &RadiusBasis {
        &self.basis
    }

    /// The modes kept.
    pub fn modes(&self) -> &Arc<ModeSet> {
        &self.modes
    }

    /// Grid points per axis.
    pub fn size(&self) -> [usize; 3] {
        self.modes.size
    }

    /// Grid spacing in Å.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Fine grid of the NUFFT, points per axis.
    pub fn fine(&self) -> [usize; 3] {
        self.fine
    }

    /// Width of the spreading window, fine cells.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Distance in Å beyond which the kernel stays below the tolerance: what the box allows for.
    pub fn effective_reach(&self) -> f64 {
        self.effective_reach
    }

    /// The rotation from the axes of the receptor's file to those of the grid: the identity, but of a plan that is
    /// [`Plan::fitted`].
    pub fn frame(&self) -> UnitQuaternion<f64> {
        self.frame
    }

    /// Middle of the receptor's bounding box along the grid's axes, in the receptor's file, Å.
    pub fn receptor_center(&self) -> Vector3<f64> {
        self.extents.receptor_center
    }

    /// Half the receptor's bounding box along the grid's axes, or more, Å.
    pub fn receptor_extent(&self) -> [f64; 3] {
        self.extents.receptor_extent
    }

    /// Middle of the ligand's bounding box, Å.
    pub fn ligand_center(&self) -> Vector3<f64> {
        self.extents.ligand_center
    }

    /// Distance of the farthest ligand knot from it, Å.
    pub fn ligand_radius(&self) -> f64 {
        self.extents.ligand_radius
    }

    /// Whether a ligand is within the room of the plan.
    pub(crate) fn holds_ligand(&self, ligand: &Knots) -> bool {
        let distance = |x: &[f64; 3]| (Vector3::from(*x) - self.ligand_center()).norm();
        let room = self.ligand_radius() * (1.0 + 1e-9) + 1e-9 * self.spacing;
        ligand.centers.iter().all(|x| distance(x) <= room)
    }

    /// Distance in Å beyond which two knots do not interact.
    pub fn reach(&self) -> f64 {
        match self.pair {
            PairKernel::Lifted => self.kernel.reach(),
            PairKernel::Product(_) => self.effective_reach,
        }
    }
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

    /// Plans the correlation of shape and further terms with the kernel of another tolerance, whose window is part of its
    /// definition: values compare with those of a coarser run of that tolerance.
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

    /// Plans the correlation of two sets of knots by the product kernel (`options.kernel.trim` has no meaning there).
    ///
    /// Under [`Band::LowPass`] the modes below the stop frequency are all there is. Under [`Band::Whole`] the grid cuts
    /// the kernel sharply at 1 / (2 spacing), by default where less than the tolerance is beyond.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn product(
        receptor: &Knots,
        ligand: &Knots,
        options: EngineOptions,
        band: Band,
    ) -> Result<Self, PlanError> {
        Self::product_in(receptor, ligand, options, band, 1.0)
    }

    /// As [`Plan::product`], with volumes in the cube of a length, `unit`: scores then do not depend on the unit of
    /// lengths, and stay within single precision whatever it is.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn product_in(
        receptor: &Knots,
        ligand: &Knots,
        options: EngineOptions,
        band: Band,
        unit: f64,
    ) -> Result<Self, PlanError> {
        let product = Some((band, unit));
        let tolerance = options.tolerance;
        Self::build(receptor, ligand, options, tolerance, product, Vec::new())
    }

    fn build(
        receptor: &Knots,
        ligand: &Knots,
        options: EngineOptions,
        kernel_tolerance: f64,
        of_product: Option<(Band, f64)>,
        terms: Vec<Term>,
    ) -> Result<Self, PlanError> {
        let band = of_product.map(|(band, _)| band);
        check_bodies(receptor, ligand)?;
        check_terms(&terms, receptor, ligand)?;
        check_tolerance(options.tolerance)?;
        check_tolerance(kernel_tolerance)?;
        let tolerance = options.tolerance;
        let radii = Radii::of(receptor, ligand);
        let (least, widest) = radii.sums();
        // With a penalty beyond the usual the largest |G| grows by lambda^2 and the best score, the measure of errors,
        // by lambda. Balls much larger than their skin earn less, too: their bumps are soft in proportion. How far sums
        // over pairs cancel (lambda near 1) no pair shows: a correlator measures that.
        let of_penalty = options.kernel.lambda.abs() / 20.0;
        let mut of_pairs = 0.0f64;
        for sum in [least, widest] {
            let (reward, largest) = options.kernel.extremes(sum)?;
            if reward > 0.0 && of_product.is_none() {
                of_pairs = of_pairs.max(largest / (20.0 * reward));
            }
        }
        let dynamic_range = of_penalty.max(of_pairs).clamp(1.0, WIDEST_RANGE);
        // A longer window leaks less past the stop frequency; the shortest serves docking (1e-2).
        let reach_factor = 1.15 + 0.75 * (1e-2 * dynamic_range / kernel_tolerance).log10().max(0.0);
        let kernel = RankingKernel::new(options.kernel, least, widest, reach_factor)?;
        let effects: Vec<ActiveTerm> = terms
            .into_iter()
            .map(|term| ActiveTerm {
                kernel: EffectKernel::new(kernel.filter(), &term.radial),
                term,
            })
            .collect();
        let chosen = checked_spacing(options.spacing)?;
        let (pair, spacing, effective_reach) = match of_product {
            None => {
                let widest = Widest::new(&kernel, widest);
                let spacing = chosen
                    .unwrap_or_else(|| ranking_spacing(&kernel, &widest, tolerance, dynamic_range));
                let reach = longest_reach(&kernel, &effects, &widest, tolerance);
                (PairKernel::Lifted, spacing, reach)
            }
            Some(of_product) => {
                let (product, spacing, reach) =
                    product_kernel(options, of_product, radii.ends(), chosen)?;
                (PairKernel::Product(Box::new(product)), spacing, reach)
            }
        };
        let extents = Extents::of(receptor, ligand);
        let ratio = oversampling(tolerance, band);
        let width = window_width(tolerance, dynamic_range, ratio);
        let (modes, fine) = modes_at(spacing, &extents, effective_reach, width, ratio)?;
        let (axis, basis, axis_error) = radii.meet(&kernel, &pair, modes.cut, 1e-3 * tolerance);
        Ok(Self {
            options,
            pair,
            axis,
            axis_error,
            basis,
            layered: band.is_some()
                && [receptor, ligand]
                    .iter()
                    .any(|knots| !knots.skin_weights.is_empty()),
            modes,
            spacing,
            fine,
            width,
            effective_reach,
            ratio,
            frame: UnitQuaternion::identity(),
            extents,
            kernel,
            effects,
        })
    }

    /// The same correlation on a grid of another spacing in Å, which is all that depends on it. The tables of a product
    /// kernel end with the grid's frequencies: it serves coarser spacings alone.
    ///
    /// # Errors
    /// [`PlanError`] on a spacing that gives no grid.
    pub fn with_spacing(&self, spacing: f64) -> Result<Self, PlanError> {
        checked_spacing(Some(spacing))?;
        let (reach, width) = (self.effective_reach, self.width);
        let (modes, fine) = modes_at(spacing, &self.extents, reach, width, self.ratio)?;
        Ok(Self {
            options: EngineOptions {
                spacing: Some(spacing),
                ..self.options
            },
            modes,
            spacing,
            fine,
            ..self.clone()
        })
    }

    /// The same correlation on a grid whose axes are turned to where the receptor, that of the plan, needs the fewest
    /// points. Poses stay in the frames of the files.
    ///
    /// # Errors
    /// [`PlanError`] where a grid is too large.
    pub fn fitted(&self, receptor: &Knots) -> Result<Self, PlanError> {
        let (reach, width, spacing) = (self.effective_reach, self.width, self.spacing);
        let size = |extents: &Extents| extents.grid(reach, width, spacing).ok();
        let Some(frame) = best_frame(receptor, &self.extents, size) else {
            return Ok(self.clone());
        };
        let extents = self.extents.turned(&receptor.centers, frame);
        let (modes, fine) = modes_at(spacing, &extents, reach, width, self.ratio)?;
        Ok(Self {
            frame,
            modes,
            fine,
            extents,
            ..self.clone()
        })
    }

    /// Number of functions in which the ligand meets the receptor: those of the lifted axis, and one for each class of
    /// a further term.
    pub fn functions(&self) -> usize {
        let terms = self.effects.iter();
        let classes = terms.map(|active| classes(&active.term.ligand).len());
        self.shape_functions().1 + classes.sum::<usize>()
    }

    /// Functions of shape on the receptor's and on the ligand's side: those of the radius, for each layer where grown
    /// balls have separate weights.
    pub fn shape_functions(&self) -> (usize, usize) {
        let layers = if self.layered { LAYERS.len() } else { 1 };
        let size = |side| layers * self.basis.size(&self.axis, side);
        (size(0), size(1))
    }

    /// The layer of a function of shape of a side (0: the receptor), and its function of the radius.
    fn layer(&self, function: usize, side: usize) -> (Option<Body>, usize) {
        if !self.layered {
            return (None, function);
        }
        let size = self.basis.size(&self.axis, side).max(1);
        (LAYERS.get(function / size).copied(), function % size)
    }

    /// Weight of a knot of a side times the value of a function of shape at its radius.
    pub(crate) fn shape_value(
        &self,
        knots: &Knots,
        side: usize,
        function: usize,
        knot: usize,
    ) -> f64 {
        let (layer, index) = self.layer(function, side);
        let value = self.basis.value(&self.axis, side, index, knots.radii[knot]);
        value * weight(knots, layer, knot)
    }

    /// The same correlation with at most `most` modes, conjugates counted, those of lowest frequency: the grid stays,
    /// and the transforms shrink with the modes.
    pub fn truncated(&self, most: usize) -> Self {
        Self {
            modes: Arc::new(ball(&self.modes, most)),
            ..self.clone()
        }
    }

    /// Indices of the knots that the planned correlation cannot resolve.
    ///
    /// The low-pass leaves less than a tenth of the overlap of two such coincident balls, which falls like (radius /
    /// resolution)^3. (It leaves nine tenths for radii of 1.5 to 1.9 Å at a resolution of 4.5 Å.) The exact sum has the
    /// same low-pass, so no error shows it. Without a low-pass their radius is below the grid spacing.
    pub fn unresolved(&self, knots: &Knots) -> Vec<usize> {
        let is_lost = |radius: f64| match &self.pair {
            PairKernel::Product(kernel) if kernel.band() == Band::Whole => radius < self.spacing,
            _ => self.kernel.overlap_left(2.0 * radius) < RESOLVED_SHARE,
        };
        let (radii, classes) = knots.radius_classes();
        let lost: Vec<bool> = radii.into_iter().map(is_lost).collect();
        (0..knots.len())
            .filter(|&index| lost[classes[index]])
            .collect()
    }

    /// Radial spectrum that couples function a of the receptor's shape with function b of the ligand's in a quantity, on
    /// all modes kept; `None` where it is zero.
    pub fn coupling(&self, fold: Quantity, (a, b): (usize, usize)) -> Option<Table<1>> {
        let w_max = self.modes.cut;
        match &self.pair {
            PairKernel::Lifted => {
                self.basis
                    .coupling(&self.kernel, &self.axis, fold, (a, b), w_max)
            }
            PairKernel::Product(product) => {
                let ((of_a, a), (of_b, b)) = (self.layer(a, 0), self.layer(b, 1));
                let layers = of_a.zip(of_b);
                self.basis
                    .product_coupling(product, fold, (a, b), layers, w_max)
            }
        }
    }
}

/// The distinct radii of the receptor and of the ligand, Å, each from the smallest to the largest.
struct Radii([Vec<f64>; 2]);

impl Radii {
    fn of(receptor: &Knots, ligand: &Knots) -> Self {
        Self([receptor, ligand].map(|knots| knots.radius_classes().0))
    }

    /// The smallest radius of the receptor and of the ligand, then the largest; zeros where there is none.
    fn ends(&self) -> [f64; 4] {
        let [receptor, ligand] = &self.0;
        let ends = [
            receptor.first(),
            ligand.first(),
            receptor.last(),
            ligand.last(),
        ];
        ends.map(|radius| radius.copied().unwrap_or_default())
    }

    /// The smallest and the largest sum of a receptor's and a ligand's radius.
    fn sums(&self) -> (f64, f64) {
        let [r_low, s_low, r_high, s_high] = self.ends();
        (r_low + s_low, r_high + s_high)
    }

    /// The lifted axis, the basis of the radii, and its largest relative error, `tolerance` at most. A product kernel,
    /// whose frequencies end at `cut` per Å, has no use for the axis, which is the mean alone then.
    fn meet(
        self,
        kernel: &RankingKernel,
        pair: &PairKernel,
        cut: f64,
        tolerance: f64,
    ) -> (LiftedAxis, RadiusBasis, f64) {
        match pair {
            PairKernel::Lifted => {
                let (axis, error) = LiftedAxis::for_tolerance(kernel, tolerance);
                let basis = RadiusBasis::choose(&axis, self.0);
                (axis, basis, error)
            }
            PairKernel::Product(product) => {
                let (basis, error) = RadiusBasis::for_product(product, self.0, cut, tolerance);
                (LiftedAxis::new(kernel, 0), basis, error)
            }
        }
    }
}

/// Weight of a knot in a layer.
fn weight(knots: &Knots, layer: Option<Body>, knot: usize) -> f64 {
    let own = match layer {
        Some(Body::Grown) if !knots.skin_weights.is_empty() => &knots.skin_weights,
        _ => &knots.weights,
    };
    own[knot]
}
