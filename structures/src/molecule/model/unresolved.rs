//! Residues that a chain has and its file does not resolve, and conformers of these segments.
//!
//! An unresolved loop bridges a gap in the chain, and termini move or go on beyond what is resolved. A docked partner
//! meets them. Their places are not known. Many conformers are sampled for each segment, clear of the body and of
//! themselves: a place that all of them pass is filled, one that few pass is mostly free.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;
use serde::{Serialize, Serializer};

use crate::Conformers;
use crate::molecule::model::{Atom, Chain, Gap, Molecule, Residue, residues};
use crate::neighbours::SpatialHash;
use crate::vector::{along, cross, dot, norm, squared_distance, subtract};

/// Residues sampled beyond a terminus: as many as count as flexible on its resolved side.
const PAST_END: usize = 8;

/// Longest loop that is sampled, residues: longer loops fold back.
const MAX_LOOP_LENGTH: i64 = 20;

/// Residues that a molecule's chains have and its file does not resolve.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct UnresolvedResidues {
    /// Unresolved residues in gaps.
    pub residues: usize,
    /// Gaps.
    pub gaps: usize,
    /// Termini beyond which more residues may follow. Peptides have none, nor does an end that something is bonded to.
    pub ends: usize,
    /// Conformers of each gap and beyond each terminus, of those that the body leaves room for.
    #[serde(rename = "conformers", serialize_with = "traces")]
    pub segments: Vec<Conformers>,
}

/// Serialises the length of a list, not its items.
pub(crate) fn length<T, S: Serializer>(list: &[T], to: S) -> Result<S::Ok, S::Error> {
    list.len().serialize(to)
}

/// Serialises the number of conformers of all segments.
fn traces<S: Serializer>(segments: &[Conformers], to: S) -> Result<S::Ok, S::Error> {
    let traces = segments.iter().map(|segment| segment.traces.len());
    traces.sum::<usize>().serialize(to)
}

impl Molecule {
    /// Detects unresolved residues from atoms and residue numbers, and samples their conformers.
    pub fn unresolved_residues(&self) -> UnresolvedResidues {
        let groups = residues(&self.atoms);
        let chains = self.chains(&groups);
        let sampler = LoopSampler::new(self.atoms.iter().map(|atom| atom.position).collect());
        let mut found = UnresolvedResidues::default();
        for chain in &chains {
            for gap in &chain.gaps {
                found.gaps += 1;
                found.residues += gap.unresolved as usize;
                found.segments.extend(self.bridge(&sampler, chain, gap));
            }
        }
        for chain in chains.iter().filter(|chain| !chain.is_short()) {
            let sides = [(chain.residues.first(), "N"), (chain.residues.last(), "C")];
            for ((residue, name), end) in sides.into_iter().zip(chain.ends) {
                let (Some(residue), Some(_)) = (residue, end) else {
                    continue;
                };
                found.ends += 1;
                found.segments.extend(self.past(&sampler, residue, name));
            }
        }
        found
    }

    fn past(&self, sampler: &LoopSampler, residue: &Residue<'_>, end: &str) -> Option<Conformers> {
        let frame = self.frame(residue, end)?;
        sampler.traces(frame, &residue.atoms, None, PAST_END)
    }

    fn bridge(&self, sampler: &LoopSampler, chain: &Chain<'_>, gap: &Gap) -> Option<Conformers> {
        let (before, after) = (chain.residues[gap.after - 1], chain.residues[gap.after]);
        let frame = self.frame(before, "C")?;
        let anchors = [before.atoms.as_slice(), &after.atoms].concat();
        let length = gap.unresolved.min(MAX_LOOP_LENGTH) as usize;
        sampler.traces(frame, &anchors, Some(gap.sides[1]), length)
    }

    /// The frame of a residue's main chain about its N or C, so that conformers move with the body.
    fn frame(&self, residue: &Residue<'_>, about: &str) -> Option<Conformers> {
        let other = if about == "N" { "C" } else { "N" };
        let at = |name: &str| self.atom(residue, name).map(|atom: &Atom| atom.position);
        let (origin, alpha, other) = (at(about)?, at("CA")?, at(other)?);
        let axes = axes(origin, alpha, other)?;
        Some(Conformers {
            origin,
            axes,
            traces: Vec::new(),
        })
    }
}

/// Distances in Å: of a CA from the C before or the N after it in the adjacent residues, and of two CA in a row.
///
/// Engh and Huber, Acta Cryst. A47 (1991) 392-400: bonds of 1.33, 1.46 and 1.52 Å at 122° and 117°.
const FIRST: f64 = 2.45;
const NEXT: f64 = 3.8;

/// Cosines of the largest and smallest bend between two steps in a row: 100° and 30°.
///
/// These are angles at a CA of 80° and 150°; helices have 91°, strands 120° to 130°.
const TURN: [f64; 2] = [-0.17, 0.87];

/// Smallest distances in Å of a CA from atoms of the body and from an earlier CA, and from atoms of the residues at the
/// segment's ends.
const ROOM: f64 = 4.0;
const ROOM_BESIDE: f64 = 3.0;

/// Conformers sampled for a segment, and the fewest that are of use: fewer say little of where it may be.
const CONFORMERS: usize = 64;
const MIN_CONFORMERS: usize = 8;

/// Directions tried for a residue before a trial ends: without a target, and with one. Then the trials of a segment at
/// most.
const TRIES: [usize; 2] = [12, 60];
const MAX_TRIALS: usize = 5000;

/// Trials after which a segment is given up: that has no first residue by then, and that has no whole conformer by
/// then.
const GIVE_UP_AFTER: [usize; 2] = [100, 1000];

