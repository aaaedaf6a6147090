//! The fast transform of knots to modes (NFFT, type 1), in three or four dimensions, on the card.
//!
//! Grid, window and order of modes are those of a plan of [`crate::transform::nufft`], whose tolerance holds down to the
//! rounding errors: those of single precision, lifted as the plan's are by dividing the window out, and those of the
//! whole numbers that are summed. Of the latter, 2^30 are the sum of all weights' magnitudes, so that n knots lose
//! about n 2^-31 of a knot at a grid point.

use super::kernel::{Kernel, Step, constants, groups};
use super::line_fft::{Direction, WIDTH};
use super::lines::Axis;
use super::{GpuDevice, GpuError, Job};
use crate::processor::Cost;
use crate::transform::nufft::Plan;
use num_complex::Complex64;

impl Job<Complex64> {
    /// The modes of knots, in the plan's order. Points are in units of the period.
    ///
    /// Cost: the grid is cleared (8 bytes per point); per knot and point of its window 16 bytes, a polynomial along the
    /// last axis and 5 operations; per axis 8 bytes of each point before and mode after, and 5 n log2 n operations per
    /// line of n.
    ///
    /// # Errors
    /// [`GpuError`] if a number is not finite, or the fine grid does not fit a buffer.
    pub fn knot_modes<const D: usize>(
        gpu: &GpuDevice,
        plan: &Plan<f64, D>,
        points: &[[f64; D]],
        weights: &[Complex64],
    ) -> Result<Self, GpuError> {
        gpu.finite("point", points)?;
        let parts: Vec<[f64; 2]> = weights
            .iter()
            .map(|weight| [weight.re, weight.im])
            .collect();
        gpu.finite("weight", &parts)?;
        if points.len() != weights.len() {
            return Err(GpuError::Input(format!(
                "{} weights for {} points",
                weights.len(),
                points.len()
            )));
        }
        // A window value is at most 1, so that all knots on one point reach 2^30.
        let sum = parts
            .iter()
            .map(|[re, im]| re.abs() + im.abs())
            .sum::<f64>();
        let unit = sum.max(f64::MIN_POSITIVE) * 0.5f64.powi(30);
        let weights: Vec<[f32; 2]> = parts
            .iter()
            .map(|part| part.map(|x| (x / unit) as f32))
            .collect();
        let mut shape = plan.grid();
        let points_of_grid: usize = shape.iter().product();
        let fine = gpu.zeros("fine grid", 8 * points_of_grid)?;
        let mut steps = Vec::new();
        let (window, width) = (plan.window_rows(), plan.width());
        if !points.is_empty() {
            steps.push(spread(gpu, plan, points, &weights, &fine)?);
        }
        let on_window = shape.iter().filter(|&&size| size > 1).count() as i32;
        let spread_points = points.len() as f64 * (width as f64).powi(on_window);
        let mut cost = Cost {
            // A sum reads and writes both parts.
            bytes: 8.0 * points_of_grid as f64 + 16.0 * spread_points,
            operations: spread_points * (2.0 * window.len() as f64 + 5.0),
        };
        let mut before = fine.clone();
        for axis in (0..D).rev() {
            let factors: Vec<f32> = plan.factors(axis).iter().map(|&x| x as f32).collect();
            let along = Axis {
                shape: &shape,
                axis,
                direction: Direction::Forward,
                factors: &factors,
                below: factors.len() / 2,
                whole: axis == D - 1,
            };
            let left: usize = shape.iter().product::<usize>() / shape[axis] * factors.len();
            let after = gpu.zeros("modes", 8 * left)?;
            steps.push(along.step(gpu, &before, &after, &mut cost)?);
            shape[axis] = factors.len();
            before = after;
        }
        let scaled = move |[re, im]: [f32; 2]| Complex64::new(f64::from(re), f64::from(im)) * unit;
        let outputs = vec![(before, plan.mode_count())];
        Ok(Self::new(gpu, steps, outputs, cost, scaled).clearing(&fine))
    }
}

fn spread<const D: usize>(
    gpu: &GpuDevice,
    plan: &Plan<f64, D>,
    points: &[[f64; D]],
    weights: &[[f32; 2]],
    fine: &wgpu::Buffer,
) -> Result<Step, GpuError> {
    let (sizes, width) = (plan.grid(), plan.width());
    // The last axis stays the last: others of one point come before.
    let four = |axes: [usize; D]| -> [usize; 4] {
        std::array::from_fn(|axis| if axis < 4 - D { 1 } else { axes[axis + D - 4] })
    };
    let widths = four(sizes.map(|size| if size == 1 { 1 } else { width }));
    let (mut firsts, mut variables) = (Vec::new(), Vec::new());
    for point in points {
        let (mut first, mut variable) = ([0u32; 4], [0f32; 4]);
        for axis in (0..D).filter(|&axis| sizes[axis] > 1) {
            let (x, size) = (point[axis], sizes[axis] as f64);
            let low = (x - x.floor()) * size - 0.5 * width as f64;
            first[axis + 4 - D] = low.ceil().rem_euclid(size) as u32;
            variable[axis + 4 - D] = (2.0 * (low.ceil() - low) - 1.0) as f32;
        }
        firsts.push(first);
        variables.push(variable);
    }
    let rows = plan.window_rows();
    let window: Vec<f32> = rows.concat().into_iter().map(|x| x as f32).collect();
    let list = |all: [usize; 4]| all.map(|n| format!("{n}u")).join(", ");
    let code = constants(&[
        ("WIDTH", WIDTH),
        ("WINDOW", width),
        ("TERMS", rows.len()),
        ("KNOTS", points.len()),
    ]) + &format!(
        "const WIDTHS = vec4<u32>({});\nconst SIZES = vec4<u32>({});\n",
        list(widths),
        list(four(sizes))
    ) + include_str!("knot_modes.wgsl");
    let kernel = Kernel::new(gpu, "spread", "spread", &code)?;
    let buffers = [
        &gpu.filled("firsts", &firsts)?,
        &gpu.filled("variables", &variables)?,
        &gpu.filled("weights", weights)?,
        &gpu.filled("window", &window)?,
        fine,
    ];
    let items = points.len() * widths[..3].iter().product::<usize>();
    let launched: usize = groups(items.div_ceil(WIDTH)).iter().product();
    if launched > u32::MAX as usize / WIDTH {
        return Err(gpu.too_small(format!(
            "{items} rows of windows, of 2^32 that can be numbered"
        )));
    }
    kernel.step(gpu, &buffers, groups(items.div_ceil(WIDTH)))
}
