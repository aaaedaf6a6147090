//! The uniform-grid baseline of tests and benches: rasterise the bumps of both bodies, transform, multiply, transform back.
//!
//! This is Kavraki's, Lysenko's and ZDock's way, which B&I compare with in their Fig. 8. Each body's function is
//! sampled on a grid of spacing h, one real array per body: the double skin's factor i only changes the product's sign.
//! With F_A and F_B the sampled psi_{r+r0} - lambda psi_r of receptor and turned ligand,
//!
//! G(t) = -h^3 sum_n F_A(n h) F_B(n h - t), by one forward and one inverse real transform per rotation.
//!
//! # What it computes
//!
//! The *product* kernel (`kernel::product`), not the lifted one, and so is compared with
//! `Plan::product` and `ProductScorer` alone. Its only error is the sampling's: the sum over
//! voxels stands for the integral of F_A(x) F_B(x - t), and errs by the aliases of both spectra at multiples of 1 / h.
//! For smooth bumps that falls faster than any power of h, for sharp balls (alpha = infinity) like a power (the tests
//! measure both).
//!
//! Under [`Band::LowPass`] the spectrum is multiplied by W(|w|) before it goes back, which filters the pair kernel, not
//! what was aliased into the band before.
//!
//! # Conventions
//!
//! Both bodies lie with the middle of their bounding boxes on voxel 0 and wrap around the box. Voxel (ix, iy, iz) of
//! the result is then the position (ix, iy, iz) h, less whole box lengths, of the ligand's centre relative to the
//! receptor's: [`UniformGrid::position`]. The box holds both bodies and twice the kernel's reach per axis, so that no
//! ligand scores with the receptor and its image both. Scores are in Å^3.

use knotdock_scoring::engine::PlanError;
use knotdock_scoring::exact::center;
use knotdock_scoring::kernel::product::{Body, factors, peak_score_and_reach};
use knotdock_scoring::kernel::{Band, Bump, KernelError, KernelOptions, ProductKernel};
use knotdock_scoring::quantity::Quantity;
use knotdock_scoring::transform::real_fft_3d::{RealFft3d, RealFft3dWorkspace};
use knotdock_scoring::transform::{Real, fast_size};
use knotdock_structures::Knots;
use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use num_complex::Complex;

/// Options of the baseline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformGridOptions {
    /// Double skin, bump exponent and low-pass (the trim has no meaning here).
    pub kernel: KernelOptions,
    /// Whether the low-pass is applied.
    pub band: Band,
    /// Grid spacing h, Å.
    pub spacing: f64,
    /// Share of its peak below which the low-passed kernel's ringing may reach through the box's faces; without a
    /// low-pass nothing does.
    pub tolerance: f64,
}

/// A planned correlation on a uniform grid.
#[derive(Clone, Debug)]
pub struct UniformGridPlan {
    /// The options it was made from.
    pub options: UniformGridOptions,
    /// The kernel that the grid samples.
    pub kernel: ProductKernel,
    bump: Bump,
    /// Grid points per axis.
    pub size: [usize; 3],
    /// Middle of the receptor's bounding box, Å.
    pub receptor_center: Vector3<f64>,
    /// Middle of the ligand's bounding box, Å.
    pub ligand_center: Vector3<f64>,
}

impl UniformGridPlan {
    /// Plans the correlation of two sets of knots.
    ///
    /// # Errors
    /// [`PlanError`] on knots or options that cannot be used.
    pub fn new(
        receptor: &Knots,
        ligand: &Knots,
        options: UniformGridOptions,
    ) -> Result<Self, PlanError> {
        receptor.check()?;
        ligand.check()?;
        let spacing = options.spacing;
        for (name, value) in [("spacing", spacing), ("tolerance", options.tolerance)] {
            if !(value.is_finite() && value > 0.0) {
                let bound = "above 0 and finite";
                return Err(PlanError::Option { name, value, bound });
            }
        }
        let largest = |knots: &Knots| knots.radii.iter().copied().fold(0.0, f64::max);
        let (r, s) = (largest(receptor), largest(ligand));
        // Frequencies matter to the low-pass's reach alone.
        let kernel = ProductKernel::new(
            options.kernel,
            options.band,
            r.max(s),
            1.0 / options.kernel.resolution,
        )?;
        let reach = match options.band {
            Band::Whole => kernel.reach(r, s),
            Band::LowPass => peak_score_and_reach(&kernel.pair_table(r, s), options.tolerance).1,
        };
        let (receptor_center, ligand_center) = (center(receptor), center(ligand));
        let (low, high) = receptor.bounds();
        let radius = ligand
            .centers
            .iter()
            .map(|&y| (Vector3::from(y) - ligand_center).norm())
            .fold(0.0, f64::max);
        let mut points = 1.0;
        let size = [0, 1, 2].map(|axis| {
            let length = high[axis] - low[axis] + 2.0 * (radius + reach);
            let count = (length / spacing).ceil() + 1.0;
            points *= count;
            if count < 1e5 {
                fast_size(count as usize)
            } else {
                0
            }
        });
        if points > 1e11 || size.contains(&0) {
            return Err(PlanError::TooLarge(points));
        }
        Ok(Self {
            options,
            kernel,
            bump: Bump::new(options.kernel.alpha).map_err(KernelError::from)?,
            size,
            receptor_center,
            ligand_center,
        })
    }

