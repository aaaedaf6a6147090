//! A placement in the making: from one pair of chains to all that lie together with it.

use knotdock_scoring::se3::Pose;
use nalgebra::Point3;

use crate::evaluate::chain_choice::ChainChoice;
use crate::evaluate::matching::chain_pair::{ChainPair, align_members};
use crate::evaluate::matching::placement::Placement;
use crate::evaluate::matching::superposition::{MAX_FIT_RMSD, PointPair, Superposition};
use crate::evaluate::residues::Residues;
use crate::evaluate::rmsd::backbone_pairs;

/// Equal residues that a chain has by no chance.
const DISTINCTIVE: usize = 20;
/// Fewer are distinctive too, from the first number on, where the share of equal residues is at least the second.
const DISTINCTIVE_PEPTIDE: (usize, f64) = (8, 0.9);
/// What is left of two merged chains must have so many equal residues: fewer pair by chance.
const MIN_OF_TWO_REMAINDERS: usize = 8;
/// What is left of a chain is elsewhere only where it has this share of the pairs of the whole chain: else the other
/// chain is a copy of what was matched already.
const MIN_OF_WHOLE: f64 = 0.9;

/// Two chains of like sequence and their superposition.
pub(in crate::evaluate) struct Candidate {
    pub pair: ChainPair,
    pub superposition: Superposition,
}

/// Farthest, in Å RMSD, that so many residues may be from where the rest of the side has them.
fn reach(residues: usize) -> f64 {
    match residues {
        0..=3 => 3.0,
        4..DISTINCTIVE => 8.0,
        _ => 10.0,
    }
}

/// The same for what is left of two chains.
const REACH_OF_REMAINDERS: f64 = 5.0;

/// A placement in the making.
pub(in crate::evaluate) struct Builder<'a> {
    user: &'a Residues,
    native: &'a Residues,
    candidates: &'a [Candidate],
    choice: &'a ChainChoice,
    /// Members of each segment that are not matched yet.
    free: [Vec<Vec<usize>>; 2],
    chains: Vec<ChainPair>,
    points: Vec<PointPair>,
    motion: Pose,
    rmsd: f64,
}

impl<'a> Builder<'a> {
    pub fn new(
        user: &'a Residues,
        native: &'a Residues,
        candidates: &'a [Candidate],
        choice: &'a ChainChoice,
    ) -> Self {
        let members = |residues: &Residues| -> Vec<Vec<usize>> {
            let segments = residues.segments.iter();
            segments.map(|segment| segment.members.clone()).collect()
        };
        Self {
            user,
            native,
            candidates,
            choice,
            free: [members(user), members(native)],
            chains: Vec::new(),
            points: Vec::new(),
            motion: Pose::identity(),
            rmsd: 0.0,
        }
    }

    /// The placement that a pair of chains fixes.
    pub fn grow_from(mut self, seed: &Candidate) -> Placement {
        self.take(seed.pair.clone());
        self.add_whole_chains();
        self.add_remainders();
        self.add_elsewhere();
        Placement {
            chains: self.chains,
            motion: self.motion,
            rmsd: self.rmsd,
        }
    }

    fn take(&mut self, pair: ChainPair) {
        let [ours, theirs] = &mut self.free;
        // Pairs rise in the user's residues; in the native's they do where sequences were aligned, not by numbers.
        let mut natives: Vec<usize> = pair.pairs.iter().map(|&(_, native)| native).collect();
        natives.sort_unstable();
        ours[pair.user].retain(|i| {
            pair.pairs
                .binary_search_by_key(i, |&(user, _)| user)
                .is_err()
        });
        theirs[pair.native].retain(|j| natives.binary_search(j).is_err());
        let added = backbone_pairs(self.user, self.native, pair.pairs.iter().copied());
        self.points.extend(added);
        let superposition = Superposition::new(&self.points);
        self.motion = superposition.best;
        self.rmsd = superposition.rmsd(&superposition.best);
        self.chains.push(pair);
    }

    fn is_whole_user(&self, segment: usize) -> bool {
        self.chains.iter().all(|chain| chain.user != segment)
    }

    fn is_whole_native(&self, segment: usize) -> bool {
        self.chains.iter().all(|chain| chain.native != segment)
    }

    fn is_untouched(&self, pair: &ChainPair) -> bool {
        self.is_whole_user(pair.user) && self.is_whole_native(pair.native)
    }

    /// Gives each whole chain the native's that lies where it comes to stand: many residues and a near fit first.
    fn add_whole_chains(&mut self) {
        loop {
            let best = self
                .candidates
                .iter()
                .filter(|candidate| self.is_untouched(&candidate.pair))
                .filter_map(|candidate| {
                    let reach = reach(candidate.pair.pairs.len());
                    // The number of atoms, each counting less the farther it is.
                    let worth = candidate.superposition.count
                        - candidate.superposition.at(&self.motion) / (reach * reach);
                    (worth > 0.0).then_some((worth, candidate))
                })
                .reduce(|best, next| if next.0 > best.0 { next } else { best });
            match best {
                Some((_, candidate)) => self.take(candidate.pair.clone()),
                None => return,
            }
        }
    }

    /// Matches what is left of merged chains with what lies there.
    fn add_remainders(&mut self) {
        loop {
            let mut best: Option<(f64, ChainPair)> = None;
            for user in 0..self.user.segments.len() {
                for native in 0..self.native.segments.len() {
                    if let Some((worth, pair)) = self.remainder(user, native)
                        && best.as_ref().is_none_or(|(other, _)| worth > *other)
                    {
                        best = Some((worth, pair));
                    }
                }
            }
            match best {
                Some((_, pair)) => self.take(pair),
                None => return,
            }
        }
    }

