//! The ways in which identical chains of one side may be matched with the native's.
//!
//! Trying all orders of n identical chains costs n! evaluations of a pose. Chains of one rigid side only ever fit the
//! native's in the orders that some rigid motion brings about, and such a motion is fixed by one pair of chains: so each
//! possible pair in turn is superposed, and the others are assigned, nearest first. For two chains these are all orders;
//! for a ring of n they are its n turns.

use knotdock_scoring::se3::Pose;

use super::matching::{ChainPair, align_all, pair_chains};
use super::residues::Residues;
use super::rmsd::backbone_pairs;
use super::superposition::Misfit;

/// Chains count as identical when this share of the shorter is equal: room for a few mutations and unlike ends.
const IDENTICAL: f64 = 0.9;
/// And this share of the longer, so that a fragment is no chain of its own.
const ALIKE_IN_LENGTH: f64 = 0.6;
/// Most ways kept of one side, the best-fitting ones: enough for every turn of an octahedral 24-mer.
const MOST: usize = 24;

/// One way of matching a side with the native's: its chain pairs.
pub(super) type Assignment = Vec<ChainPair>;

/// All equal residues of an assignment: (index of the user's, index of the native's).
pub(super) fn residue_pairs(assignment: &Assignment) -> impl Iterator<Item = (usize, usize)> + '_ {
    assignment
        .iter()
        .flat_map(|chain| chain.pairs.iter().copied())
}

/// The possible assignments of one side; first the one that names and identities suggest. Empty when nothing matches.
pub(super) fn assignments(user: &Residues, native: &Residues) -> Vec<Assignment> {
    let all = align_all(user, native);
    let base = pair_chains(user, native, &all);
    if base.is_empty() {
        return Vec::new();
    }
    // A chain that stands in several pairs is merged from several and has no single partner to exchange.
    let merged = |chain: &ChainPair| {
        base.iter().filter(|other| other.user == chain.user).count() > 1
            || base
                .iter()
                .filter(|other| other.native == chain.native)
                .count()
                > 1
    };
    let identical: Vec<(&ChainPair, Misfit)> = all
        .iter()
        .filter(|chain| {
            let (ours, theirs) = chain.lengths;
            let equal = chain.pairs.len() as f64;
            equal >= IDENTICAL * ours.min(theirs) as f64
                && equal >= ALIKE_IN_LENGTH * ours.max(theirs) as f64
                && !merged(chain)
        })
        .map(|chain| {
            (
                chain,
                Misfit::new(&backbone_pairs(user, native, chain.pairs.iter().copied())),
            )
        })
        .collect();
    let mut ranked: Vec<(f64, Assignment)> = Vec::new();
    for (_, anchor) in &identical {
        let (misfit, assignment) = assign_nearest(&identical, &anchor.best, &base);
        let known = |other: &Assignment| same_chains(other, &assignment);
        if !known(&base) && !ranked.iter().any(|(_, other)| known(other)) {
            ranked.push((misfit, assignment));
        }
    }
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let others = ranked.into_iter().map(|(_, assignment)| assignment);
    std::iter::once(base.clone())
        .chain(others)
        .take(MOST)
        .collect()
}

/// With the user's side moved by `motion`, gives each chain its nearest identical one, the nearest pair first; chains
/// without an identical partner keep the one they have in `base`. Also the mean squared distance of the pairs chosen.
fn assign_nearest(
    identical: &[(&ChainPair, Misfit)],
    motion: &Pose,
    base: &Assignment,
) -> (f64, Assignment) {
    let mut by_distance: Vec<_> = identical
        .iter()
        .map(|(chain, misfit)| (misfit.rmsd(motion), misfit, *chain))
        .collect();
    by_distance.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut chosen: Assignment = Vec::new();
    let (mut sum, mut count) = (0.0, 0.0);
    let taken = |chosen: &Assignment, chain: &ChainPair| {
        chosen
            .iter()
            .any(|other| other.user == chain.user || other.native == chain.native)
    };
    for (_, misfit, chain) in by_distance {
        if !taken(&chosen, chain) {
            chosen.push(chain.clone());
            sum += misfit.at(motion);
            count += misfit.count;
        }
    }
    let kept: Assignment = base
        .iter()
        .filter(|chain| !taken(&chosen, chain))
        .cloned()
        .collect();
    chosen.extend(kept);
    (sum / f64::max(count, 1.0), chosen)
}

fn same_chains(a: &Assignment, b: &Assignment) -> bool {
    let chains = |assignment: &Assignment| {
        let mut pairs: Vec<_> = assignment
            .iter()
            .map(|chain| (chain.user, chain.native))
            .collect();
        pairs.sort_unstable();
        pairs
    };
    chains(a) == chains(b)
}

#[cfg(test)]
mod tests {
    use super::super::test_molecules::{helix, molecule, moved, random_sequence, renamed};
    use super::*;

    /// A ring of `names.len()` copies of one chain about the z axis.
    fn ring(names: &[&str]) -> Residues {
        let one = helix("A", &random_sequence(9, 30), [20.0, 0.0, 0.0]);
        let atoms = names
            .iter()
            .enumerate()
            .flat_map(|(copy, name)| {
                let half = std::f64::consts::PI * copy as f64 / names.len() as f64;
                let turn = Pose::from_parts([half.cos(), 0.0, 0.0, half.sin()], [0.0; 3]);
                renamed(&moved(&one, &turn), name)
            })
            .collect();
        Residues::of(&molecule(atoms), "receptor").unwrap()
    }

    fn chains(assignment: &Assignment) -> Vec<usize> {
        let mut natives = vec![usize::MAX; 4];
        for chain in assignment {
            natives[chain.user] = chain.native;
        }
        natives
    }

    #[test]
    fn ring_of_four_has_its_four_turns() {
        let ring = ring(&["A", "B", "C", "D"]);
        let mut found: Vec<_> = assignments(&ring, &ring).iter().map(chains).collect();
        assert_eq!(found[0], [0, 1, 2, 3], "the names' own order comes first");
        found.sort();
        assert_eq!(
            found,
            [[0, 1, 2, 3], [1, 2, 3, 0], [2, 3, 0, 1], [3, 0, 1, 2]]
        );
    }

    #[test]
    fn one_chain_of_two_may_be_either_of_the_natives() {
        let (two, one) = (ring(&["A", "B"]), ring(&["A"]));
        assert_eq!(assignments(&two, &one).len(), 2);
        assert_eq!(assignments(&one, &two).len(), 2);
        assert_eq!(assignments(&one, &one).len(), 1);
    }
}
