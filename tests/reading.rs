//! Reading of predicted models and of biological assemblies, through every command: it is reported, recorded and
//! followed.

use crate::molecules;
use std::fs;
use std::path::Path;

use crate::program::succeed;
use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

/// The ligand as predicted: pLDDT 42, 47, 52 ... 97, two residues below 50.
fn predicted() -> String {
    let lines = molecules::ligand();
    let lines = lines.lines().map(|line| match line.get(22..26) {
        Some(number) => {
            let number: f64 = number.trim().parse().unwrap();
            line.replace(" 10.00 ", &format!("{:>6.2} ", 37.0 + 5.0 * number))
        }
        None => line.to_owned(),
    });
    lines.map(|line| line + "\n").collect()
}

fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("receptor.pdb"), molecules::receptor()).unwrap();
    fs::write(folder.path().join("ligand.pdb"), molecules::ligand()).unwrap();
    fs::write(folder.path().join("model.pdb"), predicted()).unwrap();
    let native = molecules::receptor().replace("END\n", "")
        + &molecules::ligand().replace(" ALA A", " ALA C");
    fs::write(folder.path().join("native.pdb"), native).unwrap();
    folder
}

fn json(folder: &Path, arguments: &str) -> Value {
    let output = succeed(folder, arguments.split_whitespace());
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The run in `run`, whose record is `first`, repeats from it: the same table, options and first complex.
fn hold_repeated(folder: &Path, first: &Value) {
    let commands = [
        "dock --rerun run/run.json -o again --quiet",
        "export run --rank 1 -o out --quiet",
    ];
    for command in commands {
        succeed(folder, command.split_whitespace());
    }
    let bytes = |name: &str| fs::read(folder.join(name)).unwrap();
    assert_eq!(bytes("run/poses.csv"), bytes("again/poses.csv"));
    assert_eq!(bytes("run/top/rank_0001.pdb"), bytes("out/rank_0001.pdb"));
    let again: Value = serde_json::from_slice(&bytes("again/run.json")).unwrap();
    assert_eq!(again["options"], first["options"]);
}

#[test]
fn residues_left_out_are_recorded_and_followed() {
    let folder = place();
    let folder = folder.path();
    let run = "dock receptor.pdb model.pdb --min-plddt 50 --rotations 20 --write-top 1 --native native.pdb -o run \
        --quiet";
    succeed(folder, run.split_whitespace());
    let recorded = |name: &str| -> Value {
        serde_json::from_slice(&fs::read(folder.join(name).join("run.json")).unwrap()).unwrap()
    };
    let first = recorded("run");
    assert_eq!(first["options"]["input"]["min_plddt"], 50.0);
    let ligand = &first["inputs"]["ligand"];
    assert_eq!(ligand["atoms"], 50);
    assert_eq!(
        ligand["report"]["confidence"],
        serde_json::json!({"source": "values", "mean": 69.5, "residues": 12, "below_50": 2})
    );
    assert_eq!(
        first["inputs"]["receptor"]["report"]["confidence"],
        Value::Null
    );

    hold_repeated(folder, &first);
    let matched = json(folder, "evaluate run --native native.pdb --json");
    assert_eq!(matched["match"], first["match"]);
    let named = "evaluate run/poses.csv --receptor receptor.pdb --ligand model.pdb --min-plddt 50 \
        --native native.pdb --json";
    assert_eq!(json(folder, named), matched);
}

#[test]
fn inspect_says_how_sure_the_model_is() {
    let folder = place();
    let folder = folder.path();
    let reported = json(folder, "inspect model.pdb --json");
    assert_eq!(reported["input"]["atoms"], 60);
    assert_eq!(reported["input"]["report"]["confidence"]["below_50"], 2);
    let warnings = reported["input"]["report"]["warnings"].to_string();
    assert!(warnings.contains("--min-plddt 50"), "{warnings}");
    succeed(
        folder,
        "inspect model.pdb --min-plddt 50 --atoms atoms.csv --quiet".split_whitespace(),
    );
    let table = fs::read_to_string(folder.join("atoms.csv")).unwrap();
    let left_out = table
        .lines()
        .filter(|line| line.ends_with(",,low_confidence"));
    assert_eq!(left_out.count(), 10);
    assert_eq!(table.lines().count(), 61);
}

/// The ligand as half of a dimer, whose axis stands along z at (4.75, 14).
fn half_of_a_dimer() -> String {
    let remark = "REMARK 350 BIOMOLECULE: 1\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n\
        REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n\
        REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n\
        REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\n\
        REMARK 350   BIOMT1   2 -1.000000  0.000000  0.000000        9.50000\n\
        REMARK 350   BIOMT2   2  0.000000 -1.000000  0.000000       28.00000\n\
        REMARK 350   BIOMT3   2  0.000000  0.000000  1.000000        0.00000\n";
    remark.to_owned() + &molecules::ligand()
}

#[test]
fn an_assembly_is_recorded_and_followed() {
    let folder = place();
    let folder = folder.path();
    fs::write(folder.join("half.pdb"), half_of_a_dimer()).unwrap();
    let reported = json(folder, "inspect half.pdb --json");
    assert!(
        reported["input"]["report"]["warnings"]
            .to_string()
            .contains("--assembly 1")
    );
    let run = "dock receptor.pdb half.pdb --assembly 1 --rotations 20 --write-top 1 --native native.pdb -o run --quiet";
    succeed(folder, run.split_whitespace());
    let text = fs::read(folder.join("run/run.json")).unwrap();
    let first: Value = serde_json::from_slice(&text).unwrap();
    assert_eq!(first["options"]["input"]["assembly"], "1");
    assert_eq!(first["inputs"]["ligand"]["atoms"], 120);
    assert_eq!(
        first["inputs"]["ligand"]["report"]["assembly"],
        serde_json::json!({"id": "1", "chains": 2, "chains_in_file": 1, "on_axes": 0})
    );
    // The receptor's file describes no assembly, and is read as it is.
    assert_eq!(
        first["inputs"]["receptor"]["report"]["assembly"],
        Value::Null
    );
    assert_eq!(first["chains"].as_array().unwrap().len(), 4);
    hold_repeated(folder, &first);
    assert_eq!(
        String::from_utf8(fs::read(folder.join("out/rank_0001.pdb")).unwrap())
            .unwrap()
            .lines()
            .filter(|line| line.starts_with("ATOM"))
            .count(),
        270
    );
    succeed(
        folder,
        "evaluate run --native native.pdb --quiet".split_whitespace(),
    );
}

/// What is kept of a file is written as a structure: an assembly, here a known complex, is read again as it was built.
#[test]
fn an_assembly_is_written_and_read_again() {
    let folder = place();
    let folder = folder.path();
    fs::write(folder.join("half.pdb"), half_of_a_dimer()).unwrap();
    for name in ["dimer.pdb", "dimer.cif"] {
        let built = json(
            folder,
            &format!("inspect half.pdb --assembly 1 --write {name} --json"),
        );
        let again = json(folder, &format!("inspect {name} --json"));
        for entry in ["labels", "accessible_area"] {
            assert_eq!(built[entry], again[entry], "{name}");
        }
        assert_eq!(again["input"]["atoms"], 120);
    }
    let text = fs::read_to_string(folder.join("dimer.pdb")).unwrap();
    assert!(
        text.contains("chain B was A-2") && !text.contains("chain A was"),
        "{text}"
    );
    let chains = json(folder, "inspect dimer.cif --json");
    assert_eq!(chains["input"]["report"]["chains"][1]["name"], "A-2");
    succeed(
        folder,
        "inspect half.pdb --assembly 1 --write dimer.pdb --force --quiet".split_whitespace(),
    );

    for (options, says) in [
        ("--write dimer.pdb", "already there"),
        ("--write half.pdb --force", "one of the input files"),
        ("--write dimer.txt", "neither in .pdb nor in .cif"),
        ("--write all.cif --atoms all.cif", "named twice"),
        ("--force", "required"),
    ] {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder)
            .args(format!("inspect half.pdb {options}").split_whitespace())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{options}");
        let reported = String::from_utf8_lossy(&output.stderr);
        assert!(reported.contains(says), "{options}: {reported}");
    }
    assert!(!folder.join("all.cif").exists());
}

