//! Collision of two solids at a pose (B&I, section 4.1): a verdict with its certificate, signed distance, shared volume,
//! and the force and torque of an overlap energy. [`Collision`] is the entry.
//!
//! # Conventions
//!
//! - Body A is fixed, body B moves: a point x of B's file goes to R x + t in A's frame. Lengths are in the files' unit.
//! - The **signed distance** is the distance of the solids if they are apart. If they meet, it is minus their
//!   penetration depth, the length of the shortest translation that parts them.
//! - Two solids closer than the **margin** collide.
//!
//! # Certificates
//!
//! Inner balls lie inside the solids and outer balls hold them ([`knotdock_structures::ball_solid`]). So
//!
//! - inner balls closer than the margin certify a hit, containment included; if no outer balls are closer than the
//!   margin, the pose is free;
//! - the least signed distance over pairs of inner balls is never below the signed distance of the solids: no
//!   translation shorter than the depth of one pair parts that pair;
//! - the least over pairs of outer balls is never above it while they are apart. If they meet, a translation that
//!   parts them parts the solids too.
//!
//! Between the two the triangles of the meshes decide, if both are closed and do not cross themselves
//! ([`knotdock_structures::mesh::ExactSolid`]): surfaces that cross certify a hit, and so does a part of one within the other.
//! Other solids stay undecided there, and their gap is known to `eps_A` + `eps_B`. What rounding can change is
//! undecided too.

mod contact;
mod impact;
mod separation;
mod shared_volume;

use std::sync::OnceLock;
use std::time::{Duration, Instant};

use knotdock_scoring::overlap::ModesWorkspace;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use knotdock_structures::ball_solid::{
    BallHierarchy, BallSolid, Closest, ClosestSearch, Limits, MeetingPairs, Motion,
};
use knotdock_structures::mesh::{
    ClosestPoints, ExactSolid, MeshContact, SharedRegion, SharedRegions, SurfacePairs,
};
use rayon::prelude::*;

use contact::Densities;
pub use contact::{Contact, Method};
pub use impact::Impact;
pub use shared_volume::SharedVolume;

/// Pairs of balls between two looks at the clock.
const PAIRS_PER_CLOCK_CHECK: usize = 256;
/// Pairs of balls that are compared before triangles are.
const BALLS_FIRST: usize = 256;
/// Poses that one thread takes at a time.
const POSES_PER_TASK: usize = 64;
/// Default of [`Collision::max_modes`].
pub const DEFAULT_MAX_MODES: usize = 4096;

/// Whether two solids come closer than a margin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// They do.
    Hit,
    /// They do not.
    Free,
    /// Balls or rounding leave it open.
    Undecided,
}

impl Verdict {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hit => "hit",
            Self::Free => "free",
            Self::Undecided => "undecided",
        }
    }
}

/// Certificate of a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Certificate {
    /// A hit: a pair of inner balls is closer than the margin.
    InnerBalls,
    /// Free: no pair of outer balls is closer than the margin.
    OuterBalls,
    /// A hit: triangles cross or are closer than the margin, or one mesh holds a part of the other.
    MeshesMeet,
    /// Free: no triangles are closer than the margin, and neither mesh holds a part of the other.
    MeshesApart,
    /// A hit: the summed bumps overlap by more than rounding and the omitted modes can make.
    Modes,
    /// None: the solids touch to within rounding.
    Rounding,
    /// None: the verdict is undecided.
    None,
    /// None: the deadline came first.
    Deadline,
}

impl Certificate {
    /// The verdict that it certifies.
    pub fn verdict(self) -> Verdict {
        match self {
            Self::InnerBalls | Self::MeshesMeet | Self::Modes => Verdict::Hit,
            Self::OuterBalls | Self::MeshesApart => Verdict::Free,
            Self::None | Self::Rounding | Self::Deadline => Verdict::Undecided,
        }
    }

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::InnerBalls => "inner_balls",
            Self::OuterBalls => "outer_balls",
            Self::MeshesMeet | Self::MeshesApart => "triangles",
            Self::Modes => "modes",
            Self::None => "none",
            Self::Rounding => "rounding",
            Self::Deadline => "deadline",
        }
    }
}

/// Bounds of the signed distance of two solids.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DistanceBounds {
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
    /// Points of A and of B in A's frame. Of solids that do not meet they are the closest points of triangles if these
    /// decide, else of inner balls; of solids that meet the ends of the deepest pair of inner balls.
    pub witnesses: [[f64; 3]; 2],
}

