//! The three-dimensional Fourier transform of a whole real grid, out of place: one-dimensional transforms with
//! transposes between them.
//!
//! Forward exp(-2 pi i ...), inverse with +, both without a factor. The grid is (nx, ny, nz) row-major; the spectrum is
//! (nz / 2 + 1, ny, nx) row-major with kx fastest, all frequencies in transform order, so that no transpose back is
//! needed.

use super::Real;
use num_complex::Complex;
use realfft::{ComplexToReal, RealToComplex};
use rustfft::Fft;
use std::sync::Arc;

/// Planned transforms of one grid size.
pub struct RealFft3d<T: Real> {
    size: [usize; 3],
    z_forward: Arc<dyn RealToComplex<T>>,
    z_inverse: Arc<dyn ComplexToReal<T>>,
    /// Along y and x, forward and inverse.
    y: [Arc<dyn Fft<T>>; 2],
    x: [Arc<dyn Fft<T>>; 2],
}

/// Buffers of one transform in flight.
pub struct RealFft3dWorkspace<T> {
    lines: Vec<Complex<T>>,
    scratch: Vec<Complex<T>>,
}

impl<T: Real> RealFft3d<T> {
    /// Plans the transforms of a grid with `size` points per axis, each at least 1.
    pub fn new(size: [usize; 3]) -> Self {
        let [nx, ny, nz] = size;
        Self {
            size,
            z_forward: T::forward_real_fft(nz),
            z_inverse: T::inverse_real_fft(nz),
            y: [T::forward_fft(ny), T::inverse_fft(ny)],
            x: [T::forward_fft(nx), T::inverse_fft(nx)],
        }
    }

    /// Grid points per axis.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// Number of values in a spectrum.
    pub fn spectrum_len(&self) -> usize {
        let [nx, ny, nz] = self.size;
        nx * ny * (nz / 2 + 1)
    }

    /// Buffers for one transform at a time.
    pub fn workspace(&self) -> RealFft3dWorkspace<T> {
        let scratch = self
            .y
            .iter()
            .chain(&self.x)
            .map(|fft| fft.get_inplace_scratch_len())
            .chain([
                self.z_forward.get_scratch_len(),
                self.z_inverse.get_scratch_len(),
            ])
            .max();
        let zero = Complex::new(T::zero(), T::zero());
        RealFft3dWorkspace {
            lines: vec![zero; self.spectrum_len()],
            scratch: vec![zero; scratch.unwrap_or(0)],
        }
    }

    /// Grid to spectrum. The grid's values are lost.
    ///
    /// # Panics
    /// If grid, spectrum or workspace belong to another size.
    pub fn forward(
        &self,
        grid: &mut [T],
        spectrum: &mut [Complex<T>],
        work: &mut RealFft3dWorkspace<T>,
    ) {
        assert_eq!(grid.len(), self.size.iter().product::<usize>());
        assert_eq!(spectrum.len(), self.spectrum_len());
        let [nx, ny, nz] = self.size;
        let half = nz / 2 + 1;
        for (row, line) in grid
            .chunks_exact_mut(nz)
            .zip(spectrum.chunks_exact_mut(half))
        {
            let done = self
                .z_forward
                .process_with_scratch(row, line, &mut work.scratch);
            assert!(
                done.is_ok(),
                "grid, spectrum and workspace are of this size"
            );
        }
        // (x, y, z) -> (x, z, y), plane by plane; then (x, zy) -> (zy, x).
        let planes = spectrum.chunks_exact(ny * half);
        for (from, to) in planes.zip(work.lines.chunks_exact_mut(ny * half)) {
            transpose::transpose(from, to, half, ny);
        }
        self.y[0].process_with_scratch(&mut work.lines, &mut work.scratch);
        transpose::transpose(&work.lines, spectrum, ny * half, nx);
        self.x[0].process_with_scratch(spectrum, &mut work.scratch);
    }

    /// Spectrum of a real grid to the grid, times the number of points. The spectrum's values are lost.
    ///
    /// # Panics
    /// If grid, spectrum or workspace belong to another size.
    pub fn inverse(
        &self,
        spectrum: &mut [Complex<T>],
        grid: &mut [T],
        work: &mut RealFft3dWorkspace<T>,
    ) {
        assert_eq!(grid.len(), self.size.iter().product::<usize>());
        assert_eq!(spectrum.len(), self.spectrum_len());
        let [nx, ny, nz] = self.size;
        let half = nz / 2 + 1;
        self.x[1].process_with_scratch(spectrum, &mut work.scratch);
        transpose::transpose(spectrum, &mut work.lines, nx, ny * half);
        self.y[1].process_with_scratch(&mut work.lines, &mut work.scratch);
        let planes = work.lines.chunks_exact(ny * half);
        for (from, to) in planes.zip(spectrum.chunks_exact_mut(ny * half)) {
            transpose::transpose(from, to, ny, half);
        }
        for (line, row) in spectrum
            .chunks_exact_mut(half)
            .zip(grid.chunks_exact_mut(nz))
        {
            // A real row's mean and Nyquist value are real; rounding leaves a trace that the transform would warn of.
            line[0].im = T::zero();
            if nz % 2 == 0 {
                line[half - 1].im = T::zero();
            }
            let done = self
                .z_inverse
                .process_with_scratch(line, row, &mut work.scratch);
            assert!(
                done.is_ok(),
                "grid, spectrum and workspace are of this size"
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_complex::Complex64;
    use std::f64::consts::PI;

    /// Against the definition, at sizes that differ per axis, odd and one among them.
    #[test]
    fn equals_the_definition_and_comes_back() {
        for size in [[4, 6, 8], [5, 3, 7], [1, 4, 9], [3, 1, 1]] {
            let [nx, ny, nz] = size;
            let grid: Vec<f64> = (0..nx * ny * nz)
                .map(|i| ((i * i * 7 + 3 * i) % 23) as f64 - 11.0)
                .collect();
            let fft = RealFft3d::<f64>::new(size);
            let mut work = fft.workspace();
            let mut spectrum = vec![Complex64::default(); fft.spectrum_len()];
            fft.forward(&mut grid.clone(), &mut spectrum, &mut work);
            for kz in 0..=nz / 2 {
                for ky in 0..ny {
                    for kx in 0..nx {
                        let mut sum = Complex64::default();
                        for (i, value) in grid.iter().enumerate() {
                            let (x, y, z) = (i / (ny * nz), i / nz % ny, i % nz);
                            let turns = (kx * x) as f64 / nx as f64
                                + (ky * y) as f64 / ny as f64
                                + (kz * z) as f64 / nz as f64;
                            sum += Complex64::cis(-2.0 * PI * turns) * value;
                        }
                        let ours = spectrum[(kz * ny + ky) * nx + kx];
                        assert!((ours - sum).norm() < 1e-10, "{size:?} {kx} {ky} {kz}");
                    }
                }
            }
            let mut back = vec![0.0; grid.len()];
            fft.inverse(&mut spectrum, &mut back, &mut work);
            let points = grid.len() as f64;
            for (back, value) in back.iter().zip(&grid) {
                assert!((back / points - value).abs() < 1e-12 * points);
            }
        }
    }
}
