//! Transforms between knots and modes.
//!
//! # Conventions
//!
//! - Forward: f^(w) = sum f(x) exp(-2 pi i w.x); inverse with +, carrying 1 / volume for continuous kernels.
//! - Mode (kx, ky, kz) of a box (Lx, Ly, Lz) has frequency w = (kx/Lx, ky/Ly, kz/Lz), cycles per Å. Functions are real,
//!   so only kz >= 0 is kept; Nyquist planes are left out.
//! - Real grids are (nx, ny, nz) row-major, z fastest.

pub mod direct;
pub mod modes;
pub mod ndft;
pub mod nufft;
pub(crate) mod pruned_type1;
pub mod real_fft_3d;
pub(crate) mod spreading;
pub(crate) mod transpose;
pub mod truncation;

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_traits::Float;
use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

/// The two floating-point types that transforms run in.
///
/// Fourier transforms are planned here: rustfft's planners are generic, and each program that named one (every test)
/// would compile all its vector kernels anew.
pub trait Real: rustfft::FftNum + Float + Default + std::ops::AddAssign {
    /// Rounds from f64.
    fn of(value: f64) -> Self;
    /// Widens to f64.
    fn wide(self) -> f64;
    /// The transform of a length with exp(-2 pi i ...), without a factor.
    fn forward_fft(length: usize) -> Arc<dyn Fft<Self>>;
    /// The transform of a length with exp(+2 pi i ...), without a factor.
    fn inverse_fft(length: usize) -> Arc<dyn Fft<Self>>;
    /// The forward transform of `length` real numbers.
    fn forward_real_fft(length: usize) -> Arc<dyn RealToComplex<Self>>;
    /// The inverse transform to `length` real numbers.
    fn inverse_real_fft(length: usize) -> Arc<dyn ComplexToReal<Self>>;
}

macro_rules! planned {
    () => {
        fn forward_fft(length: usize) -> Arc<dyn Fft<Self>> {
            FftPlanner::new().plan_fft_forward(length)
        }
        fn inverse_fft(length: usize) -> Arc<dyn Fft<Self>> {
            FftPlanner::new().plan_fft_inverse(length)
        }
        fn forward_real_fft(length: usize) -> Arc<dyn RealToComplex<Self>> {
            RealFftPlanner::new().plan_fft_forward(length)
        }
        fn inverse_real_fft(length: usize) -> Arc<dyn ComplexToReal<Self>> {
            RealFftPlanner::new().plan_fft_inverse(length)
        }
    };
}

impl Real for f32 {
    fn of(value: f64) -> Self {
        value as f32
    }
    fn wide(self) -> f64 {
        f64::from(self)
    }
    planned!();
}

impl Real for f64 {
    fn of(value: f64) -> Self {
        value
    }
    fn wide(self) -> f64 {
        self
    }
    planned!();
}

/// Smallest size not below `least` that the fast Fourier transform does well.
///
/// rustfft's vector kernels serve few lengths whole: 50 or 70 points take four times as long per point as 48, 54, 64 or
/// 72 (f32, AVX2). Longer lengths are good if built from those: 2^a 3^b and at most one 5 or 7, with 16 or 2 x 27 among
/// their factors.
pub fn fast_size(least: usize) -> usize {
    const SHORT: [usize; 20] = [
        2, 4, 6, 8, 12, 16, 24, 32, 36, 48, 54, 64, 72, 80, 96, 108, 112, 120, 128, 144,
    ];
    if let Some(&size) = SHORT.iter().find(|&&size| size >= least) {
        return size;
    }
    (least..)
        .find(|&n| {
            let mut rest = n;
            for prime in [2, 3] {
                while rest % prime == 0 {
                    rest /= prime;
                }
            }
            matches!(rest, 1 | 5 | 7) && (n % 16 == 0 || n % 54 == 0)
        })
        .unwrap_or(least)
}

#[cfg(test)]
mod tests {
    #[test]
    fn fast_sizes() {
        for (least, size) in [
            (1, 2),
            (50, 54),
            (65, 72),
            (97, 108),
            (145, 160),
            (161, 162),
        ] {
            assert_eq!(super::fast_size(least), size);
        }
    }
}
