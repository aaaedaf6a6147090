//! The spectrum of a body's summed bumps at chosen frequencies, the plain way.
//!
//! # Conventions
//!
//! - A body's function is f(x) = sum_j psi(|x - x_j| / r_j), psi the bump function of exponent 2, every weight one.
//!   Its transform is f^(w) = sum_j r_j^3 psi^(r_j |w|) exp(-2 pi i w.x_j).
//! - Frequencies are integers over the edge of the periodic cube. A [`FrequencyBox`] has m' = a b c of them,
//!   conjugates counted. It has kx and ky from -a/2 and -b/2 on, and kz from 0 to c/2 - 1. As f is real, the other
//!   half is known with the first.
//! - Arrays over a box are row-major, kz fastest, and hold m' / 2 values.

use knotdock_scoring::kernel::Bump;
use knotdock_scoring::kernel::bump::AlphaError;
use knotdock_scoring::kernel::radial_transform::RadialTransform;
use knotdock_scoring::kernel::table::Table;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Exponent of the bump function, B&I's choice.
const ALPHA: f64 = 2.0;

/// Balls.
#[derive(Clone, Debug, Default)]
pub struct Body {
    /// Centres.
    pub centers: Vec<[f64; 3]>,
    /// Radii.
    pub radii: Vec<f64>,
}

impl Body {
    /// Centre and radius of each ball.
    pub fn knots(&self) -> Vec<[f64; 4]> {
        let balls = self.centers.iter().zip(&self.radii);
        balls.map(|([x, y, z], r)| [*x, *y, *z, *r]).collect()
    }

    /// Lengths of the bounding box of the balls.
    pub fn extent(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            let ends = self.centers.iter().zip(&self.radii);
            let (low, high) = ends
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (x, r)| {
                    (low.min(x[axis] - r), high.max(x[axis] + r))
                });
            high - low
        })
    }

    /// Smallest and largest radius.
    pub fn radius_range(&self) -> [f64; 2] {
        let radii = self.radii.iter().copied();
        radii.fold([f64::INFINITY, 0.0], |[low, high], radius| {
            [low.min(radius), high.max(radius)]
        })
    }
}

/// The bump function and its transform, the latter from a table.
pub struct Kernel {
    /// psi.
    pub bump: Bump,
    transform: Table<1>,
}

impl Kernel {
    /// For products of radius and frequency up to `most`.
    pub fn new(most: f64) -> Result<Self, AlphaError> {
        let bump = Bump::new(ALPHA)?;
        let exact = RadialTransform::new(bump, most);
        let transform = Table::fit(most, 0.1, |q| [exact.value(q)]);
        Ok(Self { bump, transform })
    }

    /// The transform of a ball's bump at frequency w, continued to negative radii as the odd function that it is.
    pub fn of_ball(&self, w: f64, radius: f64) -> f64 {
        radius.powi(3) * self.transform.value(w * radius.abs())[0]
    }
}

/// Frequencies about zero, half of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrequencyBox {
    /// Frequencies an axis, conjugates counted; each even, the last one divisible by four.
    pub size: [usize; 3],
}

impl FrequencyBox {
    /// The box of 2^`power` frequencies, from 2^6 on, the later axes twice as long where it is no cube.
    pub fn of_power(power: u32) -> Self {
        let of_axis = |more: u32| 1 << ((power + more) / 3);
        Self {
            size: [of_axis(0), of_axis(1), of_axis(2)],
        }
    }

    /// Number of frequencies, conjugates counted: m'.
    pub fn count(self) -> usize {
        self.size.iter().product()
    }

    /// Frequencies held an axis.
    pub fn half(self) -> [usize; 3] {
        let [a, b, c] = self.size;
        [a, b, c / 2]
    }

    /// The frequency at a place, as integers.
    pub fn frequency(self, place: usize) -> [i32; 3] {
        let [a, b, c] = self.half();
        let index = [place / (b * c), place / c % b, place % c];
        [
            index[0] as i32 - (a / 2) as i32,
            index[1] as i32 - (b / 2) as i32,
            index[2] as i32,
        ]
    }

    /// Visits every place with the sum of squares of its frequency.
    pub fn for_each(self, mut visit: impl FnMut(usize, usize)) {
        let [a, b, c] = self.half();
        let mut place = 0;
        for kx in -((a / 2) as i32)..((a - a / 2) as i32) {
            for ky in -((b / 2) as i32)..((b - b / 2) as i32) {
                for kz in 0..c as i32 {
                    visit(place, square([kx, ky, kz]));
                    place += 1;
                }
            }
        }
    }

    /// Largest sum of squares of a frequency.
    pub fn largest_square(self) -> usize {
        self.size.iter().map(|n| (n / 2) * (n / 2)).sum()
    }

    /// About `count` places spread over the box; the first is that of frequency zero. None is a Nyquist
    /// frequency of a grid of the same size, which cannot distinguish it from its conjugate.
    pub fn sample(self, count: usize) -> Vec<usize> {
        let [a, b, c] = self.half();
        let zero = (a / 2 * b + b / 2) * c;
        let total = a * b * c;
        let inside = |&place: &usize| {
            let [kx, ky, _] = self.frequency(place);
            kx > -(a as i32) / 2 && ky > -(b as i32) / 2 && place != zero
        };
        // A step without a factor in common with the box's powers of two reaches every row.
        let step = (total / count.max(1)).max(1) | 1;
        let others = (0..total).step_by(step).filter(inside);
        std::iter::once(zero).chain(others).collect()
    }
}

/// Sum of squares of an integer frequency.
pub fn square(k: [i32; 3]) -> usize {
    k.iter().map(|k| (k * k) as usize).sum()
}

/// f^ at one frequency by its definition.
pub fn exact(body: &Body, kernel: &Kernel, edge: f64, k: [i32; 3]) -> Complex64 {
    let w = (square(k) as f64).sqrt() / edge;
    let balls = body.centers.iter().zip(&body.radii);
    balls
        .map(|(x, &r)| Complex64::cis(phase(x, k, edge)) * kernel.of_ball(w, r))
        .sum()
}

/// -2 pi k.x / edge.
pub fn phase(x: &[f64; 3], k: [i32; 3], edge: f64) -> f64 {
    let turns: f64 = (0..3).map(|axis| x[axis] * f64::from(k[axis])).sum();
    -2.0 * PI * turns / edge
}
