//! Tests of unresolved residues and their conformers.

use super::*;
use crate::molecule::model::{Format, residue_runs};
use crate::test_support::{capped, example, without};

fn trypsin() -> Molecule {
    example("receptor")
}

/// Residues, gaps, ends, and the conformers of each segment.
fn counts(missing: &UnresolvedResidues) -> ([usize; 3], Vec<usize>) {
    let traces = missing.segments.iter().map(|one| one.traces.len());
    let found = [missing.residues, missing.gaps, missing.ends];
    (found, traces.collect())
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    squared_distance(a, b).sqrt()
}

/// Trypsin without residues 145 to 151 of the file's numbers, a loop on its surface, and the CA atoms of these.
fn without_a_loop() -> (Molecule, Vec<[f64; 3]>) {
    let whole = trypsin();
    let runs = residue_runs(&whole.atoms);
    let first = runs.iter().position(|run| run.key.number == 145).unwrap();
    let (molecule, taken) = without(&whole, first..first + 7);
    let alphas = taken.iter().filter(|atom| atom.name == "CA");
    (molecule, alphas.map(|atom| atom.position).collect())
}

/// Trypsin's first N is in a pocket, and nothing can go on from it.
#[test]
fn conformers_go_on_from_an_end_that_has_room() {
    let molecule = trypsin();
    let missing = molecule.unresolved_residues();
    assert_eq!(counts(&missing), ([0, 0, 2], vec![64]));
    let last = molecule.atoms.iter().rfind(|atom| atom.name == "C");
    assert_eq!(missing.segments[0].origin, last.unwrap().position);
    for trace in &missing.segments[0].traces {
        assert_eq!(trace.len(), PAST_END);
    }
}

/// A conformer is a chain that has room, by its steps, its bends and its clearances.
#[test]
fn conformers_are_chains_that_have_room() {
    let (molecule, _) = without_a_loop();
    let missing = molecule.unresolved_residues();
    assert_eq!(counts(&missing).1, [64, 64]);
    let last_residue = molecule.atoms.last().unwrap().residue_number;
    for (segment, beside) in missing
        .segments
        .iter()
        .zip([&[144, 152][..], &[last_residue]])
    {
        for trace in &segment.traces {
            assert!((distance(trace[0], [0.0; 3]) - FIRST).abs() < 1e-9);
            for (place, alpha) in trace.iter().enumerate() {
                let here = segment.in_file(*alpha);
                for atom in &molecule.atoms {
                    let room = match beside.contains(&atom.residue_number) {
                        true if place == 0 || place + 1 == trace.len() => 0.0,
                        true => ROOM_BESIDE,
                        false => ROOM,
                    };
                    assert!(distance(atom.position, here) >= room);
                }
                let earlier = trace[..place.saturating_sub(1)].iter();
                assert!(
                    earlier
                        .clone()
                        .all(|other| distance(*other, *alpha) >= ROOM)
                );
            }
            let steps: Vec<[f64; 3]> = trace
                .windows(2)
                .map(|pair| std::array::from_fn(|axis| pair[1][axis] - pair[0][axis]))
                .collect();
            for step in &steps {
                assert!((distance(*step, [0.0; 3]) - NEXT).abs() < 1e-9);
            }
            for pair in steps.windows(2) {
                let cosine: f64 = (0..3).map(|axis| pair[0][axis] * pair[1][axis]).sum();
                let cosine = cosine / (NEXT * NEXT);
                assert!((TURN[0] - 1e-9..=TURN[1] + 1e-9).contains(&cosine));
            }
        }
    }
}

