//! The score of a pose: alone, for ranking, or with its slices and the unfiltered sum, for the table.
//!
//! A polynomial sum_k c_k u^k of degree 7 is (c_0..c_3 + u^4 c_4..c_7) . (1, u, u^2, u^3): two vectors of four from one
//! cache line, and the last product need not be summed across before all pairs are.
//!
//! Closures are inlined by order: what the compiler leaves outside the dispatched function is compiled without its
//! vector features. Vectors are spelt out where it found none of its own: that took the score with its slices from 0.71
//! to 0.39 of the plain loop's time (`cargo bench --bench exact`, AMD EPYC, AVX2).

use super::near::{LANES, Near, vectors, vectors_mut};
use super::tables::{Line, Places};
use super::{ExactScore, ExactScorer};
use crate::se3::Pose;
use crate::terms::effect::Effect;
use pulp::{Arch, Simd, WithSimd};

impl ExactScorer {
    /// The score of one pose, all terms together, and nothing else: what poses are ranked by, at a fraction of
    /// [`Self::score`]'s price. Agrees with it but for rounding.
    pub fn score_only(&self, pose: &Pose) -> f64 {
        Arch::new().dispatch(Alone { scorer: self, pose })
    }

    /// Score, terms, slices and unfiltered score of one pose.
    pub fn score(&self, pose: &Pose) -> ExactScore {
        Arch::new().dispatch(InParts { scorer: self, pose })
    }

