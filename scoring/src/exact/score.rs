//! The score of a pose: by term, for ranking and the table, or with its slices and the unfiltered sum, for diagnosis.
//!
//! A polynomial sum_k c_k u^k of degree 7 is (c_0..c_3 + u^4 c_4..c_7) . (1, u, u^2, u^3): two vectors of four from one
//! cache line, and the last product need not be summed across before all pairs are.
//!
//! Closures are inlined by order: what the compiler leaves outside the dispatched function is compiled without its
//! vector features. Vectors are spelt out where it found none: that took the score with its slices from 0.71
//! to 0.39 of the plain loop's time (`cargo bench --bench exact`, AMD EPYC, AVX2).

use super::tables::{Line, PairTerm, Places};
use super::{ExactScore, ExactScorer, ScoreTerms, ShapeParts};
use crate::blocks::{LANES, NearPoints, vectors, vectors_mut};
use crate::se3::Pose;
use crate::terms::effect::Effect;
use crate::vectorized::with_simd;
use pulp::Simd;

impl ExactScorer {
    /// The score of one pose and nothing else: the sum of [`Self::terms`].
    pub fn score_only(&self, pose: &Pose) -> f64 {
        self.terms(pose).score
    }

    /// Score of one pose by term.
    pub fn terms(&self, pose: &Pose) -> ScoreTerms {
        let scorer = self;
        with_simd!(<'a>(scorer: &'a ExactScorer, pose: &'a Pose) -> ScoreTerms, |simd| {
            let ([shape], mut terms) = scorer.sums(
                simd,
                pose,
                &scorer.effects,
                #[inline(always)]
                |index| scorer.tables.scores.get(index).map(std::array::from_ref),
            );
            terms[Effect::Shape as usize] = shape;
            ScoreTerms {
                score: terms.iter().sum(),
                terms,
            }
        })
    }

    /// The parts of shape's term at one pose: its slices, and the unfiltered score.
    pub fn shape(&self, pose: &Pose) -> ShapeParts {
        let scorer = self;
        with_simd!(<'a>(scorer: &'a ExactScorer, pose: &'a Pose) -> ShapeParts, |simd| {
            let (slices, _) = scorer.sums(
                simd,
                pose,
                &[],
                #[inline(always)]
                |index| scorer.tables.slices.get(index),
            );
            ShapeParts {
                slices,
                unfiltered: scorer.unfiltered_with(simd, pose),
            }
        })
    }

    /// G of B&I's own kernel at one pose.
    pub fn unfiltered(&self, pose: &Pose) -> f64 {
        let scorer = self;
        with_simd!(
            <'a>(scorer: &'a ExactScorer, pose: &'a Pose) -> f64,
            |simd| scorer.unfiltered_with(simd, pose)
        )
    }

    /// Score and terms of one pose with the parts of shape. Shape's term is the weighted sum of the slices to the last
    /// digit; [`Self::terms`] sums it by another table and differs by rounding.
    pub fn score(&self, pose: &Pose) -> ExactScore {
        let (mut by_term, shape) = (self.terms(pose), self.shape(pose));
        let weights = self.kernel.options().slice_weights();
        by_term.terms[Effect::Shape as usize] = weighted(weights, shape.slices);
        by_term.score = by_term.terms.iter().sum();
        ExactScore::of(by_term, shape)
    }

    /// Sums over all pairs of the shape kernels whose lines `lines` holds, and of `effects` by effect.
    #[inline(always)]
    fn sums<'a, S: Simd, const KERNELS: usize>(
        &self,
        simd: S,
        pose: &Pose,
        effects: &[PairTerm],
        lines: impl Fn(usize) -> Option<&'a [Line; KERNELS]>,
    ) -> ([f64; KERNELS], [f64; Effect::ALL.len()]) {
        let (rotation, center) = self.placed(pose);
        let reach = self.kernel.reach();
        let mut totals = [0.0; KERNELS];
        let mut terms = [0.0; Effect::ALL.len()];
        let mut near = NearPoints::default();
        let mut active = [(&NONE, 0.0, &[][..]); MOST_TERMS];
        for (index, knot) in self.ligand.iter().enumerate() {
            let x = (rotation * knot.position + center).into();
            let starts = &self.tables.starts[knot.class];
            let mut count = 0;
            for term in effects {
                if let (Some((value, row)), Some(place)) = (term.of(index), active.get_mut(count)) {
                    *place = (term, value, row);
                    count += 1;
                }
            }
            let active = active.get(..count).unwrap_or_default();
            self.receptor.near(
                simd,
                &x,
                reach,
                &mut near,
                #[inline(always)]
                |near| {
                    let mut of_terms = [0.0; MOST_TERMS];
                    let sums = self.add_up(
                        simd,
                        near,
                        #[inline(always)]
                        |other, panel| {
                            let other = self.knots.get(other as usize)?;
                            let start = starts.get(other.class as usize)?;
                            Some((other.weight, lines((start + panel) as usize)?))
                        },
                        active,
                        &mut of_terms,
                    );
                    for (total, sum) in totals.iter_mut().zip(sums) {
                        *total += knot.weight * sum;
                    }
                    for ((term, value, _), sum) in active.iter().zip(of_terms) {
                        terms[term.effect as usize] += value * sum;
                    }
                },
            );
        }
        (totals, terms)
    }

    /// Sums over the collected knots of their weights times kernels: of shape, both of which `shape` gives by knot and
    /// panel, and of some terms.
    #[inline(always)]
    fn add_up<'a, S: Simd, const KERNELS: usize>(
        &self,
        simd: S,
        near: &NearPoints,
        shape: impl Fn(u32, u32) -> Option<(f64, &'a [Line; KERNELS])>,
        terms: &[ActiveOf],
        of_terms: &mut [f64; MOST_TERMS],
    ) -> [f64; KERNELS] {
        const { assert!(MOST_TERMS == 3, "a further effect needs a further arm") };
        match *terms {
            [] => self.add_up_with(simd, near, shape, [], of_terms),
            [a] => self.add_up_with(simd, near, shape, [a], of_terms),
            [a, b] => self.add_up_with(simd, near, shape, [a, b], of_terms),
            [a, b, c, ..] => self.add_up_with(simd, near, shape, [a, b, c], of_terms),
        }
    }

    /// As [`Self::add_up`]. A pair is placed once for shape and all terms.
    #[inline(always)]
    fn add_up_with<'a, S: Simd, const KERNELS: usize, const TERMS: usize>(
        &self,
        simd: S,
        near: &NearPoints,
        shape: impl Fn(u32, u32) -> Option<(f64, &'a [Line; KERNELS])>,
        terms: [ActiveOf; TERMS],
        of_terms: &mut [f64; MOST_TERMS],
    ) -> [f64; KERNELS] {
        // Two sums by name, not by index, stay in registers.
        let zero = [simd.splat_f64s(0.0); 4];
        let (mut even, mut odd) = ([zero; KERNELS], [zero; KERNELS]);
        let (mut even_terms, mut odd_terms) = ([zero; TERMS], [zero; TERMS]);
        for (squares, knots) in near.eights() {
            let places = self.tables.place(simd, squares);
            for lane in (0..LANES).step_by(2) {
                for (lane, sums, of_terms) in [
                    (lane, &mut even, &mut even_terms),
                    (lane + 1, &mut odd, &mut odd_terms),
                ] {
                    let (knot, panel) = (knots[lane], places.panel(lane));
                    let powers = Powers::of(simd, &places, lane);
                    if let Some((weight, lines)) = shape(knot, panel) {
                        for (sum, line) in sums.iter_mut().zip(lines) {
                            powers.add(simd, weight, line, sum);
                        }
                    } else {
                        debug_assert!(false, "a knot, class or panel that is not there");
                    }
                    for (sum, (term, _, row)) in of_terms.iter_mut().zip(&terms) {
                        powers.add(simd, term.weight(knot, row), term.line(panel), sum);
                    }
                }
            }
        }
        let both = |even: [S::f64s; 4], odd: [S::f64s; 4]| {
            let mut four = [0.0; 4];
            for (total, (even, odd)) in
                (vectors_mut::<S>(&mut four).iter_mut()).zip(even.into_iter().zip(odd))
            {
                *total = simd.add_f64s(even, odd);
            }
            (four[0] + four[2]) + (four[1] + four[3])
        };
        for (sum, (even, odd)) in of_terms
            .iter_mut()
            .zip(even_terms.into_iter().zip(odd_terms))
        {
            *sum = both(even, odd);
        }
        std::array::from_fn(|kernel| both(even[kernel], odd[kernel]))
    }

    /// G of B&I's own kernel, evaluated directly.
    #[inline(always)]
    fn unfiltered_with<S: Simd>(&self, simd: S, pose: &Pose) -> f64 {
        let (rotation, center) = self.placed(pose);
        let cone = self.kernel.cone();
        let offsets = self.kernel.options().slice_offsets();
        let mut totals = [0.0; 3];
        let mut near = NearPoints::default();
        for knot in &self.ligand {
            let x = (rotation * knot.position + center).into();
            let radius_sums = &self.tables.sums[knot.class];
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
        weighted(self.kernel.options().slice_weights(), totals)
    }
}

