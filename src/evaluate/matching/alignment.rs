//! Alignment of two chains: by residue number where the numbers agree, by sequence otherwise.
//!
//! The sequence alignment is Gotoh's (J. Mol. Biol. 162 (1982) 705-708, affine gaps, time and memory of the product
//! of the lengths) with free ends. If a gap fits several places alike, in a run of glycines or at the edge
//! of a missing loop, it goes where the chain that lacks the residues is broken. If nothing is broken there, numbers
//! decide: those that agree, and those that leave some out. The superposition decides the rest ([`settle`]).

use std::collections::HashMap;

use nalgebra::Point3;

use crate::evaluate::residues::residue::{Number, Residue};
use crate::evaluate::residues::segments::{Step, step};

const MATCH: f64 = 5.0;
const MISMATCH: f64 = -2.0;
/// Added to a match of equal numbers: less than any difference that the sequence itself makes.
const SAME_NUMBER: f64 = 0.4;
/// Added to a gap where the chain that lacks residues is broken, and where only its numbers leave some out: less than a
/// match and more than numbers that agree by chance.
const AT_BREAK: f64 = 2.5;
const AT_NUMBER_STEP: f64 = 0.2;
/// Opening costs more than one match gains, so that the residues of a free end are not scattered one by one over a
/// long chain.
const GAP_OPEN: f64 = -8.0;
/// Missing loops are long and common: length costs little.
const GAP_EXTEND: f64 = -0.1;

/// Residues of two chains that are aligned with each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::evaluate) struct Alignment {
    /// Places (in the first chain, in the second) of equal residues, rising in the first.
    pub pairs: Vec<(usize, usize)>,
    /// Aligned places, whether the residues are equal or not.
    pub aligned: usize,
}

/// Aligns two chains.
///
/// Numbers alone decide where they pair at least as many equal residues as the sequence does.
pub(in crate::evaluate) fn align(first: &[&Residue], second: &[&Residue]) -> Alignment {
    let by_number = pair_by_number(first, second);
    if by_number.pairs.len() == first.len().min(second.len()) {
        return by_number;
    }
    let by_sequence = align_sequences(first, second);
    if by_number.pairs.len() >= by_sequence.pairs.len() {
        by_number
    } else {
        by_sequence
    }
}

fn pair_by_number(first: &[&Residue], second: &[&Residue]) -> Alignment {
    let (ours, places) = (places_by_number(first), places_by_number(second));
    let mut found = Alignment::default();
    for (place, residue) in first.iter().enumerate() {
        let is_single = ours.get(&residue.number) == Some(&Some(place));
        if let Some(&Some(other)) = places.get(&residue.number).filter(|_| is_single) {
            found.aligned += 1;
            if residue.kind == second[other].kind {
                found.pairs.push((place, other));
            }
        }
    }
    found
}

/// The place of each number; `None` if several residues have it, as in files without insertion codes.
fn places_by_number(residues: &[&Residue]) -> HashMap<Number, Option<usize>> {
    let mut places = HashMap::new();
    for (place, residue) in residues.iter().enumerate() {
        let known = places.entry(residue.number).or_insert(Some(place));
        if *known != Some(place) {
            *known = None;
        }
    }
    places
}

/// State before a cell's best score.
#[derive(Clone, Copy, PartialEq)]
enum State {
    /// Both residues aligned.
    Both,
    /// Residue of the first chain against a gap.
    First,
    /// Residue of the second chain against a gap.
    Second,
    /// Nothing aligned yet: the free end.
    Start,
}

/// The three scores of a cell, for alignments that end in each state.
#[derive(Clone, Copy)]
struct Cell {
    both: f64,
    first: f64,
    second: f64,
}

impl Cell {
    const EDGE: Cell = Cell {
        both: f64::NEG_INFINITY,
        first: f64::NEG_INFINITY,
        second: f64::NEG_INFINITY,
    };
}

/// The best of the candidates; the first of equal ones.
fn best<const N: usize>(candidates: [(f64, State); N]) -> (f64, State) {
    let mut winner = (f64::NEG_INFINITY, State::Start);
    for candidate in candidates {
        if candidate.0 > winner.0 {
            winner = candidate;
        }
    }
    winner
}

