//! The score of a pose: alone, for ranking, or with its slices and the unfiltered sum, for the table.
//!
//! A polynomial sum_k c_k u^k of degree 7 is (c_0..c_3 + u^4 c_4..c_7) . (1, u, u^2, u^3): two vectors of four from one cache line, and
//! the last product need not be summed across before all pairs are.
//!
//! Closures are inlined by order: what the compiler leaves outside the dispatched function is compiled without its vector features.

use super::blocks::{Block, LANES};
use super::effects::Sums;
use super::tables::{Line, Places};
use super::{ExactScore, ExactScorer};
use crate::effect::Effect;
use crate::se3::Pose;
use crate::vectorized::vectorized;

impl ExactScorer {
    /// The score of one pose, all terms together, and nothing else: what poses are ranked by, at a fraction of [`Self::score`]'s price.
    /// Agrees with it but for rounding.
    pub fn score_only(&self, pose: &Pose) -> f64 {
        vectorized(
            #[inline(always)]
            || {
                let ([score], terms) = self.sums(
                    pose,
                    #[inline(always)]
                    |index| self.tables.scores().get(index).map(std::array::from_ref),
                );
                score + terms.iter().sum::<f64>()
            },
        )
    }

    /// Score, terms, slices and unfiltered score of one pose.
    pub fn score(&self, pose: &Pose) -> ExactScore {
        vectorized(
            #[inline(always)]
            || {
                let (slices, mut terms) = self.sums(
                    pose,
                    #[inline(always)]
                    |index| self.tables.slices().get(index),
                );
                let weights = self.kernel.options().slice_weights();
                let weighted = |slices: [f64; 3]| (0..3).map(|i| weights[i] * slices[i]).sum();
                // From the slices, not the score's own table: what the table shows then adds up to the last digit.
                terms[Effect::Shape as usize] = weighted(slices);
                ExactScore {
                    score: terms.iter().sum(),
                    terms,
                    slices,
                    unfiltered: weighted(self.unfiltered_slices(pose)),
                }
            },
        )
    }

    /// Sums over all pairs of the shape kernels whose lines `lines` holds, and of the terms beside shape by effect.
    #[inline(always)]
    fn sums<'a, const KERNELS: usize>(
        &self,
        pose: &Pose,
        lines: impl Fn(usize) -> Option<&'a [Line; KERNELS]>,
    ) -> ([f64; KERNELS], [f64; Effect::ALL.len()]) {
        // A loop over no terms would still cost shape alone a quarter more.
        if self.effects.is_empty() {
            self.sums_with::<KERNELS, false>(pose, lines)
        } else {
            self.sums_with::<KERNELS, true>(pose, lines)
        }
    }

    #[inline(always)]
    fn sums_with<'a, const KERNELS: usize, const EFFECTS: bool>(
        &self,
        pose: &Pose,
        lines: impl Fn(usize) -> Option<&'a [Line; KERNELS]>,
    ) -> ([f64; KERNELS], [f64; Effect::ALL.len()]) {
        let (rotation, center) = self.placed(pose);
        let reach = self.kernel.reach();
        let mut totals = [0.0; KERNELS];
        let mut terms = [0.0; Effect::ALL.len()];
        for (index, knot) in self.ligand.iter().enumerate() {
            let x = (rotation * knot.position + center).into();
            let starts = self.tables.starts(knot.class);
            let mut sums = [Sums::default(); KERNELS];
            let mut term_sums = [Sums::default(); Effect::ALL.len()];
            self.receptor.near(
                &x,
                reach,
                #[inline(always)]
                |number, block| {
                    let places = self.tables.place(&block.squares(&x));
                    add_block(block, &places, starts, &lines, &mut sums);
                    if EFFECTS {
                        for (term, sums) in self.effects.iter().zip(&mut term_sums) {
                            if let Some((_, row)) = term.of(index) {
                                term.add_block(number, &places, row, sums);
                            }
                        }
                    }
                },
            );
            for (total, sums) in totals.iter_mut().zip(&sums) {
                *total += knot.weight * across(sums);
            }
            for (term, sums) in self.effects.iter().zip(&term_sums) {
                let value = term.of(index).map_or(0.0, |(value, _)| value);
                terms[term.effect as usize] += value * across(sums);
            }
        }
        (totals, terms)
    }

    /// Slices of B&I's own kernel, evaluated directly.
    #[inline(always)]
    fn unfiltered_slices(&self, pose: &Pose) -> [f64; 3] {
        let (rotation, center) = self.placed(pose);
        let cone = self.kernel.cone();
        let offsets = self.kernel.options().slice_offsets();
        let mut totals = [0.0; 3];
        for knot in &self.ligand {
            let x = (rotation * knot.position + center).into();
            let radius_sums = self.tables.sums(knot.class);
            let mut sums = [0.0; 3];
            self.receptor.near(
                &x,
                self.unfiltered_reach,
                #[inline(always)]
                |_, block| {
                    let squares = block.squares(&x);
                    for lane in 0..LANES {
                        let Some(radius_sum) = radius_sums.get(block.classes[lane] as usize) else {
                            continue;
                        };
                        let widest = radius_sum + offsets[2];
                        if squares[lane] >= widest * widest {
                            continue;
                        }
                        let distance = squares[lane].sqrt();
                        for (sum, offset) in sums.iter_mut().zip(offsets) {
                            let sigma = radius_sum + offset;
                            if distance < sigma {
                                *sum += block.weights[lane] * cone.value(distance, sigma);
                            }
                        }
                    }
                },
            );
            for (total, sum) in totals.iter_mut().zip(sums) {
                *total += knot.weight * sum;
            }
        }
        totals
    }
}

/// The sum of partial sums.
#[inline(always)]
fn across([even, odd]: &Sums) -> f64 {
    let four: [f64; 4] = std::array::from_fn(|k| even[k] + odd[k]);
    (four[0] + four[2]) + (four[1] + four[3])
}

/// Adds the kernels of eight receptor knots.
#[inline(always)]
fn add_block<'a, const KERNELS: usize>(
    block: &Block,
    places: &Places,
    starts: &[u32],
    lines: &impl Fn(usize) -> Option<&'a [Line; KERNELS]>,
    sums: &mut [Sums; KERNELS],
) {
    let mut powers = [[0.0; 4]; LANES];
    let mut fourths = [0.0; LANES];
    for lane in 0..LANES {
        let (weight, u) = (block.weights[lane], places.offsets[lane]);
        let square = u * u;
        let first = weight * u;
        powers[lane] = [weight, first, weight * square, first * square];
        fourths[lane] = square * square;
    }
    for lane in 0..LANES {
        let start = starts.get(block.classes[lane] as usize).copied();
        let Some(own) = lines((start.unwrap_or(0) + places.panels[lane]) as usize) else {
            continue;
        };
        for (sum, Line(line)) in sums.iter_mut().zip(own) {
            let sum = &mut sum[lane % 2];
            for k in 0..4 {
                sum[k] += powers[lane][k] * (line[k] + fourths[lane] * line[k + 4]);
            }
        }
    }
}
