//! Placements of one docked side on the native: which of its chains is which copy, by superposition.
//!
//! A docked side is rigid, so one pair of chains fixes where all others must be. Each likely pair in turn is
//! superposed; then every other chain is assigned the native's chain in its place, and so is the rest of chains that one
//! file has merged. Copies elsewhere in the crystal are never mixed, whatever their names, the order of the file and the
//! residues that each copy lacks. For two identical chains the placements are their orders that fit; for a ring of n they
//! are its n rotations.
//!
//! A chain with nothing in its place is assigned the one chain of its sequence, even if that is elsewhere (a hinge, a
//! domain that moved).

use knotdock_scoring::se3::Pose;
use nalgebra::{Point3, Vector3};

use crate::evaluate::chain_choice::ChainChoice;
use crate::evaluate::matching::chain_pair::{ChainPair, align_members};
use crate::evaluate::matching::superposition::{MAX_FIT_RMSD, PointPair, Superposition};
use crate::evaluate::residues::Residues;
use crate::evaluate::rmsd::backbone_pairs;

/// Pairs with less than this share of the largest's residues begin no placement.
const MIN_SEED: f64 = 0.2;
/// Most placements that are made: more than a capsid has chains.
const MAX_PLACEMENTS: usize = 256;
/// Pairs of fewer residues are near by chance, if there are longer ones.
const MIN_PAIRS: usize = 3;
/// Equal residues that a chain has by no chance.
const DISTINCTIVE: usize = 20;
/// Fewer are distinctive too, from the first number on, if the share of equal residues is at least the second.
const DISTINCTIVE_PEPTIDE: (usize, f64) = (8, 0.9);
/// Fewest equal residues in the rest of two merged chains: fewer pair by chance.
const MIN_OF_TWO_REMAINDERS: usize = 8;
/// The rest of a chain is elsewhere only if it has this share of the pairs of the whole chain: else the other
/// chain is a copy of a matched one.
const MIN_OF_WHOLE: f64 = 0.9;
/// Largest RMSD in Å of the rest of two chains from their place in the rest of the side.
const REACH_OF_REMAINDERS: f64 = 5.0;

/// A placement: one way to superpose a docked side on the native.
#[derive(Clone, Debug)]
pub(in crate::evaluate) struct Placement {
    /// Matched residues, chain by chain. No residue is in two.
    pub chains: Vec<ChainPair>,
    /// Takes the side from its own frame to the native's.
    pub motion: Pose,
    /// Backbone RMSD in Å of all matched residues after `motion`.
    pub rmsd: f64,
}

impl Placement {
    /// All equal residues: (index of the docked residue, index of the native's).
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.chains
            .iter()
            .flat_map(|chain| chain.pairs.iter().copied())
    }

    /// Number of equal residues.
    pub fn matched(&self) -> usize {
        self.chains.iter().map(|chain| chain.pairs.len()).sum()
    }

    /// Number of equal residues in chains of equal names.
    pub fn same_named(&self, user: &Residues, native: &Residues) -> usize {
        let chains = self.chains.iter();
        let same = chains.filter(|pair| {
            let (user, native) = pair.names(user, native);
            user == native
        });
        same.map(|pair| pair.pairs.len()).sum()
    }

    /// Equal residues as a share, 0 to 1, of all aligned ones.
    pub fn identity(&self) -> f64 {
        let aligned: usize = self.chains.iter().map(|chain| chain.aligned).sum();
        self.matched() as f64 / aligned.max(1) as f64
    }

    /// Indices of the native's segments that have part in it, rising.
    pub fn native_segments(&self) -> Vec<usize> {
        let mut segments: Vec<usize> = self.chains.iter().map(|chain| chain.native).collect();
        segments.sort_unstable();
        segments.dedup();
        segments
    }

    /// Indices of the native's matched residues, rising.
    pub fn natives(&self) -> Vec<usize> {
        let mut natives: Vec<usize> = self.pairs().map(|(_, native)| native).collect();
        natives.sort_unstable();
        natives
    }

    /// All equal residues, rising.
    pub fn sorted_pairs(&self) -> Vec<(usize, usize)> {
        let mut pairs: Vec<_> = self.pairs().collect();
        pairs.sort_unstable();
        pairs
    }
}

