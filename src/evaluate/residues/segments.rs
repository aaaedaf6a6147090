//! Boundaries of chains that share one name.
//!
//! Many programs write several chains under one name: an antibody's H and L, both partners of a complex, the two
//! strands of a duplex. A new segment begins
//!
//! - where a residue number comes again, or falls;
//! - where the file itself ends a chain (a TER record), unless a missing loop may be there: PyMOL writes TER at every
//!   gap;
//! - where the backbone is broken and the numbers leave no room for unresolved residues: consecutive numbers without
//!   a bond from C to N (O3' to P), or a gap too wide for the numbers;
//! - where a nucleic acid follows a protein, or the reverse;
//! - where the numbers leap by a hundred or more, which is how the makers of docking benchmark 5 distinguish merged
//!   chains (both copies of a homodimer as 377-576 and 1375-1576, in 1AZS).
//!
//! Residues that are bonded to each other are only parted by a leap: files without insertion codes repeat numbers
//! within a chain. Only a number that comes again makes pieces of less than three residues. A chain that is cut at
//! a gap does no harm: all its pieces are matched.

use std::collections::HashSet;

use crate::evaluate::residues::residue::{
    LINKING_OXYGEN, Number, PHOSPHATE_BOND, PHOSPHORUS, Residue,
};

/// Smallest step in residue numbers that begins a new segment.
const LEAP: i64 = 100;
/// Only with this many residues on both sides of it: shorter pieces stay with their chain.
const MIN_PIECE: usize = 20;

/// Fewest residues of a chain that does not begin with a number that comes again.
const MIN_CHAIN: usize = 3;

/// If more than this share of consecutive residues is not bonded, bonds are no evidence of chains: a crude model.
const BROKEN: f64 = 0.05;

/// Longest C-N distance of a peptide bond in Å, with room for poor structures.
const PEPTIDE_BOND: f64 = 2.5;
/// CA-CA distances of neighbours in Å, for files that hold nothing else.
const ALPHA_CARBONS: std::ops::RangeInclusive<f64> = 2.0..=5.0;
/// Longest distance in Å of O3' from the next O5', if the phosphate between them is not in the file.
const OXYGENS: f64 = 4.5;
/// Most that a missing residue spans, in Å: an amino acid and a nucleotide.
const SPANS: [f64; 2] = [3.8, 7.5];
/// Longest gap in Å that numbers with an insertion code may hide: a residue or two that the numbering does not count.
const UNCOUNTED: f64 = 12.0;

/// Longest gap in residues and in Å in which a TER record does not end the chain.
const MAX_GAP_LENGTH: (i64, f64) = (60, 40.0);

/// Places of CA, C, N and O5' among the backbone atoms.
const ALPHA_CARBON: usize = 0;
const CARBON: usize = 1;
const NITROGEN: usize = 2;
const FIVE_PRIME_OXYGEN: usize = 10;

/// Link between two residues in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Link {
    Bonded,
    /// Distance in Å, and the most that a missing residue spans, in Å.
    Distant(f64, f64),
    /// The atoms that would show it are not in the file.
    Unknown,
}

/// Evidence in the file of unresolved residues between two consecutive ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in crate::evaluate) enum Step {
    /// Bonded, or of consecutive numbers where no atoms show a bond.
    Joined,
    /// Bonded, but the numbers leave some out.
    Numbered,
    /// Not bonded, or not of consecutive numbers where no atoms show a bond.
    Broken,
}

/// Evidence of unresolved residues between two residues of a chain.
pub(in crate::evaluate) fn step(before: &Residue, after: &Residue) -> Step {
    let consecutive = after.number.0.saturating_sub(before.number.0) <= 1;
    match (link(before, after), consecutive) {
        (Link::Bonded, true) | (Link::Unknown, true) => Step::Joined,
        (Link::Bonded, false) => Step::Numbered,
        (Link::Distant(..), _) | (Link::Unknown, false) => Step::Broken,
    }
}