/// Distance in Å by which a residue brings a loop towards its target at most, and that of the last CA from the target.
/// Straight chains, with 3.8 Å per residue, close no gap.
const CLOSING: f64 = 3.6;
const CLOSED: f64 = 2.9;

/// Samples conformers that keep clear of a body.
struct LoopSampler {
    positions: Vec<[f64; 3]>,
    cells: SpatialHash<usize>,
}

struct Trace<'a> {
    sampler: &'a LoopSampler,
    frame: &'a Conformers,
    /// The atoms of the residues that the segment begins and ends at.
    anchors: &'a [usize],
    /// The N that it ends at, in the segment's own frame.
    target: Option<[f64; 3]>,
    length: usize,
}

impl LoopSampler {
    fn new(positions: Vec<[f64; 3]>) -> Self {
        Self {
            cells: SpatialHash::of_points(positions.iter().copied(), ROOM),
            positions,
        }
    }

    /// Conformers of `length` residues from a frame's origin on, to the N at `target` (file's frame, Å) if one is
    /// given.
    ///
    /// `anchors` are the atoms of the residues at the segment's ends. `None` where the body leaves no room.
    fn traces(
        &self,
        mut frame: Conformers,
        anchors: &[usize],
        target: Option<[f64; 3]>,
        length: usize,
    ) -> Option<Conformers> {
        let trace = Trace {
            sampler: self,
            anchors,
            target: target.map(|point| frame.local(point)),
            frame: &frame,
            length,
        };
        // The same seed for each segment, so that conformers depend on the body alone.
        let mut random = Pcg32::new(0, 0);
        let mut traces = Vec::with_capacity(CONFORMERS);
        let mut longest = 0;
        for trial in 0..MAX_TRIALS {
            let found = [longest, traces.len()];
            let has_nothing = |(limit, found)| trial >= limit && found == 0;
            if traces.len() == CONFORMERS || GIVE_UP_AFTER.into_iter().zip(found).any(has_nothing) {
                break;
            }
            let grown = trace.grow(&mut random);
            longest = longest.max(grown.len());
            traces.extend((grown.len() == length).then_some(grown));
        }
        frame.traces = traces;
        (frame.traces.len() >= MIN_CONFORMERS).then_some(frame)
    }
}

impl Trace<'_> {
    /// Grows one trace; it is shorter than the segment where it runs into something.
    fn grow(&self, random: &mut Pcg32) -> Vec<[f64; 3]> {
        let mut trace: Vec<[f64; 3]> = Vec::with_capacity(self.length);
        let mut direction = None;
        let tries = TRIES[usize::from(self.target.is_some())];
        while trace.len() < self.length {
            let last = trace.last().copied().unwrap_or([0.0; 3]);
            let step = if trace.is_empty() { FIRST } else { NEXT };
            let room = (0..tries).find_map(|_| {
                let unit = unit(random);
                let next = along(last, step, unit);
                let bends =
                    direction.is_none_or(|before| (TURN[0]..=TURN[1]).contains(&dot(before, unit)));
                (bends && self.closes(next, trace.len()) && self.is_free(next, &trace))
                    .then_some((next, unit))
            });
            let Some((next, unit)) = room else {
                break;
            };
            // The first step is no line between two CA atoms.
            direction = (!trace.is_empty()).then_some(unit);
            trace.push(next);
        }
        trace
    }

    /// Whether the residues left of a loop can still reach its target.
    fn closes(&self, alpha: [f64; 3], place: usize) -> bool {
        self.target.is_none_or(|target| {
            let left = (self.length - 1 - place) as f64;
            let reach = CLOSING * left + CLOSED;
            squared_distance(alpha, target) <= reach * reach
        })
    }

    /// Whether a CA keeps clear of the body and of the trace up to it.
    fn is_free(&self, alpha: [f64; 3], trace: &[[f64; 3]]) -> bool {
        let bonded = trace.is_empty() || (self.target.is_some() && trace.len() + 1 == self.length);
        let at = self.frame.in_file(alpha);
        let sampler = self.sampler;
        let free_of_body = sampler.cells.around(at).copied().all(|atom| {
            let squared = squared_distance(sampler.positions[atom], at);
            squared >= ROOM * ROOM
                || self.anchors.contains(&atom) && (bonded || squared >= ROOM_BESIDE * ROOM_BESIDE)
        });
        let earlier = trace.split_last().map_or(&[][..], |(_, earlier)| earlier);
        free_of_body
            && earlier
                .iter()
                .all(|other| squared_distance(*other, alpha) >= ROOM * ROOM)
    }
}

/// A unit vector, uniform over all directions.
fn unit(random: &mut Pcg32) -> [f64; 3] {
    let mut share = || f64::from(random.next_u32()) / f64::from(u32::MAX);
    let z = 2.0 * share() - 1.0;
    let (sine, cosine) = (std::f64::consts::TAU * share()).sin_cos();
    let radius = (1.0 - z * z).max(0.0).sqrt();
    [radius * cosine, radius * sine, z]
}

/// Axes of a right-handed frame: from `first` on to `origin`, and across to where `other` lies; `None` if all are on
/// one line.
fn axes(origin: [f64; 3], first: [f64; 3], other: [f64; 3]) -> Option<[[f64; 3]; 3]> {
    let x = normalized(subtract(origin, first))?;
    let z = normalized(cross(x, subtract(other, first)))?;
    Some([x, cross(z, x), z])
}

fn normalized(vector: [f64; 3]) -> Option<[f64; 3]> {
    let length = norm(vector);
    (length > 1e-3).then(|| vector.map(|x| x / length))
}

#[cfg(test)]
mod tests;
