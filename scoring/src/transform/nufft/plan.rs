//! The plan: the choice of grid and window for a tolerance.

use super::super::{Real, fast_size, spreading::MAX_WIDTH};
use super::sorted_points::Grid;
use super::window::{Quality, Window, best};
use rustfft::Fft;
use std::sync::Arc;
use thiserror::Error;

/// Oversampling factors that are weighed against each other.
const OVERSAMPLING: [f64; 4] = [1.125, 1.25, 1.5, 2.0];
/// Planes of the fine grid whose points are spread together.
const SLAB: usize = 8;
/// Share of the tolerance that the root mean square of the error may take. Points on the grid itself (on faces of the
/// box, say) bring the errors of all axes and of all aliases into step: measured 2.8 times the mean square's root in
/// three dimensions.
const ALIASING_SHARE: f64 = 0.33;
/// Most points of a fine grid.
const MAX_GRID: usize = u32::MAX as usize;

/// A planned pair of transforms between points and `D` = 3 or 4 axes of modes. See the [module](super) for conventions.
///
/// ```compile_fail
/// // Fewer than three axes do not compile.
/// let plan = knotdock_scoring::transform::nufft::Plan::<f64, 2>::new([8, 8], 1e-3, 10);
/// ```
pub struct Plan<T: Real, const D: usize> {
    pub(super) modes: [usize; D],
    pub(super) grid: Grid<D>,
    pub(super) window: Window<T>,
    /// One over the window's transform, for each axis and mode.
    pub(super) factors: [Vec<T>; D],
    pub(super) to_modes: [Arc<dyn Fft<T>>; D],
    pub(super) to_grid: [Arc<dyn Fft<T>>; D],
}

impl<T: Real, const D: usize> Plan<T, D> {
    /// Plans for `modes` an axis (any positive numbers) and a relative `tolerance`: 1e-12 to below 1 in f64, 1e-5 in
    /// f32. Grid and window are chosen for the least time at about `points` points; any number may be transformed.
    ///
    /// # Errors
    /// [`PlanError`] when an axis has no modes, the tolerance is out of reach, or the grid would be too large.
    pub fn new(modes: [usize; D], tolerance: f64, points: usize) -> Result<Self, PlanError> {
        Self::cheapest(modes, tolerance, points, &OVERSAMPLING)
    }

    /// As [`Self::new`], with the grid at least `oversampling` (above 1, at most 4) times finer than the modes.
    ///
    /// # Errors
    /// As [`Self::new`]; and when the oversampling is out of range. Little oversampling cannot reach small tolerances.
    pub fn with_oversampling(
        modes: [usize; D],
        tolerance: f64,
        oversampling: f64,
    ) -> Result<Self, PlanError> {
        if !(oversampling > 1.0 && oversampling <= 4.0) {
            return Err(PlanError::Oversampling {
                requested: oversampling,
            });
        }
        Self::cheapest(modes, tolerance, 0, &[oversampling])
    }

    /// Plans with the grid and window of least cost among the oversampling factors.
    fn cheapest(
        modes: [usize; D],
        tolerance: f64,
        points: usize,
        oversampling: &[f64],
    ) -> Result<Self, PlanError> {
        const { assert!(D == 3 || D == 4, "transforms have three or four axes") };
        check::<T, D>(&modes, tolerance)?;
        let Choice {
            fine,
            width,
            quality,
            ..
        } = choose::<T, D>(&modes, tolerance, points, oversampling)?;
        let window = Window::new(width, quality.shape, 0.02 * tolerance * quality.edge);
        Ok(Self {
            modes,
            grid: Grid {
                fine,
                widths: fine.map(|n| if n == 1 { 1 } else { width }),
                slab: SLAB,
            },
            factors: std::array::from_fn(|axis| factors(&window, modes[axis], fine[axis])),
            to_modes: fine.map(T::forward_fft),
            to_grid: fine.map(T::inverse_fft),
            window,
        })
    }

    /// Modes per axis.
    pub fn modes(&self) -> [usize; D] {
        self.modes
    }

