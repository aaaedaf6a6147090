//! The time by which a search must stop for the run to end in time.

use std::time::Instant;

/// Time of a finer rotation against one of the first search, whose transform of the ligand several share. As measured on
/// the example pair.
const FINE: f64 = 2.1;

/// The end of a run, and the work after its search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deadline {
    /// When the run must end.
    pub end: Instant,
    /// Seconds after the search for each pose that is kept, as measured in this run.
    pub pose: f64,
    /// Peaks kept of each rotation.
    pub per_rotation: usize,
    /// Poses kept of all.
    pub poses: usize,
    /// Finer rotations that follow.
    pub finer: f64,
}

impl Deadline {
    /// Whether a search that began at `started` and has done this number of rotations must stop.
    pub fn is_reached(&self, started: Instant, done: usize) -> bool {
        self.must_stop(started.elapsed().as_secs_f64(), left(self.end), done)
    }

    /// Whether the seconds left are no more than the rest of the run takes.
    fn must_stop(&self, searching: f64, left: f64, done: usize) -> bool {
        let poses = self.poses.min(self.per_rotation * done);
        let rotation = searching / done.max(1) as f64;
        left <= self.pose * poses as f64 + FINE * self.finer * rotation
    }
}

/// Seconds until a time.
pub(crate) fn left(end: Instant) -> f64 {
    end.saturating_duration_since(Instant::now()).as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_leaves_time_for_the_rest() {
        let deadline = Deadline {
            end: Instant::now(),
            pose: 0.001,
            per_rotation: 3,
            poses: 2000,
            finer: 100.0,
        };
        // 300 poses, and 100 finer rotations of 21 ms.
        assert!(!deadline.must_stop(1.0, 2.41, 100));
        assert!(deadline.must_stop(1.0, 2.39, 100));
        // No more poses are kept than the most.
        assert!(!deadline.must_stop(10.0, 4.11, 1000));
        assert!(deadline.must_stop(10.0, 4.09, 1000));
        assert!(deadline.must_stop(0.0, 0.0, 0));
        assert!(deadline.is_reached(Instant::now(), 0));
    }
}