/// A molecule of two models that lie side by side: the ligand, and itself moved along x.
fn two_models() -> String {
    let moved = molecules::ligand().replace("END\n", "");
    let moved = moved.lines().map(|line| {
        let x: f64 = line[30..38].trim().parse().unwrap();
        format!("{}{:>8.3}{}\n", &line[..30], x + 12.0, &line[38..])
    });
    let first = molecules::ligand().replace("END\n", "");
    format!(
        "MODEL        1\n{first}ENDMDL\nMODEL        2\n{}ENDMDL\nEND\n",
        moved.collect::<String>()
    )
}

/// Found by a user: only half of an assembly in models was docked. Every command reads all models where they are
/// requested.
#[test]
fn all_models_are_recorded_and_followed() {
    let folder = place();
    let folder = folder.path();
    fs::write(folder.join("dimer.pdb1"), two_models()).unwrap();
    let reported = json(folder, "inspect dimer.pdb1 --json");
    assert_eq!(reported["input"]["atoms"], 60);
    let warnings = reported["input"]["report"]["warnings"].to_string();
    assert!(warnings.contains("--model all"), "{warnings}");
    let reported = json(
        folder,
        "inspect dimer.pdb1:A-2 --model all --atoms atoms.csv --json",
    );
    assert_eq!(reported["input"]["atoms"], 60);

    let run = "dock receptor.pdb dimer.pdb1 --model all --rotations 20 --write-top 1 --native native.pdb -o run \
        --quiet";
    succeed(folder, run.split_whitespace());
    let recorded = |name: &str| -> Value {
        serde_json::from_slice(&fs::read(folder.join(name).join("run.json")).unwrap()).unwrap()
    };
    let first = recorded("run");
    assert_eq!(first["options"]["input"]["model"], "all");
    let ligand = &first["inputs"]["ligand"];
    assert_eq!(ligand["atoms"], 120);
    assert_eq!(
        ligand["report"]["joined_models"],
        serde_json::json!({"models": 2, "on_axes": 0})
    );
    hold_repeated(folder, &first);
    let matched = json(folder, "evaluate run --native native.pdb --json");
    assert_eq!(matched["match"], first["match"]);

    let pairs = "name,receptor,ligand,model,rotations\nfirst,receptor.pdb,dimer.pdb1,all,20\n";
    fs::write(folder.join("pairs.csv"), pairs).unwrap();
    succeed(folder, "batch pairs.csv -o runs --quiet".split_whitespace());
    assert_eq!(recorded("runs/first")["options"]["input"]["model"], "all");
    assert_eq!(recorded("runs/first")["inputs"]["ligand"]["atoms"], 120);

    // Two files of one model have none to join.
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .args("dock receptor.pdb ligand.pdb --model all".split_whitespace())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains("--model all is for files of several models"),
        "{said}"
    );
}