/// The placements of a docked side on the native, by chains that the user's choice allows, the pair with most
/// residues first. Empty when no sequence matches.
pub(in crate::evaluate) fn placements(
    user: &Residues,
    native: &Residues,
    choice: &ChainChoice,
) -> Vec<Placement> {
    let mut alike = Vec::new();
    for (u, docked) in user.segments.iter().enumerate() {
        for (n, other) in native.segments.iter().enumerate() {
            if choice.allows(docked, other) {
                let members = ((u, &docked.members[..]), (n, &other.members[..]));
                alike.push(align_members(user, native, members.0, members.1));
            }
        }
    }
    alike.retain(ChainPair::is_alike);
    let sizes = alike.iter().map(|pair| pair.pairs.len());
    let largest = sizes.max().unwrap_or_default();
    alike.retain(|pair| pair.pairs.len() >= MIN_PAIRS.min(largest));
    let candidate = |mut pair: ChainPair| {
        let superposed =
            |pair: &ChainPair| Superposition::new(&backbone_pairs(user, native, &pair.pairs));
        let mut superposition = superposed(&pair);
        if pair.settle(user, native, &superposition.best) {
            superposition = superposed(&pair);
        }
        Candidate {
            pair,
            superposition,
        }
    };
    let candidates: Vec<Candidate> = alike.into_iter().map(candidate).collect();
    let size = |candidate: &Candidate| candidate.pair.pairs.len();
    let mut seeds: Vec<&Candidate> = candidates
        .iter()
        .filter(|seed| size(seed) as f64 >= MIN_SEED * largest as f64)
        .collect();
    seeds.sort_by_key(|seed| std::cmp::Reverse(size(seed)));
    let mut found: Vec<Placement> = Vec::new();
    let mut made = 0;
    for seed in seeds {
        if found.iter().any(|known| known.chains.contains(&seed.pair)) {
            continue;
        }
        if made == MAX_PLACEMENTS {
            break;
        }
        made += 1;
        let placement = Builder::new(user, native, &candidates, choice).grow_from(seed);
        let pairs = placement.sorted_pairs();
        if !found.iter().any(|known| known.sorted_pairs() == pairs) {
            found.push(placement);
        }
    }
    found
}

/// Two chains of like sequence and their superposition.
struct Candidate {
    pair: ChainPair,
    superposition: Superposition,
}

/// Largest RMSD in Å of that many residues from their place in the rest of the side.
fn reach(residues: usize) -> f64 {
    match residues {
        0..=3 => 3.0,
        4..DISTINCTIVE => 8.0,
        _ => 10.0,
    }
}

