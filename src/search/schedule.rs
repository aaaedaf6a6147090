//! Which rotations are searched, in which order, and until when.
//!
//! A search within a time stops between two rotations. What it has searched by then is the first part of an order in which
//! every first part covers all orientations about evenly, and how many those were is recorded: searched again, the same
//! rotations give the same bytes.

use crate::dock::plan::DockPlan;
use crate::search::scan::{Quartet, all_rotations};
use std::time::Instant;

/// A time at which a run is to be at its end, and what its search leaves to do until then.
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
    /// A run that ends at `end`. `rotation` is the seconds on the clock that a rotation of the search is expected to take,
    /// all threads working, and `rest` what follows a search of so many rotations.
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

    /// Whether a search that began at `begun` and has done so many rotations must stop.
    pub(crate) fn is_reached(&self, begun: Instant, done: usize) -> bool {
        self.must_stop(begun.elapsed().as_secs_f64(), self.left(), done)
    }

    /// Whether the seconds left are no more than the rest of the run takes at the pace of the search. Other programs slow
    /// the rest as they slowed the search.
    fn must_stop(&self, searching: f64, left: f64, done: usize) -> bool {
        let pace = match done {
            0 => 1.0,
            done => searching / (self.rotation * done as f64),
        };
        left <= pace * (self.rest)(done)
    }
}

/// The quartets to search: all in the order of the set, or evenly spread where a search may stop, or has stopped, before
/// the last.
pub(crate) fn schedule(plan: &DockPlan, deadline: Option<&Deadline>) -> Vec<Quartet> {
    let all = all_rotations(plan);
    let limit = plan.options.stopped.map(|stopped| stopped.rotations);
    if deadline.is_none() && limit.is_none() {
        return all;
    }
    let mut spread: Vec<Quartet> = evenly_spread(all.len()).map(|index| all[index]).collect();
    if let Some(limit) = limit {
        let mut searched = 0;
        spread.retain(|quartet| {
            let wanted = searched < limit;
            searched += quartet.count();
            wanted
        });
    }
    spread
}

/// Indices below `count` in steps of a golden section of it, so that a first part of them leaves no large gap. Sets of
/// rotations are spirals, whose indices run through all orientations.
fn evenly_spread(count: usize) -> impl Iterator<Item = usize> {
    let golden = (count as f64 * 0.618_033_988_749_894_9).round() as usize;
    let coprime = |step: &usize| greatest_common_divisor(*step, count) == 1;
    let step = (golden.max(1)..).find(coprime).unwrap_or(1);
    (0..count).map(move |place| place * step % count)
}

fn greatest_common_divisor(a: usize, b: usize) -> usize {
    if b == 0 {
        a
    } else {
        greatest_common_divisor(b, a % b)
    }
}

#[cfg(test)]
mod tests {
    use crate::search::rotations::{covering_radius, rotation_set};
    use crate::search::schedule::*;
    use knotdock_scoring::se3::HalfTurn;

    #[test]
    fn the_order_has_every_index_once() {
        for count in [0, 1, 2, 3, 4, 5, 900, 901, 14_063] {
            let mut indices: Vec<usize> = evenly_spread(count).collect();
            indices.sort_unstable();
            assert!(indices.iter().copied().eq(0..count), "{count}");
        }
    }

    /// A first part covers as a set of that size does, or nearly; the set's own order leaves half of the orientations out.
    #[test]
    fn a_first_part_covers_all_orientations() {
        let set = rotation_set(3600);
        let of_quartets = |quartets: Vec<usize>| -> Vec<_> {
            let four = |index: usize| (4 * index..4 * index + 4).map(|index| set[index]);
            quartets.into_iter().flat_map(four).collect()
        };
        assert_eq!(HalfTurn::ALL.len(), 4);
        for part in [90, 225, 450, 700] {
            let own = covering_radius(&rotation_set(4 * part));
            let first = covering_radius(&of_quartets(evenly_spread(900).take(part).collect()));
            assert!(first < 1.6 * own, "{part}: {first} {own}");
            let in_order = covering_radius(&of_quartets((0..part).collect()));
            assert!(first < in_order, "{part}: {first} {in_order}");
        }
    }

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