    /// Sums over all pairs of the shape kernels whose lines `lines` holds, and of the terms beside shape by effect.
    #[inline(always)]
    fn sums<'a, S: Simd, const KERNELS: usize>(
        &self,
        simd: S,
        pose: &Pose,
        lines: impl Fn(usize) -> Option<&'a [Line; KERNELS]>,
    ) -> ([f64; KERNELS], [f64; Effect::ALL.len()]) {
        let (rotation, center) = self.placed(pose);
        let reach = self.kernel.reach();
        let mut totals = [0.0; KERNELS];
        let mut terms = [0.0; Effect::ALL.len()];
        let mut near = Near::new();
        for (index, knot) in self.ligand.iter().enumerate() {
            let x = (rotation * knot.position + center).into();
            let starts = self.tables.starts(knot.class);
            self.receptor.near(
                simd,
                &x,
                reach,
                &mut near,
                #[inline(always)]
                |near| {
                    let sums = self.add_up(
                        simd,
                        near,
                        #[inline(always)]
                        |other, panel| {
                            let other = self.knots.get(other as usize)?;
                            let start = starts.get(other.class as usize)?;
                            Some((other.weight, lines((start + panel) as usize)?))
                        },
                    );
                    for (total, sum) in totals.iter_mut().zip(sums) {
                        *total += knot.weight * sum;
                    }
                    for term in &self.effects {
                        let Some((value, row)) = term.of(index) else {
                            continue;
                        };
                        let [sum] = self.add_up(
                            simd,
                            near,
                            #[inline(always)]
                            |other, panel| {
                                let line = term.line(panel);
                                Some((term.weight(other, row), std::array::from_ref(line)))
                            },
                        );
                        terms[term.effect as usize] += value * sum;
                    }
                },
            );
        }
        (totals, terms)
    }

    /// Sums over the collected knots of their weights times kernels, both of which `pair` gives by knot and panel.
    #[inline(always)]
    fn add_up<'a, S: Simd, const KERNELS: usize>(
        &self,
        simd: S,
        near: &Near,
        pair: impl Fn(u32, u32) -> Option<(f64, &'a [Line; KERNELS])>,
    ) -> [f64; KERNELS] {
        // Two sums by name, not by index, stay in registers.
        let (mut even, mut odd) = ([[0.0; 4]; KERNELS], [[0.0; 4]; KERNELS]);
        for (squares, knots) in near.eights() {
            let places = self.tables.place(simd, squares);
            for lane in (0..LANES).step_by(2) {
                for (lane, sums) in [(lane, &mut even), (lane + 1, &mut odd)] {
                    if let Some((weight, lines)) = pair(knots[lane], places.panel(lane)) {
                        let powers = Powers::of(&places, lane, weight);
                        for (sum, line) in sums.iter_mut().zip(lines) {
                            powers.add(simd, line, sum);
                        }
                    } else {
                        debug_assert!(false, "a knot, class or panel that is not there");
                    }
                }
            }
        }
        std::array::from_fn(|kernel| {
            let four: [f64; 4] = std::array::from_fn(|k| even[kernel][k] + odd[kernel][k]);
            (four[0] + four[2]) + (four[1] + four[3])
        })
    }

    /// Slices of B&I's own kernel, evaluated directly.
    #[inline(always)]
    fn unfiltered_slices<S: Simd>(&self, simd: S, pose: &Pose) -> [f64; 3] {
        let (rotation, center) = self.placed(pose);
        let cone = self.kernel.cone();
        let offsets = self.kernel.options().slice_offsets();
        let mut totals = [0.0; 3];
        let mut near = Near::new();
        for knot in &self.ligand {
            let x = (rotation * knot.position + center).into();
            let radius_sums = self.tables.sums(knot.class);
            let mut sums = [0.0; 3];
            self.receptor.near(
                simd,
                &x,
                self.unfiltered_reach,
                &mut near,
                #[inline(always)]
                |near| {
                    for (square, number) in near.pairs() {
                        let Some(other) = self.knots.get(number as usize) else {
                            debug_assert!(false, "a knot that is not there is near");
                            continue;
                        };
                        let Some(radius_sum) = radius_sums.get(other.class as usize) else {
                            debug_assert!(false, "every class has its radius sum");
                            continue;
                        };
                        let widest = radius_sum + offsets[2];
                        if square >= widest * widest {
                            continue;
                        }
                        let distance = square.sqrt();
                        for (sum, offset) in sums.iter_mut().zip(offsets) {
                            let sigma = radius_sum + offset;
                            if distance < sigma {
                                *sum += other.weight * cone.value(distance, sigma);
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

/// The score of a pose and nothing else.
struct Alone<'a> {
    scorer: &'a ExactScorer,
    pose: &'a Pose,
}

impl WithSimd for Alone<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let tables = &self.scorer.tables;
        let ([score], terms) = self.scorer.sums(
            simd,
            self.pose,
            #[inline(always)]
            |index| tables.scores().get(index).map(std::array::from_ref),
        );
        score + terms.iter().sum::<f64>()
    }
}

/// The score of a pose, its terms and slices and the unfiltered sum.
struct InParts<'a> {
    scorer: &'a ExactScorer,
    pose: &'a Pose,
}

impl WithSimd for InParts<'_> {
    type Output = ExactScore;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> ExactScore {
        let Self { scorer, pose } = self;
        let (slices, mut terms) = scorer.sums(
            simd,
            pose,
            #[inline(always)]
            |index| scorer.tables.slices().get(index),
        );
        let weights = scorer.kernel.options().slice_weights();
        let weighted = |slices: [f64; 3]| (0..3).map(|i| weights[i] * slices[i]).sum();
        // From the slices, not the score's own table: what the table shows then adds up to the last digit.
        terms[Effect::Shape as usize] = weighted(slices);
        ExactScore {
            score: terms.iter().sum(),
            terms,
            slices,
            unfiltered: weighted(scorer.unfiltered_slices(simd, pose)),
        }
    }
}

/// Powers of the argument of a pair.
struct Powers {
    /// 1, u, u^2, u^3, times the pair's weight.
    low: [f64; 4],
    /// u^4.
    fourth: f64,
}

impl Powers {
    #[inline(always)]
    fn of(places: &Places, lane: usize, weight: f64) -> Self {
        Self {
            low: places.low(lane).map(|power| weight * power),
            fourth: places.fourth(lane),
        }
    }

    /// Adds a kernel.
    #[inline(always)]
    fn add<S: Simd>(&self, simd: S, Line(line): &Line, sum: &mut [f64; 4]) {
        let (low, high) = line.split_at(4);
        let (low, high) = (vectors::<S>(low), vectors::<S>(high));
        let powers = vectors::<S>(&self.low);
        let fourth = simd.splat_f64s(self.fourth);
        for (index, sum) in vectors_mut::<S>(sum).iter_mut().enumerate() {
            let value = simd.mul_add_e_f64s(fourth, high[index], low[index]);
            *sum = simd.mul_add_e_f64s(powers[index], value, *sum);
        }
    }
}