/// The option that B values are pLDDT is followed if no file is detected as a prediction. If one is, a measured partner
/// is left unchanged.
#[test]
fn b_values_that_the_user_calls_plddt_are_read_as_such() {
    let folder = place();
    let folder = folder.path();
    // pLDDT 22, 27 ... 77: a mean of 49.5, from which nothing can be detected.
    let low = predicted().lines().fold(String::new(), |text, line| {
        let line = match line
            .get(60..66)
            .and_then(|value| value.trim().parse::<f64>().ok())
        {
            Some(value) => format!("{}{:>6.2}{}", &line[..60], value - 20.0, &line[66..]),
            None => line.to_owned(),
        };
        text + &line + "\n"
    });
    fs::write(folder.join("low.pdb"), &low).unwrap();
    let reported = json(folder, "inspect low.pdb --min-plddt 50 --json");
    assert_eq!(reported["input"]["report"]["confidence"]["source"], "user");
    assert_eq!(reported["input"]["atoms"], 30);
    let warnings = reported["input"]["report"]["warnings"].to_string();
    assert!(
        warnings.contains("because --min-plddt is given"),
        "{warnings}"
    );

    let run = "dock receptor.pdb low.pdb --min-plddt 50 --rotations 20 --write-top 0 --native native.pdb -o run \
        --quiet";
    succeed(folder, run.split_whitespace());
    let text = fs::read(folder.join("run/run.json")).unwrap();
    let first: Value = serde_json::from_slice(&text).unwrap();
    let inputs = &first["inputs"];
    assert_eq!(inputs["ligand"]["report"]["confidence"]["source"], "user");
    // All B values of the receptor are 10, which is no pLDDT.
    assert_eq!(inputs["receptor"]["report"]["confidence"], Value::Null);
    let matched = json(folder, "evaluate run --native native.pdb --json");
    assert_eq!(matched["match"], first["match"]);
    let named = "evaluate run --ligand low.pdb --min-plddt 50 --native native.pdb --json";
    assert_eq!(json(folder, named)["match"], first["match"]);

    // Beside a model that is known as one, what may be measured stays.
    let beside =
        "dock low.pdb model.pdb --min-plddt 50 --rotations 20 --write-top 0 -o beside --quiet";
    succeed(folder, beside.split_whitespace());
    let text = fs::read(folder.join("beside/run.json")).unwrap();
    let inputs = serde_json::from_slice::<Value>(&text).unwrap()["inputs"].clone();
    assert_eq!(inputs["receptor"]["atoms"], 60);
    assert_eq!(inputs["ligand"]["atoms"], 50);
}

/// Residues of a chain are docked, and recorded as they were picked.
#[test]
fn picked_residues_are_recorded_and_followed() {
    let folder = place();
    let folder = folder.path();
    let run = "dock receptor.pdb:A:3-12,B ligand.pdb:A:2-6,8 --active-ligand A:2,3,4-6 --rotations 20 \
        --write-top 1 -o run --quiet";
    succeed(folder, run.split_whitespace());
    let text = fs::read(folder.join("run/run.json")).unwrap();
    let first: Value = serde_json::from_slice(&text).unwrap();
    let inputs = &first["inputs"];
    assert_eq!(
        inputs["receptor"]["chains"],
        serde_json::json!(["A:3-12", "B"])
    );
    assert_eq!(inputs["receptor"]["atoms"], 5 * 24);
    assert_eq!(inputs["ligand"]["atoms"], 5 * 6);
    assert_eq!(first["options"]["restraints"]["active_ligand"], "A:2,3,4-6");
    hold_repeated(folder, &first);

    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .args("dock receptor.pdb ligand.pdb --active-ligand 5".split_whitespace())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("write A:5"), "{said}");
}

