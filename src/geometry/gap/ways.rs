//! Three ways from balls to the spectrum of their summed bumps without a grid, all through an [`Expansion`] of the
//! radius.
//!
//! - [`direct()`]: the nufft sums as they stand (NDFT), over whichever expansion: with the series that is the 4D sum.
//! - [`fast_4d`]: one four-dimensional fast transform of the points (x, y, z, r), for the series.
//! - [`fast_3d`]: a three-dimensional fast transform for each function of the radius.
//!
//! All end with the product with the kernel and the sum over the functions of the radius, and give the same numbers.

use super::expansion::Expansion;
use super::spectrum::{Body, FrequencyBox};
use knotdock_scoring::transform::direct;
use knotdock_scoring::transform::nufft::{Plan, SortedPoints, Workspace};
use knotdock_structures::Error;
use num_complex::Complex64;
use std::f64::consts::PI;

/// A body ready for its transforms: all that no rotation changes is prepared, and is not timed.
pub struct Points<'a> {
    expansion: &'a Expansion,
    frequencies: FrequencyBox,
    /// Centres in units of the cube's edge.
    centers: Vec<[f64; 3]>,
    /// For every function of the radius the weights, with the phase that moves the half box of frequencies onto one
    /// about zero.
    weights: Vec<Vec<Complex64>>,
    /// Radii in units of the series' period.
    heights: Vec<f64>,
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
        let period = expansion.period.unwrap_or(1.0);
        Self {
            expansion,
            frequencies,
            centers,
            weights: expansion.radial.iter().map(shifted).collect(),
            heights: body.radii.iter().map(|radius| radius / period).collect(),
        }
    }

    /// Values held at the frequencies of the box.
    fn values(&self) -> Vec<Complex64> {
        vec![Complex64::default(); self.frequencies.count() / 2]
    }

    /// Values of kx.
    pub fn planes(&self) -> usize {
        self.frequencies.half()[0]
    }

    /// Multiplications of the direct sums: balls, frequencies held, functions.
    pub fn direct_cost(&self) -> f64 {
        self.centers.len() as f64
            * (self.frequencies.count() / 2) as f64
            * self.expansion.len() as f64
    }
}

/// The nufft sums, direct.
pub fn direct(points: &Points) -> Vec<Complex64> {
    let sums = direct::forward(&points.centers, &points.weights, points.frequencies.half());
    let mut output = points.values();
    points
        .expansion
        .combine(points.frequencies, &mut output, |place, f| sums[f][place]);
    output
}

/// A share of [`direct()`]'s work: the frequencies of `planes` of the a values of kx, nothing of it kept. The work is
/// the same for every kx, so that all take a / `planes` times its time. (Fewer values of kz would not do: the phases
/// of x and y are multiplied once for all of them.)
pub fn direct_share(points: &Points, planes: usize) -> f64 {
    let [_, b, c] = points.frequencies.half();
    let sums = direct::forward(&points.centers, &points.weights, [planes, b, c]);
    let share = FrequencyBox {
        size: [planes, b, 2 * c],
    };
    let mut output = vec![Complex64::default(); planes * b * c];
    points
        .expansion
        .combine(share, &mut output, |place, f| sums[f][place]);
    output[0].re
}

/// A fast transform in D dimensions, planned.
pub struct Fast<const D: usize> {
    plan: Plan<f64, D>,
    sorted: SortedPoints<D>,
    work: Workspace<f64, D>,
    sums: Vec<Vec<Complex64>>,
}

impl<const D: usize> Fast<D> {
    fn new(
        modes: [usize; D],
        tolerance: f64,
        points: &[[f64; D]],
        outputs: usize,
    ) -> Result<Self, Error> {
        let plan = Plan::new(modes, tolerance, points.len()).map_err(refused)?;
        Ok(Self {
            sorted: plan.locate(points).map_err(refused)?,
            work: plan.workspace(),
            sums: vec![vec![Complex64::default(); plan.mode_count()]; outputs],
            plan,
        })
    }
}

/// The error of a fast transform that cannot be done.
fn refused(error: impl std::fmt::Display) -> Error {
    Error::machine(error).help("take a coarser grid")
}

/// (x, y, z, r) of every ball, in units of the periods.
fn lifted(points: &Points) -> Vec<[f64; 4]> {
    let balls = points.centers.iter().zip(&points.heights);
    balls.map(|(x, r)| [x[0], x[1], x[2], *r]).collect()
}

/// Plans [`fast_4d`].
pub fn plan_4d(points: &Points, tolerance: f64) -> Result<Fast<4>, Error> {
    let [a, b, c] = points.frequencies.half();
    // The series has an odd number of modes, from -most to most, as the transform numbers them.
    let modes = [a, b, c, points.expansion.len()];
    Fast::new(modes, tolerance, &lifted(points), 1)
}

/// One four-dimensional fast transform.
pub fn fast_4d(points: &Points, fast: &mut Fast<4>) -> Result<Vec<Complex64>, Error> {
    let located = fast.plan.locate_into(&lifted(points), &mut fast.sorted);
    located.map_err(refused)?;
    // The fourth coordinate carries the functions of the radius; that of frequency zero is one, so that its weights
    // are the phases alone.
    let weights = &points.weights[points.expansion.len() / 2];
    let sums = &mut fast.sums[0];
    fast.plan
        .forward(&fast.sorted, weights, &mut fast.work, sums)
        .map_err(refused)?;
    let functions = points.expansion.len();
    let mut output = points.values();
    points
        .expansion
        .combine(points.frequencies, &mut output, |place, f| {
            sums[place * functions + f]
        });
    Ok(output)
}

/// Plans [`fast_3d`].
pub fn plan_3d(points: &Points, tolerance: f64) -> Result<Fast<3>, Error> {
    let modes = points.frequencies.half();
    Fast::new(modes, tolerance, &points.centers, points.expansion.len())
}

/// A three-dimensional fast transform for each function of the radius.
pub fn fast_3d(points: &Points, fast: &mut Fast<3>) -> Result<Vec<Complex64>, Error> {
    let located = fast.plan.locate_into(&points.centers, &mut fast.sorted);
    located.map_err(refused)?;
    for (weights, sums) in points.weights.iter().zip(&mut fast.sums) {
        fast.plan
            .forward(&fast.sorted, weights, &mut fast.work, sums)
            .map_err(refused)?;
    }
    let mut output = points.values();
    points
        .expansion
        .combine(points.frequencies, &mut output, |place, f| {
            fast.sums[f][place]
        });
    Ok(output)
}
