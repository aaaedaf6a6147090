//! Flexible regions: clashes with unresolved segments and contacts of termini cost score.

use super::*;
use knotdock_structures::Conformers;
use knotdock_structures::molecule::{InputSpec, ReadOptions, read};

/// An atom near unresolved residues costs the weight times the share of conformers within reach, whatever effects are
/// on; search scores stay unchanged. The program looks conformers up in cells of 1 Å; distances to all their residues
/// bound the result.
#[test]
fn clashes_with_unresolved_residues_cost() {
    const WEIGHT: f64 = 12.5;
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let table = |weight: &str| {
        let unresolved = format!("--config=terms.unresolved_weight={weight}");
        let options = "--rotations 24 --effects shape --no-cluster --refine 0 --config=terms.termini_weight=0";
        let options: Vec<&str> = options.split(' ').chain([unresolved.as_str()]).collect();
        let (object, table) = dock(folder.path(), &receptor, &ligand, &options);
        let unresolved = object["run"]["plan"]["unresolved_residues"].clone();
        let mut reader = csv::Reader::from_reader(table.as_bytes());
        let rows = reader.deserialize().map(|row| row.unwrap());
        let rows: Vec<std::collections::BTreeMap<String, String>> = rows.collect();
        (rows, unresolved)
    };
    let (rows, found) = table(&WEIGHT.to_string());
    // One end of trypsin is buried.
    let counts = |side: usize| [&found[side]["ends"], &found[side]["conformers"]];
    assert_eq!([counts(0), counts(1)], [[2, 64], [2, 128]]);
    let (plain, found) = table("0");
    assert_eq!(found[0]["conformers"], 0);
    assert!(plain.iter().all(|row| row["unresolved"].is_empty()));

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
        let value = number("unresolved");
        assert_eq!(number("pose_score"), number("search_score") + value);
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
            -value >= least - 1e-3 && -value <= most + 1e-3,
            "{least} {value} {most}"
        );
        met += usize::from(least > 0.0);
    }
    assert!(met > 0, "no pose meets unresolved residues");
    let scores = |rows: &[std::collections::BTreeMap<String, String>]| {
        let mut scores: Vec<String> = rows.iter().map(|row| row["search_score"].clone()).collect();
        scores.sort();
        scores
    };
    assert_eq!(scores(&rows), scores(&plain));
}

/// Sum over atoms and segments of the share of conformers within reach.
fn inside(atoms: &[[f64; 3]], segments: &[Conformers], reach: f64) -> f64 {
    let mut sum = 0.0;
    for segment in segments {
        let conformers = segment.traces.len() as f64;
        for atom in atoms {
            let at = segment.local(*atom);
            let near = |alpha: &[f64; 3]| {
                let squares = (0..3).map(|axis| (alpha[axis] - at[axis]).powi(2));
                squares.sum::<f64>() < reach * reach
            };
            let passing = segment
                .traces
                .iter()
                .filter(|conformer| conformer.iter().any(near));
            sum += passing.count() as f64 / conformers;
        }
    }
    sum
}

/// Atoms of the first and last residues of a chain in contact with the other side cost their weight each, counted by
/// all pairs.
#[test]
fn contacts_of_termini_cost() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let options = "--rotations 24 --effects shape --no-cluster --refine 0 --config=terms.unresolved_weight=0 --config=terms.termini_weight=3";
    let options: Vec<&str> = options.split(' ').collect();
    let (object, table) = dock(folder.path(), &receptor, &ligand, &options);
    let plan = &object["run"]["plan"];
    assert_eq!(plan["terminus_residues"][0]["residues"], 16);
    assert_eq!(plan["terminus_residues"][1]["residues"], 2);
    assert_eq!(plan["unresolved_residues"][0]["ends"], 0);
    // Of 223 residues eight are near each terminus, of 29 one. No residue number of these two files occurs twice.
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
        assert_eq!(number("termini"), -3.0 * atoms as f64);
        assert_eq!(
            number("pose_score"),
            number("search_score") + number("termini")
        );
        met += usize::from(atoms > 0);
    }
    assert!(met > 0, "no pose touches a terminus");
}
