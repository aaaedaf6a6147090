//! Logarithmic axes: their range, their ticks, and the text of these.

/// Share of an axis that a dot takes to either side, and a little more.
const DOT: f64 = 0.03;

/// A logarithmic axis: from and to, in powers of ten.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    low: f64,
    high: f64,
}

impl Scale {
    /// An axis that holds all values with some room, at least from one to five; up to `most` where values have a most,
    /// with room for the dot of one that is it.
    pub fn over(values: impl Iterator<Item = f64>, most: Option<f64>) -> Self {
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
        let (low, mut highest) = (low - room, high + room);
        if let Some(most) = most.map(f64::log10) {
            let dot = DOT * (most - low);
            let end = if high > most - dot {
                high.max(most) + dot
            } else {
                most
            };
            highest = highest.min(end);
        }
        Self { low, high: highest }
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

    /// Powers of two within the axis, as exponents: every one, or every second or third if they would be too
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

    /// The axis of a share once ran on to 170%.
    #[test]
    fn an_axis_ends_at_the_most_that_there_can_be() {
        let of = |values: [f64; 2]| Scale::over(values.into_iter(), Some(100.0));
        assert_eq!(of([60.0, 90.0]).high, 2.0);
        assert!(of([1.0, 3.0]).high < 1.0);
        // A dot at the end has room, and half its width at the most.
        let full = of([60.0, 100.0]);
        assert!(full.high > 2.0 && full.high < 2.0 + 0.05 * (full.high - full.low));
        let past = of([60.0, 120.0]);
        assert!(past.high > 120f64.log10());
    }

    #[test]
    fn ticks_lie_within_the_axis_and_read_as_people_write() {
        let narrow = Scale::over([3.0, 40.0].into_iter(), None);
        assert_eq!(narrow.ticks(), [5.0, 10.0, 20.0]);
        let wide = Scale::over([1e-6, 1e-1].into_iter(), None);
        assert!(wide.ticks().len() >= 5);
        for scale in [
            narrow,
            wide,
            Scale::over([7.0].into_iter(), None),
            Scale::over(std::iter::empty(), None),
        ] {
            assert!(scale.low < scale.high && !scale.ticks().is_empty());
        }
        let powers = Scale::over([64.0, 2097152.0].into_iter(), None).powers_of_two();
        assert!(powers.contains(&6) && powers.contains(&21) && powers.len() <= 9);
        let texts = [0.5, 10.0, 1e-6, 0.05].map(tick_text);
        assert_eq!(texts, ["0.5", "10", "1e-6", "0.05"]);
    }
}
