//! `knotdock dock --from-model`: a predicted complex docked again.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::dock_run::run::{comparable, rows, run};
use crate::molecules;
use crate::program::refused;

const QUICK: &str = "--rotations 40 --write-top 0 --quiet";

fn record(run: &Path) -> Value {
    serde_json::from_slice(&fs::read(run.join("run.json")).unwrap()).unwrap()
}

/// A folder with a complex of two helices and a third one, chain C, as model.pdb.
fn made() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let ligand = molecules::ligand().replace(" ALA A", " ALA C");
    let model = molecules::receptor().replace("END\n", "") + &ligand;
    fs::write(folder.path().join("model.pdb"), model).unwrap();
    folder
}

/// The axis along z, by x and y, about which half a turn takes the inhibitor of 1PPE to another place that it touches.
const ELSEWHERE: [f64; 2] = [13.0, -4.4];

/// Writes bound trypsin with its inhibitor, half a turn about an axis if one is given.
fn trypsin(folder: &Path, name: &str, axis: Option<[f64; 2]>) {
    let atoms = |side: &str| {
        let file = format!("structures/examples/1ppe_{side}_bound.pdb");
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(file);
        let text = fs::read_to_string(path).unwrap();
        let records = text.lines().filter(|line| line.starts_with("ATOM"));
        records.map(str::to_owned).collect::<Vec<_>>()
    };
    let turned = |line: String| {
        let Some(axis) = axis else { return line };
        let number = |from: usize| line[from..from + 8].trim().parse::<f64>().unwrap();
        let [x, y] = [0, 1].map(|part| 2.0 * axis[part] - number(30 + 8 * part));
        format!("{}{x:8.3}{y:8.3}{}", &line[..30], &line[46..])
    };
    let ligand = atoms("ligand").into_iter().map(turned);
    let lines: Vec<String> = atoms("receptor").into_iter().chain(ligand).collect();
    fs::write(folder.join(name), lines.join("\n") + "\n").unwrap();
}

/// The poses are those of docking the two files and measuring them by the complex, whatever their prediction, and a
/// record repeats the run on any number of threads.
#[test]
fn the_search_knows_nothing_of_the_prediction() {
    let folder = made();
    let at = |name: &str| folder.path().join(name);
    run(
        folder.path(),
        &format!("dock --from-model model.pdb A,B C -o run -j 1 {QUICK}"),
    );
    run(
        folder.path(),
        &format!(
            "dock model.pdb:A,B model.pdb:C --native-receptor model.pdb:A,B --native-ligand model.pdb:C -o plain {QUICK}"
        ),
    );
    let poses = |name: &str| fs::read(at(name).join("poses.csv")).unwrap();
    assert_eq!(poses("run"), poses("plain"));
    assert_eq!(record(&at("plain"))["redocking"], Value::Null);
    run(
        folder.path(),
        "dock --rerun run/run.json -o again -j 2 --quiet",
    );
    assert_eq!(comparable(&at("run")), comparable(&at("again")));
    let found = record(&at("run"))["redocking"].take();
    let number = |value: &Value| value.as_f64().unwrap();
    let relaxed = &found["relaxed"];
    assert!(number(&relaxed["pose_score"]) > number(&found["predicted_score"]));
    // An ascent stays within 5 Å and an arc of 5 Å.
    assert!((0.0..10.0).contains(&number(&relaxed["rmsd_moved"])));
    assert!(number(&found["nearest_rotation_degrees"]) > 1.0);
    let rows = rows(&at("run"));
    let near = rows.iter().position(|row| row["capri"] != "incorrect");
    let rank = near.map(|row| row as u64 + 1);
    assert_eq!(found["near"]["rank"].as_u64(), rank);
    let answer = match rank {
        Some(1..=10) => "agrees",
        Some(_) => "found-lower",
        None => "does-not-agree",
    };
    assert_eq!(found["agreement"], answer);
}

