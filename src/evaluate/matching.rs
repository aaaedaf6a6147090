//! Which chains, and so which residues, of the user's molecule are which of the native's.
//!
//! Every chain is aligned with every chain, whatever their names. The pair with most equal residues is taken first
//! (equal names win near-ties), its residues are set aside, and what is left is matched again. So chains that one file
//! holds under one name and the other under two find each other, in any order.

use super::alignment::align;
use super::residues::Residues;

/// A stretch of the user's chain matched with one of the native's.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ChainPair {
    /// Index of the user's segment.
    pub user: usize,
    /// Index of the native's segment.
    pub native: usize,
    /// Equal residues: (index of the user's, index of the native's).
    pub pairs: Vec<(usize, usize)>,
    /// Aligned places, equal or not.
    pub aligned: usize,
    /// Number of residues that were there to align, of the user's and of the native's.
    pub lengths: (usize, usize),
}

/// What is left of a chain after a match may be matched again if it has this many residues: fewer pair by chance.
const LEAST_REMAINDER: usize = 20;
/// And if what it pairs is at least this share of what it did while both chains were whole: else most of the other chain is a copy of what was
/// matched already, and the rest a loop that one copy lacks.
const LEAST_OF_WHOLE: f64 = 0.5;
/// Chains are one another's when at least this share of the shorter is equal.
const LEAST_IDENTITY: f64 = 0.5;
/// How much more the same name counts: it decides between identical chains, not between different ones.
const SAME_NAME: f64 = 1.05;

/// Residues not yet matched, of the user's molecule and of the native.
struct Free {
    user: Vec<bool>,
    native: Vec<bool>,
}

/// Aligns what is free of two segments.
fn align_segments(
    user: &Residues,
    native: &Residues,
    segments: (usize, usize),
    free: &Free,
) -> ChainPair {
    let left = |residues: &Residues, segment: usize, free: &[bool]| -> Vec<usize> {
        let members = residues.segments[segment].members.iter().copied();
        members.filter(|&member| free[member]).collect()
    };
    let ours = left(user, segments.0, &free.user);
    let theirs = left(native, segments.1, &free.native);
    let found = align(
        &ours.iter().map(|&i| &user.residues[i]).collect::<Vec<_>>(),
        &theirs
            .iter()
            .map(|&j| &native.residues[j])
            .collect::<Vec<_>>(),
    );
    ChainPair {
        user: segments.0,
        native: segments.1,
        pairs: found
            .pairs
            .iter()
            .map(|&(i, j)| (ours[i], theirs[j]))
            .collect(),
        aligned: found.aligned,
        lengths: (ours.len(), theirs.len()),
    }
}

/// Every segment of the user's molecule aligned with every one of the native's, rows by the user's.
pub(super) fn align_all(user: &Residues, native: &Residues) -> Vec<ChainPair> {
    let free = Free {
        user: vec![true; user.residues.len()],
        native: vec![true; native.residues.len()],
    };
    (0..user.segments.len())
        .flat_map(|u| (0..native.segments.len()).map(move |n| (u, n)))
        .map(|segments| align_segments(user, native, segments, &free))
        .collect()
}

