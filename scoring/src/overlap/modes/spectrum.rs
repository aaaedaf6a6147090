//! Transform of a body's bumps at the lattice's frequencies, the body turned and moved at will.

use super::lattice::{Block, Lattice};
use crate::kernel::radial_transform::RadialTransform;
use crate::kernel::table::Table;
use crate::overlap::WeightedBall;
use knotdock_structures::numeric::Bump;
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::PI;

/// Balls in a vector.
const LANES: usize = 8;
type Lane = [f64; LANES];

/// Error of a value of the bump's transform: what [`RadialTransform`] is held to by its tests.
const TRANSFORM_ERROR: f64 = 1e-10;

/// Sums of one entry over balls: re and im of C = sum a c cos, then of S = sum a c sin.
///
/// The amplitude is a, and c the weight times the phase along y and z. The transform is C - i S at +k and C + i S at -k.
pub(super) type Sums = [f64; 4];

/// psi^ of the unit bump.
pub(super) struct Transform {
    exact: RadialTransform,
    table: Option<Table<1>>,
}

impl Transform {
    /// Of frequencies up to `q_max`, in cycles a radius.
    pub fn new(bump: Bump, q_max: f64) -> Self {
        let end = 1.001 * q_max.max(1.0);
        let exact = RadialTransform::new(bump, end);
        let table = bump
            .alpha()
            .is_finite()
            .then(|| Table::fit(end, 1.0 / 32.0, |q| [exact.value(q)]));
        Self { exact, table }
    }

    pub fn value(&self, q: f64) -> f64 {
        match &self.table {
            Some(table) => table.value(q)[0],
            None => self.exact.value(q),
        }
    }
}

/// A body's balls about its middle, with the amplitude of each at each shell.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// Middle of the balls' bounding box.
    pub center: Vector3<f64>,
    /// Number of balls.
    pub balls: usize,
    positions: Vec<[Vector3<f64>; LANES]>,
    weights: Vec<Lane>,
    /// \[shell\]\[block of balls\]: r^3 psi^(r |w|).
    amplitudes: Vec<Lane>,
    /// By shell: most that the transform can be.
    pub envelope: Vec<f64>,
    /// By shell: most that its computed value can be off, rounding included.
    pub errors: Vec<f64>,
}

impl Body {
    /// Middle of a set of balls, and the radius of a ball about it that holds all of them.
    pub fn extent(balls: &[WeightedBall]) -> (Vector3<f64>, f64) {
        let mut low = Vector3::repeat(f64::INFINITY);
        let mut high = Vector3::repeat(f64::NEG_INFINITY);
        for ball in balls {
            let center = Vector3::from(ball.center);
            low = low.inf(&center.add_scalar(-ball.radius));
            high = high.sup(&center.add_scalar(ball.radius));
        }
        let center = 0.5 * (low + high);
        let reach =
            |ball: &WeightedBall| (Vector3::from(ball.center) - center).norm() + ball.radius;
        (center, balls.iter().map(reach).fold(0.0, f64::max))
    }

    pub fn new(balls: &[WeightedBall], lattice: &Lattice, transform: &Transform) -> Self {
        let (center, _) = Self::extent(balls);
        let count = balls.len().div_ceil(LANES);
        let shells = lattice.shells();
        let mut body = Self {
            center,
            balls: balls.len(),
            positions: vec![[Vector3::zeros(); LANES]; count],
            weights: vec![[0.0; LANES]; count],
            amplitudes: vec![[0.0; LANES]; count * shells],
            envelope: vec![0.0; shells],
            errors: vec![0.0; shells],
        };
        // Phases are powers of one phase an axis, whose error grows with the power; sums add one rounding a term.
        let rounding = f64::EPSILON * (12.0 * lattice.limit as f64 + balls.len() as f64 + 32.0);
        for (index, ball) in balls.iter().enumerate() {
            let (block, lane) = (index / LANES, index % LANES);
            body.positions[block][lane] = Vector3::from(ball.center) - center;
            body.weights[block][lane] = ball.weight;
            let cube = ball.radius.powi(3);
            for shell in 0..shells {
                let w = (shell as f64).sqrt() / lattice.length;
                let amplitude = cube * transform.value(ball.radius * w);
                body.amplitudes[shell * count + block][lane] = amplitude;
                let weight = ball.weight.abs();
                body.envelope[shell] += weight * amplitude.abs();
                body.errors[shell] +=
                    weight * (rounding * amplitude.abs() + TRANSFORM_ERROR * cube);
            }
        }
        body
    }
}

