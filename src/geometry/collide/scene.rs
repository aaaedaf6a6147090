//! Two solids made ready for many poses: verdicts and bounds of the signed distance.

use std::time::{Duration, Instant};

use knotdock_scoring::overlap::ModesWorkspace;
use knotdock_scoring::se3::Pose;
use knotdock_structures::ball_solid::{
    BallHierarchy, BallSolid, Closest, ClosestSearch, Limits, MeetingPairs, Motion,
};
use serde::Serialize;

/// Pairs of balls looked at between two looks at the clock.
pub(super) const PAIRS_A_LOOK: usize = 256;

/// Whether two solids come closer than a margin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// They do.
    Hit,
    /// They do not.
    Free,
    /// The balls do not say.
    Undecided,
}

impl Verdict {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hit => "hit",
            Self::Free => "free",
            Self::Undecided => "undecided",
        }
    }
}

/// What a verdict rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Certificate {
    /// A pair of inner balls closer than the margin.
    InnerBalls,
    /// No pair of outer balls is.
    OuterBalls,
    /// The summed bumps overlap by more than the modes left out and rounding can make.
    Modes,
    /// Nothing: the verdict is undecided.
    None,
    /// Nothing: the deadline came first.
    Deadline,
}

impl Certificate {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::InnerBalls => "inner_balls",
            Self::OuterBalls => "outer_balls",
            Self::Modes => "modes",
            Self::None => "none",
            Self::Deadline => "deadline",
        }
    }
}

/// When work on a pose must end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deadline(Option<Instant>);

impl Deadline {
    /// Never.
    pub const NEVER: Self = Self(None);

    /// So long from now.
    pub fn after(time: Option<Duration>) -> Self {
        Self(time.and_then(|time| Instant::now().checked_add(time)))
    }

    /// Whether there is one.
    pub fn is_set(&self) -> bool {
        self.0.is_some()
    }

    /// Whether it has come.
    pub fn has_come(&self) -> bool {
        self.0.is_some_and(|end| Instant::now() >= end)
    }

    /// Pairs of balls to look at before the next look at the clock.
    fn block(&self) -> usize {
        if self.0.is_some() {
            PAIRS_A_LOOK
        } else {
            usize::MAX
        }
    }
}

/// A verdict, and what it took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Whether the solids come closer than the margin.
    pub verdict: Verdict,
    /// What certifies it.
    pub certificate: Certificate,
    /// Pairs of balls that were looked at.
    pub ball_pairs: usize,
}

/// Bounds of the signed distance of the solids.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// It is no less than this.
    pub low: f64,
    /// It is no more than this.
    pub high: f64,
    /// Points on the closest pair of inner balls, of A and of B, in A's frame: the ends of the gap, or of the depth.
    pub witnesses: [[f64; 3]; 2],
    /// Pairs of balls that were looked at.
    pub ball_pairs: usize,
}

/// Buffers of one thread.
#[derive(Default)]
pub struct Workspace {
    pub(super) search: ClosestSearch,
    pub(super) pairs: MeetingPairs,
    pub(super) marks: [Vec<bool>; 2],
    pub(super) modes: Option<ModesWorkspace>,
}

impl Workspace {
    /// Empty buffers.
    pub fn new() -> Self {
        Self::default()
    }
}

/// Two solids and a margin.
#[derive(Clone, Debug)]
pub struct CollisionScene {
    solids: [BallSolid; 2],
    margin: f64,
}

impl CollisionScene {
    /// Body A stands and B moves; poses at which they are closer than `margin` (in the files' unit, not negative)
    /// count as hits.
    pub fn new(solids: [BallSolid; 2], margin: f64) -> Self {
        Self { solids, margin }
    }

    /// The bodies.
    pub fn solids(&self) -> &[BallSolid; 2] {
        &self.solids
    }

    /// Distance below which a pose is a hit.
    pub fn margin(&self) -> f64 {
        self.margin
    }

    /// `eps_A` + `eps_B`: how far the distance of outer balls is below that of inner ones.
    pub fn band(&self) -> f64 {
        self.solids[0].epsilon() + self.solids[1].epsilon()
    }

    pub(super) fn trees(&self) -> [&BallHierarchy; 2] {
        self.solids.each_ref().map(BallSolid::hierarchy)
    }

    /// The motion of B's stored coordinates into A's.
    pub fn motion(&self, pose: &Pose) -> Motion {
        let matrix = pose.rotation.to_rotation_matrix();
        let [a, b] = self.solids.each_ref().map(BallSolid::origin);
        let moved = pose.apply(b);
        Motion {
            rows: [0, 1, 2].map(|row| [0, 1, 2].map(|column| matrix[(row, column)])),
            shift: [0, 1, 2].map(|axis| moved[axis] - a[axis]),
        }
    }

    /// Whether the solids come closer than the margin.
    pub fn verdict(&self, motion: &Motion, deadline: Deadline, work: &mut Workspace) -> Found {
        let limits = Limits {
            ignored_from: self.margin + self.band(),
            enough_below: self.margin,
        };
        let found = self.search(motion, &limits, deadline, work);
        let (verdict, certificate) = if found.distance < self.margin {
            (Verdict::Hit, Certificate::InnerBalls)
        } else if found.lower >= limits.ignored_from {
            (Verdict::Free, Certificate::OuterBalls)
        } else if found.finished {
            (Verdict::Undecided, Certificate::None)
        } else {
            (Verdict::Undecided, Certificate::Deadline)
        };
        Found {
            verdict,
            certificate,
            ball_pairs: found.ball_pairs,
        }
    }

    /// Bounds of the signed distance.
    pub fn distance(&self, motion: &Motion, deadline: Deadline, work: &mut Workspace) -> Bounds {
        let found = self.search(motion, &Limits::NONE, deadline, work);
        let mut ball_pairs = found.ball_pairs;
        let mut low = found.lower - self.band();
        if low < 0.0 {
            let (length, pairs) =
                self.separation(motion, (found.distance, found.pair), deadline, work);
            low = -length;
            ball_pairs += pairs;
        }
        let pair = found.pair.unwrap_or([0, 0]);
        Bounds {
            low,
            high: found.distance,
            witnesses: self.witnesses(motion, pair),
            ball_pairs,
        }
    }

    /// The closest pair of inner balls within limits, as far as the deadline lets it be found.
    pub(super) fn search(
        &self,
        motion: &Motion,
        limits: &Limits,
        deadline: Deadline,
        work: &mut Workspace,
    ) -> Closest {
        let trees = self.trees();
        work.search.begin(trees, motion, limits);
        loop {
            let found = work.search.advance(trees, motion, limits, deadline.block());
            if found.finished || deadline.has_come() {
                return found;
            }
        }
    }

    /// Points of two balls on the line of their centres, in A's file frame.
    fn witnesses(&self, motion: &Motion, [first, second]: [usize; 2]) -> [[f64; 3]; 2] {
        let a = self.solids[0].inner()[first];
        let b = self.solids[1].inner()[second];
        let center = motion.apply(b.center);
        let direction = unit([0, 1, 2].map(|axis| center[axis] - a.center[axis]));
        let origin = self.solids[0].origin();
        let on = |center: [f64; 3], radius: f64| {
            [0, 1, 2].map(|axis| origin[axis] + center[axis] + radius * direction[axis])
        };
        [on(a.center, a.radius), on(center, -b.radius)]
    }
}

/// The direction of a vector; x of none.
pub(super) fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = vector.iter().fold(0.0f64, |sum, part| sum.hypot(*part));
    if length > 0.0 {
        vector.map(|part| part / length)
    } else {
        [1.0, 0.0, 0.0]
    }
}
