//! `--config`: options from a file, the commands that take them, and the order of precedence.

use crate::molecules;
use std::fs;
use std::path::Path;

use crate::program::succeed;
use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

const OPTIONS: &str = "\
# A quick look.
[search]
rotations = 24
poses = 60

[kernel]
effects = \"shape\"
lambda = 5

[output]
write_top = 2
";

fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("receptor.pdb"), molecules::receptor()).unwrap();
    fs::write(folder.path().join("ligand.pdb"), molecules::ligand()).unwrap();
    fs::write(folder.path().join("quick.toml"), OPTIONS).unwrap();
    folder
}

fn json(folder: &Path, arguments: &str) -> Value {
    let output = succeed(folder, arguments.split_whitespace());
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The error of a command that is refused.
fn refused(folder: &Path, arguments: &str) -> Value {
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .arg("--json")
        .args(arguments.split_whitespace())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments}");
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    object["error"].clone()
}

#[test]
fn a_file_stands_for_what_would_be_typed_and_what_is_typed_wins() {
    let folder = place();
    let docked = |options: &str| {
        let reported = json(
            folder.path(),
            &format!("dock receptor.pdb ligand.pdb {options} --json"),
        );
        let poses = fs::read(reported["poses"].as_str().unwrap()).unwrap();
        (poses, reported["run"]["options"].clone())
    };
    let at = |name: &str| folder.path().join(name).display().to_string();
    let typed = docked(&format!(
        "--rotations 24 --poses 60 --effects shape --lambda 5 --write-top 2 -o {}",
        at("typed")
    ));
    let from_file = docked(&format!("--config quick.toml -o {}", at("file")));
    assert_eq!(typed, from_file);
    let (_, options) = docked(&format!(
        "--config quick.toml --lambda 7 --rotations 90deg -o {}",
        at("both")
    ));
    assert_eq!(options["kernel"]["lambda"], 7.0);
    assert_eq!(options["search"]["rotations"], 17);
    assert_eq!(options["search"]["poses"], 60);
    // The record is complete: nothing of the file is needed to repeat the run.
    fs::remove_file(folder.path().join("quick.toml")).unwrap();
    succeed(
        folder.path(),
        "dock --rerun file/run.json -o again -q".split(' '),
    );
    let again = fs::read(folder.path().join("again/poses.csv")).unwrap();
    assert_eq!(again, typed.0);
}

/// A file holds options of `knotdock dock`; other commands take theirs of it, and a batch hands it to each pair.
#[test]
fn other_commands_take_their_part_of_a_file() {
    let folder = place();
    let score = |options: &str| {
        let pose = "score receptor.pdb ligand.pdb --pose 1,0,0,0,0,0,0 --json";
        json(folder.path(), &format!("{pose} {options}"))["exact"].clone()
    };
    assert_eq!(
        score("--config quick.toml"),
        score("--lambda 5 --effects shape")
    );
    fs::write(
        folder.path().join("pairs.csv"),
        "receptor,ligand\nreceptor.pdb,ligand.pdb\n",
    )
    .unwrap();
    let batch = "batch pairs.csv -o runs -q -- --config quick.toml --poses 40";
    succeed(folder.path(), batch.split(' '));
    let record = fs::read(folder.path().join("runs/receptor_ligand/run.json")).unwrap();
    let record: Value = serde_json::from_slice(&record).unwrap();
    assert_eq!(record["options"]["search"]["rotations"], 24);
    assert_eq!(record["options"]["search"]["poses"], 40);
    let error = refused(
        folder.path(),
        "batch pairs.csv -o others -q -- --config no.toml",
    );
    assert!(error["message"].is_string());
}

#[test]
fn what_is_wrong_with_a_file_is_reported_with_its_line() {
    let folder = place();
    for (text, line, part) in [
        ("[search]\nrotations = 0\n", 2, "between 1 and"),
        ("[search]\nturns = 9\n", 2, "no option `turns`"),
        ("[speed]\nrotations = 9\n", 1, "`speed`"),
        ("rotations = 9\n", 1, "`rotations`"),
    ] {
        fs::write(folder.path().join("wrong.toml"), text).unwrap();
        let error = refused(
            folder.path(),
            "dock receptor.pdb ligand.pdb --config wrong.toml",
        );
        assert_eq!(error["file"], "wrong.toml");
        assert_eq!(error["line"], line, "{text}");
        assert!(error["message"].as_str().unwrap().contains(part), "{error}");
        assert!(error["remedy"].is_string());
    }
    // A file that it names has its own faults.
    let text = "[terms]\n\ncontact_potential = \"no.csv\"\n";
    fs::write(folder.path().join("wrong.toml"), text).unwrap();
    let pair = "dock receptor.pdb ligand.pdb --config wrong.toml";
    let error = refused(folder.path(), pair);
    assert_eq!(error["file"], "no.csv");
    let remedy = error["remedy"].as_str().unwrap();
    assert!(
        remedy.ends_with("wrong.toml, line 3 names the file"),
        "{remedy}"
    );
    // What the file says counts as given: molecules have no grid.
    fs::write(
        folder.path().join("meshes.toml"),
        "[sampling]\nsample_grid = \"2^12\"\n",
    )
    .unwrap();
    let error = refused(
        folder.path(),
        "dock receptor.pdb ligand.pdb --config meshes.toml",
    );
    assert!(error["message"].as_str().unwrap().contains("for meshes"));
    refused(folder.path(), "dock --config quick.toml --rerun run.json");
    refused(folder.path(), "dock receptor.pdb --config quick.toml");
}

/// A ring of a file is one of the command line, but for the ligand, which clap cannot know to be one too many.
#[test]
fn rings_and_angles_in_a_file() {
    let folder = place();
    let ring = "[search]\nsymmetry = \"C3\"\nposes = 40\n[kernel]\neffects = \"shape\"\n";
    let write = |more: &str| {
        let text = ring.replace("poses", &format!("{more}poses"));
        fs::write(folder.path().join("ring.toml"), text).unwrap();
    };
    write("rotations = 12\n");
    let reported = json(
        folder.path(),
        "dock receptor.pdb --config ring.toml -o ring --json",
    );
    assert_eq!(reported["run"]["options"]["search"]["rotations"], 12);
    refused(
        folder.path(),
        "dock receptor.pdb ligand.pdb --config ring.toml",
    );
    refused(
        folder.path(),
        "dock receptor.pdb --config ring.toml --budget 5s",
    );
    write("rotations = \"12deg\"\n");
    let error = refused(folder.path(), "dock receptor.pdb --config ring.toml");
    assert!(error["message"].as_str().unwrap().contains("axes"));
}
