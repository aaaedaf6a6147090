//! The correlation of two bodies at one grid size, the time of each of its steps, and what leaving out modes does to
//! it.

use crate::scene::Scene;
use crate::timing::least;
use knotdock::geometry::gap::grid::Grid;
use knotdock::geometry::gap::spectrum::Kernel;
use knotdock_scoring::transform::truncation::Selection;
use num_complex::Complex64;
use std::hint::black_box;

/// Share of the peak from which two bodies count as colliding. A truncated function has no exact zeros.
const CONTACT: f64 = 1e-3;
/// Pairs of balls of which pairwise summation is timed; the time of all follows by their number.
const PAIRS: usize = 4_000_000;

/// The function of one grid size, and the times of its steps in seconds.
pub struct Whole {
    grid: Grid,
    spectra: [Vec<Complex64>; 2],
    product: Vec<Complex64>,
    values: Vec<f64>,
    peak: f64,
    /// Sampling both bodies.
    pub rasterising: f64,
    /// Their two transforms.
    pub forward: f64,
    /// The product of the spectra.
    pub multiplying: f64,
    /// The transform back.
    pub inverse: f64,
    /// Forming the sum of every two balls.
    pub pairwise: f64,
}

/// Errors of a truncated function, as shares of the peak, and the share of the cube in which its verdict on collision
/// is another.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Root mean square.
    pub rms: f64,
    /// Largest.
    pub worst: f64,
    /// Share of grid points on the other side of `CONTACT`.
    pub verdict: f64,
}

impl Whole {
    /// Correlates a scene and times every step.
    pub fn new(scene: &Scene, kernel: &Kernel) -> Self {
        let grid = Grid::new(scene.per_axis, scene.edge);
        let mut buffers = grid.buffers();
        let mut rasterising = 0.0;
        let mut forward = 0.0;
        let spectra = [&scene.bunny, &scene.peg].map(|body| {
            rasterising += least(|| grid.rasterise(&body.knots(), &kernel.bump, &mut buffers));
            // The transform takes the same time whatever it is given.
            forward += least(|| grid.forward(&mut buffers));
            grid.rasterise(&body.knots(), &kernel.bump, &mut buffers);
            grid.forward(&mut buffers);
            buffers.spectrum.clone()
        });
        let mut product = buffers.spectrum.clone();
        let multiplying = least(|| grid.multiply(&spectra[0], &spectra[1], &mut product));
        let inverse = least(|| grid.inverse(&mut buffers));
        buffers.spectrum.copy_from_slice(&product);
        grid.inverse(&mut buffers);
        let values = buffers.grid;
        Self {
            peak: values.iter().fold(0.0, |peak, value| peak.max(value.abs())),
            pairwise: pairwise(scene),
            grid,
            spectra,
            product,
            values,
            rasterising,
            forward,
            multiplying,
            inverse,
        }
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Spectrum of the function, Nyquist planes zero.
    pub fn product(&self) -> &[Complex64] {
        &self.product
    }

    /// The function at the grid's points.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Its largest value.
    pub fn peak(&self) -> f64 {
        self.peak
    }

    /// The function of the selected modes at all of the grid's points.
    pub fn truncated(&self, selection: &Selection) -> Vec<f64> {
        let mut buffers = self.grid.buffers();
        self.grid
            .keep(&self.product, selection, &mut buffers.spectrum);
        self.grid.inverse(&mut buffers);
        buffers.grid
    }

    /// What a selection of modes makes wrong.
    pub fn errors(&self, selection: &Selection) -> Errors {
        let kept = self.truncated(selection);
        let (mut squares, mut worst, mut other) = (0.0, 0.0f64, 0usize);
        let contact = CONTACT * self.peak;
        for (value, truncated) in self.values.iter().zip(&kept) {
            let error = (value - truncated).abs();
            squares += error * error;
            worst = worst.max(error);
            other += usize::from((*value > contact) != (*truncated > contact));
        }
        let points = self.values.len() as f64;
        Errors {
            rms: (squares / points).sqrt() / self.peak,
            worst: worst / self.peak,
            verdict: other as f64 / points,
        }
    }

    /// Selections of at most 2^6, 2^7, ... modes, each with the power of two: dominant ones, and those of lowest
    /// frequency.
    pub fn selections(&self) -> impl Iterator<Item = (u32, [Selection; 2])> {
        let magnitudes = self.grid.magnitudes(&self.product);
        let modes = &self.grid.modes;
        let last = self.values.len().ilog2();
        (6..=last).map(move |power| {
            let most = 1 << power;
            let dominant = Selection::by_magnitude(modes, &magnitudes, most);
            (power, [dominant, Selection::low_frequency(modes, most)])
        })
    }

    /// The two bodies' spectra.
    pub fn spectra(&self) -> [&[Complex64]; 2] {
        [&self.spectra[0], &self.spectra[1]]
    }

    /// What is compared with the paper's time of a convolution.
    pub fn total(&self) -> f64 {
        self.forward + self.multiplying + self.inverse
    }
}

/// Seconds of forming the sum of every two balls, one of each body: the Minkowski sum in four dimensions.
fn pairwise(scene: &Scene) -> f64 {
    let rows = (PAIRS / scene.peg.radii.len()).clamp(1, scene.bunny.radii.len());
    let mut sums = vec![[0.0; 4]; rows * scene.peg.radii.len()];
    let balls = || scene.bunny.centers.iter().zip(&scene.bunny.radii);
    let seconds = least(|| {
        let rows = balls().zip(sums.chunks_exact_mut(scene.peg.radii.len()));
        for ((x, r), row) in rows {
            let others = scene.peg.centers.iter().zip(&scene.peg.radii);
            for (sum, (y, s)) in row.iter_mut().zip(others) {
                *sum = [x[0] - y[0], x[1] - y[1], x[2] - y[2], r + s];
            }
        }
        black_box(&mut sums);
    });
    seconds * scene.bunny.radii.len() as f64 / rows as f64
}