    /// Box lengths in Å.
    pub fn lengths(&self) -> [f64; 3] {
        self.size.map(|n| n as f64 * self.options.spacing)
    }
}

/// A prepared correlation of one pair on a uniform grid.
pub struct UniformGrid<T: Real> {
    plan: UniformGridPlan,
    fft: RealFft3d<T>,
    /// Each product of the fold: the receptor's spectrum with factor, low-pass, h^3 and 1 / N in it, and the ligand's
    /// function.
    products: Vec<(Vec<Complex<T>>, Body)>,
    ligand: Vec<Ball>,
}

/// A ball relative to its body's centre, in Å.
#[derive(Clone, Copy, Debug)]
struct Ball {
    position: Vector3<f64>,
    radius: f64,
    weight: f64,
}

/// Buffers of one rotation in flight; nothing is allocated after this.
pub struct UniformGridWorkspace<T> {
    /// Scores after [`UniformGrid::correlate`], (nx, ny, nz) row-major.
    pub grid: Vec<T>,
    spectrum: Vec<Complex<T>>,
    sum: Vec<Complex<T>>,
    fft: RealFft3dWorkspace<T>,
}

impl<T: Real> UniformGrid<T> {
    /// Rasterises and transforms the receptor.
    pub fn new(plan: UniformGridPlan, receptor: &Knots, ligand: &Knots, fold: Quantity) -> Self {
        let fft = RealFft3d::<T>::new(plan.size);
        let zero = Complex::new(T::zero(), T::zero());
        let receptor = balls(receptor, plan.receptor_center);
        let mut work = fft.workspace();
        let mut grid = vec![T::zero(); plan.size.iter().product()];
        let scale = plan.options.spacing.powi(3) / grid.len() as f64;
        let products = factors(fold)
            .iter()
            .map(|&(body, other, factor)| {
                rasterise(&plan, body, receptor.iter().copied(), &mut grid);
                let mut spectrum = vec![zero; fft.spectrum_len()];
                fft.forward(&mut grid, &mut spectrum, &mut work);
                for (place, value) in spectrum.iter_mut().enumerate() {
                    *value = value.scale(T::of(factor * scale * low_pass(&plan, place)));
                }
                (spectrum, other)
            })
            .collect();
        Self {
            ligand: balls(ligand, plan.ligand_center),
            products,
            fft,
            plan,
        }
    }

    /// Buffers for one rotation at a time.
    pub fn workspace(&self) -> UniformGridWorkspace<T> {
        let zero = Complex::new(T::zero(), T::zero());
        let sums = usize::from(self.products.len() > 1) * self.fft.spectrum_len();
        UniformGridWorkspace {
            grid: vec![T::zero(); self.plan.size.iter().product()],
            spectrum: vec![zero; self.fft.spectrum_len()],
            sum: vec![zero; sums],
            fft: self.fft.workspace(),
        }
    }

    /// Position of the ligand's centre relative to the receptor's for a voxel, in Å, in the box centred on the
    /// receptor.
    pub fn position(&self, voxel: usize) -> Vector3<f64> {
        let [_, ny, nz] = self.plan.size;
        let index = [voxel / (ny * nz), voxel / nz % ny, voxel % nz];
        Vector3::from([0, 1, 2].map(|axis| {
            let n = self.plan.size[axis];
            let signed = if 2 * index[axis] >= n {
                index[axis] as f64 - n as f64
            } else {
                index[axis] as f64
            };
            signed * self.plan.options.spacing
        }))
    }