/// A placement in the making.
struct Builder<'a> {
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
    fn new(
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
    fn grow_from(mut self, seed: &Candidate) -> Placement {
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
        let added = backbone_pairs(self.user, self.native, &pair.pairs);
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

    /// Gives each whole chain the native's chain in its place: many residues and a near fit first.
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

    /// Matches the rest of merged chains with the native's residues in their place.
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

    /// The remainders of two chains, of which one at least is matched in part, if they are alike and near each other, with
    /// their worth.
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
        let points = backbone_pairs(self.user, self.native, &pair.pairs);
        let superposition = Superposition::new(&points);
        let worth = superposition.count - superposition.at(&self.motion) / (reach * reach);
        (pair.is_alike() && worth > 0.0).then_some((worth, pair))
    }

    /// Whether the balls about these residues come near each other once the user's are moved.
    fn are_near(&self, ours: &[usize], theirs: &[usize]) -> bool {
        let ball = |residues: &Residues, members: &[usize]| {
            let centers = members
                .iter()
                .map(|&member| residues.residues[member].center);
            let coords = centers.clone().map(|point| point.coords);
            let center = Point3::from(coords.sum::<Vector3<f64>>() / members.len() as f64);
            let distances = centers.map(|point| nalgebra::distance(&point, &center));
            (center, distances.fold(0.0, f64::max))
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
            let of_chain = self.candidates.iter().filter(|one| one.pair.user == user);
            for candidate in of_chain {
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
                let points = backbone_pairs(self.user, self.native, &pair.pairs);
                let distance = Superposition::new(&points).rmsd(&self.motion);
                if nearest.as_ref().is_none_or(|(other, _)| distance < *other) {
                    nearest = Some((distance, pair));
                }
            }
            let Some((_, pair)) = nearest else {
                continue;
            };
            let added = backbone_pairs(self.user, self.native, &pair.pairs);
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
    let shared = b
        .pairs
        .iter()
        .filter(|(_, native)| natives.contains(native));
    2 * shared.count() > b.pairs.len()
}

/// Whether the equal residues are too many to be equal by chance.
fn is_distinctive(pair: &ChainPair) -> bool {
    let (least, share) = DISTINCTIVE_PEPTIDE;
    let equal = pair.pairs.len();
    let shorter = pair.lengths.0.min(pair.lengths.1);
    equal >= DISTINCTIVE || (equal >= least && equal as f64 >= share * shorter as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::test_molecules::{
        chain_of, helix, molecule, moved, numbers, random_sequence, renamed,
    };
    use knotdock_structures::molecule::Atom;

    fn residues(atoms: &[Atom]) -> Residues {
        Residues::of(&molecule(atoms.to_vec()), "receptor").unwrap()
    }

    /// Chains by name, sequence and first number, side by side in the order given.
    fn chains(rows: &[(&str, &str, i64, f64)]) -> Vec<Atom> {
        let chain = |&(name, letters, first, x): &(&str, &str, i64, f64)| {
            let aside = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
            moved(
                &chain_of(name, letters, &numbers(first, letters.len())),
                &aside,
            )
        };
        rows.iter().flat_map(chain).collect()
    }

    /// (user chain, native chain, equal residues) of the first placement, sorted.
    fn matched(user: &[Atom], native: &[Atom]) -> Vec<(String, String, usize)> {
        let (user, native) = (residues(user), residues(native));
        let found = placements(&user, &native, &ChainChoice::default());
        let mut rows: Vec<_> = found[0]
            .chains
            .iter()
            .map(|pair| {
                (
                    user.segments[pair.user].name.clone(),
                    native.segments[pair.native].name.clone(),
                    pair.pairs.len(),
                )
            })
            .collect();
        rows.sort();
        rows
    }

    fn expected(rows: &[(&str, &str, usize)]) -> Vec<(String, String, usize)> {
        let owned = |&(u, n, k): &(&str, &str, usize)| (u.to_owned(), n.to_owned(), k);
        rows.iter().map(owned).collect()
    }

    #[test]
    fn chains_of_other_names_find_each_other() {
        let (heavy, light) = (random_sequence(1, 60), random_sequence(2, 50));
        let user = chains(&[("L", &light, 1, 12.0), ("H", &heavy, 1, 0.0)]);
        let native = chains(&[("A", &heavy, 301, 0.0), ("B", &light, 1, 12.0)]);
        assert_eq!(
            matched(&user, &native),
            expected(&[("H", "A", 60), ("L", "B", 50)])
        );
    }

    #[test]
    fn merged_chain_matches_two_in_either_order() {
        // Benchmark makers write an antibody's H and L as one chain; the user's file keeps two, or the reverse. Numbers
        // that begin again or run on split the chain; a gap that may be a loop does not, and then what the first match
        // left is matched.
        let (heavy, light) = (random_sequence(3, 60), random_sequence(4, 50));
        let split = chains(&[("L", &light, 1, 12.0), ("H", &heavy, 1, 0.0)]);
        for second_number in [1, 61, 101, 501] {
            let merged = chains(&[("A", &heavy, 1, 0.0), ("A", &light, second_number, 12.0)]);
            for (user, native) in [(&split, &merged), (&merged, &split)] {
                let mut sizes: Vec<_> =
                    matched(user, native).into_iter().map(|row| row.2).collect();
                sizes.sort_unstable();
                assert_eq!(sizes, [50, 60], "{second_number}");
            }
        }
    }

    #[test]
    fn short_pieces_of_a_merged_chain_are_matched() {
        // Eleven residues each: what is left of a merged chain used to count only from 20 on.
        let (one, other) = (random_sequence(11, 11), random_sequence(12, 11));
        let merged = chains(&[("B", &one, 1, 0.0), ("B", &other, 12, 12.0)]);
        let split = chains(&[("C", &one, 1, 0.0), ("D", &other, 1, 12.0)]);
        let sizes = |rows: Vec<(String, String, usize)>| -> usize {
            assert_eq!(rows.len(), 2);
            rows.iter().map(|row| row.2).sum()
        };
        assert_eq!(sizes(matched(&merged, &split)), 22);
        assert_eq!(sizes(matched(&split, &merged)), 22);
        let unsplit = chains(&[("B", &one, 1, 0.0), ("B", &other, 50, 12.0)]);
        assert_eq!(residues(&unsplit).segments.len(), 1);
        assert_eq!(sizes(matched(&unsplit, &split)), 22);
    }

    /// A loop that one copy lacks has no partner in another copy.
    #[test]
    fn what_is_left_of_a_copy_is_not_matched_with_another() {
        let one = random_sequence(9, 300);
        let without = |name: &str, x: f64, from: i64, to: i64| -> Vec<Atom> {
            let atoms = chains(&[(name, &one, 1, x)]);
            let kept = atoms.into_iter();
            kept.filter(|atom| !(from..to).contains(&atom.residue_number))
                .collect()
        };
        let user = chains(&[("R", &one, 1, 0.0)]);
        let native = [without("A", 0.0, 41, 66), without("C", 40.0, 101, 131)].concat();
        assert_eq!(matched(&user, &native), expected(&[("R", "A", 275)]));
        // Of two copies either way, loops of the first are not matched with the second.
        let user = [chains(&[("A", &one, 1, 0.0)]), without("B", 40.0, 41, 66)].concat();
        assert_eq!(
            matched(&user, &native),
            expected(&[("A", "A", 275), ("B", "C", 245)])
        );
    }

    #[test]
    fn a_chain_elsewhere_is_matched_all_the_same() {
        let (heavy, light) = (random_sequence(3, 60), random_sequence(4, 50));
        let user = residues(&chains(&[("H", &heavy, 1, 0.0), ("L", &light, 1, 12.0)]));
        for x in [24.0, 82.0] {
            let native = residues(&chains(&[("A", &heavy, 1, 0.0), ("B", &light, 1, x)]));
            let found = placements(&user, &native, &ChainChoice::default());
            assert_eq!(found[0].matched(), 110);
            assert_eq!(found[0].rmsd > MAX_FIT_RMSD, x > 80.0);
        }
    }

    #[test]
    fn strangers_are_not_matched() {
        let user = residues(&chains(&[("A", &random_sequence(7, 100), 1, 0.0)]));
        let native = residues(&chains(&[("A", &random_sequence(8, 100), 1, 0.0)]));
        assert!(placements(&user, &native, &ChainChoice::default()).is_empty());
    }

    /// A ring of `names.len()` copies of one chain about the z axis.
    fn ring(names: &[&str]) -> Residues {
        let one = helix("A", &random_sequence(9, 30), [20.0, 0.0, 0.0]);
        let copies = names.iter().enumerate().flat_map(|(copy, name)| {
            let half = std::f64::consts::PI * copy as f64 / names.len() as f64;
            let turn = Pose::from_parts([half.cos(), 0.0, 0.0, half.sin()], [0.0; 3]);
            renamed(&moved(&one, &turn), name)
        });
        residues(&copies.collect::<Vec<_>>())
    }

    fn natives(placement: &Placement) -> Vec<usize> {
        let mut natives = vec![usize::MAX; 4];
        for chain in &placement.chains {
            natives[chain.user] = chain.native;
        }
        natives
    }

    #[test]
    fn ring_of_four_has_its_four_rotations() {
        let ring = ring(&["A", "B", "C", "D"]);
        let mut found: Vec<_> = placements(&ring, &ring, &ChainChoice::default())
            .iter()
            .map(natives)
            .collect();
        found.sort();
        assert_eq!(
            found,
            [[0, 1, 2, 3], [1, 2, 3, 0], [2, 3, 0, 1], [3, 0, 1, 2]]
        );
    }

    #[test]
    fn one_chain_of_two_may_be_either_of_the_natives() {
        let (two, one) = (ring(&["A", "B"]), ring(&["A"]));
        let count = |user, native| placements(user, native, &ChainChoice::default()).len();
        assert_eq!(count(&two, &one), 2);
        assert_eq!(count(&one, &two), 2);
        assert_eq!(count(&one, &one), 1);
    }
}
