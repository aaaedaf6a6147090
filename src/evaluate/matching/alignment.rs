//! Alignment of two chains: by residue number where the numbers agree, by sequence otherwise.
//!
//! The sequence alignment is Gotoh's (J. Mol. Biol. 162 (1982) 705-708, affine gaps, time and memory of the product
//! of the lengths) with free ends. Two equal residues that also agree in number score a little more than two that do
//! not. So the numbers decide where a gap could stand in several places alike: in a run of glycines, or at the edge
//! of a missing loop.

use std::collections::HashMap;

use crate::evaluate::residues::residue::{Number, Residue};

const MATCH: f64 = 5.0;
const MISMATCH: f64 = -2.0;
/// Added to a match of equal numbers: less than any difference that the sequence itself makes.
const SAME_NUMBER: f64 = 0.4;
/// Opening costs more than one match gains, so that the residues of a free end are not scattered one by one over a
/// long chain.
const GAP_OPEN: f64 = -8.0;
/// Missing loops are long and common: length costs little.
const GAP_EXTEND: f64 = -0.1;

/// Residues of two chains that stand for each other.
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

/// The place of each number; nothing where several residues have it, as in files without insertion codes.
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

/// Where a cell's best score came from: the state before it.
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

/// The better of the candidates; the earlier one on ties, so that the answer does not hang on chance.
fn best<const N: usize>(candidates: [(f64, State); N]) -> (f64, State) {
    let mut winner = (f64::NEG_INFINITY, State::Start);
    for candidate in candidates {
        if candidate.0 > winner.0 {
            winner = candidate;
        }
    }
    winner
}

fn align_sequences(first: &[&Residue], second: &[&Residue]) -> Alignment {
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
                (up.both + GAP_OPEN, State::Both),
                (up.first + GAP_EXTEND, State::First),
                (up.second + GAP_OPEN, State::Second),
            ]);
            let left = current[column];
            let (gap_second, from_second) = best([
                (left.both + GAP_OPEN, State::Both),
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
