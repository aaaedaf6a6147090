//! Whether an exact fit stands out from the background of its own run.
//!
//! Every place that a run tries has an optimum, and the energies of wrong places are alike: they are its background.
//! The margin of the best place is how far it lies below the median of the next thirty ones, in their standard
//! deviations. These follow from the median of absolute deviations, which copies of the best place in a symmetric
//! partner do not move. Bound and unbound training pairs are its two classes (docs/research/defaults.md, "Sharp fits").

use serde::Serialize;

/// Places after the best one that make the background.
const BACKGROUND: usize = 30;
/// Fewest of them that say anything.
const FEWEST: usize = 5;
/// Margin from which a fit is exact, standard deviations.
pub const MARGIN: f64 = 6.0;
/// Margin from which fits score at all, as a share of that: neighbours of an exact fit come near it.
const SCORING_SHARE: f64 = 0.5;
/// Standard deviations in a median of absolute deviations, where these are normally distributed.
const NORMAL: f64 = 1.4826;
/// Least standard deviation of a background, RT: poses of a kind have none.
const LEAST_DEVIATION: f64 = 1.0;
/// Score of an RT below the energy at which fits begin to score: exact fits lie 10 to 60 RT below it, and the soft
/// scores of a run's best 250 poses span about 1,400.
const SCORE_PER_RT: f64 = 200.0;

/// What the sharp stage saw.
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
    /// Median energy of the places that make the background, RT.
    pub median: f64,
    /// Their standard deviation, RT.
    pub deviation: f64,
}

impl Evidence {
    /// Evidence by the energies of different places, best first; `None` where there are too few places.
    pub fn of(energies: &[f64]) -> Option<Self> {
        let (best, others) = energies.split_first()?;
        let others = others.get(..BACKGROUND.min(others.len()))?;
        if others.len() < FEWEST {
            return None;
        }
        let middle = median(others.to_vec());
        let off = others.iter().map(|energy| (energy - middle).abs());
        Some(Self {
            best: *best,
            median: middle,
            deviation: (NORMAL * median(off.collect())).max(LEAST_DEVIATION),
        })
    }

    /// Standard deviations that the best place lies below the background.
    pub fn margin(&self) -> f64 {
        (self.median - self.best) / self.deviation
    }

    /// Whether an exact fit stands out.
    pub fn stands_out(&self) -> bool {
        self.margin() > MARGIN
    }

    /// Score of a fit by how far it lies below the energy at which fits begin to score; 0 above it.
    pub fn score(&self, energy: f64) -> f64 {
        let begins = self.median - SCORING_SHARE * MARGIN * self.deviation;
        SCORE_PER_RT * (begins - energy).max(0.0)
    }
}

/// Median; the mean of the two in the middle of an even number.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.get(middle.saturating_sub(1)..=middle) {
        Some([low, high]) if values.len().is_multiple_of(2) => 0.5 * (low + high),
        _ => values.get(middle).copied().unwrap_or(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn margins_are_in_deviations_of_the_other_places() {
        // Others -60 to -50: median -55, absolute deviations 0 to 5, of which the median is 3.
        let others: Vec<f64> = (0..11).map(|step| -60.0 + f64::from(step)).collect();
        let with = |best: f64| Evidence::of(&[&[best], &others[..]].concat()).unwrap();
        let evidence = with(-85.0);
        assert!((evidence.margin() - 30.0 / (3.0 * NORMAL)).abs() < 1e-12);
        assert!(evidence.stands_out() && !with(-75.0).stands_out());
        let begins = -55.0 - SCORING_SHARE * MARGIN * 3.0 * NORMAL;
        assert!((evidence.score(-85.0) - SCORE_PER_RT * (begins + 85.0)).abs() < 1e-9);
        assert_eq!(evidence.score(-55.0), 0.0);
    }

    /// Copies of one place have no spread, and few places no background.
    #[test]
    fn few_or_equal_places_prove_nothing() {
        assert_eq!(Evidence::of(&[-90.0, -50.0, -50.0]), None);
        assert_eq!(Evidence::of(&[]), None);
        assert!(!Evidence::of(&[-51.0; 8]).unwrap().stands_out());
        assert!(Evidence::of(&[-50.0; 8]).unwrap().margin().is_finite());
    }

    /// Of the tail only the best thirty count, and some copies of the best place hardly do.
    #[test]
    fn neither_tail_nor_copies_count() {
        let mut energies = vec![-80.0];
        energies.extend((0..30).map(|step| -50.0 + 0.1 * f64::from(step)));
        let short = Evidence::of(&energies).unwrap();
        energies.extend([0.0, 1e6]);
        assert_eq!(Evidence::of(&energies), Some(short));
        energies.splice(1..1, [-79.9, -79.8]);
        let with_copies = Evidence::of(&energies).unwrap();
        assert!((with_copies.margin() / short.margin() - 1.0).abs() < 0.1);
    }

    #[test]
    fn medians_of_odd_and_even_numbers() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), 2.5);
        assert_eq!(median(vec![7.0]), 7.0);
    }
}