/// Results for one pose.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CollisionReport {
    /// Whether the solids come closer than the margin.
    pub verdict: Verdict,
    /// Certificate of the verdict.
    pub certificate: Certificate,
    /// Bounds of the signed distance, if requested.
    pub distance: Option<DistanceBounds>,
    /// Distance in SE(3) ([`super::motion`]) within which every pose has the same verdict, if distances are requested:
    /// zero if that is undecided, and for hits in which no inner balls meet. It is a lower bound.
    pub pose_tolerance: Option<f64>,
    /// Shared volume, if requested.
    pub shared_volume: Option<SharedVolume>,
    /// Overlap energy, force and torque, if requested.
    pub contact: Option<Contact>,
    /// Pairs of balls that were compared.
    pub ball_pairs: usize,
    /// Fourier modes that were summed.
    pub modes: usize,
    /// Wall time, in seconds.
    pub seconds: f64,
}

/// Collision of a fixed solid and a moving one. Alone it computes verdicts; other quantities are requested.
///
/// ```
/// use knotdock::Collision;
/// use knotdock_scoring::se3::Pose;
/// use knotdock_structures::Ball;
/// use knotdock_structures::ball_solid::BallSolid;
///
/// let ball = Ball { center: [0.0; 3], radius: 1.0 };
/// let (a, b) = (BallSolid::from_balls(&[ball], None)?, BallSolid::from_balls(&[ball], None)?);
/// let pose = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [2.25, 0.0, 0.0]);
///
/// let report = Collision::new(&a, &b).margin(0.5).distance(true).at(&pose)?;
/// assert_eq!(report.verdict.name(), "hit");
/// assert_eq!(report.distance.unwrap().high, 0.25);
/// # Ok::<(), knotdock::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Collision<'a> {
    solids: [&'a BallSolid; 2],
    /// Sum of how far the solids reach from where their stored coordinates are zero.
    reach: f64,
    /// How far B reaches from the origin of its file.
    arm: f64,
    margin: f64,
    method: Method,
    max_modes: usize,
    deadline: Option<Duration>,
    distance: bool,
    shared_volume: bool,
    force: bool,
    densities: OnceLock<Densities>,
}

impl<'a> Collision<'a> {
    /// Collision of `fixed` (body A) and `moved` (body B), in one unit of length.
    #[must_use]
    pub fn new(fixed: &'a BallSolid, moved: &'a BallSolid) -> Self {
        Self {
            solids: [fixed, moved],
            reach: fixed.reach() + moved.reach(),
            arm: moved.reach_from(moved.origin().map(|part| -part)),
            margin: 0.0,
            method: Method::Auto,
            max_modes: DEFAULT_MAX_MODES,
            deadline: None,
            distance: false,
            shared_volume: false,
            force: false,
            densities: OnceLock::new(),
        }
    }

    /// Sets the distance below which solids collide, in the files' unit; not negative.
    #[must_use]
    pub fn margin(self, margin: f64) -> Self {
        Self {
            margin,
            densities: OnceLock::new(),
            ..self
        }
    }

    /// Sets how verdicts and forces are computed.
    #[must_use]
    pub fn method(self, method: Method) -> Self {
        Self {
            method,
            densities: OnceLock::new(),
            ..self
        }
    }

    /// Sets the maximum number of Fourier modes, conjugates included.
    #[must_use]
    pub fn max_modes(self, max_modes: usize) -> Self {
        Self {
            max_modes,
            densities: OnceLock::new(),
            ..self
        }
    }

    /// Sets the time for one pose: bounds are then the best known by its end, which depend on the machine.
    #[must_use]
    pub fn deadline(self, deadline: Option<Duration>) -> Self {
        Self { deadline, ..self }
    }

    /// Requests bounds of the signed distance.
    #[must_use]
    pub fn distance(self, distance: bool) -> Self {
        Self { distance, ..self }
    }

    /// Requests the shared volume.
    #[must_use]
    pub fn shared_volume(self, shared_volume: bool) -> Self {
        Self {
            shared_volume,
            ..self
        }
    }

    /// Requests overlap energy, force and torque.
    #[must_use]
    pub fn force(self, force: bool) -> Self {
        Self { force, ..self }
    }

    /// `eps_A` + `eps_B`: how far the distance of outer balls is below that of inner ones.
    pub fn band(&self) -> f64 {
        self.solids[0].epsilon() + self.solids[1].epsilon()
    }

