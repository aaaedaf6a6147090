//! Whether an exact fit stands out from the background of the run.
//!
//! Every place that a run tries has an optimum, and the energies of wrong places are alike: they are its background.
//! The margin of the best place is its distance below the middle of the others, in standard deviations. These follow
//! from the better half of the others: remaining overlaps spread the worse half. The best sixteenth is left out,
//! because it holds copies of the best place in a symmetric partner. Both are means of many places, so that no single
//! place moves the margin by much (docs/research/defaults.md, "Sharp fits").

use serde::Serialize;

/// Fewest other places that form a background.
const MIN_OTHERS: usize = 16;
/// Margin from which a fit is exact and scores after [`MANY`] rotations or more, standard deviations.
const MARGIN: f64 = 3.6;
/// Addition to it for fewer rotations, for each power of ten: wrong fits have larger margins there
/// (docs/research/defaults.md).
const MARGIN_OF_FEW: f64 = 0.65;
const MANY: usize = 3600;
/// Margin from which fits score on request, whether or not one stands out.
pub(super) const REQUESTED: f64 = 2.0;
/// Mean of a normal distribution between its first and sixth sixteenth, standard deviations below its middle.
const NORMAL: f64 = 0.8199;
/// Least standard deviation of a background, RT: equal poses have none.
const MIN_DEVIATION: f64 = 1.0;
/// Score of an RT below the energy at which fits begin to score. Exact fits are up to 40 RT below it, and the soft scores
/// of a run's best 250 poses span about 1,400.
pub(super) const SCORE_PER_RT: f64 = 400.0;

/// Finding of the sharp stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SharpFinding {
    /// An exact fit stands out: ranked by it.
    ExactFit,
    /// Ranked by sharp fits because that was requested, though none stands out.
    Requested,
    /// No exact fit; ranked by the soft score.
    NoExactFit,
}

/// The best place of a run against the others.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Evidence {
    /// Energy of the best place, RT.
    pub best: f64,
    /// Energy in the middle of the other places, RT.
    pub middle: f64,
    /// Their standard deviation, RT.
    pub deviation: f64,
    /// Margin from which a fit of this run is exact, standard deviations.
    pub needed: f64,
}

impl Evidence {
    /// Evidence by the energies of different places, best first, of a search of this many rotations; `None` if there are
    /// too few places.
    pub fn of(energies: &[f64], rotations: usize) -> Option<Self> {
        let (best, others) = energies.split_first()?;
        if others.len() < MIN_OTHERS {
            return None;
        }
        let middle = mean_between(others, [4, 12]);
        let deviation = (middle - mean_between(others, [1, 6])) / NORMAL;
        Some(Self {
            best: *best,
            middle,
            deviation: deviation.max(MIN_DEVIATION),
            needed: MARGIN + MARGIN_OF_FEW * (MANY as f64 / rotations as f64).log10().max(0.0),
        })
    }

    /// Standard deviations of the best place below the background.
    pub fn margin(&self) -> f64 {
        (self.middle - self.best) / self.deviation
    }

    /// Whether an exact fit stands out.
    pub fn stands_out(&self) -> bool {
        self.margin() > self.needed
    }

    /// Energy of a place with a margin, RT.
    pub fn at_margin(&self, margin: f64) -> f64 {
        self.middle - margin * self.deviation
    }
}

/// Mean of sorted values between two sixteenths of them.
fn mean_between(sorted: &[f64], sixteenths: [usize; 2]) -> f64 {
    let [from, to] = sixteenths.map(|sixteenth| sixteenth * sorted.len() / 16);
    let between = sorted.get(from..to).unwrap_or_default();
    between.iter().sum::<f64>() / between.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A normal background of two hundred places, by its quantiles: mean -50, standard deviation 4.
    fn background() -> impl Iterator<Item = f64> {
        (0..200).map(|step| -50.0 + 4.0 * normal_quantile((f64::from(step) + 0.5) / 200.0))
    }

    /// Quantile of the normal distribution, by bisection of a sum over its density.
    fn normal_quantile(share: f64) -> f64 {
        let density = |x: f64| (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
        let below = |x: f64| {
            let step = x / 200.0;
            let sum: f64 = (0..200).map(|k| density((f64::from(k) + 0.5) * step)).sum();
            0.5 + sum * step
        };
        let (mut low, mut high) = (-6.0, 6.0);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if below(middle) < share {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    fn with(best: &[f64], others: impl Iterator<Item = f64>) -> Evidence {
        let energies: Vec<f64> = best.iter().copied().chain(others).collect();
        Evidence::of(&energies, MANY).unwrap()
    }

    #[test]
    fn margins_are_in_standard_deviations_of_the_other_places() {
        let evidence = with(&[-74.0], background());
        assert!((evidence.middle + 50.0).abs() < 0.01, "{evidence:?}");
        assert!(
            (evidence.deviation / 4.0 - 1.0).abs() < 0.01,
            "{evidence:?}"
        );
        assert!((evidence.margin() - 6.0).abs() < 0.06);
        assert!((evidence.at_margin(evidence.margin()) + 74.0).abs() < 1e-9);
        assert!(evidence.stands_out() && !with(&[-64.0], background()).stands_out());
        let of = |rotations| Evidence::of(&[-50.0; 40], rotations).unwrap().needed;
        assert_eq!([of(3600), of(100_000)], [MARGIN; 2]);
        assert!((of(360) - MARGIN - MARGIN_OF_FEW).abs() < 1e-12);
    }

    /// Copies of one place have no spread, and few places no background.
    #[test]
    fn few_or_equal_places_prove_nothing() {
        assert_eq!(Evidence::of(&[-50.0; MIN_OTHERS], MANY), None);
        assert_eq!(Evidence::of(&[], MANY), None);
        assert!(!with(&[-51.0], [-50.0; MIN_OTHERS].into_iter()).stands_out());
        assert!(with(&[-50.0], [-50.0; 39].into_iter()).margin().is_finite());
    }

    /// Neither how bad the worst places are nor copies of the best one say much, and a place more or less hardly
    /// moves the margin.
    #[test]
    fn no_single_place_counts_for_much() {
        let one = with(&[-74.0], background()).margin();
        let worst = background().enumerate().map(|(place, energy)| match place {
            150.. => energy + 1e6,
            _ => energy,
        });
        assert_eq!(with(&[-74.0], worst).margin(), one);
        let copies = with(&[-74.0, -73.9, -73.8], background()).margin();
        assert!((copies / one - 1.0).abs() < 0.03, "{copies} {one}");
        let fewer = with(&[-74.0], background().skip(1)).margin();
        assert!((fewer / one - 1.0).abs() < 0.02, "{fewer} {one}");
    }
}