    /// What is left of two chains, of which one at least is matched in part, if it is alike and lies together; and
    /// what it is worth.
    fn remainder(&self, user: usize, native: usize) -> Option<(f64, ChainPair)> {
        let whole = (self.is_whole_user(user), self.is_whole_native(native));
        if whole == (true, true) {
            return None;
        }
        let segments = (&self.user.segments[user], &self.native.segments[native]);
        let (ours, theirs) = (&self.free[0][user], &self.free[1][native]);
        if !self.choice.allows(segments.0, segments.1)
            || ours.is_empty()
            || theirs.is_empty()
            || !self.are_near(ours, theirs)
        {
            return None;
        }
        let pair = align_members(self.user, self.native, (user, ours), (native, theirs));
        let equal = pair.pairs.len();
        let reach = if whole == (false, false) {
            (equal >= MIN_OF_TWO_REMAINDERS).then_some(REACH_OF_REMAINDERS)
        } else {
            Some(reach(equal))
        }?;
        let superposition = Superposition::new(&backbone_pairs(
            self.user,
            self.native,
            pair.pairs.iter().copied(),
        ));
        let worth = superposition.count - superposition.at(&self.motion) / (reach * reach);
        (pair.is_alike() && worth > 0.0).then_some((worth, pair))
    }

    /// Whether the balls about these residues come near each other once the user's are moved.
    fn are_near(&self, ours: &[usize], theirs: &[usize]) -> bool {
        let ball = |residues: &Residues, members: &[usize]| {
            let centers = || {
                members
                    .iter()
                    .map(|&member| residues.residues[member].center)
            };
            let sum = centers().fold(nalgebra::Vector3::zeros(), |sum, point| sum + point.coords);
            let center = Point3::from(sum / members.len() as f64);
            let radius = centers()
                .map(|point| nalgebra::distance(&point, &center))
                .fold(0.0, f64::max);
            (center, radius)
        };
        let ((center, radius), (other, other_radius)) =
            (ball(self.user, ours), ball(self.native, theirs));
        let moved = Point3::from(self.motion.apply(center.into()));
        nalgebra::distance(&moved, &other) < radius + other_radius + reach(DISTINCTIVE)
    }

    /// Gives chains that found nothing in their place the native's chain of their sequence that is elsewhere. A chain that
    /// found a part gets the rest if the whole then fits, or if the rest is of the same native chain (a domain that moved).
    fn add_elsewhere(&mut self) {
        for user in 0..self.user.segments.len() {
            let ours = self.free[0][user].clone();
            if ours.is_empty() || self.is_copy_of_a_placed_one(user) {
                continue;
            }
            let mut nearest: Option<(f64, ChainPair)> = None;
            for candidate in self
                .candidates
                .iter()
                .filter(|known| known.pair.user == user)
            {
                let native = candidate.pair.native;
                let theirs = &self.free[1][native];
                let pair = if self.is_untouched(&candidate.pair) {
                    candidate.pair.clone()
                } else {
                    align_members(self.user, self.native, (user, &ours), (native, theirs))
                };
                let of_whole = MIN_OF_WHOLE * candidate.pair.pairs.len() as f64;
                if !is_distinctive(&pair) || (pair.pairs.len() as f64) < of_whole {
                    continue;
                }
                let points = backbone_pairs(self.user, self.native, pair.pairs.iter().copied());
                let distance = Superposition::new(&points).rmsd(&self.motion);
                if nearest.as_ref().is_none_or(|(other, _)| distance < *other) {
                    nearest = Some((distance, pair));
                }
            }
            let Some((_, pair)) = nearest else {
                continue;
            };
            let added = backbone_pairs(self.user, self.native, pair.pairs.iter().copied());
            let points = [self.points.as_slice(), &added].concat();
            let all = Superposition::new(&points);
            let name = |native: usize| self.native.segments[native].chain();
            let mut own = self.chains.iter().filter(|chain| chain.user == user);
            let is_one_chain = own.all(|chain| name(chain.native) == name(pair.native));
            let is_by_no_chance = is_one_chain && pair.pairs.len() >= DISTINCTIVE;
            if all.rmsd(&all.best) <= MAX_FIT_RMSD || is_by_no_chance {
                self.take(pair);
            }
        }
    }

    /// Whether the user's chain is a copy of one that is placed: a native with fewer copies has none for it.
    fn is_copy_of_a_placed_one(&self, user: usize) -> bool {
        self.candidates.iter().any(|candidate| {
            candidate.pair.user == user
                && candidate.pair.is_identical()
                && self.chains.iter().any(|chain| {
                    chain.native == candidate.pair.native
                        && chain.user != user
                        && shares_residues(chain, &candidate.pair)
                })
        })
    }
}

/// Whether the two match the same residues of the native.
fn shares_residues(a: &ChainPair, b: &ChainPair) -> bool {
    let natives: Vec<usize> = a.pairs.iter().map(|&(_, native)| native).collect();
    b.pairs
        .iter()
        .filter(|(_, native)| natives.contains(native))
        .count()
        * 2
        > b.pairs.len()
}

/// Whether the equal residues are too many to be equal by chance.
fn is_distinctive(pair: &ChainPair) -> bool {
    let (least, share) = DISTINCTIVE_PEPTIDE;
    let equal = pair.pairs.len();
    let shorter = pair.lengths.0.min(pair.lengths.1);
    equal >= DISTINCTIVE || (equal >= least && equal as f64 >= share * shorter as f64)
}
