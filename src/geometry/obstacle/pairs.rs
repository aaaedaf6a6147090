//! The balls of a Minkowski sum, pair by pair.

use knotdock_structures::sampling::Ball;

/// The n1 n2 balls (a + b, r + s + offset) of two sets; those without a radius above zero are left out.
///
/// B&I, eq. 41 and 44: the offset takes another slice of the lifted sum.
#[derive(Clone, Copy, Debug)]
pub struct PairSums<'a> {
    first: &'a [Ball],
    second: &'a [Ball],
    offset: f64,
}

impl<'a> PairSums<'a> {
    /// The sums of two sets.
    pub fn new(first: &'a [Ball], second: &'a [Ball], offset: f64) -> Self {
        Self {
            first,
            second,
            offset,
        }
    }

    /// Pairs, counted whatever their radius.
    pub fn pairs(&self) -> u64 {
        self.first.len() as u64 * self.second.len() as u64
    }

    /// The balls, those of the first ball of the first set before all others.
    pub fn iter(&self) -> impl Iterator<Item = Ball> + use<'a> {
        let (second, offset) = (self.second, self.offset);
        self.first.iter().flat_map(move |a| {
            second.iter().filter_map(move |b| {
                let radius = a.radius + b.radius + offset;
                (radius > 0.0).then(|| Ball {
                    center: [0, 1, 2].map(|axis| a.center[axis] + b.center[axis]),
                    radius,
                })
            })
        })
    }

    /// The two sets, the larger balls first.
    pub(super) fn sorted(&self) -> [Vec<Ball>; 2] {
        [self.first, self.second].map(|balls| {
            let mut balls = balls.to_vec();
            balls.sort_by(|a, b| b.radius.total_cmp(&a.radius));
            balls
        })
    }

    /// What is added to each radius.
    pub(super) fn offset(&self) -> f64 {
        self.offset
    }
}
