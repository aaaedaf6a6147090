//! Logarithmic axes: their range, where numbers stand, and how these read.

/// A logarithmic axis: from and to, in powers of ten.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    low: f64,
    high: f64,
}

impl Scale {
    /// An axis that holds all values with some room, at least from one to five.
    pub fn over(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values
            .map(f64::log10)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            });
        if low > high {
            return Self {
                low: 0.0,
                high: 1.0,
            };
        }
        let room = (0.08 * (high - low)).max(0.5 * (0.7 - (high - low)).max(0.1));
        Self {
            low: low - room,
            high: high + room,
        }
    }

    /// From and to, as powers of ten.
    pub fn range(self) -> std::ops::Range<f64> {
        self.low..self.high
    }

    /// Where numbers stand: at powers of ten, with twos and fives between where few of these are in view.
    pub fn ticks(self) -> Vec<f64> {
        let digits: &[f64] = if self.high - self.low > 2.5 {
            &[1.0]
        } else {
            &[1.0, 2.0, 5.0]
        };
        let powers = self.low.floor() as i32..=self.high.ceil() as i32;
        powers
            .flat_map(|power| digits.iter().map(move |digit| digit * 10f64.powi(power)))
            .filter(|tick| (self.low..=self.high).contains(&tick.log10()))
            .collect()
    }

    /// Powers of two within the axis, as exponents: every one, or every second or third where they would stand too
    /// close.
    pub fn powers_of_two(self) -> Vec<i32> {
        let doubling = 2f64.log10();
        let step = (((self.high - self.low) / doubling / 8.0).ceil() as i32).max(1);
        let first = (self.low / doubling).ceil() as i32;
        let last = (self.high / doubling).floor() as i32;
        (first..=last).filter(|power| power % step == 0).collect()
    }
}

/// A tick's number, at most five characters.
pub(super) fn tick_text(value: f64) -> String {
    if (0.01..1e5).contains(&value) {
        // Powers of ten come with their rounding.
        let text = format!("{value:.2}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{value:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_lie_within_the_axis_and_read_as_people_write() {
        let narrow = Scale::over([3.0, 40.0].into_iter());
        assert_eq!(narrow.ticks(), [5.0, 10.0, 20.0]);
        let wide = Scale::over([1e-6, 1e-1].into_iter());
        assert!(wide.ticks().len() >= 5);
        for scale in [
            narrow,
            wide,
            Scale::over([7.0].into_iter()),
            Scale::over(std::iter::empty()),
        ] {
            assert!(scale.low < scale.high && !scale.ticks().is_empty());
        }
        let powers = Scale::over([64.0, 2097152.0].into_iter()).powers_of_two();
        assert!(powers.contains(&6) && powers.contains(&21) && powers.len() <= 9);
        let texts = [0.5, 10.0, 1e-6, 0.05].map(tick_text);
        assert_eq!(texts, ["0.5", "10", "1e-6", "0.05"]);
    }
}
