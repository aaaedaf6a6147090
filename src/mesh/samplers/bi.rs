//! Sampler `bi`: Behandish and Ilieş' Algorithm 1, which the product kernel correlates.
//!
//! # The double skin
//!
//! Balls of any size count by volume when densities are multiplied and integrated (B&I eq. 51-53). Each part has F =
//! f(S + B0) - lambda f(S), with f a sum of bumps that is about one in a solid and zero outside. A pair then scores
//! -<F_A, F_B>. The balls are those of A3 at mu = 0.25, and f has weights fitted to the solid.
//!
//! **Two sets of weights.** f(S + B0) has the same balls, grown by the depth of the skin. Grown balls overlap more, so
//! that weights fitted to S add up to several times one in its skin (8 times one, measured on a block).
//! They are fitted a second time, to the grown solid.
//!
//! **Radii** are rounded to 24 equal steps before the fit, which compensates for that. Each function of the lifted axis
//! then represents one radius, exactly.
//!
//! # Lengths
//!
//! S is the part grown by [`CORE`] offsets, the skin [`SKIN`] offsets deep. Two flat faces with a gap g score, per
//! area, the correlation of their profiles (1 - lambda in S, 1 in the skin) through the low-pass. With these lengths
//! and lambda = 9 it is greatest at g = r0, above half of that from 0.65 to 1.5 r0, and below zero under 0.5 r0.

use knotdock_structures::sampling::decomposition::{DecompositionOptions, decompose};
use knotdock_structures::sampling::grid::DepthField;
use knotdock_structures::sampling::weights::{self, FittedWeights};
use knotdock_structures::sampling::{Ball, SampleError};

use super::{BallsToWeigh, PartToSample, WeightedBalls, union};

/// Growth of the part before its density is fitted, in offsets.
pub const CORE: f64 = 0.17;
/// Depth of the skin, in offsets.
pub const SKIN: f64 = 0.5;
/// Most distinct radii.
const CLASSES: usize = 24;

pub(in crate::mesh) fn sample(part: &PartToSample) -> Result<WeightedBalls, SampleError> {
    let grid = part.field.grid;
    let (core, skin) = (CORE * part.offset, SKIN * part.offset);
    let found = decompose(part.solid, part.field, &DecompositionOptions::default())?;
    let grown = found
        .a3
        .iter()
        .map(|ball| ball.grown(core - grid.epsilon()));
    let mut balls: Vec<Ball> = grown.collect();
    round_radii(&mut balls);
    let Some(bump) = part.fitted else {
        let weights = vec![1.0; balls.len()];
        return Ok(WeightedBalls {
            skin_weights: weights.clone(),
            balls,
            weights,
            per_cell: None,
            fit: None,
            skin_fit: None,
        });
    };
    let around = DepthField::new(part.solid, grid.padded(core + skin + grid.epsilon()));
    let fitted = |by: f64, balls: &[Ball]| -> FittedWeights {
        let grown = DepthField {
            grid: around.grid,
            depth: around.depth.iter().map(|depth| depth + by).collect(),
        };
        let volume = grown.inside().len() as f64 * grid.spacing().powi(3);
        weights::fit(&grown, balls, bump, volume)
    };
    let fit = fitted(core, &balls);
    let grown: Vec<Ball> = balls.iter().map(|ball| ball.grown(skin)).collect();
    let skin_fit = fitted(core + skin, &grown);
    // A ball without weight would only cost time.
    let used = |place: &usize| fit.weights[*place] > 0.0 || skin_fit.weights[*place] > 0.0;
    let used: Vec<usize> = (0..balls.len()).filter(used).collect();
    Ok(WeightedBalls {
        balls: used.iter().map(|&place| balls[place]).collect(),
        weights: used.iter().map(|&place| fit.weights[place]).collect(),
        skin_weights: used.iter().map(|&place| skin_fit.weights[place]).collect(),
        per_cell: None,
        fit: Some(fit),
        skin_fit: Some(skin_fit),
    })
}

/// Balls of a file as they are, but for the rounding of radii: their weights are the file's if it has some.
pub(in crate::mesh) fn of_balls(part: &BallsToWeigh) -> WeightedBalls {
    let (core, skin) = (CORE * part.offset, SKIN * part.offset);
    let mut balls: Vec<Ball> = part.balls.iter().map(|ball| ball.grown(core)).collect();
    round_radii(&mut balls);
    let grown: Vec<Ball> = balls.iter().map(|ball| ball.grown(skin)).collect();
    let grid = part.grid.padded(core + skin + part.grid.epsilon());
    let fitted = |balls: &[Ball]| {
        let field = union(grid, balls);
        let volume = field.inside().len() as f64 * grid.spacing().powi(3);
        let bump = part.fitted;
        bump.map(|bump| weights::fit(&field, balls, bump, volume))
    };
    let fit = match part.weights {
        Some(_) => None,
        None => fitted(&balls),
    };
    let skin_fit = fitted(&grown);
    let of = |fit: &Option<FittedWeights>| match fit {
        Some(fit) => fit.weights.clone(),
        None => vec![1.0; balls.len()],
    };
    WeightedBalls {
        weights: part.weights.map_or_else(|| of(&fit), <[f64]>::to_vec),
        skin_weights: of(&skin_fit),
        balls,
        per_cell: None,
        fit,
        skin_fit,
    }
}

/// Rounds radii to equal steps from the smallest to the largest.
fn round_radii(balls: &mut [Ball]) {
    let radii = balls.iter().map(|ball| ball.radius);
    let low = radii.clone().fold(f64::INFINITY, f64::min);
    let high = radii.fold(0.0, f64::max);
    let step = (high - low) / (CLASSES - 1) as f64;
    if step > 0.0 {
        for ball in balls {
            ball.radius = low + step * ((ball.radius - low) / step).round();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_are_few_and_near_what_they_were() {
        let ball = |radius| Ball {
            center: [0.0; 3],
            radius,
        };
        let before: Vec<Ball> = (0..500)
            .map(|i| ball(0.1 + 0.9 * f64::from(i) / 499.0))
            .collect();
        let mut after = before.clone();
        round_radii(&mut after);
        let mut distinct: Vec<f64> = after.iter().map(|ball| ball.radius).collect();
        distinct.dedup();
        assert_eq!(distinct.len(), CLASSES);
        for (before, after) in before.iter().zip(&after) {
            assert!((before.radius - after.radius).abs() <= 0.5001 * 0.9 / (CLASSES - 1) as f64);
        }
        let mut alike = vec![ball(0.3); 3];
        round_radii(&mut alike);
        assert!(alike.iter().all(|ball| ball.radius == 0.3));
    }
}