/// Score of a gap after each residue of the chain that lacks residues.
fn gap_scores(chain: &[&Residue]) -> Vec<f64> {
    let scores = chain.windows(2).map(|pair| match step(pair[0], pair[1]) {
        Step::Joined => GAP_OPEN,
        Step::Numbered => GAP_OPEN + AT_NUMBER_STEP,
        Step::Broken => GAP_OPEN + AT_BREAK,
    });
    scores.chain([GAP_OPEN]).collect()
}

fn align_sequences(first: &[&Residue], second: &[&Residue]) -> Alignment {
    let (open_first, open_second) = (gap_scores(first), gap_scores(second));
    let (rows, columns) = (first.len(), second.len());
    let mut traces = vec![[State::Start; 3]; rows * columns];
    let mut above = vec![Cell::EDGE; columns + 1];
    let mut end = (f64::NEG_INFINITY, 0, 0);
    for row in 0..rows {
        let mut current = vec![Cell::EDGE; columns + 1];
        for column in 0..columns {
            let score = if first[row].kind != second[column].kind {
                MISMATCH
            } else if first[row].number == second[column].number {
                MATCH + SAME_NUMBER
            } else {
                MATCH
            };
            let diagonal = above[column];
            // Only an alignment that begins at an edge of the table begins free of charge.
            let start = if row == 0 || column == 0 {
                0.0
            } else {
                f64::NEG_INFINITY
            };
            let (both, from_both) = best([
                (diagonal.both, State::Both),
                (diagonal.first, State::First),
                (diagonal.second, State::Second),
                (start, State::Start),
            ]);
            let up = above[column + 1];
            let (gap_first, from_first) = best([
                (up.both + open_second[column], State::Both),
                (up.first + GAP_EXTEND, State::First),
                (up.second + GAP_OPEN, State::Second),
            ]);
            let left = current[column];
            let (gap_second, from_second) = best([
                (left.both + open_first[row], State::Both),
                (left.first + GAP_OPEN, State::First),
                (left.second + GAP_EXTEND, State::Second),
            ]);
            current[column + 1] = Cell {
                both: both + score,
                first: gap_first,
                second: gap_second,
            };
            traces[row * columns + column] = [from_both, from_first, from_second];
            if (row + 1 == rows || column + 1 == columns) && both + score > end.0 {
                end = (both + score, row, column);
            }
        }
        above = current;
    }
    trace_back(first, second, &traces, end)
}

/// Moves gaps that fit several places alike to where the superposed residues are nearest each other.
///
/// `pairs` are places in the two chains, and `moved` superposes the first on the second. Gaps at which numbers or bonds
/// decide stay. Returns whether any moved.
pub(in crate::evaluate) fn settle(
    first: &[&Residue],
    second: &[&Residue],
    pairs: &mut [(usize, usize)],
    moved: impl Fn(Point3<f64>) -> Point3<f64>,
) -> bool {
    // Mean square distance of the backbone atoms that both have.
    let distance = |(i, j): (usize, usize)| {
        let atoms = first[i].backbone.iter().zip(&second[j].backbone);
        let both = atoms.filter_map(|(x, y)| (*x).zip(*y));
        let squares = both.map(|(x, y)| nalgebra::distance_squared(&moved(x), &y));
        match squares.clone().count() {
            0 => f64::INFINITY,
            count => squares.sum::<f64>() / count as f64,
        }
    };
    let mut any = false;
    for at in 1..pairs.len() {
        // A gap before pair `at` moves to the left as long as that brings residues nearer.
        let (mut left, mut moved_left) = (at, false);
        while left > 0 {
            let ((i, j), (next_i, next_j)) = (pairs[left - 1], pairs[left]);
            let new = match (next_i - i, next_j - j) {
                (2.., 1) if j > 0 && are_alike(second, j - 1, j) => (next_i - 1, j),
                (1, 2..) if i > 0 && are_alike(first, i - 1, i) => (i, next_j - 1),
                _ => break,
            };
            let fits = first[new.0].kind == second[new.1].kind;
            if !fits || distance(new) >= distance((i, j)) {
                break;
            }
            pairs[left - 1] = new;
            (left, moved_left) = (left - 1, true);
        }
        // If it did not, it may move to the right, pair by pair.
        let mut right = at;
        while !moved_left && right < pairs.len() {
            let ((i, j), (next_i, next_j)) = (pairs[right - 1], pairs[right]);
            let new = match (next_i - i, next_j - j) {
                (2.., 1) if are_alike(second, j, next_j) => (i + 1, next_j),
                (1, 2..) if are_alike(first, i, next_i) => (next_i, j + 1),
                _ => break,
            };
            let fits = first[new.0].kind == second[new.1].kind;
            if !fits || distance(new) >= distance((next_i, next_j)) {
                break;
            }
            pairs[right] = new;
            (right, any) = (right + 1, true);
        }
        any |= moved_left;
    }
    any
}