/// Matches the chains of a molecule with those of the native; `all` is [`align_all`] of the two.
///
/// A chain stands in several of the pairs where one file has merged what the other keeps apart. No residue stands in two.
pub(super) fn pair_chains(user: &Residues, native: &Residues, all: &[ChainPair]) -> Vec<ChainPair> {
    let mut free = Free {
        user: vec![true; user.residues.len()],
        native: vec![true; native.residues.len()],
    };
    let mut candidates = all.to_vec();
    let mut taken = Vec::new();
    loop {
        let weight = |pair: &ChainPair| {
            let same = user.segments[pair.user].name == native.segments[pair.native].name;
            pair.pairs.len() as f64 * if same { SAME_NAME } else { 1.0 }
        };
        let whole = |pair: &ChainPair| {
            let place = pair.user * native.segments.len() + pair.native;
            all[place].pairs.len() as f64
        };
        let acceptable = |pair: &&ChainPair| {
            let (ours, theirs) = pair.lengths;
            let enough = |left: usize, whole: usize| left == whole || left >= LEAST_REMAINDER;
            !pair.pairs.is_empty()
                && enough(ours, user.segments[pair.user].members.len())
                && enough(theirs, native.segments[pair.native].members.len())
                && pair.pairs.len() as f64 >= LEAST_IDENTITY * ours.min(theirs) as f64
                && pair.pairs.len() as f64 >= LEAST_OF_WHOLE * whole(pair)
        };
        let mut best: Option<&ChainPair> = None;
        for pair in candidates.iter().filter(acceptable) {
            if best.is_none_or(|other| weight(pair) > weight(other)) {
                best = Some(pair);
            }
        }
        let Some(best) = best.cloned() else {
            return taken;
        };
        for &(i, j) in &best.pairs {
            free.user[i] = false;
            free.native[j] = false;
        }
        for pair in &mut candidates {
            if pair.user == best.user || pair.native == best.native {
                *pair = align_segments(user, native, (pair.user, pair.native), &free);
            }
        }
        taken.push(best);
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_molecules::{chain_of, molecule, numbers, random_sequence};
    use super::*;

    fn residues(chains: &[(&str, &str, i64)]) -> Residues {
        let atoms = chains
            .iter()
            .flat_map(|&(name, letters, first)| {
                chain_of(name, letters, &numbers(first, letters.len()))
            })
            .collect();
        Residues::of(&molecule(atoms), "receptor").unwrap()
    }

    /// (user chain, native chain, equal residues), in the order taken.
    fn matched(user: &Residues, native: &Residues) -> Vec<(String, String, usize)> {
        pair_chains(user, native, &align_all(user, native))
            .into_iter()
            .map(|pair| {
                (
                    user.segments[pair.user].name.clone(),
                    native.segments[pair.native].name.clone(),
                    pair.pairs.len(),
                )
            })
            .collect()
    }

    fn expected(rows: &[(&str, &str, usize)]) -> Vec<(String, String, usize)> {
        rows.iter()
            .map(|&(u, n, k)| (u.into(), n.into(), k))
            .collect()
    }

    #[test]
    fn chains_of_other_names_find_each_other() {
        let (heavy, light) = (random_sequence(1, 60), random_sequence(2, 50));
        let user = residues(&[("L", &light, 1), ("H", &heavy, 1)]);
        let native = residues(&[("A", &heavy, 301), ("B", &light, 1)]);
        assert_eq!(
            matched(&user, &native),
            expected(&[("H", "A", 60), ("L", "B", 50)])
        );
    }

    #[test]
    fn merged_chain_matches_two_in_either_order() {
        // Benchmark makers write an antibody's H and L as one chain; the user's file keeps two, or the reverse. Numbers
        // that begin again split the chain; running ones do not, and then the second match takes what the first left.
        let (heavy, light) = (random_sequence(3, 60), random_sequence(4, 50));
        let apart = residues(&[("L", &light, 1), ("H", &heavy, 1)]);
        for second_number in [1, 501] {
            let merged = residues(&[("A", &heavy, 1), ("A", &light, second_number)]);
            for (user, native) in [(&apart, &merged), (&merged, &apart)] {
                let sizes: Vec<_> = matched(user, native).into_iter().map(|row| row.2).collect();
                assert_eq!(sizes, [60, 50]);
            }
        }
    }

    #[test]
    fn names_decide_between_identical_chains_only() {
        let (one, other) = (random_sequence(5, 40), random_sequence(6, 40));
        let user = residues(&[("A", &one, 1), ("B", &one, 1)]);
        let native = residues(&[("B", &one, 1), ("A", &one, 1)]);
        assert_eq!(
            matched(&user, &native),
            expected(&[("A", "A", 40), ("B", "B", 40)])
        );
        let user = residues(&[("A", &one, 1)]);
        let native = residues(&[("A", &other, 1), ("B", &one, 1)]);
        assert_eq!(matched(&user, &native), expected(&[("A", "B", 40)]));
    }

    /// A loop that one copy lacks has no partner in another copy.
    #[test]
    fn what_is_left_of_a_copy_is_not_matched_with_another() {
        let one = random_sequence(9, 300);
        let without = |from: usize, to: usize| one[..from].to_owned() + &one[to..];
        let user = residues(&[("R", &one, 1)]);
        let native = residues(&[("A", &without(40, 65), 1), ("C", &without(100, 130), 1)]);
        assert_eq!(matched(&user, &native), expected(&[("R", "A", 275)]));
        // Of two copies either way, loops of the first are not matched with the second.
        let user = residues(&[("A", &one, 1), ("B", &without(40, 65), 1)]);
        assert_eq!(
            matched(&user, &native),
            expected(&[("A", "A", 275), ("B", "C", 245)])
        );
    }

    #[test]
    fn strangers_are_not_matched() {
        let user = residues(&[("A", &random_sequence(7, 100), 1)]);
        let native = residues(&[("A", &random_sequence(8, 100), 1)]);
        assert!(matched(&user, &native).is_empty());
    }
}