    /// Number of modes in all.
    pub fn mode_count(&self) -> usize {
        self.modes.iter().product()
    }

    /// Points of the fine grid per axis; 1 on an axis of one mode, which needs no grid.
    pub fn grid(&self) -> [usize; D] {
        self.grid.fine
    }

    /// Width of the spreading window in grid points.
    pub fn width(&self) -> usize {
        self.window.width
    }

    /// [power, highest first][point of the window]: polynomials in 2 f - 1, f in [0, 1) the distance of the window's
    /// first point from its edge, of its points' values.
    #[cfg(feature = "gpu")]
    pub(crate) fn window_rows(&self) -> Vec<&[T]> {
        self.window.rows().collect()
    }

    /// One over the window's transform, by mode of an axis.
    #[cfg(feature = "gpu")]
    pub(crate) fn factors(&self, axis: usize) -> &[T] {
        &self.factors[axis]
    }
}

/// A grid and a window that reach the tolerance.
struct Choice<const D: usize> {
    /// As of [`cost`].
    cost: f64,
    fine: [usize; D],
    width: usize,
    quality: Quality,
}

/// Refuses modes and tolerances for which there is no plan.
fn check<T: Real, const D: usize>(modes: &[usize; D], tolerance: f64) -> Result<(), PlanError> {
    if let Some(axis) = modes.iter().position(|&n| n == 0) {
        return Err(PlanError::NoModes { axis });
    }
    let least = if T::epsilon().wide() > 1e-10 {
        1e-5
    } else {
        1e-12
    };
    // A tolerance of 1e-5 may arrive as the nearest f32.
    if !(tolerance >= 0.999 * least && tolerance < 1.0) {
        return Err(PlanError::Tolerance {
            requested: tolerance,
            least,
        });
    }
    Ok(())
}

/// Whether a grid of these sizes has few enough points.
fn is_addressable(sizes: &[usize]) -> bool {
    let product = sizes
        .iter()
        .try_fold(1usize, |product, &n| product.checked_mul(n));
    product.is_some_and(|product| product <= MAX_GRID)
}

/// Chooses the cheapest grid and window that reach the tolerance.
fn choose<T: Real, const D: usize>(
    modes: &[usize; D],
    tolerance: f64,
    points: usize,
    oversampling: &[f64],
) -> Result<Choice<D>, PlanError> {
    let too_large = || PlanError::TooLarge {
        modes: modes.to_vec(),
    };
    // Before any search for good lengths, which would not end for absurd ones.
    if !is_addressable(modes) {
        return Err(too_large());
    }
    let mut choice: Option<Choice<D>> = None;
    let mut least = f64::INFINITY;
    let mut fits = false;
    for &factor in oversampling {
        let target = modes.map(|n| {
            if n == 1 {
                1
            } else {
                fast_size((n as f64 * factor).ceil() as usize)
            }
        });
        if !is_addressable(&target) {
            continue;
        }
        fits = true;
        let narrowest = narrowest::<T, D>(modes, target, tolerance, &mut least);
        if let Some((fine, width, quality)) = narrowest {
            let cost = cost(modes, &fine, width, points);
            if choice.as_ref().is_none_or(|cheapest| cost < cheapest.cost) {
                choice = Some(Choice {
                    cost,
                    fine,
                    width,
                    quality,
                });
            }
        }
    }
    if !fits {
        return Err(too_large());
    }
    choice.ok_or(PlanError::Tolerance {
        requested: tolerance,
        least,
    })
}

