//! Points within reach of a point, one after another, so that later steps handle these alone.

use pulp::Simd;

/// Points in a block: what vector registers take together.
pub(crate) const LANES: usize = 8;

/// Points that are collected before they are handed on.
const CAPACITY: usize = 1024;

/// For each set of lanes, as bits: its lanes first, in order.
static FRONT: [[u8; LANES]; 1 << LANES] = front();

const fn front() -> [[u8; LANES]; 1 << LANES] {
    let mut front = [[0; LANES]; 1 << LANES];
    let mut mask = 0;
    while mask < 1 << LANES {
        let (mut lane, mut count) = (0, 0);
        while lane < LANES {
            if mask >> lane & 1 == 1 {
                front[mask][count] = lane as u8;
                count += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    front
}

/// Points within reach of another.
pub(crate) struct Near {
    /// Squared distances in Å^2.
    squares: [f64; CAPACITY],
    /// Places in the order of the blocks.
    points: [u32; CAPACITY],
    count: usize,
}

impl Default for Near {
    fn default() -> Self {
        Self {
            squares: [0.0; CAPACITY],
            points: [0; CAPACITY],
            count: 0,
        }
    }
}

impl Near {
    /// Whether another eight might find no room.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.count > CAPACITY - LANES
    }

    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    #[inline(always)]
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds those of eight points, the first of which is `first`, that are nearer than the root of `square_reach`.
    /// Whether one is near is a coin toss that no branch predictor wins, so all eight are written, the near ones first,
    /// and only these are counted.
    #[inline(always)]
    pub fn add(&mut self, first: u32, squares: &[f64; LANES], square_reach: f64) {
        debug_assert!(!self.is_full());
        let from = self.count.min(CAPACITY - LANES);
        let places = &mut self.squares[from..from + LANES];
        let points = &mut self.points[from..from + LANES];
        let mut mask = 0;
        for lane in 0..LANES {
            mask |= usize::from(squares[lane] < square_reach) << lane;
        }
        let order = &FRONT[mask];
        for lane in 0..LANES {
            points[lane] = first + u32::from(order[lane]);
        }
        for lane in 0..LANES {
            places[lane] = squares[usize::from(order[lane]) % LANES];
        }
        self.count = from + mask.count_ones() as usize;
    }

    /// Fills up the last eight with places infinitely far away.
    #[inline(always)]
    pub fn fill(&mut self) {
        for place in self.count..self.count.next_multiple_of(LANES) {
            if let (Some(square), Some(point)) =
                (self.squares.get_mut(place), self.points.get_mut(place))
            {
                (*square, *point) = (f64::INFINITY, 0);
            }
        }
    }

    /// Squared distances and places, eight by eight.
    #[inline(always)]
    pub fn eights(&self) -> impl Iterator<Item = (&[f64; LANES], &[u32; LANES])> {
        let filled = self.count.div_ceil(LANES);
        let (squares, _) = self.squares.as_chunks();
        let (points, _) = self.points.as_chunks();
        squares.iter().zip(points).take(filled)
    }

    /// Squared distances and places one by one, without what fills up the last eight.
    #[inline(always)]
    pub fn pairs(&self) -> impl Iterator<Item = (f64, u32)> {
        let pairs = self.squares.iter().zip(&self.points).take(self.count);
        pairs.map(|(&square, &point)| (square, point))
    }
}

/// Four, eight or sixteen numbers as vectors.
#[inline(always)]
pub(crate) fn vectors<S: Simd>(values: &[f64]) -> &[S::f64s] {
    const { assert!(S::F64_LANES <= 4, "longer vectors would leave numbers out") };
    S::as_simd_f64s(values).0
}

/// Four, eight or sixteen numbers as vectors to write to.
#[inline(always)]
pub(crate) fn vectors_mut<S: Simd>(values: &mut [f64]) -> &mut [S::f64s] {
    const { assert!(S::F64_LANES <= 4, "longer vectors would leave numbers out") };
    S::as_mut_simd_f64s(values).0
}
