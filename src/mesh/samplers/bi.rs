//! Sampler `bi`: Behandish and Ilieş' Algorithm 1, which the product kernel correlates.
//!
//! # The double skin
//!
//! Balls of any size count by volume when densities are multiplied and integrated (B&I eq. 51-53). Each part has F =
//! f(S + B0) - lambda f(S), and a pair scores -<F_A, F_B>. The balls are those of A1 up to 2 offsets and of A3
//! above, at mu = 0.25, on a grid of half the offset. Each gives two bumps, of the ball and of the ball grown by the
//! depth of the skin. Their weights, of either sign, are fitted to F at once ([`super::double_skin`]).
//!
//! **Radii** are rounded to 24 equal ratios before the fit, which compensates for that. Each function of the lifted axis
//! then represents one radius, exactly.
//!
//! # Lengths
//!
//! S is the part grown by [`CORE`] offsets, the skin [`SKIN`] offsets deep. Two flat faces with a gap g score, per
//! area, the correlation of their profiles (1 - lambda in S, 1 in the skin) through the low-pass. With these lengths
//! and lambda = 9 it is greatest at g = r0, above half of that from 0.65 to 1.5 r0, and below zero under 0.5 r0.

use knotdock_scoring::kernel::KernelOptions;
use knotdock_structures::sampling::Ball;
use knotdock_structures::sampling::decomposition::{DecompositionOptions, decompose};
use knotdock_structures::sampling::grid::{DepthField, Grid};

use super::double_skin::DoubleSkin;
use super::{BallsToWeigh, PartToSample, SamplerError, WeightedBalls, union};

/// Growth of the part before its density is fitted, in offsets.
pub const CORE: f64 = 0.17;
/// Depth of the skin, in offsets.
pub const SKIN: f64 = 0.5;
/// Nodes of the decomposition's grid per offset. With one, flat faces have too few balls: the fit of a block was off by
/// 0.49 rms near its surface, with two by 0.17 (the block of tests/mesh_docking/fairness.rs).
const PER_OFFSET: f64 = 2.0;
/// Most distinct radii.
const CLASSES: usize = 24;

/// Balls of A1 up to this radius are kept, larger ones from A3, in offsets.
const SMALL: f64 = 2.0;
/// Smallest balls, in offsets.
const LEAST: f64 = 0.25;

pub(in crate::mesh) fn sample(part: &PartToSample) -> Result<WeightedBalls, SamplerError> {
    let grid = part.field.grid;
    let (core, skin) = (CORE * part.offset, SKIN * part.offset);
    let per_axis = (PER_OFFSET * 2.0 * grid.half() / part.offset).round() as usize + 1;
    let coarse = match per_axis < grid.per_axis() {
        true => &DepthField::new(part.solid, Grid::new(part.solid, per_axis)),
        false => part.field,
    };
    let found = decompose(part.solid, coarse, &DecompositionOptions::default())?;
    let (least, small) = (LEAST * part.offset, SMALL * part.offset);
    let ungrown = found
        .a3
        .iter()
        .map(|ball| ball.grown(-coarse.grid.epsilon()));
    let large = ungrown.filter(|ball| ball.radius > small);
    let small = found
        .a1
        .iter()
        .filter(|ball| (least..=small).contains(&ball.radius));
    let mut balls: Vec<Ball> = small.copied().chain(large).collect();
    if balls.is_empty() {
        balls = found.a1;
    }
    for ball in &mut balls {
        *ball = ball.grown(core);
    }
    round_radii(&mut balls);
    let around = DepthField::new(part.solid, grid.padded(core + skin + grid.epsilon()));
    weighted(
        balls,
        &around,
        (core, part.offset),
        (part.kernel, part.room),
        None,
    )
}

/// Balls of a file as they are, but for the rounding of radii: their weights are the file's if it has some.
pub(in crate::mesh) fn of_balls(part: &BallsToWeigh) -> Result<WeightedBalls, SamplerError> {
    let (core, skin) = (CORE * part.offset, SKIN * part.offset);
    let grid = part.grid.padded(core + skin + part.grid.epsilon());
    let around = union(grid, &part.balls, core + 2.0 * skin);
    let mut balls: Vec<Ball> = part.balls.iter().map(|ball| ball.grown(core)).collect();
    round_radii(&mut balls);
    weighted(
        balls,
        &around,
        (core, part.offset),
        (part.kernel, part.room),
        part.weights,
    )
}

/// The balls with weights: given, fitted, or one where there is no kernel to fit them to.
fn weighted(
    balls: Vec<Ball>,
    around: &DepthField,
    (core, offset): (f64, f64),
    (kernel, room): (Option<KernelOptions>, Option<u64>),
    given: Option<&[f64]>,
) -> Result<WeightedBalls, SamplerError> {
    let Some(kernel) = kernel else {
        let weights = given.map_or_else(|| vec![1.0; balls.len()], <[f64]>::to_vec);
        return Ok(WeightedBalls {
            skin_weights: weights.clone(),
            balls,
            weights,
            per_cell: None,
            fit: None,
            double_skin: None,
        });
    };
    let skin = DoubleSkin {
        field: around,
        core,
        kernel: KernelOptions {
            offset: SKIN * offset,
            ..kernel
        },
        given,
        room,
    };
    let fitted = skin.fit(&balls)?;
    Ok(WeightedBalls {
        balls,
        weights: fitted.weights,
        skin_weights: fitted.skin_weights,
        per_cell: None,
        fit: None,
        double_skin: Some(fitted.fit),
    })
}

/// Rounds radii to equal ratios from the smallest to the largest.
fn round_radii(balls: &mut [Ball]) {
    let radii = balls.iter().map(|ball| ball.radius);
    let low = radii.clone().fold(f64::INFINITY, f64::min);
    let high = radii.fold(0.0, f64::max);
    let step = (high / low).ln() / (CLASSES - 1) as f64;
    if step > 0.0 {
        for ball in balls {
            ball.radius = low * (step * ((ball.radius / low).ln() / step).round()).exp();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_are_few_and_near_what_they_were() {
        let ball = |radius| Ball::new([0.0; 3], radius);
        let before: Vec<Ball> = (0..500)
            .map(|i| ball(0.1 + 0.9 * f64::from(i) / 499.0))
            .collect();
        let mut after = before.clone();
        round_radii(&mut after);
        let mut distinct: Vec<f64> = after.iter().map(|ball| ball.radius).collect();
        distinct.dedup();
        assert_eq!(distinct.len(), CLASSES);
        // Half a step of ten to the 1/23.
        let most = 10f64.powf(0.5001 / (CLASSES - 1) as f64);
        for (before, after) in before.iter().zip(&after) {
            let ratio = after.radius / before.radius;
            assert!(ratio < most && ratio > 1.0 / most);
        }
        let mut alike = vec![ball(0.3); 3];
        round_radii(&mut alike);
        assert!(alike.iter().all(|ball| ball.radius == 0.3));
    }
}