/// Whether a gap after one residue of a chain shows as little as one after another.
fn are_alike(chain: &[&Residue], one: usize, other: usize) -> bool {
    let shown = |place: usize| chain.get(place + 1).map(|after| step(chain[place], after));
    shown(one) == shown(other)
}

fn trace_back(
    first: &[&Residue],
    second: &[&Residue],
    traces: &[[State; 3]],
    (score, mut row, mut column): (f64, usize, usize),
) -> Alignment {
    let mut found = Alignment::default();
    if score <= 0.0 {
        return found;
    }
    let mut state = State::Both;
    loop {
        let [from_both, from_first, from_second] = traces[row * second.len() + column];
        let (before, up, left) = match state {
            State::Both => {
                found.aligned += 1;
                if first[row].kind == second[column].kind {
                    found.pairs.push((row, column));
                }
                (from_both, 1, 1)
            }
            State::First => (from_first, 1, 0),
            State::Second => (from_second, 0, 1),
            State::Start => break,
        };
        if before == State::Start || row < up || column < left {
            break;
        }
        (state, row, column) = (before, row - up, column - left);
    }
    found.pairs.reverse();
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::residues::Residues;
    use crate::evaluate::test_molecules::{chain_of, molecule};

    /// Aligns two one-letter sequences with the residue numbers given.
    fn pairs(first: (&str, &[i64]), second: (&str, &[i64])) -> Vec<(usize, usize)> {
        let read = |(letters, numbers): (&str, &[i64])| {
            Residues::of(&molecule(chain_of("A", letters, numbers)), "receptor").unwrap()
        };
        let (a, b) = (read(first), read(second));
        align(
            &a.residues.iter().collect::<Vec<_>>(),
            &b.residues.iter().collect::<Vec<_>>(),
        )
        .pairs
    }

    #[test]
    fn off_by_one_over_a_run_is_matched_by_sequence() {
        // The ligand of 1OPH in docking benchmark 5: numbers agree first, then differ by one.
        let found = pairs(
            ("ACDEFGHIKL", &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10]),
            ("ACDEFGHIKL", &[1, 2, 3, 5, 6, 7, 8, 9, 10, 11]),
        );
        assert_eq!(found, (0..10).map(|i| (i, i)).collect::<Vec<_>>());
    }

    #[test]
    fn numbers_place_the_gap_that_the_sequence_leaves_open() {
        // Three glycines against two: only the numbers say that the first is the missing one.
        let found = pairs(
            ("WYWGGGFYF", &[1, 2, 3, 4, 5, 6, 7, 8, 9]),
            ("WYWGGFYF", &[1, 2, 3, 5, 6, 7, 8, 9]),
        );
        assert_eq!(found[3], (4, 3));
        // The same where a mutation elsewhere and a shifted tail keep numbers alone from winning.
        let found = pairs(
            (
                "WYWGGGFYFACDE",
                &[1, 2, 3, 4, 5, 6, 7, 8, 9, 20, 21, 22, 23],
            ),
            ("WYWGGFYFACDE", &[1, 2, 3, 5, 6, 7, 8, 9, 30, 31, 32, 33]),
        );
        assert_eq!(found[3], (4, 3));
        assert_eq!(found.len(), 12);
    }

    /// Found with a model numbered from 1 and a native that lacks the second of two glycines: the first was left out.
    #[test]
    fn a_gap_is_where_the_chain_is_broken() {
        let whole: Vec<i64> = (1..=9).collect();
        let native = chain_of("A", "WYWGGCFYF", &(21..=29).collect::<Vec<_>>());
        for missing in [24, 25] {
            for numbers in [false, true] {
                // Numbers that run on say nothing; the broken bond does.
                let mut atoms = native.clone();
                atoms.retain(|atom| atom.residue_number != missing);
                for atom in atoms
                    .iter_mut()
                    .filter(|atom| !numbers && atom.residue_number > missing)
                {
                    atom.residue_number -= 1;
                }
                let read = |atoms| Residues::of(&molecule(atoms), "receptor").unwrap();
                let (user, native) = (read(chain_of("A", "WYWGGCFYF", &whole)), read(atoms));
                let found = align(
                    &user.residues.iter().collect::<Vec<_>>(),
                    &native.residues.iter().collect::<Vec<_>>(),
                );
                assert_eq!(found.pairs.len(), 8);
                let kept = if missing == 24 { 4 } else { 3 };
                assert_eq!(found.pairs[3], (kept, 3), "{missing} {numbers}");
            }
        }
    }

    /// Where neither numbers nor bonds say which of two is missing, the superposed chains do.
    #[test]
    fn the_superposition_decides_what_is_left_open() {
        let read = |atoms| Residues::of(&molecule(atoms), "receptor").unwrap();
        let user = read(chain_of("A", "WYWGGGCFYF", &(1..=10).collect::<Vec<_>>()));
        for missing in 4..=6 {
            let mut atoms = chain_of("A", "WYWGGGCFYF", &(1..=10).collect::<Vec<_>>());
            // Oxygens alone show no bonds.
            atoms.retain(|atom| atom.residue_number != missing && atom.name == "O");
            let native = read(atoms);
            let [ours, theirs] =
                [&user, &native].map(|one| one.residues.iter().collect::<Vec<_>>());
            for start in 4..=6 {
                let mut pairs: Vec<(usize, usize)> =
                    (0..10).filter(|&i| i + 1 != start).zip(0..).collect();
                settle_all(&ours, &theirs, &mut pairs);
                assert_eq!(
                    pairs[missing as usize - 1].0,
                    missing as usize,
                    "{missing} {start}"
                );
                assert!(pairs[..missing as usize - 1].iter().all(|(i, j)| i == j));
            }
        }
    }

    fn settle_all(ours: &[&Residue], theirs: &[&Residue], pairs: &mut [(usize, usize)]) {
        let mut numbered: Vec<Residue> = theirs.iter().map(|&one| one.clone()).collect();
        for (place, residue) in numbered.iter_mut().enumerate() {
            // Numbers that show nothing.
            residue.number = (3 * place as i64, None);
        }
        let theirs: Vec<&Residue> = numbered.iter().collect();
        settle(ours, &theirs, pairs, |point| point);
    }

    #[test]
    fn no_residue_is_paired_twice_where_numbers_come_again() {
        let numbers = &[1, 2, 2, 3, 4];
        let found = pairs(("AGGVL", numbers), ("AGGVL", numbers));
        assert_eq!(found, (0..5).map(|i| (i, i)).collect::<Vec<_>>());
    }

    #[test]
    fn mutated_residue_is_aligned_but_not_paired() {
        let found = pairs(("ACDEF", &[1, 2, 3, 4, 5]), ("ACWEF", &[1, 2, 3, 4, 5]));
        assert_eq!(found, [(0, 0), (1, 1), (3, 3), (4, 4)]);
    }

    #[test]
    fn fragment_is_found_inside_a_long_chain() {
        let found = pairs(
            ("EFGH", &[1, 2, 3, 4]),
            ("ACDEFGHIKLMN", &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]),
        );
        assert_eq!(found, [(0, 3), (1, 4), (2, 5), (3, 6)]);
    }

    #[test]
    fn unlike_chains_share_nothing() {
        assert!(pairs(("AAAA", &[1, 2, 3, 4]), ("WWWW", &[5, 6, 7, 8])).is_empty());
    }
}
