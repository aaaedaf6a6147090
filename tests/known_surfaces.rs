//! Interface predictions and membranes: how poses are ranked and searched by them, and the inputs that are refused.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use knotdock_scoring::se3::Pose;

use crate::dock_run::run::{comparable, number, rows, run};
use crate::program::{refused, succeed};

type Row = BTreeMap<String, String>;

fn example(name: &str) -> String {
    format!(
        "{}/structures/examples/1ppe_{name}_unbound.pdb",
        concat!(env!("CARGO_MANIFEST_DIR"), "/..")
    )
}

const SHORT: &str =
    "--rotations 96 --poses 60 --no-cluster --sharp off --write-top 0 -o run --force --quiet";

/// Docks the example pair into `run`.
fn dock(folder: &Path, options: &str) -> Vec<Row> {
    let (receptor, ligand) = (example("receptor"), example("ligand"));
    let mut words = vec!["dock", &receptor, &ligand];
    words.extend(SHORT.split(' ').chain(options.split_whitespace()));
    succeed(folder, words);
    rows(&folder.join("run"))
}

/// Atoms of an example file that are docked: residue number and position.
fn atoms(name: &str) -> Vec<(String, [f64; 3])> {
    let text = fs::read_to_string(example(name)).unwrap();
    let is_atom = |line: &&str| line.starts_with("ATOM") && line[76..78].trim() != "H";
    let number = |line: &str, from: usize| line[from..from + 8].trim().parse().unwrap();
    let atom = |line: &str| {
        let position = [30, 38, 46].map(|from| number(line, from));
        (line[22..27].trim().to_owned(), position)
    };
    text.lines().filter(is_atom).map(atom).collect()
}

fn pose(row: &Row) -> Pose {
    let quaternion = ["qw", "qx", "qy", "qz"].map(|part| number(row, part));
    Pose::from_parts(quaternion, ["tx", "ty", "tz"].map(|part| number(row, part)))
}

/// Each nat of log-odds beyond the mean of a residue within 5 Å counts the weight, and a record repeats the run
/// without the file.
#[test]
fn likely_residues_in_contact_count_their_log_odds() {
    let folder = tempfile::tempdir().unwrap();
    let mut table = "chain,residue,probability\n".to_owned();
    // Residues about the active site, and others.
    let likely = ["57", "195", "189", "192", "41", "99"];
    let unlikely = ["74", "110", "160", "230", "20", "135"];
    for (residues, p) in [(likely, 0.8), (unlikely, 0.05)] {
        for residue in residues {
            table += &format!("A,{residue},{p}\n");
        }
    }
    fs::write(folder.path().join("p.csv"), table).unwrap();
    let found = dock(
        folder.path(),
        "--interface-receptor p.csv --config terms.interface_weight=7",
    );
    let (receptor, ligand) = (atoms("receptor"), atoms("ligand"));
    let logit = |p: f64| (p / (1.0 - p)).ln();
    let odds = |residue: &str| match () {
        () if likely.contains(&residue) => logit(0.8) - logit(0.425),
        () if unlikely.contains(&residue) => logit(0.05) - logit(0.425),
        () => 0.0,
    };
    let mut seen = BTreeSet::new();
    for row in found.iter().step_by(4) {
        let pose = pose(row);
        let moved: Vec<_> = ligand.iter().map(|(_, x)| pose.apply(*x)).collect();
        let touches = |x: [f64; 3]| {
            let square = |y: &[f64; 3]| (0..3).map(|k| (x[k] - y[k]).powi(2)).sum::<f64>();
            moved.iter().any(|y| square(y) < 25.0)
        };
        let touching = receptor.iter().filter(|(_, x)| touches(*x));
        let touching: BTreeSet<&str> = touching.map(|(residue, _)| residue.as_str()).collect();
        let expected: f64 = 7.0 * touching.into_iter().map(odds).sum::<f64>();
        let term = number(row, "interface_predictions");
        assert!((term - expected).abs() < 1e-6, "{term} {expected}");
        seen.insert(expected as i64);
    }
    assert!(seen.len() > 3, "{seen:?}");

    let before = comparable(&folder.path().join("run"));
    fs::remove_file(folder.path().join("p.csv")).unwrap();
    run(
        folder.path(),
        "dock --rerun run/run.json -o again --threads 1 --quiet",
    );
    assert_eq!(before, comparable(&folder.path().join("again")));
}

