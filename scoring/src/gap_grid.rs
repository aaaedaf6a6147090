//! The gap function on a uniform grid: rasterise, transform, multiply, transform back; whole, or from some of its
//! modes.
//!
//! The gap function is g(t) = integral of f_1(x) f_2(x - t) dx over the periodic cube, by sums over its n^3 grid
//! points. F_1 and F_2 are the transforms of the sampled functions. Then g(t) = sum_k G_k exp(2 pi i k.t / edge),
//! with G_k = (h^3 / n^3) F_1k conj(F_2k) and h = edge / n. Modes are those of a [`ModeSet`]: all but the Nyquist
//! planes, (n - 1)^3 of them, conjugates counted.
//!
//! The engine's own uniform grid scores a double skin in a box that it chooses. Here the box has exactly m points, as
//! in the paper, and every step is separate so that it can be timed.

use crate::kernel::Bump;
use crate::transform::fast_size;
use crate::transform::modes::{ModeSet, place};
use crate::transform::real_fft_3d::{RealFft3d, RealFft3dWorkspace};
use crate::transform::truncation::Selection;
use num_complex::Complex64;

/// A periodic cube of grid points.
pub struct Grid {
    /// Points per axis.
    pub per_axis: usize,
    /// Its edge.
    pub edge: f64,
    /// Its modes.
    pub modes: ModeSet,
    /// For every mode its place in a spectrum.
    places: Vec<usize>,
    fft: RealFft3d<f64>,
}

/// Modes that are kept, and the smallest grid that can hold the function that they make.
pub struct Truncation {
    /// Points per axis of that grid.
    pub size: [usize; 3],
    /// (place in the whole spectrum, place in the small grid's).
    kept: Vec<(usize, usize)>,
    fft: RealFft3d<f64>,
}

/// Buffers of one grid size.
pub struct Buffers {
    /// Values, row-major, z fastest.
    pub grid: Vec<f64>,
    /// Their spectrum.
    pub spectrum: Vec<Complex64>,
    work: RealFft3dWorkspace<f64>,
}

impl Buffers {
    fn new(fft: &RealFft3d<f64>) -> Self {
        Self {
            grid: vec![0.0; fft.size().iter().product()],
            spectrum: vec![Complex64::default(); fft.spectrum_len()],
            work: fft.workspace(),
        }
    }
}

impl Grid {
    /// A cube with an even number of points per axis.
    pub fn new(per_axis: usize, edge: f64) -> Self {
        // A frequency beyond all that the grid has.
        let cut = per_axis as f64 / edge;
        let modes = ModeSet::new([per_axis; 3], [edge; 3], cut);
        let mut places = vec![0; modes.count];
        for column in &modes.columns {
            for (index, kx) in (-column.kx_max..=column.kx_max).enumerate() {
                places[column.start + index] =
                    spectrum_place([kx, column.ky, column.kz], [per_axis; 3]);
            }
        }
        let fft = RealFft3d::new([per_axis; 3]);
        Self {
            per_axis,
            edge,
            modes,
            places,
            fft,
        }
    }

    /// Buffers of the whole grid.
    pub fn buffers(&self) -> Buffers {
        Buffers::new(&self.fft)
    }

    /// Samples the sum of the bumps of balls (x, y, z, r) at every grid point; the origin is the first.
    pub fn rasterise(&self, balls: &[[f64; 4]], bump: &Bump, buffers: &mut Buffers) {
        let n = self.per_axis;
        let h = self.edge / n as f64;
        let wrap = |index: i64| index.rem_euclid(n as i64) as usize;
        let run = |at: f64, half: f64| {
            let first = ((at - half) / h).ceil() as i64;
            first..=((at + half) / h).floor() as i64
        };
        buffers.grid.fill(0.0);
        for &[x, y, z, radius] in balls {
            for ix in run(x, radius) {
                let dx = ix as f64 * h - x;
                let left = (radius * radius - dx * dx).max(0.0);
                for iy in run(y, left.sqrt()) {
                    let dy = iy as f64 * h - y;
                    let near = dx * dx + dy * dy;
                    let half = (radius * radius - near).max(0.0).sqrt();
                    let row = (wrap(ix) * n + wrap(iy)) * n;
                    let along = run(z, half);
                    let mut at = row + wrap(*along.start());
                    for iz in along {
                        let dz = iz as f64 * h - z;
                        let distance = (near + dz * dz).sqrt();
                        buffers.grid[at] += bump.value(distance / radius);
                        // A division a voxel would cost as much as the bump.
                        at += 1;
                        if at == row + n {
                            at = row;
                        }
                    }
                }
            }
        }
    }