    /// Largest gap at which a pose may stay undecided: the band, or zero if triangles decide all but rounding.
    pub fn undecided_band(&self) -> f64 {
        self.exact().map_or(self.band(), |_| 0.0)
    }

    /// Distance in SE(3) within which every pose has the verdict of a pose with these bounds.
    ///
    /// Between poses whose rotations differ by theta and whose translations by t, a point of B at most rho from the
    /// origin of its file moves by no more than t + rho theta. That is at most sqrt(1 + rho^2 / 2) times the distance
    /// sqrt(2 theta^2 + t^2). Free solids stay apart, and the deepest pair of inner balls in each other, until that
    /// exceeds their gap or depth.
    fn tolerance(&self, verdict: Verdict, bounds: &DistanceBounds) -> f64 {
        let slack = match verdict {
            Verdict::Free => bounds.low - self.margin,
            Verdict::Hit => self.margin - bounds.high,
            Verdict::Undecided => 0.0,
        };
        slack.max(0.0) / (0.5 * self.arm * self.arm + 1.0).sqrt()
    }

    /// Results for one pose.
    ///
    /// # Errors
    /// [`Error`] if the margin is negative or not finite.
    pub fn at(&self, pose: &Pose) -> Result<CollisionReport, Error> {
        self.prepare()?;
        Ok(self.query(pose, &mut Workspace::default()).report())
    }

    /// Results for many poses, in their order, on the threads of the caller's pool.
    ///
    /// # Errors
    /// As [`Self::at`].
    pub fn at_each(&self, poses: &[Pose]) -> Result<Vec<CollisionReport>, Error> {
        self.prepare()?;
        let chunks = poses.par_chunks(POSES_PER_TASK);
        let reports = chunks.map_init(Workspace::default, |work, poses| {
            let reports = poses.iter().map(|pose| self.query(pose, work).report());
            reports.collect::<Vec<_>>()
        });
        Ok(reports.flatten_iter().collect())
    }

    /// Checks the margin, and makes the densities if the requested quantities need them.
    ///
    /// # Errors
    /// As [`Self::at`].
    pub fn prepare(&self) -> Result<(), Error> {
        if !(self.margin >= 0.0 && self.margin.is_finite()) {
            return Err(Error::input(format!("the margin is {}", self.margin))
                .help("give a finite margin, 0 or above"));
        }
        let sums = self.exact().is_none() || self.method == Method::Hybrid;
        if self.method == Method::Modes || (self.force && sums) {
            self.densities()?;
        }
        Ok(())
    }

    /// The densities, made at first use.
    fn densities(&self) -> Result<&Densities, Error> {
        if let Some(densities) = self.densities.get() {
            return Ok(densities);
        }
        let densities = Densities::new(self)?;
        Ok(self.densities.get_or_init(|| densities))
    }

    /// Computation of single quantities at a pose, with the buffers of the caller. Forces, and verdicts by modes, need
    /// [`Self::prepare`] first.
    pub fn query<'q>(&'q self, pose: &Pose, work: &'q mut Workspace) -> CollisionQuery<'q> {
        let start = Instant::now();
        CollisionQuery {
            collision: self,
            motion: self.motion(pose),
            start,
            end: self.deadline.and_then(|time| start.checked_add(time)),
            searched: None,
            contact: None,
            region: None,
            ball_pairs: 0,
            modes: 0,
            work,
        }
    }

    /// The meshes whose triangles decide contact, if both do and the method takes them.
    fn exact(&self) -> Option<[&'a ExactSolid; 2]> {
        let [a, b] = self.solids.map(BallSolid::exact);
        let takes = !matches!(self.method, Method::Tree | Method::Modes);
        takes.then_some(())?;
        Some([a?, b?])
    }

    fn trees(&self) -> [&'a BallHierarchy; 2] {
        self.solids.map(BallSolid::hierarchy)
    }

    /// The motion of B's stored coordinates into A's.
    fn motion(&self, pose: &Pose) -> Motion {
        let matrix = pose.rotation.to_rotation_matrix();
        let [a, b] = self.solids.map(BallSolid::origin);
        let moved = pose.apply(b);
        Motion {
            rows: [0, 1, 2].map(|row| [0, 1, 2].map(|column| matrix[(row, column)])),
            shift: [0, 1, 2].map(|axis| moved[axis] - a[axis]),
        }
    }
}