    /// G over all translations at one rotation, into `work.grid`.
    pub fn correlate(&self, rotation: &UnitQuaternion<f64>, work: &mut UniformGridWorkspace<T>) {
        let matrix = rotation.to_rotation_matrix();
        for (index, (receptor, body)) in self.products.iter().enumerate() {
            self.rasterise_turned(&matrix, *body, &mut work.grid);
            self.fft
                .forward(&mut work.grid, &mut work.spectrum, &mut work.fft);
            let last = index + 1 == self.products.len();
            for (place, (value, receptor)) in work.spectrum.iter_mut().zip(receptor).enumerate() {
                let mut product = receptor * value.conj();
                if index > 0 {
                    product = product + work.sum[place];
                }
                if last {
                    *value = product;
                } else {
                    work.sum[place] = product;
                }
            }
        }
        self.fft
            .inverse(&mut work.spectrum, &mut work.grid, &mut work.fft);
    }

    /// Time in seconds of rasterising one rotation's ligand alone, which [`Self::correlate`] contains.
    pub fn rasterising_seconds(
        &self,
        rotation: &UnitQuaternion<f64>,
        work: &mut UniformGridWorkspace<T>,
    ) -> f64 {
        let start = std::time::Instant::now();
        let matrix = rotation.to_rotation_matrix();
        for (_, body) in &self.products {
            self.rasterise_turned(&matrix, *body, &mut work.grid);
        }
        start.elapsed().as_secs_f64()
    }

    /// Samples a body's function of the turned ligand.
    fn rasterise_turned(&self, rotation: &Rotation3<f64>, body: Body, grid: &mut [T]) {
        let turned = self.ligand.iter().map(|ball| Ball {
            position: rotation * ball.position,
            ..*ball
        });
        rasterise(&self.plan, body, turned, grid);
    }
}

fn balls(knots: &Knots, center: Vector3<f64>) -> Vec<Ball> {
    (0..knots.len())
        .map(|i| Ball {
            position: Vector3::from(knots.centers[i]) - center,
            radius: knots.radii[i],
            weight: knots.weights[i],
        })
        .collect()
}

/// W at a place of a spectrum.
fn low_pass(plan: &UniformGridPlan, place: usize) -> f64 {
    let [nx, ny, _] = plan.size;
    let lengths = plan.lengths();
    let index = [place % nx, place / nx % ny, place / (nx * ny)];
    let square: f64 = (0..3)
        .map(|axis| {
            let k = index[axis].min(plan.size[axis] - index[axis]) as f64;
            (k / lengths[axis]).powi(2)
        })
        .sum();
    plan.kernel.low_pass(square.sqrt())
}

/// Samples sum_i c_i (the body's function of ball i) at every voxel, wrapping around the box.
fn rasterise<T: Real>(
    plan: &UniformGridPlan,
    body: Body,
    balls: impl Iterator<Item = Ball>,
    grid: &mut [T],
) {
    let h = plan.options.spacing;
    let bump = plan.bump;
    let [nx, ny, nz] = plan.size;
    grid.fill(T::zero());
    let wrap = |index: i64, n: usize| index.rem_euclid(n as i64) as usize;
    // Voxels n with |n h - at| <= half.
    let run = |at: f64, half: f64| {
        let first = ((at - half) / h).ceil() as i64;
        first..=((at + half) / h).floor() as i64
    };
    for ball in balls {
        let [x, y, z] = ball.position.into();
        let grown = ball.radius + plan.options.kernel.offset;
        let reach = if body == Body::Solid {
            ball.radius
        } else {
            grown
        };
        for ix in run(x, reach) {
            let dx = ix as f64 * h - x;
            let left = reach * reach - dx * dx;
            for iy in run(y, left.max(0.0).sqrt()) {
                let dy = iy as f64 * h - y;
                let near = dx * dx + dy * dy;
                let half = (reach * reach - near).max(0.0).sqrt();
                let row = (wrap(ix, nx) * ny + wrap(iy, ny)) * nz;
                let row = &mut grid[row..row + nz];
                let range = run(z, half);
                let mut place = wrap(*range.start(), nz);
                for iz in range {
                    let dz = iz as f64 * h - z;
                    let distance = (near + dz * dz).sqrt();
                    let solid = bump.value(distance / ball.radius);
                    let value = match body {
                        Body::Solid => solid,
                        Body::Grown => bump.value(distance / grown),
                        Body::DoubleSkin => {
                            bump.value(distance / grown) - plan.options.kernel.lambda * solid
                        }
                    };
                    row[place] += T::of(ball.weight * value);
                    place += 1;
                    if place == nz {
                        place = 0;
                    }
                }
            }
        }
    }
}
