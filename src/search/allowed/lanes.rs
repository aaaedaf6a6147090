//! The number of restraints that have a ball that meets a box of voxels.

/// Balls that are looked at together.
const LANES: usize = 16;
/// Balls after which a count may end early.
const TOGETHER: usize = 4 * LANES;
/// In place of a square without a ball.
const NONE: f32 = -1.0;

/// Voxels from one place to another on an axis, both included.
#[derive(Clone, Copy)]
pub(super) struct Span {
    low: f32,
    high: f32,
}

impl Span {
    pub fn new(low: usize, high: usize) -> Self {
        Self {
            low: low as f32,
            high: high as f32,
        }
    }

    /// Its ends times a factor.
    #[inline(always)]
    pub fn scaled(self, factor: f32) -> [f32; 2] {
        [factor * self.low, factor * self.high]
    }

    /// Distance of a place from it.
    #[inline(always)]
    fn distance(self, at: f32) -> f32 {
        // By comparisons, which are one instruction each: `max` looks for NaN as well.
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        larger(larger(self.low - at, at - self.high), 0.0)
    }
}

/// The balls of all restraints, in voxels: coordinate by coordinate, those of restraints with one ball first.
#[derive(Default)]
pub(super) struct Balls {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    /// Squares of the radii.
    square: Vec<f32>,
    /// Ends of the balls of each restraint with several, after the end of the single ones. In whole lanes.
    ends: Vec<usize>,
    /// Restraints with one ball.
    single: usize,
}

impl Balls {
    pub fn clear(&mut self) {
        for list in [&mut self.x, &mut self.y, &mut self.z, &mut self.square] {
            list.clear();
        }
        self.ends.clear();
    }

    /// Adds a restraint by its balls' centres and radii. Restraints of one ball come first.
    pub fn add(&mut self, balls: impl Iterator<Item = ([f64; 3], f64)>) {
        let start = self.x.len();
        for ([x, y, z], radius) in balls {
            self.x.push(x as f32);
            self.y.push(y as f32);
            self.z.push(z as f32);
            self.square.push((radius * radius) as f32);
        }
        let end = self.x.len();
        if end - start == 1 {
            assert!(self.ends.is_empty(), "restraints of one ball come first");
            return;
        }
        if self.ends.is_empty() {
            self.end_single(start);
        }
        self.fill_lanes();
        self.ends.push(self.x.len());
    }

    /// Ends the balls of restraints with one: moves what comes after the first `count` to whole lanes.
    fn end_single(&mut self, count: usize) {
        let gap = count.next_multiple_of(LANES) - count;
        for list in [&mut self.x, &mut self.y, &mut self.z, &mut self.square] {
            list.splice(count..count, std::iter::repeat_n(NONE, gap));
        }
        self.ends.push(count + gap);
        self.single = count;
    }

    /// Fills the last lanes with balls that nothing meets.
    fn fill_lanes(&mut self) {
        let whole = self.x.len().next_multiple_of(LANES);
        for list in [&mut self.x, &mut self.y, &mut self.z, &mut self.square] {
            list.resize(whole, NONE);
        }
    }

    /// Makes all lanes whole. To be called after the last restraint.
    pub fn end(&mut self) {
        if self.ends.is_empty() {
            self.end_single(self.x.len());
        }
    }

    /// Squares of the remaining radii of the balls along the rows of a box: negative if a ball meets none.
    #[inline(always)]
    pub fn left_along(&self, x: Span, y: Span, left: &mut Vec<f32>) {
        left.resize(self.x.len(), NONE);
        let places = self.x.iter().zip(&self.y).zip(&self.square);
        for (left, ((at_x, at_y), square)) in left.iter_mut().zip(places) {
            let (dx, dy) = (x.distance(*at_x), y.distance(*at_y));
            *left = square - dx * dx - dy * dy;
        }
    }

    /// Whether `needed` restraints have a ball that meets the box which `left` is of, from one place on its rows to
    /// another.
    #[inline(always)]
    pub fn hold(&self, z: Span, left: &[f32], needed: usize) -> bool {
        let meets = |at: f32, left: f32| {
            let distance = z.distance(at);
            distance * distance <= left
        };
        let lanes_of = |from: usize, to: usize| {
            let (at, _) = self.z[from..to].as_chunks::<LANES>();
            let (left, _) = left[from..to].as_chunks::<LANES>();
            at.iter().zip(left)
        };
        let Some(&single) = self.ends.first() else {
            return needed == 0;
        };
        // Restraints that hold, and that are still to come.
        let (mut held, mut coming) = (0, self.single + self.ends.len() - 1);
        for start in (0..single).step_by(TOGETHER) {
            if held >= needed || held + coming < needed {
                return held >= needed;
            }
            let mut counts = [0u32; LANES];
            for (at, left) in lanes_of(start, single.min(start + TOGETHER)) {
                for lane in 0..LANES {
                    counts[lane] += u32::from(meets(at[lane], left[lane]));
                }
            }
            held += counts.iter().sum::<u32>() as usize;
            coming -= TOGETHER.min(self.single - start);
        }
        for ends in self.ends.windows(2) {
            if held >= needed || held + coming < needed {
                return held >= needed;
            }
            held += usize::from(lanes_of(ends[0], ends[1]).any(|(at, left)| {
                (0..LANES).fold(false, |any, lane| any | meets(at[lane], left[lane]))
            }));
            coming -= 1;
        }
        held >= needed
    }
}
