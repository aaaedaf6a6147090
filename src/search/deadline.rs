//! The time by which a run must end.

use std::time::Instant;

/// A time by which a run must end, and what remains to be done after its search.
pub struct Deadline {
    end: Instant,
    /// Seconds on the clock for a rotation, as expected.
    rotation: f64,
    /// Seconds on the clock for what follows a search of so many rotations, likewise.
    rest: Box<dyn Fn(usize) -> f64 + Send + Sync>,
}

impl std::fmt::Debug for Deadline {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { end, rotation, .. } = self;
        write!(f, "Deadline {{ end: {end:?}, rotation: {rotation} }}")
    }
}

impl Deadline {
    /// A run that ends at `end`. `rotation` is the seconds on the clock that a rotation of the search is expected to
    /// take, all threads working, and `rest` what follows a search of so many rotations.
    pub fn new(
        end: Instant,
        rotation: f64,
        rest: impl Fn(usize) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self {
            end,
            rotation,
            rest: Box::new(rest),
        }
    }

    /// Seconds until then.
    pub(crate) fn left(&self) -> f64 {
        self.end
            .saturating_duration_since(Instant::now())
            .as_secs_f64()
    }

    /// Whether a search that began at `started` and has done so many rotations must stop.
    pub(crate) fn is_reached(&self, started: Instant, done: usize) -> bool {
        self.must_stop(started.elapsed().as_secs_f64(), self.left(), done)
    }

    /// Whether the seconds left are no more than the rest of the run takes at the pace of the search. Other programs
    /// slow the rest as they slowed the search.
    fn must_stop(&self, searching: f64, left: f64, done: usize) -> bool {
        let pace = match done {
            0 => 1.0,
            done => searching / (self.rotation * done as f64),
        };
        left <= pace * (self.rest)(done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times are what the search took, not what it was expected to.
    #[test]
    fn a_slow_machine_stops_earlier() {
        let deadline = Deadline::new(Instant::now(), 0.01, |rotations| {
            0.5 + 0.001 * rotations as f64
        });
        // As expected: 100 rotations in a second, 0.6 s to go.
        assert!(!deadline.must_stop(1.0, 0.61, 100));
        assert!(deadline.must_stop(1.0, 0.59, 100));
        // Four times as slow.
        assert!(deadline.must_stop(4.0, 2.39, 100));
        assert!(!deadline.must_stop(4.0, 2.41, 100));
        assert!(deadline.must_stop(0.0, 0.0, 0));
        assert!(deadline.is_reached(Instant::now(), 0));
    }
}