/// The crystal complex is found again, and the same inhibitor turned away from its place is not.
#[test]
fn a_right_pose_agrees_and_a_wrong_one_does_not() {
    let folder = tempfile::tempdir().unwrap();
    trypsin(folder.path(), "right.pdb", None);
    trypsin(folder.path(), "wrong.pdb", Some(ELSEWHERE));
    let answer = |name: &str| {
        let command = format!(
            "dock --from-model {name}.pdb -o {name} --rotations 200 --write-top 0 --no-report"
        );
        let text = run(folder.path(), &command);
        (text, record(&folder.path().join(name))["redocking"].take())
    };
    let (text, right) = answer("right");
    assert!(
        text.contains("Docking agrees with the predicted pose: rank 1 "),
        "{text}"
    );
    assert_eq!(
        (&right["agreement"], &right["near"]["rank"]),
        (&"agrees".into(), &1.into())
    );
    let score = |of: &Value| of["pose_score"].as_f64().unwrap();
    assert!(score(&right["relaxed"]) > score(&right["best_elsewhere"]));
    assert_eq!(right["clusters_above"], 0);
    let (text, wrong) = answer("wrong");
    assert!(
        text.contains("Docking does not agree") || text.contains("lower"),
        "{text}"
    );
    assert_ne!(wrong["agreement"], "agrees");
    assert!(score(&wrong["relaxed"]) < score(&wrong["best_elsewhere"]));
    assert!(wrong["clusters_above"].as_u64() > Some(0));
}

#[test]
fn what_is_no_complex_of_two_sides_is_refused() {
    let folder = made();
    let ligand = molecules::ligand();
    fs::write(folder.path().join("one.pdb"), &ligand).unwrap();
    let far = molecules::pdb(&[0.0, 90.0].map(|x| molecules::Helix {
        chain: if x > 0.0 { 'B' } else { 'A' },
        first: 1,
        residues: 12,
        axis: [x, 0.0],
    }));
    fs::write(folder.path().join("far.pdb"), far).unwrap();
    for (arguments, expected) in [
        ("one.pdb", "one chain, A"),
        ("model.pdb", "the file has A, B, C"),
        ("model.pdb:A", "which chains"),
        ("model.pdb:A,B C", "chains of one side"),
        ("model.pdb:A,B A C", "which chains"),
        ("model.pdb A", "chains of one side"),
        ("model.pdb A,B X", "no chain 'X'"),
        ("far.pdb", "no heavy atoms within 5 Å"),
        ("model.pdb one.pdb", "takes one file"),
        ("missing.pdb", "no such file"),
        (
            "model.pdb A,B C --symmetry C2",
            "--symmetry does not work with --from-model",
        ),
        (
            "model.pdb A,B C --model all",
            "--model does not work with --from-model",
        ),
        (
            "model.pdb A,B C --config search.symmetry='C2'",
            "--symmetry does not work with",
        ),
        ("model.pdb A,B C --native model.pdb", "--native"),
        ("model.pdb A,B C --receptor-also one.pdb", "--receptor-also"),
        ("model.pdb A,B C --budget 5s", "--budget"),
    ] {
        let words = format!("dock --from-model {arguments} -o no {QUICK}");
        let error = refused(folder.path(), words.split_whitespace());
        let message = error["message"].as_str().unwrap();
        assert!(message.contains(expected), "{arguments}: {error}");
        let remedy = error["remedy"].as_str().unwrap();
        assert!(
            expected.starts_with('-') || !remedy.contains("--native"),
            "{error}"
        );
        assert!(!folder.path().join("no").exists());
    }
    let words = format!("dock one.pdb one.pdb --from-model model.pdb A,B C -o no {QUICK}");
    let error = refused(folder.path(), words.split_whitespace());
    assert!(
        error["message"].as_str().unwrap().contains("--from-model"),
        "{error}"
    );
}