/// Options that would do nothing are refused, and not ignored.
#[test]
fn what_would_do_nothing_is_refused() {
    let folder = place();
    let commands = [
        "dock receptor.pdb ligand.pdb",
        "score receptor.pdb ligand.pdb --pose 1,0,0,0,0,0,0",
        "inspect ligand.pdb",
        "tradeoff receptor.pdb ligand.pdb",
    ];
    let options = [
        (
            "--min-plddt 50",
            "no B values here can be pLDDT: all B values are 10",
            "_ma_qa_metric",
        ),
        (
            "--assembly 1",
            "--assembly is for files that describe",
            "REMARK 350",
        ),
    ];
    for (command, (option, says, remedy)) in commands
        .iter()
        .flat_map(|command| options.map(|option| (command, option)))
    {
        let command = format!("{command} {option} --json");
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(command.split_whitespace())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{command}");
        let reported: Value = serde_json::from_slice(&output.stdout).unwrap();
        let message = reported["error"]["message"].as_str().unwrap();
        assert!(message.contains(says), "{message}");
        assert!(
            reported["error"]["remedy"]
                .as_str()
                .unwrap()
                .contains(remedy)
        );
    }
    // The files of a run are read again as the run read them, whatever the options say now.
    let run = "dock receptor.pdb ligand.pdb --rotations 20 --write-top 0 --native native.pdb -o run --quiet";
    succeed(folder.path(), run.split_whitespace());
    for (options, says) in [
        ("--waters keep", "need --receptor and --ligand"),
        ("--min-plddt 50", "need --receptor and --ligand"),
        ("--ligand ligand.pdb --min-plddt 50", "predicted models"),
    ] {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(format!("evaluate run {options}").split_whitespace())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{options}");
        let reported = String::from_utf8_lossy(&output.stderr);
        assert!(reported.contains(says), "{options}: {reported}");
    }
    succeed(
        folder.path(),
        "score receptor.pdb model.pdb --pose 1,0,0,0,0,0,0 --min-plddt 50 --quiet"
            .split_whitespace(),
    );
}

/// Found by a review: the known complex was read twice, which of a pipe is nothing the second time.
#[cfg(target_os = "linux")]
#[test]
fn the_known_complex_may_come_from_a_pipe() {
    let folder = place();
    let folder = folder.path();
    let run = "dock receptor.pdb ligand.pdb --rotations 20 --write-top 0 -o run --quiet";
    succeed(folder, run.split_whitespace());
    let piped = cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .args("evaluate run --native /dev/stdin --json".split_whitespace())
        .write_stdin(fs::read(folder.join("native.pdb")).unwrap())
        .output()
        .unwrap();
    let reported: Value = serde_json::from_slice(&piped.stdout).unwrap();
    assert_eq!(
        reported,
        json(folder, "evaluate run --native native.pdb --json")
    );
}

/// Found by an audit: a table that a full disk cut short was a success.
#[cfg(target_os = "linux")]
#[test]
fn a_report_that_cannot_be_written_is_a_failure() {
    let folder = place();
    for more in [&[][..], &["--json"]] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full");
        let output = std::process::Command::new(assert_cmd::cargo::cargo_bin!("knotdock"))
            .current_dir(folder.path())
            .args(["inspect", "receptor.pdb"])
            .args(more)
            .stdout(full.unwrap())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1));
        let reported = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            reported.contains("cannot write to standard output"),
            "{reported}"
        );
    }
}

/// A pipe can be read but once: the record, the table of atoms and the measures come from one reading.
#[cfg(target_os = "linux")]
#[test]
fn a_pipe_is_recorded_as_what_came_through_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = concat!(
        concat!(env!("CARGO_MANIFEST_DIR"), "/.."),
        "/structures/examples/1ppe_ligand_unbound.pdb"
    );
    let inspect = |input: &str, atoms: &str| -> Value {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(["inspect", input, "--atoms", atoms, "--json"])
            .write_stdin(fs::read(file).unwrap())
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let [whole, piped] = [(file, "whole.csv"), ("/dev/stdin", "piped.csv")]
        .map(|(input, atoms)| inspect(input, atoms));
    assert_eq!(whole["input"]["sha256"], piped["input"]["sha256"]);
    assert_eq!(whole["labels"], piped["labels"]);
    let table = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(table("whole.csv"), table("piped.csv"));
}