    /// The grid's values to their spectrum; the values are lost.
    pub fn forward(&self, buffers: &mut Buffers) {
        self.fft
            .forward(&mut buffers.grid, &mut buffers.spectrum, &mut buffers.work);
    }

    /// The spectrum to the grid's values, without a factor; the spectrum is lost.
    pub fn inverse(&self, buffers: &mut Buffers) {
        self.fft
            .inverse(&mut buffers.spectrum, &mut buffers.grid, &mut buffers.work);
    }

    /// The transform of the continuous function that the samples stand for, at an integer frequency with kz >= 0.
    pub fn transform_at(&self, spectrum: &[Complex64], k: [i32; 3]) -> Complex64 {
        let h = self.edge / self.per_axis as f64;
        spectrum[spectrum_place(k, [self.per_axis; 3])] * h.powi(3)
    }

    /// The factor of G_k beside the product of two spectra.
    pub fn factor(&self) -> f64 {
        let n = self.per_axis as f64;
        (self.edge / n).powi(3) / n.powi(3)
    }

    /// All of G, into a spectrum whose Nyquist planes stay zero.
    pub fn multiply(&self, first: &[Complex64], second: &[Complex64], product: &mut [Complex64]) {
        let n = self.per_axis;
        let factor = self.factor();
        product.fill(Complex64::default());
        for kz in 0..n / 2 {
            for ky in (0..n).filter(|&ky| ky != n / 2) {
                let row = (kz * n + ky) * n;
                let row = row..row + n;
                let values = first[row.clone()].iter().zip(&second[row.clone()]);
                for (value, (a, b)) in product[row.clone()].iter_mut().zip(values) {
                    *value = a * b.conj() * factor;
                }
                product[row.start + n / 2] = Complex64::default();
            }
        }
    }

    /// |G_k| of every mode of the set.
    pub fn magnitudes(&self, product: &[Complex64]) -> Vec<f64> {
        self.places
            .iter()
            .map(|&place| product[place].norm())
            .collect()
    }

    /// G_k of a mode of the set.
    pub fn mode(&self, product: &[Complex64], mode: usize) -> Complex64 {
        product[self.places[mode]]
    }

    /// Leaves only the selected modes of a product.
    pub fn keep(&self, product: &[Complex64], selection: &Selection, kept: &mut [Complex64]) {
        kept.fill(Complex64::default());
        for (mode, &place) in self.places.iter().enumerate() {
            if selection.keeps(mode) {
                kept[place] = product[place];
            }
        }
    }

    /// Plans the correlation from the selected modes alone.
    pub fn truncate(&self, selection: &Selection) -> Truncation {
        let mut limits = [0; 3];
        let mut kept = Vec::new();
        for column in &self.modes.columns {
            for (index, kx) in (-column.kx_max..=column.kx_max).enumerate() {
                if selection.keeps(column.start + index) {
                    let k = [kx, column.ky, column.kz];
                    for axis in 0..3 {
                        limits[axis] = limits[axis].max(k[axis].unsigned_abs() as usize);
                    }
                    kept.push((self.places[column.start + index], k));
                }
            }
        }
        let size = limits.map(|limit| fast_size(2 * limit + 2));
        let kept = kept
            .into_iter()
            .map(|(whole, k)| (whole, spectrum_place(k, size)))
            .collect();
        Truncation {
            size,
            kept,
            fft: RealFft3d::new(size),
        }
    }
}

/// Place in a grid's spectrum of a frequency with kz >= 0.
fn spectrum_place([kx, ky, kz]: [i32; 3], [nx, ny, _]: [usize; 3]) -> usize {
    (kz as usize * ny + place(ky, ny)) * nx + place(kx, nx)
}

impl Truncation {
    /// Buffers of the small grid.
    pub fn buffers(&self) -> Buffers {
        Buffers::new(&self.fft)
    }

    /// Multiplies the kept modes of two spectra of the whole grid.
    pub fn multiply(&self, grid: &Grid, spectra: [&[Complex64]; 2], buffers: &mut Buffers) {
        let factor = grid.factor();
        buffers.spectrum.fill(Complex64::default());
        for &(whole, small) in &self.kept {
            buffers.spectrum[small] = spectra[0][whole] * spectra[1][whole].conj() * factor;
        }
    }

    /// The kept modes' function on the small grid, whose first point is the origin.
    pub fn inverse(&self, buffers: &mut Buffers) {
        self.fft
            .inverse(&mut buffers.spectrum, &mut buffers.grid, &mut buffers.work);
    }
}