/// Conformers cross a gap from end to end and pass where the loop was, two in five of them within 5 Å of each of its CA
/// atoms in the mean.
#[test]
fn loops_lead_across_gaps_where_they_were() {
    let (molecule, alphas) = without_a_loop();
    let missing = molecule.unresolved_residues();
    assert_eq!(counts(&missing).0, [alphas.len(), 1, 2]);
    let bridge = &missing.segments[0];
    let number = |wanted: i64, name: &str| {
        let mut atoms = molecule.atoms.iter();
        atoms
            .find(|atom| atom.residue_number == wanted && atom.name == name)
            .unwrap()
            .position
    };
    assert_eq!(bridge.origin, number(144, "C"));
    let end = number(152, "N");
    for trace in &bridge.traces {
        assert!(distance(bridge.in_file(*trace.last().unwrap()), end) < 3.0);
    }
    let share = |point: [f64; 3]| {
        let local = bridge.local(point);
        let near = |trace: &&Vec<[f64; 3]>| trace.iter().any(|at| distance(*at, local) < 5.0);
        bridge.traces.iter().filter(near).count() as f64 / bridge.traces.len() as f64
    };
    let mean = alphas.iter().map(|alpha| share(*alpha)).sum::<f64>() / alphas.len() as f64;
    assert!(mean > 0.4, "{mean}");
}

#[test]
fn conformers_go_with_the_molecule() {
    let (molecule, _) = without(&trypsin(), 100..110);
    let turned = |[x, y, z]: [f64; 3]| [0.6 * x - 0.8 * y + 1e5, 0.8 * x + 0.6 * y, z - 7.0];
    let [here, there] = [molecule.clone(), molecule.map_positions(turned)]
        .map(|molecule| molecule.unresolved_residues());
    assert_eq!(counts(&here), counts(&there));
    assert!(!here.segments.is_empty());
    for (one, other) in here.segments.iter().zip(&there.segments) {
        for (a, b) in one
            .traces
            .iter()
            .flatten()
            .zip(other.traces.iter().flatten())
        {
            assert!(distance(turned(one.in_file(*a)), other.in_file(*b)) < 1e-6);
            assert!(distance(one.local(one.in_file(*a)), *a) < 1e-9);
        }
    }
}

#[test]
fn peptides_and_capped_ends_have_nothing_past_them() {
    let (peptide, _) = without(&trypsin(), 19..223);
    assert_eq!(counts(&peptide.unresolved_residues()), ([0; 3], vec![]));
    let capped = capped(trypsin());
    assert_eq!(counts(&capped.unresolved_residues()), ([0, 0, 1], vec![]));
}

/// Where chains are merged under one name, numbers begin again or the next residue is out of reach.
#[test]
fn merged_chains_end_and_begin() {
    let one = trypsin();
    let far = one.map_positions(|[x, y, z]| [x + 90.0, y, z]);
    let atoms = [one.atoms, far.atoms].concat();
    let merged = Molecule::new(atoms, Format::Pdb);
    assert_eq!(
        counts(&merged.unresolved_residues()),
        ([0, 0, 4], vec![64; 2])
    );
    let mut numbered_on = merged;
    let half = numbered_on.atoms.len() / 2;
    for atom in &mut numbered_on.atoms[half..] {
        atom.residue_number += 300;
    }
    let found = counts(&numbered_on.unresolved_residues());
    assert_eq!(found, ([0, 0, 4], vec![64; 2]));
}

#[test]
fn no_molecule_is_too_odd() {
    let nothing = Molecule::new(Vec::new(), Format::Pdb);
    assert_eq!(counts(&nothing.unresolved_residues()), ([0; 3], vec![]));
    let mut all_in_one = trypsin();
    for atom in &mut all_in_one.atoms {
        atom.position = [1.0, 2.0, 3.0];
    }
    assert_eq!(counts(&all_in_one.unresolved_residues()).1, [0; 0]);
    // An end whose main chain is on one line has no frame.
    let mut in_line = trypsin();
    let last = in_line.atoms.last().unwrap().residue_number;
    let mut of_last = in_line.atoms.iter_mut();
    let mut main = |name: &str| {
        let atom = of_last.find(|atom| atom.residue_number == last && atom.name == name);
        &mut atom.unwrap().position
    };
    let (first, alpha, carbon) = (*main("N"), main("CA"), *main("C"));
    *alpha = std::array::from_fn(|axis| 0.5 * (first[axis] + carbon[axis]));
    assert_eq!(counts(&in_line.unresolved_residues()), ([0, 0, 2], vec![]));
}
