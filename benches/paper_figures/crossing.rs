//! Crossing of a rising curve and a level.

/// The argument at which a curve given by rising (argument, value) pairs first rises above `level`, between two of
/// its points on logarithmic axes. `None` if it is above from the start or never is.
pub fn crossing(curve: &[[f64; 2]], level: f64) -> Option<f64> {
    curve.windows(2).find_map(|pair| {
        let [[x0, y0], [x1, y1]] = [pair[0], pair[1]];
        if !(y0 <= level && level < y1) {
            return None;
        }
        let share = (level / y0).ln() / (y1 / y0).ln();
        Some(x0 * (x1 / x0).powf(share))
    })
}