/// Link from `before` to `after`.
fn link(before: &Residue, after: &Residue) -> Link {
    let measured = |from: usize, to: usize| {
        let ends = before.backbone[from].zip(after.backbone[to]);
        ends.map(|(from, to)| nalgebra::distance(&from, &to))
    };
    let classify = |distance: f64, bond: f64, span: f64| {
        if distance <= bond {
            Link::Bonded
        } else {
            Link::Distant(distance, span)
        }
    };
    let is_protein = |residue: &Residue| residue.backbone[..PHOSPHORUS].iter().any(Option::is_some);
    let is_nucleic = |residue: &Residue| residue.backbone[PHOSPHORUS..].iter().any(Option::is_some);
    let [amino_acid, nucleotide] = SPANS;
    if (is_protein(before) && is_nucleic(after)) || (is_nucleic(before) && is_protein(after)) {
        Link::Distant(f64::INFINITY, nucleotide)
    } else if let Some(distance) = measured(CARBON, NITROGEN) {
        classify(distance, PEPTIDE_BOND, amino_acid)
    } else if let Some(distance) = measured(LINKING_OXYGEN, PHOSPHORUS) {
        classify(distance, PHOSPHATE_BOND, nucleotide)
    } else if let Some(distance) = measured(LINKING_OXYGEN, FIVE_PRIME_OXYGEN) {
        classify(distance, OXYGENS, nucleotide)
    } else if let Some(distance) = measured(ALPHA_CARBON, ALPHA_CARBON) {
        if distance < *ALPHA_CARBONS.start() {
            Link::Unknown
        } else {
            classify(distance, *ALPHA_CARBONS.end(), amino_acid)
        }
    } else {
        Link::Unknown
    }
}

/// Whether residues of consecutive numbers are bonded as a rule, so that a missing bond says something.
fn has_bonds(residues: &[Residue]) -> bool {
    let consecutive = || {
        let steps = residues.windows(2);
        steps.filter(|step| step[0].number.0.saturating_add(1) == step[1].number.0)
    };
    let broken = consecutive()
        .filter(|step| link(&step[0], &step[1]) != Link::Bonded)
        .count();
    broken as f64 <= 1.0 + BROKEN * consecutive().count() as f64
}

/// Whether another chain begins with `after`; `ends` are the lines at which the file ends a chain, rising, and
/// `bonds` says whether a missing bond means something.
fn begins_chain(before: &Residue, after: &Residue, ends: &[usize], bonds: bool) -> bool {
    let link = link(before, after);
    if link == Link::Bonded {
        return false;
    }
    let (last, first) = (before.lines.1, after.lines.0);
    let next_end = ends.get(ends.partition_point(|&line| line <= last));
    let is_ended = next_end.is_some_and(|&line| line <= first);
    let step = after.number.0.saturating_sub(before.number.0);
    if step < 0 {
        return true;
    }
    match link {
        Link::Distant(..) if step == 1 && (bonds || is_ended) => true,
        Link::Distant(distance, span) => {
            let (residues, longest) = MAX_GAP_LENGTH;
            distance > f64::max(span * step as f64, UNCOUNTED)
                || (is_ended && (step > residues || distance > longest))
        }
        Link::Bonded => false,
        Link::Unknown => is_ended,
    }
}

/// Cuts the residues of one chain name, in file order, into chains.
pub(in crate::evaluate) fn segments(residues: Vec<Residue>, ends: &[usize]) -> Vec<Vec<Residue>> {
    let bonds = has_bonds(&residues);
    let mut left = residues.len();
    let mut seen: HashSet<Number> = HashSet::new();
    let mut pieces: Vec<Vec<Residue>> = Vec::new();
    for residue in residues {
        let begins = pieces.last().is_none_or(|piece| {
            piece.last().is_none_or(|before| {
                let step = residue.number.0.saturating_sub(before.number.0);
                (seen.contains(&residue.number) && link(before, &residue) != Link::Bonded)
                    || (step >= LEAP && piece.len().min(left) >= MIN_PIECE)
                    || (piece.len().min(left) >= MIN_CHAIN
                        && begins_chain(before, &residue, ends, bonds))
            })
        });
        if begins {
            pieces.push(Vec::new());
            seen.clear();
        }
        seen.insert(residue.number);
        if let Some(piece) = pieces.last_mut() {
            piece.push(residue);
        }
        left -= 1;
    }
    pieces
}

