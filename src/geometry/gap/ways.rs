//! Two ways from balls to the spectrum of their summed bumps without a grid, both through an [`Expansion`] of the
//! radius.
//!
//! They are direct Fourier sums (NDFT), or a fast transform (NFFT) for each function of the radius. Both end with the
//! product with the kernel and the sum over the functions of the radius, and give the same numbers.

use super::expansion::Expansion;
use super::spectrum::{Body, FrequencyBox};
use knotdock_scoring::transform::direct;
use knotdock_scoring::transform::nufft::{Plan, SortedPoints, Workspace};
use knotdock_structures::Error;
use num_complex::Complex64;
use std::f64::consts::PI;

/// A body ready for its transforms: what no rotation changes is prepared, and is not timed.
pub struct Points<'a> {
    /// The functions of the radius.
    pub expansion: &'a Expansion,
    /// The frequencies of the spectrum.
    pub frequencies: FrequencyBox,
    /// Centres in units of the cube's edge.
    pub centers: Vec<[f64; 3]>,
    /// For every function of the radius the weights, with the phase that moves the half box of frequencies onto one
    /// about zero.
    pub weights: Vec<Vec<Complex64>>,
}

impl<'a> Points<'a> {
    /// Takes the centres and prepares weights.
    pub fn new(
        body: &Body,
        edge: f64,
        frequencies: FrequencyBox,
        expansion: &'a Expansion,
    ) -> Self {
        let centers: Vec<[f64; 3]> = body
            .centers
            .iter()
            .map(|x| x.map(|coordinate| coordinate / edge))
            .collect();
        let shift = (frequencies.half()[2] / 2) as f64;
        let shifts: Vec<Complex64> = centers
            .iter()
            .map(|x| Complex64::cis(-2.0 * PI * shift * x[2]))
            .collect();
        let shifted = |radial: &Vec<Complex64>| {
            let pairs = radial.iter().zip(&shifts);
            pairs.map(|(radial, shift)| radial * shift).collect()
        };
        Self {
            expansion,
            frequencies,
            centers,
            weights: expansion.radial.iter().map(shifted).collect(),
        }
    }

    /// The spectrum from the sums over balls: `value(place, f)` is that of function f.
    pub fn combined(&self, value: impl Fn(usize, usize) -> Complex64) -> Vec<Complex64> {
        let mut output = vec![Complex64::default(); self.frequencies.count() / 2];
        self.expansion.combine(self.frequencies, &mut output, value);
        output
    }
}

/// The direct sums.
pub fn direct(points: &Points) -> Vec<Complex64> {
    let sums = direct::forward(&points.centers, &points.weights, points.frequencies.half());
    points.combined(|place, f| sums[f][place])
}

/// A planned fast transform, with its buffers.
pub struct Fast {
    plan: Plan<f64, 3>,
    sorted: SortedPoints<3>,
    work: Workspace<f64, 3>,
    sums: Vec<Vec<Complex64>>,
}

/// The error of a fast transform that cannot be done.
pub(super) fn refused(error: impl std::fmt::Display) -> Error {
    Error::machine(error).help("take a coarser grid")
}

/// Plans [`fast`].
///
/// # Errors
/// [`Error`] if a tolerance or a grid is out of reach.
pub fn planned(points: &Points, tolerance: f64) -> Result<Fast, Error> {
    let count = points.centers.len();
    let plan = Plan::new(points.frequencies.half(), tolerance, count).map_err(refused)?;
    Ok(Fast {
        sorted: plan.locate(&points.centers).map_err(refused)?,
        work: plan.workspace(),
        sums: vec![vec![Complex64::default(); plan.mode_count()]; points.expansion.rank()],
        plan,
    })
}

/// A fast transform for each function of the radius.
///
/// # Errors
/// [`Error`] if a centre is not finite.
pub fn fast(points: &Points, fast: &mut Fast) -> Result<Vec<Complex64>, Error> {
    let sorted = fast.plan.locate_into(&points.centers, &mut fast.sorted);
    sorted.map_err(refused)?;
    for (weights, sums) in points.weights.iter().zip(&mut fast.sums) {
        fast.plan
            .forward(&fast.sorted, weights, &mut fast.work, sums)
            .map_err(refused)?;
    }
    Ok(points.combined(|place, f| fast.sums[f][place]))
}