/// Buffers of one thread.
#[derive(Default)]
pub struct Workspace {
    search: ClosestSearch,
    surfaces: SurfacePairs,
    regions: SharedRegions,
    pairs: MeetingPairs,
    marks: [Vec<bool>; 2],
    /// For the largest balls, and for all.
    modes: [Option<ModesWorkspace>; 2],
}

/// One pose of a [`Collision`], with its deadline and counters.
pub struct CollisionQuery<'q> {
    collision: &'q Collision<'q>,
    motion: Motion,
    start: Instant,
    end: Option<Instant>,
    /// The certificate by balls and triangles, once it is known.
    searched: Option<Certificate>,
    /// A margin and how meshes are to each other with it, once that is known.
    contact: Option<(f64, MeshContact)>,
    /// The region that meshes share, once it is known.
    region: Option<SharedRegion>,
    ball_pairs: usize,
    modes: usize,
    work: &'q mut Workspace,
}

impl CollisionQuery<'_> {
    /// Everything that the collision requests.
    fn report(mut self) -> CollisionReport {
        let certificate = self.certificate();
        let contact = self.collision.force.then(|| self.contact()).flatten();
        let distance = self.collision.distance.then(|| self.distance());
        let shared_volume = self
            .collision
            .shared_volume
            .then(|| match certificate.verdict() {
                Verdict::Free => SharedVolume::default(),
                _ => self.shared_volume(),
            });
        CollisionReport {
            verdict: certificate.verdict(),
            certificate,
            pose_tolerance: distance
                .map(|bounds| self.collision.tolerance(certificate.verdict(), &bounds)),
            distance,
            shared_volume,
            contact,
            ball_pairs: self.ball_pairs,
            modes: self.modes,
            seconds: self.start.elapsed().as_secs_f64(),
        }
    }

    /// The verdict, by its certificate.
    pub fn certificate(&mut self) -> Certificate {
        match self.collision.method {
            Method::Modes => self.certificate_by_modes(),
            _ => self.certificate_by_search(),
        }
    }

    /// The certificate by balls and by triangles.
    fn certificate_by_search(&mut self) -> Certificate {
        if let Some(known) = self.searched {
            return known;
        }
        let exact = self.collision.exact();
        let first = match (exact, self.collision.method) {
            (None, _) => usize::MAX,
            (Some(_), Method::Exact) => 0,
            (Some(_), _) => BALLS_FIRST,
        };
        let (margin, rounding) = (self.collision.margin, self.rounding());
        let limits = Limits {
            ignored_from: margin + self.collision.band() + rounding,
            enough_below: margin - rounding,
        };
        let trees = self.collision.trees();
        self.work.search.begin(trees, &self.motion, &limits);
        let mut certificate = self.certificate_by_balls(&limits, first);
        if let (Some(solids), Certificate::None) = (exact, certificate) {
            certificate = match self.meshes(solids, margin) {
                MeshContact::Met => Certificate::MeshesMeet,
                MeshContact::Apart => Certificate::MeshesApart,
                // Solids whose faces are flush may be deep in each other.
                MeshContact::Open => match self.certificate_by_balls(&limits, usize::MAX) {
                    Certificate::None => Certificate::Rounding,
                    certificate => certificate,
                },
            };
        }
        self.ball_pairs += self.work.search.ball_pairs();
        self.searched = Some(certificate);
        certificate
    }

    /// The certificate after at most `most` more pairs of balls.
    fn certificate_by_balls(&mut self, limits: &Limits, most: usize) -> Certificate {
        let closest = self.advanced(limits, most);
        if closest.distance < limits.enough_below {
            Certificate::InnerBalls
        } else if closest.lower >= limits.ignored_from {
            Certificate::OuterBalls
        } else if has_come(self.end) {
            Certificate::Deadline
        } else if self.collision.band() == 0.0 && closest.finished {
            Certificate::Rounding
        } else {
            Certificate::None
        }
    }

    /// How two meshes are to each other, as far as the deadline allows.
    fn meshes(&mut self, solids: [&ExactSolid; 2], margin: f64) -> MeshContact {
        if let Some((known, contact)) = self.contact
            && known == margin
        {
            return contact;
        }
        let (lengths, end) = ([margin, self.rounding()], self.end);
        let surfaces = &mut self.work.surfaces;
        let contact = surfaces.contact(solids, &self.motion, lengths, || has_come(end));
        self.contact = Some((margin, contact));
        contact
    }

    /// Bounds of the signed distance.
    pub fn distance(&mut self) -> DistanceBounds {
        let closest = self.closest(&Limits::NONE);
        let mut bounds = DistanceBounds {
            low: closest.lower - self.collision.band(),
            high: closest.distance,
            witnesses: self.witnesses(closest.pair.unwrap_or([0, 0])),
        };
        // With a deadline triangles decide the verdict alone.
        let exact = self.collision.exact().filter(|_| self.end.is_none());
        if let Some(solids) = exact.filter(|_| bounds.high > 0.0) {
            match self.gap(solids, bounds.high) {
                Gap::Apart(found) => {
                    bounds.low = bounds.low.max(found.low);
                    bounds.high = bounds.high.min(found.high);
                    bounds.witnesses = found.points;
                }
                Gap::None => bounds.high = 0.0,
                Gap::Open => {}
            }
        }
        if bounds.low < 0.0 {
            bounds.low = -self.separation(&closest);
        }
        bounds
    }

    /// The gap between two meshes, which is no larger than `most`.
    fn gap(&mut self, solids: [&ExactSolid; 2], most: f64) -> Gap {
        match self.meshes(solids, 0.0) {
            MeshContact::Met => Gap::None,
            MeshContact::Open => Gap::Open,
            MeshContact::Apart => {
                let lengths = [most, self.rounding()];
                let found = self.work.surfaces.closest(solids, &self.motion, lengths);
                found.map_or(Gap::Open, Gap::Apart)
            }
        }
    }

    /// The closest pair of inner balls within limits, as far as the deadline allows.
    fn closest(&mut self, limits: &Limits) -> Closest {
        let trees = self.collision.trees();
        self.work.search.begin(trees, &self.motion, limits);
        let closest = self.advanced(limits, usize::MAX);
        self.ball_pairs += closest.ball_pairs;
        closest
    }

    /// Goes on with the search for at most `most` pairs of balls, as far as the deadline allows.
    fn advanced(&mut self, limits: &Limits, most: usize) -> Closest {
        let (trees, motion) = (self.collision.trees(), &self.motion);
        let search = &mut self.work.search;
        let stop_at = search.ball_pairs().saturating_add(most);
        let step = match self.end {
            Some(_) => most.min(PAIRS_PER_CLOCK_CHECK),
            None => most,
        };
        loop {
            let closest = search.advance(trees, motion, limits, step);
            if closest.finished || closest.ball_pairs >= stop_at || has_come(self.end) {
                return closest;
            }
        }
    }

    /// The region that two meshes share, if their triangles decide.
    fn region(&mut self) -> Option<SharedRegion> {
        if self.region.is_none() {
            let solids = self.collision.exact()?;
            let rounding = self.rounding();
            self.region = self.work.regions.at(solids, &self.motion, rounding);
        }
        self.region
    }

    /// How far the rounding of a pose and of coordinates moves a point of B in A's frame.
    fn rounding(&self) -> f64 {
        let places = self.collision.solids.map(BallSolid::origin);
        let places = places.iter().chain([&self.motion.shift]).flatten();
        let length = self.collision.reach + places.map(|part| part.abs()).sum::<f64>();
        8.0 * f64::EPSILON * length
    }

    /// Points of two balls on the line of their centres, in A's file frame.
    fn witnesses(&self, [first, second]: [usize; 2]) -> [[f64; 3]; 2] {
        let [a, b] = self.collision.solids;
        let origin = a.origin();
        let (a, b) = (a.inner()[first], b.inner()[second]);
        let center = self.motion.apply(b.center);
        let direction = unit([0, 1, 2].map(|axis| center[axis] - a.center[axis]));
        let on = |center: [f64; 3], radius: f64| {
            [0, 1, 2].map(|axis| origin[axis] + center[axis] + radius * direction[axis])
        };
        [on(a.center, a.radius), on(center, -b.radius)]
    }
}

/// The gap between two meshes.
enum Gap {
    /// They meet.
    None,
    /// Rounding leaves open whether they do.
    Open,
    Apart(ClosestPoints),
}

/// Whether a deadline has come.
fn has_come(end: Option<Instant>) -> bool {
    end.is_some_and(|end| Instant::now() >= end)
}

/// The direction of a vector; x for the zero vector.
fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = length(vector);
    if length > 0.0 {
        vector.map(|part| part / length)
    } else {
        [1.0, 0.0, 0.0]
    }
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().fold(0.0f64, |sum, part| sum.hypot(*part))
}

#[cfg(test)]
mod tests;
