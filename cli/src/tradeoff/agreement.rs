//! Agreement of two searches: the share of one's first rows that the other one finds.

use knotdock_scoring::se3::Pose;

use knotdock::rank::cluster::RigidBody;

/// The share of `reference` poses that have one of `found` within `radius`: RMSD of the body's points, in their unit.
/// 1 where there is nothing to find.
pub fn agreement(body: &RigidBody, reference: &[Pose], found: &[Pose], radius: f64) -> f64 {
    if reference.is_empty() {
        return 1.0;
    }
    let found: Vec<_> = found.iter().map(|pose| body.place(pose)).collect();
    let hits = reference.iter().filter(|pose| {
        let placed = body.place(pose);
        found
            .iter()
            .any(|other| body.mean_square(&placed, other) <= radius * radius)
    });
    hits.count() as f64 / reference.len() as f64
}

/// Comparison of two scores over the same poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Root mean square of the difference, as a share of the second's largest magnitude.
    pub rms: f64,
    /// Pearson's correlation; `None` where either does not vary.
    pub correlation: Option<f64>,
}

/// Compares `scores` with `reference`, pose by pose.
pub fn compare(scores: &[f64], reference: &[f64]) -> Comparison {
    let count = scores.len().min(reference.len()).max(1) as f64;
    let pairs = || scores.iter().zip(reference);
    let largest = reference
        .iter()
        .fold(f64::MIN_POSITIVE, |a, b| a.max(b.abs()));
    let squares: f64 = pairs().map(|(a, b)| ((a - b) / largest).powi(2)).sum();
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / count;
    let means = [
        mean(&mut pairs().map(|(a, _)| *a)),
        mean(&mut pairs().map(|(_, b)| *b)),
    ];
    let (mut both, mut first, mut second) = (0.0, 0.0, 0.0);
    for (a, b) in pairs() {
        let (a, b) = ((a - means[0]) / largest, (b - means[1]) / largest);
        both += a * b;
        first += a * a;
        second += b * b;
    }
    let correlation = both / (first * second).sqrt();
    Comparison {
        rms: (squares / count).sqrt(),
        correlation: correlation
            .is_finite()
            .then_some(correlation.clamp(-1.0, 1.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agreement_is_the_share_that_has_a_neighbour() {
        let body = RigidBody::new(&[[0.0; 3], [1.0, 0.0, 0.0]]);
        let at = |x: f64| Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
        let reference = [at(0.0), at(10.0), at(20.0), at(30.0)];
        let found = [at(1.0), at(12.5), at(20.0)];
        assert_eq!(agreement(&body, &reference, &found, 2.0), 0.5);
        assert_eq!(agreement(&body, &reference, &found, 2.6), 0.75);
        assert_eq!(agreement(&body, &reference, &reference, 0.0), 1.0);
        assert_eq!(agreement(&body, &reference, &[], 5.0), 0.0);
        assert_eq!(agreement(&body, &[], &[], 5.0), 1.0);
    }

    #[test]
    fn a_scaled_score_correlates_fully_and_differs_all_the_same() {
        let compared = compare(&[2.0, 4.0, 8.0], &[1.0, 2.0, 4.0]);
        assert!((compared.correlation.unwrap() - 1.0).abs() < 1e-12);
        assert!((compared.rms - (21.0f64 / 3.0).sqrt() / 4.0).abs() < 1e-12);
        assert_eq!(compare(&[1.0, 1.0], &[1.0, 2.0]).correlation, None);
        assert_eq!(compare(&[3.0, 1.0], &[3.0, 1.0]).rms, 0.0);
    }
}
