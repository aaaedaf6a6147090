//! What is found missing, and where balls stand for it.

use super::*;
use crate::molecule::Format;
use crate::molecule::groups::residue_runs;
use crate::test_support::{capped, example, without};

fn trypsin() -> Molecule {
    example("receptor")
}

fn counts(missing: &MissingResidues) -> [usize; 4] {
    let balls = missing.centers.len();
    [missing.residues, missing.gaps, missing.ends, balls]
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    squared_distance(a, b).sqrt()
}

#[test]
fn two_balls_stand_past_each_end_one_behind_the_other() {
    let molecule = trypsin();
    let missing = molecule.missing_residues();
    assert_eq!(counts(&missing), [0, 0, 2, 4]);
    let ends = [
        molecule.atoms.iter().find(|atom| atom.name == "N"),
        molecule.atoms.iter().rfind(|atom| atom.name == "C"),
    ];
    for (end, balls) in ends.iter().zip(missing.centers.chunks(2)) {
        let end = end.unwrap().position;
        assert!((distance(end, balls[0]) - PAST_END[0]).abs() < 1e-9);
        assert!((distance(end, balls[1]) - PAST_END[1]).abs() < 1e-9);
        assert!((distance(balls[0], balls[1]) - 3.5).abs() < 1e-9);
    }
}

/// A loop on the surface of trypsin, residues 143 to 151 of the file's numbers: the balls stand closer to it than a residue is wide.
#[test]
fn balls_bow_out_where_a_loop_is_missing() {
    let whole = trypsin();
    let runs = residue_runs(&whole.atoms);
    let first = runs.iter().position(|run| run.key.1 == 145).unwrap();
    let (molecule, taken) = without(&whole, first..first + 7);
    let missing = molecule.missing_residues();
    let numbers: i64 = runs[first + 7].key.1 - runs[first - 1].key.1 - 1;
    assert_eq!(counts(&missing)[1..3], [1, 2]);
    assert_eq!(missing.residues as i64, numbers);
    let loop_atoms: Vec<[f64; 3]> = taken.iter().map(|atom| atom.position).collect();
    let balls = &missing.centers[..missing.residues];
    let nearest = |ball: &[f64; 3]| {
        let distances = loop_atoms.iter().map(|atom| distance(*atom, *ball));
        distances.fold(f64::INFINITY, f64::min)
    };
    let mean = balls.iter().map(nearest).sum::<f64>() / balls.len() as f64;
    assert!(mean < 3.2, "{mean}");
}

#[test]
fn balls_go_with_the_molecule() {
    let (molecule, _) = without(&trypsin(), 100..110);
    let turned = |[x, y, z]: [f64; 3]| [0.6 * x - 0.8 * y + 50.0, 0.8 * x + 0.6 * y, z - 7.0];
    let [here, there] = [molecule.clone(), molecule.map_positions(turned)]
        .map(|molecule| molecule.missing_residues());
    assert_eq!(counts(&here), counts(&there));
    for (one, other) in here.centers.iter().zip(&there.centers) {
        assert!(distance(turned(*one), *other) < 1e-9);
    }
}

#[test]
fn peptides_and_capped_ends_have_nothing_past_them() {
    let (peptide, _) = without(&trypsin(), 19..223);
    assert_eq!(counts(&peptide.missing_residues()), [0; 4]);
    let capped = capped(trypsin());
    assert_eq!(counts(&capped.missing_residues()), [0, 0, 1, 2]);
}

/// Where chains are merged under one name, numbers begin again or the next residue is out of reach.
#[test]
fn merged_chains_end_and_begin() {
    let one = trypsin();
    let far = one.map_positions(|[x, y, z]| [x + 90.0, y, z]);
    let atoms = [one.atoms, far.atoms].concat();
    let merged = Molecule::new(atoms, Format::Pdb);
    assert_eq!(counts(&merged.missing_residues()), [0, 0, 4, 8]);
    let mut numbered_on = merged;
    let half = numbered_on.atoms.len() / 2;
    for atom in &mut numbered_on.atoms[half..] {
        atom.residue_number += 300;
    }
    assert_eq!(counts(&numbered_on.missing_residues()), [0, 0, 4, 8]);
}

#[test]
fn no_molecule_is_too_odd() {
    let nothing = Molecule::new(Vec::new(), Format::Pdb);
    assert_eq!(counts(&nothing.missing_residues()), [0; 4]);
    let mut all_in_one = trypsin();
    for atom in &mut all_in_one.atoms {
        atom.position = [1.0, 2.0, 3.0];
    }
    let balls = all_in_one.missing_residues().centers;
    assert!(balls.iter().flatten().all(|x| x.is_finite()));
}