/// Puts modified residues that the file lists after the chain (as HETATM records) where they are bonded.
pub(in crate::evaluate) fn in_bonded_order(found: Vec<Residue>) -> Vec<Residue> {
    let mut kept: Vec<Residue> = Vec::with_capacity(found.len());
    for residue in found {
        let joined = |before: &Residue, after: &Residue| link(before, after) == Link::Bonded;
        let is_stray = residue.hetero && !kept.last().is_some_and(|last| joined(last, &residue));
        let place = is_stray.then(|| {
            let after = kept.iter().position(|before| joined(before, &residue));
            let before = || kept.iter().position(|after| joined(&residue, after));
            after.map(|place| place + 1).or_else(before)
        });
        match place.flatten() {
            Some(place) => kept.insert(place, residue),
            None => kept.push(residue),
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use crate::evaluate::residues::Residues;
    use crate::evaluate::test_molecules::{atom, chain_of, helix, molecule, moved, numbers};
    use knotdock_scoring::se3::Pose;
    use knotdock_structures::molecule::Atom;

    fn sizes(atoms: Vec<Atom>) -> Vec<usize> {
        sizes_with(atoms, Vec::new())
    }

    fn sizes_with(atoms: Vec<Atom>, ends: Vec<usize>) -> Vec<usize> {
        let mut molecule = molecule(atoms);
        molecule.chain_breaks = ends;
        let residues = Residues::of(&molecule, "receptor").unwrap();
        let segments = residues.segments.iter();
        segments.map(|segment| segment.members.len()).collect()
    }

    /// A chain of `count` alanines from the given number on, `x` Å to the side.
    fn beside(first: i64, count: usize, x: f64) -> Vec<Atom> {
        let atoms = chain_of("A", &"A".repeat(count), &numbers(first, count));
        let aside = Pose::from_parts([1.0, 0.0, 0.0, 0.0], [x, 0.0, 0.0]);
        moved(&atoms, &aside)
    }

    #[test]
    fn repeated_number_begins_a_segment() {
        // An antibody's two chains under one name: number 1 comes twice, with 2A an insertion that is no repeat.
        let mut atoms = Vec::new();
        for (number, code) in [(1, None), (2, None), (2, Some('A')), (1, None), (2, None)] {
            let mut one = atom("A", number, "ALA", "CA", [0.0; 3]);
            one.insertion_code = code;
            atoms.push(one);
        }
        let residues = Residues::of(&molecule(atoms), "receptor").unwrap();
        let sizes: Vec<_> = residues.segments.iter().map(|s| s.members.len()).collect();
        assert_eq!(sizes, [3, 2]);
        assert_eq!(residues.segments[1].name, "A/2");
    }

    #[test]
    fn leaping_number_begins_a_segment() {
        let sizes = |numbers: Vec<i64>| -> Vec<usize> {
            let letters = "A".repeat(numbers.len());
            let residues =
                Residues::of(&molecule(chain_of("A", &letters, &numbers)), "receptor").unwrap();
            let segments = residues.segments.iter();
            segments.map(|segment| segment.members.len()).collect()
        };
        assert_eq!(sizes((1..=30).chain(1001..=1025).collect()), [30, 25]);
        // A loop of 99 residues that the file lacks, and a tag of five: one chain.
        assert_eq!(sizes((1..=30).chain(129..=150).collect()), [52]);
        assert_eq!(sizes((1..=30).chain(501..=505).collect()), [35]);
    }

    #[test]
    fn merged_chains_may_meet_at_the_same_number_and_name() {
        let atoms = vec![
            atom("A", 1, "GLY", "N", [0.0; 3]),
            atom("A", 1, "GLY", "CA", [1.0; 3]),
            atom("A", 1, "GLY", "N", [2.0; 3]),
        ];
        let residues = Residues::of(&molecule(atoms), "receptor").unwrap();
        assert_eq!(residues.segments.len(), 2);
    }
    /// Found with both partners of a complex under one name, the ligand's numbers starting again below the
    /// receptor's: the ligand's first residues, whose numbers the receptor does not have, were counted to the
    /// receptor.
    #[test]
    fn falling_number_begins_a_segment() {
        assert_eq!(
            sizes([beside(16, 40, 0.0), beside(1, 29, 9.0)].concat()),
            [40, 29]
        );
        // Insertions may be counted backwards, as thrombin's 1H to 1A.
        let mut atoms = beside(1, 4, 0.0);
        for one in &mut atoms {
            one.insertion_code = char::from_digit(20 - one.residue_number as u32, 36);
            one.residue_number = 1;
        }
        assert_eq!(sizes(atoms), [4]);
    }

    #[test]
    fn broken_bond_between_consecutive_numbers_begins_a_segment() {
        assert_eq!(
            sizes([beside(1, 30, 0.0), beside(31, 14, 9.0)].concat()),
            [30, 14]
        );
        // One chain that runs on, and one with a loop missing.
        assert_eq!(sizes(beside(1, 44, 0.0)), [44]);
        let gap = |atoms: &mut Vec<Atom>| atoms.retain(|a| !(20..26).contains(&a.residue_number));
        let mut atoms = beside(1, 44, 0.0);
        gap(&mut atoms);
        assert_eq!(sizes(atoms), [38]);
        // Six residues missing reach over 7 x 3.8 Å, not over 60.
        let mut atoms = [beside(1, 22, 0.0), beside(23, 22, 60.0)].concat();
        gap(&mut atoms);
        assert_eq!(sizes(atoms), [19, 19]);
    }

    /// A gap in the numbers may be a missing loop or a second chain. A TER record decides where a loop would be long;
    /// in a short gap it says nothing, for PyMOL writes it at each.
    #[test]
    fn end_of_a_chain_in_the_file_begins_a_segment() {
        let pieces = |second: i64, x: f64, ends: Vec<usize>| {
            let mut atoms = [beside(1, 20, 0.0), beside(second, 20, x)].concat();
            for (line, one) in atoms.iter_mut().enumerate() {
                one.line = line + 1 + usize::from(line >= 100);
            }
            sizes_with(atoms, ends)
        };
        assert_eq!(pieces(91, 9.0, vec![]), [40]);
        assert_eq!(pieces(91, 9.0, vec![101]), [20, 20]);
        assert_eq!(pieces(91, 9.0, vec![201]), [40]);
        assert_eq!(pieces(61, 50.0, vec![]), [40]);
        assert_eq!(pieces(61, 50.0, vec![101]), [20, 20]);
        assert_eq!(pieces(31, 9.0, vec![101]), [40]);
    }

    /// Found with a file whose insertion codes were lost: a chain was cut into pieces so short that they matched
    /// anything.
    #[test]
    fn numbers_that_come_again_within_a_bonded_chain_do_not_cut_it() {
        let mut atoms = beside(1, 30, 0.0);
        for one in atoms.iter_mut().filter(|one| one.residue_number > 12) {
            one.residue_number -= 1;
        }
        assert_eq!(sizes(atoms), [30]);
    }

    /// Some programs list selenomethionines after the chain that they are in.
    #[test]
    fn modified_residues_after_the_chain_stay_in_it() {
        let mut atoms = helix("A", &"A".repeat(30), [0.0; 3]);
        let is_modified = |one: &Atom| [1, 12, 13].contains(&one.residue_number);
        for one in atoms.iter_mut().filter(|one| is_modified(one)) {
            one.hetero = true;
            one.residue_name = "MSE".into();
        }
        let (modified, others): (Vec<_>, Vec<_>) = atoms.into_iter().partition(is_modified);
        let residues = Residues::of(&molecule([others, modified].concat()), "native").unwrap();
        assert_eq!(residues.segments.len(), 1);
        let order: Vec<i64> = residues.residues.iter().map(|one| one.number.0).collect();
        assert_eq!(order, numbers(1, 30));
    }

    /// The strands of a duplex under one name, numbers running on; the second has no phosphate at its first nucleotide.
    #[test]
    fn strands_are_parted_where_no_phosphate_links_them() {
        let mut atoms = Vec::new();
        for number in 1..=8 {
            for (name, along) in [("P", 0.0), ("O5'", 1.6), ("C1'", 3.0), ("O3'", 5.0)] {
                let strand = if number > 4 { 15.0 } else { 0.0 };
                if number != 5 || name != "P" {
                    atoms.push(atom(
                        "B",
                        number,
                        "DA",
                        name,
                        [6.6 * number as f64 + along, strand, 0.0],
                    ));
                }
            }
        }
        assert_eq!(sizes(atoms), [4, 4]);
    }
}