/// B values that are probabilities say what a table with their means does.
#[test]
fn b_values_of_the_file_are_predictions() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(example("ligand")).unwrap();
    let mut table = BTreeMap::new();
    let lines = text.lines().map(|line| {
        if !line.starts_with("ATOM") {
            return line.to_owned();
        }
        let residue = line[22..27].trim();
        let p = format!("{:.2}", 0.03 * residue.parse::<f64>().unwrap());
        table.insert(residue.to_owned(), p.clone());
        format!("{}{p:>6}{}", &line[..60], &line[66..])
    });
    let changed: Vec<String> = lines.collect();
    fs::write(folder.path().join("changed.pdb"), changed.join("\n")).unwrap();
    let rows_of = table
        .iter()
        .map(|(residue, p)| format!("B,{residue},{p}\n"));
    let csv = format!("chain,residue,probability\n{}", rows_of.collect::<String>());
    fs::write(folder.path().join("p.csv"), csv).unwrap();
    let of_table = dock(folder.path(), "--interface-ligand p.csv");
    let receptor = example("receptor");
    let mut words = vec![
        "dock",
        &receptor,
        "changed.pdb",
        "--interface-ligand",
        "bfactor",
    ];
    words.extend(SHORT.split(' '));
    succeed(folder.path(), words);
    let of_values = rows(&folder.path().join("run"));
    assert_eq!(of_table.len(), of_values.len());
    for (a, b) in of_table.iter().zip(&of_values) {
        let difference = number(a, "interface_predictions") - number(b, "interface_predictions");
        assert!(difference.abs() < 1e-6);
        assert_eq!((&a["tx"], &a["qw"]), (&b["tx"], &b["qw"]));
    }
    assert!(
        of_table
            .iter()
            .any(|row| number(row, "interface_predictions") != 0.0)
    );
}

/// No pose lies deeper in a membrane than the samples leave open, each Å of it costs, and planes that the file marks
/// mean what their numbers do.
#[test]
fn poses_stay_out_of_a_membrane() {
    let folder = tempfile::tempdir().unwrap();
    let z: Vec<f64> = atoms("receptor").iter().map(|(_, x)| x[2]).collect();
    let middle = (z.iter().sum::<f64>() / z.len() as f64).round();
    let (low, high) = (middle - 30.0, middle + 2.0);
    let free = dock(folder.path(), "");
    let ligand = atoms("ligand");
    let depth = |row: &Row| {
        let pose = pose(row);
        let z = ligand.iter().map(|(_, x)| pose.apply(*x)[2]);
        let range = (f64::INFINITY, f64::NEG_INFINITY);
        let (lowest, highest) = z.fold(range, |(l, h), z| (l.min(z), h.max(z)));
        (high - lowest).min(highest - low).max(0.0)
    };
    assert!(free.iter().any(|row| depth(row) > 15.0));
    assert!(!free[0].contains_key("membrane"));
    let found = dock(folder.path(), &format!("--membrane={low},{high}"));
    assert!(found.len() > 20);
    for row in &found {
        assert!(depth(row) < 12.0, "{}", depth(row));
        assert!((number(row, "membrane") + 50.0 * depth(row)).abs() < 1e-6);
    }
    assert!(depth(&found[0]) < 6.0);

    let mut marked = fs::read_to_string(example("receptor")).unwrap();
    let end = marked.find("\nEND").map_or(marked.len(), |at| at + 1);
    marked.truncate(end);
    for (serial, (name, z)) in (1..).zip([("N", low), ("O", high), ("N", low), ("O", high)]) {
        marked += &format!(
            "HETATM{:>5}  {name}   DUM  {:>4}    {:8.3}{:8.3}{z:8.3}\n",
            9000 + serial,
            9000 + serial,
            2.0 * f64::from(serial),
            0.0
        );
    }
    fs::write(folder.path().join("marked.pdb"), marked).unwrap();
    let ligand = example("ligand");
    let mut words = vec!["dock", "marked.pdb", &ligand, "--membrane", "receptor"];
    words.extend(SHORT.split(' '));
    succeed(folder.path(), words);
    assert_eq!(rows(&folder.path().join("run")), found);
}

/// Files and options that cannot be used are refused with a remedy, and nothing is written.
#[test]
fn what_cannot_be_used_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("p.csv"),
        "chain,residue,probability\nA,57,0.5\nA,195,1.5\n",
    )
    .unwrap();
    for (options, line, said) in [
        ("--interface-receptor p.csv", 3, "the probability is `1.5`"),
        ("--interface-ligand p.csv", 2, "there is no residue A:57"),
        (
            "--interface-receptor bfactor",
            0,
            "the B values of 223 of 223",
        ),
        ("--interface-receptor none.csv", 0, "cannot be read"),
        ("--membrane receptor", 0, "marks no flat membrane"),
        ("--membrane=3,2", 0, "lowest and highest z"),
        ("--membrane=-1e3,1e3", 0, "lies in the membrane"),
        (
            "--membrane=-9,9 --symmetry C2",
            0,
            "left out with --symmetry",
        ),
    ] {
        let (receptor, ligand) = (example("receptor"), example("ligand"));
        let mut words = vec!["dock", &receptor];
        if !options.contains("symmetry") {
            words.push(&ligand);
        }
        words.extend(options.split(' '));
        words.extend(["--rotations", "24", "-o", "none"]);
        let error = refused(folder.path(), words);
        assert!(!folder.path().join("none").exists());
        let message = error["message"].as_str().unwrap();
        assert!(message.contains(said), "{options}: {message}");
        assert_eq!(error["line"].as_u64().unwrap_or(0), line, "{error}");
    }
}
