//! Transforms between knots and modes.
//!
//! # Conventions
//!
//! - Forward: f^(w) = sum f(x) exp(-2 pi i w.x); inverse with +, carrying 1 / volume for continuous kernels.
//! - Mode (kx, ky, kz) of a box (Lx, Ly, Lz) has frequency w = (kx/Lx, ky/Ly, kz/Lz), cycles per Å. Functions are real, so
//!   only kz >= 0 is kept; Nyquist planes are left out.
//! - Real grids are (nx, ny, nz) row-major, z fastest.

pub mod modes;
pub mod ndft;
pub mod nfft;
pub mod spreading;

use rustfft::num_traits::Float;

/// The two floating-point types that transforms run in.
pub trait Real: rustfft::FftNum + Float + Default + std::ops::AddAssign {
    /// Rounds from f64.
    fn of(value: f64) -> Self;
    /// Widens to f64.
    fn wide(self) -> f64;
}

impl Real for f32 {
    fn of(value: f64) -> Self {
        value as f32
    }
    fn wide(self) -> f64 {
        f64::from(self)
    }
}

impl Real for f64 {
    fn of(value: f64) -> Self {
        value
    }
    fn wide(self) -> f64 {
        self
    }
}

/// Smallest even 2^a 3^b 5^c 7^d not below `least`: sizes that the fast Fourier transform does best.
pub fn fast_size(least: usize) -> usize {
    (least.max(2)..)
        .filter(|n| n % 2 == 0)
        .find(|&n| {
            let mut rest = n;
            for prime in [2, 3, 5, 7] {
                while rest % prime == 0 {
                    rest /= prime;
                }
            }
            rest == 1
        })
        .unwrap_or(least)
}

#[cfg(test)]
mod tests {
    #[test]
    fn fast_sizes() {
        assert_eq!(super::fast_size(1), 2);
        assert_eq!(super::fast_size(51), 54);
        assert_eq!(super::fast_size(97), 98);
        assert_eq!(super::fast_size(101), 108);
    }
}
