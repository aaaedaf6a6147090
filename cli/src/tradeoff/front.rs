//! The Pareto front: what nothing else beats on both counts.

/// Whether each of some (cost, loss) pairs is on the front: no other pair is at most as large in both and smaller in
/// one. Pairs without a loss, or with a number that is not finite, are never on it and beat nothing.
pub fn front(pairs: &[(f64, Option<f64>)]) -> Vec<bool> {
    let finite = |&(cost, loss): &(f64, Option<f64>)| {
        let loss = loss.filter(|loss| loss.is_finite())?;
        cost.is_finite().then_some((cost, loss))
    };
    let known: Vec<(f64, f64)> = pairs.iter().filter_map(finite).collect();
    pairs
        .iter()
        .map(|pair| {
            finite(pair).is_some_and(|(cost, loss)| {
                !known.iter().any(|&(other_cost, other_loss)| {
                    other_cost <= cost
                        && other_loss <= loss
                        && (other_cost < cost || other_loss < loss)
                })
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_beaten_is_off_and_what_is_unknown_too() {
        let pairs = [
            (1.0, Some(9.0)),
            (2.0, Some(9.0)),
            (2.0, Some(3.0)),
            (3.0, Some(1.0)),
            (0.5, None),
            (0.5, Some(f64::NAN)),
        ];
        assert_eq!(front(&pairs), [true, false, true, true, false, false]);
        // Equals do not beat each other.
        assert_eq!(front(&[(1.0, Some(1.0)); 2]), [true, true]);
    }

    proptest! {
        /// Nothing beats a pair on the front, and every pair off it is beaten by one on it.
        #[test]
        fn the_front_is_what_nothing_beats(pairs in prop::collection::vec((0..9, 0..9), 1..20)) {
            let pairs: Vec<(f64, Option<f64>)> =
                pairs.into_iter().map(|(cost, loss)| (f64::from(cost), Some(f64::from(loss)))).collect();
            let on = front(&pairs);
            let beats = |a: &(f64, Option<f64>), b: &(f64, Option<f64>)| a.0 <= b.0 && a.1 <= b.1 && a != b;
            for (pair, on_front) in pairs.iter().zip(&on) {
                let beaten = pairs.iter().any(|other| beats(other, pair));
                prop_assert_eq!(*on_front, !beaten);
                let by_front = pairs.iter().zip(&on).any(|(other, on)| *on && beats(other, pair));
                prop_assert_eq!(beaten, by_front);
            }
        }
    }
}
