//! What is not sure to be where a file shows it, or not shown: missing residues and ends of chains cost poses that meet them.

use super::*;
use knotdock_structures::Conformers;
use knotdock_structures::molecule::{InputSpec, ReadOptions, read};

/// Atoms that lie where chains may go on cost their weight times the share of courses that pass them, of whatever effects; scores stay as they were. The
/// program asks cells of 1 Å; distances to all residues of all courses tell between what that must be.
#[test]
fn what_lies_where_residues_are_missing_costs() {
    const WEIGHT: f64 = 12.5;
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let table = |weight: &str| {
        let options = "--rotations 24 --effects shape --no-cluster --refine 0 --termini-weight 0 --unresolved-weight";
        let options: Vec<&str> = options.split(' ').chain([weight]).collect();
        let (object, table) = dock(folder.path(), &receptor, &ligand, &options);
        let missing = object["run"]["plan"]["missing_residues"].clone();
        let mut reader = csv::Reader::from_reader(table.as_bytes());
        let rows = reader.deserialize().map(|row| row.unwrap());
        let rows: Vec<std::collections::BTreeMap<String, String>> = rows.collect();
        (rows, missing)
    };
    let (rows, told) = table(&WEIGHT.to_string());
    // One end of trypsin is buried.
    let counts = |side: usize| [&told[side]["ends"], &told[side]["conformers"]];
    assert_eq!([counts(0), counts(1)], [[2, 64], [2, 128]]);
    let (plain, told) = table("0");
    assert_eq!(told[0]["conformers"], 0);
    assert!(plain.iter().all(|row| row["missing"].is_empty()));

    let sides = [&receptor, &ligand].map(|file| {
        let molecule = read(&InputSpec::whole(file), &ReadOptions::default()).unwrap();
        let atoms: Vec<[f64; 3]> = molecule.atoms.iter().map(|atom| atom.position).collect();
        (atoms, molecule.unresolved_residues().segments)
    });
    let (fixed, moving) = (&sides[0], &sides[1]);
    let half_cell = 0.5 * 3f64.sqrt();
    let mut met = 0;
    for row in rows.iter().step_by(5) {
        let number = |name: &str| -> f64 { row[name].parse().unwrap() };
        let missing = number("missing");
        assert_eq!(number("pose_score"), number("score") + missing);
        let quaternion = ["qw", "qx", "qy", "qz"].map(number);
        let pose = Pose::from_parts(quaternion, ["tx", "ty", "tz"].map(number));
        let back = pose.inverse();
        let placed: Vec<[f64; 3]> = moving.0.iter().map(|x| pose.apply(*x)).collect();
        let carried: Vec<[f64; 3]> = fixed.0.iter().map(|x| back.apply(*x)).collect();
        let expected = |reach: f64| {
            WEIGHT * (inside(&placed, &fixed.1, reach) + inside(&carried, &moving.1, reach))
        };
        let (least, most) = (expected(5.0 - half_cell), expected(5.0 + half_cell));
        assert!(
            -missing >= least - 1e-3 && -missing <= most + 1e-3,
            "{least} {missing} {most}"
        );
        met += usize::from(least > 0.0);
    }
    assert!(met > 0, "no pose meets missing residues");
    let scores = |rows: &[std::collections::BTreeMap<String, String>]| {
        let mut scores: Vec<String> = rows.iter().map(|row| row["score"].clone()).collect();
        scores.sort();
        scores
    };
    assert_eq!(scores(&rows), scores(&plain));
}

/// How many atoms lie within reach of residues that are missing, each by the share of courses that do.
fn inside(atoms: &[[f64; 3]], stretches: &[Conformers], reach: f64) -> f64 {
    let mut sum = 0.0;
    for stretch in stretches {
        let courses = stretch.traces.len() as f64;
        for atom in atoms {
            let at = stretch.local(*atom);
            let near = |alpha: &[f64; 3]| {
                let squares = (0..3).map(|axis| (alpha[axis] - at[axis]).powi(2));
                squares.sum::<f64>() < reach * reach
            };
            let passing = stretch
                .traces
                .iter()
                .filter(|course| course.iter().any(near));
            sum += passing.count() as f64 / courses;
        }
    }
    sum
}

/// Atoms of the first and last residues of a chain that touch the other side cost their weight each: as many as all pairs of atoms tell.
#[test]
fn contacts_of_ends_of_chains_cost() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let options = "--rotations 24 --effects shape --no-cluster --refine 0 --unresolved-weight 0 --termini-weight 3";
    let options: Vec<&str> = options.split(' ').collect();
    let (object, table) = dock(folder.path(), &receptor, &ligand, &options);
    let plan = &object["run"]["plan"];
    assert_eq!(plan["chain_end_residues"][0]["residues"], 16);
    assert_eq!(plan["chain_end_residues"][1]["residues"], 2);
    assert_eq!(plan["missing_residues"][0]["ends"], 0);
    // Of 223 residues eight are near each end, of 29 one; no number of these two files comes twice.
    let atoms = |file: &str, near: usize| -> Vec<([f64; 3], bool)> {
        let text = std::fs::read_to_string(file).unwrap();
        let lines: Vec<&str> = text
            .lines()
            .filter(|line| line.starts_with("ATOM"))
            .collect();
        let mut residues: Vec<&str> = lines.iter().map(|line| &line[22..27]).collect();
        residues.dedup();
        let ends = [&residues[..near], &residues[residues.len() - near..]].concat();
        let coordinate = |line: &str, from: usize| line[from..from + 8].trim().parse().unwrap();
        let atom = |line: &&str| {
            let position = [30, 38, 46].map(|from| coordinate(line, from));
            (position, ends.contains(&&line[22..27]))
        };
        lines.iter().map(atom).collect()
    };
    let (fixed, moving) = (atoms(&receptor, 8), atoms(&ligand, 1));
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let mut met = 0;
    for row in reader.deserialize().take(30) {
        let row: std::collections::BTreeMap<String, String> = row.unwrap();
        let number = |name: &str| -> f64 { row[name].parse().unwrap() };
        let quaternion = ["qw", "qx", "qy", "qz"].map(number);
        let pose = Pose::from_parts(quaternion, ["tx", "ty", "tz"].map(number));
        let placed: Vec<([f64; 3], bool)> = moving
            .iter()
            .map(|(position, end)| (pose.apply(*position), *end))
            .collect();
        let touches = |atom: &[f64; 3], others: &[([f64; 3], bool)]| {
            others.iter().any(|(other, _)| {
                let squares = (0..3).map(|axis| (atom[axis] - other[axis]).powi(2));
                squares.sum::<f64>() < 25.0
            })
        };
        let touching = |own: &[([f64; 3], bool)], others: &[([f64; 3], bool)]| {
            own.iter()
                .filter(|(atom, end)| *end && touches(atom, others))
                .count()
        };
        let atoms = touching(&fixed, &placed) + touching(&placed, &fixed);
        assert_eq!(number("chain_ends"), -3.0 * atoms as f64);
        assert_eq!(number("pose_score"), number("score") + number("chain_ends"));
        met += usize::from(atoms > 0);
    }
    assert!(met > 0, "no pose touches an end");
}