/// Phases of a body at a pose.
#[derive(Clone, Debug)]
pub(super) struct Phases {
    /// \[block\]: arms about the body's middle, turned.
    arms: Vec<[Lane; 3]>,
    /// \[axis\]\[k\]\[block\]: cos and sin of k theta.
    powers: [Vec<[Lane; 2]>; 3],
    /// \[block\]: weight times phase of a column.
    column: Vec<[Lane; 2]>,
}

impl Phases {
    pub fn new(body: &Body, lattice: &Lattice) -> Self {
        let count = body.positions.len();
        let zero = [[0.0; LANES]; 2];
        Self {
            arms: vec![[[0.0; LANES]; 3]; count],
            powers: std::array::from_fn(|_| vec![zero; (lattice.limit + 1) * count]),
            column: vec![zero; count],
        }
    }

    /// Places the body's middle at `place`, turned about it.
    #[inline(always)]
    pub fn place(
        &mut self,
        body: &Body,
        lattice: &Lattice,
        rotation: &Rotation3<f64>,
        place: &Vector3<f64>,
    ) {
        let count = body.positions.len();
        let radians = 2.0 * PI / lattice.length;
        for (block, positions) in body.positions.iter().enumerate() {
            for (lane, position) in positions.iter().enumerate() {
                let arm = rotation * position;
                for (axis, lanes) in self.arms[block].iter_mut().enumerate() {
                    lanes[lane] = arm[axis];
                }
            }
            for axis in 0..3 {
                let (mut cos, mut sin) = ([0.0; LANES], [0.0; LANES]);
                for lane in 0..LANES {
                    let angle = radians * (self.arms[block][axis][lane] + place[axis]);
                    (sin[lane], cos[lane]) = angle.sin_cos();
                }
                let mut next = [[1.0; LANES], [0.0; LANES]];
                for row in self.powers[axis].iter_mut().skip(block).step_by(count) {
                    *row = next;
                    for lane in 0..LANES {
                        next[0][lane] = row[0][lane] * cos[lane] - row[1][lane] * sin[lane];
                        next[1][lane] = row[0][lane] * sin[lane] + row[1][lane] * cos[lane];
                    }
                }
            }
        }
    }

    /// Sums the body's bumps at the entries of a block of shells: with an axis, each times its arm along it.
    #[inline(always)]
    pub fn gather(&mut self, body: &Body, block: &Block, arm: Option<usize>, out: &mut [Sums]) {
        let count = body.positions.len();
        let [x, y, z] = &self.powers;
        for column in &block.columns {
            let ky = column.ky.unsigned_abs() as usize;
            let sign = if column.ky < 0 { -1.0 } else { 1.0 };
            let along_y = &y[ky * count..(ky + 1) * count];
            let along_z = &z[column.kz * count..(column.kz + 1) * count];
            for (index, phase) in self.column.iter_mut().enumerate() {
                let (y, z) = (&along_y[index], &along_z[index]);
                let mut weights = body.weights[index];
                if let Some(axis) = arm {
                    for (weight, arm) in weights.iter_mut().zip(&self.arms[index][axis]) {
                        *weight *= arm;
                    }
                }
                for lane in 0..LANES {
                    let (c, s) = (y[0][lane], sign * y[1][lane]);
                    phase[0][lane] = weights[lane] * (z[0][lane] * c - z[1][lane] * s);
                    phase[1][lane] = -weights[lane] * (z[0][lane] * s + z[1][lane] * c);
                }
            }
            let entries = &block.entries[column.entries.clone()];
            for (entry, out) in entries.iter().zip(&mut out[column.entries.clone()]) {
                let along_x = &x[entry.k * count..(entry.k + 1) * count];
                let amplitudes = &body.amplitudes[entry.shell * count..(entry.shell + 1) * count];
                let (mut cr, mut ci) = ([0.0; LANES], [0.0; LANES]);
                let (mut sr, mut si) = ([0.0; LANES], [0.0; LANES]);
                for ((phase, x), a) in self.column.iter().zip(along_x).zip(amplitudes) {
                    for lane in 0..LANES {
                        let (re, im) = (a[lane] * phase[0][lane], a[lane] * phase[1][lane]);
                        cr[lane] = f64::mul_add(re, x[0][lane], cr[lane]);
                        ci[lane] = f64::mul_add(im, x[0][lane], ci[lane]);
                        sr[lane] = f64::mul_add(re, x[1][lane], sr[lane]);
                        si[lane] = f64::mul_add(im, x[1][lane], si[lane]);
                    }
                }
                let total = |lanes: Lane| lanes.iter().sum::<f64>();
                *out = [total(cr), total(ci), total(sr), total(si)];
            }
        }
    }
}