/// The narrowest window that reaches the tolerance, with its grid of at least `target` points; lowers `least` to the
/// least tolerance that the windows tried can reach.
fn narrowest<T: Real, const D: usize>(
    modes: &[usize; D],
    target: [usize; D],
    tolerance: f64,
    least: &mut f64,
) -> Option<([usize; D], usize, Quality)> {
    for width in 2..=MAX_WIDTH {
        // The window must not meet itself around the period.
        let fine = target.map(|n| {
            if n == 1 {
                1
            } else if n < width {
                fast_size(width)
            } else {
                n
            }
        });
        let axes: Vec<(usize, usize)> = modes
            .iter()
            .copied()
            .zip(fine)
            .filter(|&(n, _)| n > 1)
            .collect();
        let quality = best(width, &axes);
        let rounding = T::epsilon().wide() * quality.rounding;
        let error = quality.aliasing.hypot(rounding);
        *least = least.min(error / ALIASING_SHARE);
        if error <= ALIASING_SHARE * tolerance {
            return Some((fine, width, quality));
        }
    }
    None
}

/// One over the window's transform for the modes of an axis of `length` fine points.
fn factors<T: Real>(window: &Window<T>, modes: usize, length: usize) -> Vec<T> {
    let factor = |index: usize| {
        if modes == 1 {
            return T::one();
        }
        let k = index as f64 - (modes / 2) as f64;
        T::of(1.0 / window.transform(k / length as f64))
    };
    (0..modes).map(factor).collect()
}

/// Time of a transform in units of about a nanosecond, from the operations counted: multiply-adds of spreading and
/// points of one-dimensional transforms.
fn cost(modes: &[usize], fine: &[usize], width: usize, points: usize) -> f64 {
    let lanes = width.next_multiple_of(2) as f64;
    let outer: f64 = fine[1..]
        .iter()
        .map(|&n| if n == 1 { 1.0 } else { width as f64 })
        .product();
    let spreading = points as f64 * (outer * (2.0 + 0.35 * lanes) + 10.0 * lanes);
    // Axes 1, 2, ..., 0, each on the modes that earlier ones kept.
    let mut transforms = 0.0;
    for step in 0..fine.len() {
        let axis = (step + 1) % fine.len();
        let mut lines = 1.0;
        for other in 0..fine.len() {
            let done = other != 0 && other < axis || axis == 0;
            if other != axis {
                lines *= if done { modes[other] } else { fine[other] } as f64;
            }
        }
        transforms += 3.5 * lines * fine[axis] as f64;
    }
    spreading + transforms
}

/// A transform that cannot be planned.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PlanError {
    /// An axis has no modes.
    #[error("axis {axis} has no modes; ask for at least 1 on each axis")]
    NoModes {
        /// The axis, from 0.
        axis: usize,
    },
    /// The tolerance is no number between the precision's least and 1.
    #[error(
        "tolerance {requested} is out of reach: it must be at least {least} and below 1 in this precision"
    )]
    Tolerance {
        /// The requested value.
        requested: f64,
        /// Least tolerance of this precision or the widest window.
        least: f64,
    },
    /// The grid does not fit into the address space.
    #[error(
        "{modes:?} modes need a grid of more points than can be addressed; ask for fewer modes"
    )]
    TooLarge {
        /// Modes per axis.
        modes: Vec<usize>,
    },
    /// An oversampling that is not above 1, or not finite.
    #[error("oversampling {requested} must be above 1 and at most 4")]
    Oversampling {
        /// The requested value.
        requested: f64,
    },
}

/// Input that does not suit the plan.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TransformError {
    /// A coordinate is NaN or infinite.
    #[error("coordinate {axis} of point {index} is {value}; coordinates must be finite")]
    Point {
        /// The point, from 0.
        index: usize,
        /// The axis, from 0.
        axis: usize,
        /// Its value.
        value: f64,
    },
    /// More points than 32-bit places can number.
    #[error("{count} points are too many; split them into sets of at most 4294967295")]
    TooManyPoints {
        /// Points given.
        count: usize,
    },
    /// An array has a length other than the plan or the points need.
    #[error("{what} holds {got} numbers where {expected} are needed")]
    Length {
        /// The array.
        what: &'static str,
        /// Length needed.
        expected: usize,
        /// Length given.
        got: usize,
    },
    /// Points or workspace were made by a plan of another shape.
    #[error("{what} belongs to another plan; make it anew from this one")]
    Foreign {
        /// The points or the workspace.
        what: &'static str,
    },
}