/// A term in which a ligand knot takes part, with the knot's value and matrix row.
type ActiveOf<'a> = (&'a PairTerm, f64, &'a [f64]);

/// Terms beside shape.
const MOST_TERMS: usize = Effect::ALL.len() - 1;
/// A term without knots.
static NONE: PairTerm = PairTerm::NONE;

/// Slices as one sum.
fn weighted(weights: [f64; 3], slices: [f64; 3]) -> f64 {
    (0..3).map(|i| weights[i] * slices[i]).sum()
}

/// Powers of the argument of a pair, as vectors of which the first ones make four numbers.
struct Powers<S: Simd> {
    /// 1, u, u^2, u^3.
    low: [S::f64s; 4],
    /// u^4.
    fourth: S::f64s,
}

impl<S: Simd> Powers<S> {
    /// Vectors that make four numbers.
    const VECTORS: usize = 4 / S::F64_LANES;

    /// The powers come from numbers that are spread over a vector: single numbers that are stored side by side and
    /// loaded as a vector stall, until all of them have left the store buffer.
    #[inline(always)]
    fn of(simd: S, places: &Places, lane: usize) -> Self {
        let (first, square) = (places.first(lane), places.square(lane));
        let (first, square) = (simd.splat_f64s(first), simd.splat_f64s(square));
        let mut low = [first; 4];
        for (index, low) in low.iter_mut().enumerate().take(Self::VECTORS) {
            let pick = |of: &'static [f64; 4]| vectors::<S>(of)[index];
            // 1, u, 1, u and 1, 1, u^2, u^2.
            let by_first = simd.mul_add_e_f64s(
                first,
                pick(&[0.0, 1.0, 0.0, 1.0]),
                pick(&[1.0, 0.0, 1.0, 0.0]),
            );
            let by_square = simd.mul_add_e_f64s(
                square,
                pick(&[0.0, 0.0, 1.0, 1.0]),
                pick(&[1.0, 1.0, 0.0, 0.0]),
            );
            *low = simd.mul_f64s(by_first, by_square);
        }
        Self {
            low,
            fourth: simd.splat_f64s(places.fourth(lane)),
        }
    }

    /// Adds a kernel times the weight of the pair.
    #[inline(always)]
    fn add(&self, simd: S, weight: f64, Line(line): &Line, sum: &mut [S::f64s; 4]) {
        let weight = simd.splat_f64s(weight);
        let (low, high) = line.split_at(4);
        let (low, high) = (vectors::<S>(low), vectors::<S>(high));
        for index in 0..Self::VECTORS {
            let value = simd.mul_add_e_f64s(self.fourth, high[index], low[index]);
            let low = simd.mul_f64s(self.low[index], weight);
            sum[index] = simd.mul_add_e_f64s(low, value, sum[index]);
        }
    }
}
