//! Smooth steps: the low-pass W(|w|) of the ranking kernel and every other taper from 1 to 0.

/// C-infinity step from 1 (x <= start) down to 0 (x >= stop); `start` < `stop`.
///
/// f(1 - u) / (f(1 - u) + f(u)) with f(t) = exp(-1 / t) and u the way from start to stop: all derivatives vanish at
/// both ends.
pub fn smooth_step_down(x: f64, start: f64, stop: f64) -> f64 {
    let u = (x - start) / (stop - start);
    if u <= 0.0 {
        1.0
    } else if u >= 1.0 {
        0.0
    } else {
        // f(u) / f(1 - u) = exp(1 / (1 - u) - 1 / u); written with one exponential so that neither underflows first.
        1.0 / (1.0 + (1.0 / (1.0 - u) - 1.0 / u).exp())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falls_from_one_to_zero_and_is_symmetric() {
        assert_eq!(smooth_step_down(0.1, 0.1, 0.3), 1.0);
        assert_eq!(smooth_step_down(0.3, 0.1, 0.3), 0.0);
        assert!((smooth_step_down(0.2, 0.1, 0.3) - 0.5).abs() < 1e-15);
        let mut last = 1.0;
        for i in 0..=100 {
            let x = 0.1 + 0.002 * f64::from(i);
            let value = smooth_step_down(x, 0.1, 0.3);
            assert!(value <= last);
            assert!((value + smooth_step_down(0.4 - x, 0.1, 0.3) - 1.0).abs() < 1e-12);
            last = value;
        }
    }
}
