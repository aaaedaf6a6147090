//! The ways in which one docked side lies on the native: which of its chains is which copy, by superposition.
//!
//! A docked side is rigid, so one pair of chains fixes where all others must be. Each likely pair in turn is
//! superposed; then every other chain is given the native's chain that lies where it comes to stand, and what is left
//! of chains that one file has merged likewise. Copies elsewhere in the crystal are never mixed, whatever their
//! names, the order of the file and the residues that each copy lacks. For two identical chains these ways are their
//! orders that fit; for a ring of n they are its n rotations.
//!
//! A chain that finds nothing in its place is given the one chain of its sequence, even if that stands elsewhere (a
//! hinge, a domain that moved).

use crate::evaluate::chain_choice::ChainChoice;
use crate::evaluate::matching::chain_pair::{ChainPair, align_all};
use crate::evaluate::matching::placement::Placement;
use crate::evaluate::matching::placement_builder::{Builder, Candidate};
use crate::evaluate::matching::superposition::Superposition;
use crate::evaluate::residues::Residues;
use crate::evaluate::rmsd::backbone_pairs;

/// Pairs with less than this share of the largest's residues begin no placement.
const MIN_SEED: f64 = 0.2;
/// Most placements that are made: more than a capsid has chains.
const MAX_PLACEMENTS: usize = 256;
/// Pairs of fewer residues lie together by chance, where there are longer ones.
const MIN_PAIRS: usize = 3;

/// The ways in which the user's side may lie on the native, by chains that the user's choice allows, the pair with most
/// residues first. Empty when no sequence matches.
pub(in crate::evaluate) fn placements(
    user: &Residues,
    native: &Residues,
    choice: &ChainChoice,
) -> Vec<Placement> {
    let mut alike = align_all(user, native);
    alike.retain(|pair| {
        let segments = (&user.segments[pair.user], &native.segments[pair.native]);
        pair.is_alike() && choice.allows(segments.0, segments.1)
    });
    let largest = alike
        .iter()
        .map(|pair| pair.pairs.len())
        .max()
        .unwrap_or_default();
    let least = MIN_PAIRS.min(largest);
    let candidates: Vec<Candidate> = alike
        .into_iter()
        .filter(|pair| pair.pairs.len() >= least)
        .map(|mut pair| {
            let superposed = |pair: &ChainPair| {
                Superposition::new(&backbone_pairs(user, native, pair.pairs.iter().copied()))
            };
            let mut superposition = superposed(&pair);
            if pair.settle(user, native, &superposition.best) {
                superposition = superposed(&pair);
            }
            Candidate {
                pair,
                superposition,
            }
        })
        .collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::matching::superposition::MAX_FIT_RMSD;
    use crate::evaluate::test_molecules::{
        chain_of, helix, molecule, moved, numbers, random_sequence, renamed,
    };
    use knotdock_scoring::se3::Pose;
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
