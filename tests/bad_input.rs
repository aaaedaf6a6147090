//! Each kind of bad input: exit code 2, a message that names the fault, the file and the line, and the remedy; and
//! nothing written.

use crate::molecules;
use std::fs;
use std::path::Path;

use assert_cmd::Command;
use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("receptor.pdb"), molecules::receptor()).unwrap();
        fs::write(folder.path().join("ligand.pdb"), molecules::ligand()).unwrap();
        Self { folder }
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path().join(name), text).unwrap();
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = cargo_bin_cmd!("knotdock");
        command.current_dir(self.path()).args(arguments);
        command
    }

    /// Runs what must be refused, and returns the JSON error after checking that the message for people says the same.
    fn refused(&self, arguments: &[&str]) -> Value {
        let before = self.files();
        let output = self.command(arguments).arg("--json").output().unwrap();
        assert_eq!(
            output.status.code(),
            Some(2),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        let object: Value = serde_json::from_slice(&output.stdout).unwrap();
        let error = &object["error"];
        assert_eq!(
            error.as_object().unwrap().keys().collect::<Vec<_>>(),
            ["file", "line", "message", "remedy"]
        );
        let message = error["message"].as_str().unwrap();
        let remedy = error["remedy"].as_str().unwrap();
        let reported = String::from_utf8(output.stderr).unwrap();
        assert!(
            reported.contains(message) && reported.contains(remedy),
            "{reported}"
        );
        assert_eq!(self.files(), before, "a refused run must leave nothing");
        error.clone()
    }

    fn files(&self) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(self.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    fn dock(&self, receptor: &str) -> Value {
        self.refused(&["dock", receptor, "ligand.pdb"])
    }
}

fn says(error: &Value, words: &str) {
    let message = error["message"].as_str().unwrap();
    assert!(message.contains(words), "{message}");
}

/// What an unset variable of a shell leaves: this was "no such file", in no file.
#[test]
fn no_file_at_all() {
    for name in ["", ":A"] {
        let error = Place::new().dock(name);
        says(&error, "names no file");
        assert_eq!(error["file"], Value::Null);
    }
}

#[test]
fn a_missing_file() {
    let error = Place::new().dock("nowhere.pdb");
    says(&error, "no such file");
    assert_eq!(error["file"], "nowhere.pdb");
    assert_eq!(error["line"], Value::Null);
}

#[test]
fn no_atoms() {
    let place = Place::new();
    place.write("empty.pdb", "HEADER    NOTHING\nREMARK   1\nEND\n");
    says(&place.dock("empty.pdb"), "no atoms");
}

#[test]
fn an_empty_selection() {
    let place = Place::new();
    place.write(
        "water.pdb",
        "HETATM    1  O   HOH A   1       0.000   0.000   0.000  1.00 10.00           O\nEND\n",
    );
    says(&place.dock("water.pdb"), "no atom is left");
}

#[test]
fn an_unknown_chain_lists_those_present() {
    let error = Place::new().dock("receptor.pdb:A,X");
    says(&error, "'X'");
    says(&error, "A, B");
    says(&Place::new().dock("receptor.pdb:"), "no chain");
}

#[test]
fn coordinates_that_are_not_numbers_name_their_line() {
    let place = Place::new();
    for number in ["     nan", "     inf", "   x.yz1"] {
        let text = molecules::receptor();
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        lines[6].replace_range(38..46, number);
        place.write("broken.pdb", &lines.join("\n"));
        let error = place.dock("broken.pdb");
        assert_eq!(error["line"], 7);
        assert_eq!(error["file"], "broken.pdb");
    }
}

#[test]
fn what_is_not_a_structure() {
    let place = Place::new();
    place.write("letter.pdb", "Dear all,\nthis is not a protein.\n");
    says(&place.dock("letter.pdb"), "not a structure");
    fs::create_dir(place.path().join("folder")).unwrap();
    says(&place.dock("folder"), "directory");
}

#[test]
fn a_model_that_is_not_there_and_nothing_left() {
    let place = Place::new();
    let model = |number: usize| {
        let atoms = molecules::receptor().replace("END\n", "");
        format!("MODEL     {number:>4}\n{atoms}ENDMDL\n")
    };
    place.write("models.pdb", &(model(1) + &model(2)));
    for command in ["dock", "score"] {
        let error = place.refused(
            &[
                command,
                "models.pdb",
                "ligand.pdb",
                "--model",
                "3",
                "--pose=1,0,0,0,0,0,0",
            ][..if command == "dock" { 5 } else { 6 }],
        );
        says(&error, "no model 3; the file has 2");
        assert_eq!(error["file"], "models.pdb");
    }
    place.write(
        "hetero.pdb",
        "HETATM    1 ZN    ZN A   1       0.000   0.000   0.000  1.00 10.00          ZN\nEND\n",
    );
    says(
        &place.refused(&["inspect", "hetero.pdb", "--hetatm", "drop"]),
        "no atom is left",
    );
    let error = place.refused(&["inspect", "receptor.pdb", "--atoms", "nowhere/atoms.csv"]);
    says(&error, "cannot write");
    says(
        &place.refused(&["inspect", "receptor.pdb", "--model", "2"]),
        "these have one",
    );
    // What the run recorded does not go with --rerun.
    place.refused(&["dock", "--rerun", "run.json", "--waters", "keep"]);
}

#[test]
fn a_directory_that_cannot_be_written_to() {
    let place = Place::new();
    // A file in the way stops even root, whom permissions do not.
    place.write("file", "");
    for directory in ["file", "file/run"] {
        let error = place.refused(&["dock", "receptor.pdb", "ligand.pdb", "-o", directory]);
        says(&error, "cannot write");
    }
}

#[test]
fn options_out_of_range() {
    let place = Place::new();
    for option in [
        ["--rotations", "0"],
        ["--rotations", "0deg"],
        ["--rotations", "0.2deg"],
        ["--config", "nowhere.toml"],
        ["--config", "receptor.pdb"],
        ["--spacing", "-1"],
        ["--offset", "nan"],
        ["--effects", "gravity"],
        ["--ph", "15"],
        ["--waters", "some"],
        ["--hetatm", "no"],
        ["--hydrogens", "no-additives"],
        ["--altloc", "AB"],
        ["--model", "0"],
        ["--min-plddt", "101"],
        ["--config", "terms.contact_weight=-1"],
        ["--contact-weight", "1"],
        ["--config", "contact_weight=1"],
        ["--preset", "quick"],
        ["--config", "terms.contact_potential='receptor.pdb'"],
        ["--config", "terms.contact_potential='nowhere.csv'"],
        ["--config", "terms.fine_contact_potential='receptor.pdb'"],
        ["--config", "terms.atom_pair_potential='receptor.pdb'"],
        ["--config", "terms.atom_pair_weight=-1"],
        ["--memory", "lots"],
        ["--threads", "0"],
        ["--native-receptor", "receptor.pdb"],
        ["--rerun", "run.json"],
        ["--no-such-option", "1"],
    ] {
        place.refused(&["dock", "receptor.pdb", "ligand.pdb", option[0], option[1]]);
    }
    place.refused(&["dock", "receptor.pdb"]);
    place.refused(&["dock"]);
    place.refused(&["fold", "receptor.pdb"]);
    place.refused(&["export", "run", "--rank", "0"]);
}

/// A truncated table is detected from its last line.
#[test]
fn a_table_of_kinds_that_is_not_whole() {
    let place = Place::new();
    let whole = include_str!("../scoring/src/terms/pose/atom_pair_potential.csv");
    let lines: Vec<&str> = whole.lines().take(100).collect();
    place.write("short.csv", &lines.join("\n"));
    let error = place.refused(&[
        "dock",
        "receptor.pdb",
        "ligand.pdb",
        "--config",
        "terms.atom_pair_potential='short.csv'",
    ]);
    says(&error, "pairs of kinds have no row");
    assert_eq!(error["file"], "short.csv");
    assert_eq!(error["line"], 100);
    let remedy = error["remedy"].as_str().unwrap();
    assert!(remedy.contains("atom_pair_potential.py"), "{remedy}");
}

#[test]
fn a_run_that_is_not_one() {
    let place = Place::new();
    place.write("run.json", "{\n \"schema\": 1,\n");
    let error = place.refused(&["dock", "--rerun", "run.json"]);
    says(&error, "run.json");
    assert_eq!(error["line"], 3);
    place.write(
        "run.json",
        "{\"schema\":99,\"program\":\"knotdock\",\"options\":7}",
    );
    says(
        &place.refused(&["dock", "--rerun", "run.json"]),
        "its schema is 99",
    );
    place.write("run.json", "{\"schema\":1}");
    place.refused(&["dock", "--rerun", "run.json"]);
    place.refused(&["export", "nowhere", "--rank", "1"]);
    place.refused(&["evaluate", "nowhere", "--native", "receptor.pdb"]);
}

#[test]
fn help_and_version_are_no_errors() {
    let place = Place::new();
    for arguments in [
        ["--version", "--json"],
        ["--help", "--json"],
        ["dock", "--help"],
    ] {
        let output = place.command(&arguments).output().unwrap();
        assert!(output.status.success());
        assert!(output.stderr.is_empty());
    }
}

/// Found by an audit: `--lambda -1` was an unexpected argument, and the tip would have made a file of it.
#[test]
fn a_negative_number_is_judged_as_the_value_that_it_is() {
    let place = Place::new();
    for option in [
        "--lambda",
        "--rotations",
        "--fine-rotations",
        "--resolution",
        "--ph",
        "--threads",
    ] {
        let error = place.refused(&["dock", "receptor.pdb", "ligand.pdb", option, "-1"]);
        says(&error, &format!("invalid value '-1' for '{option}"));
    }
}

/// Found by an audit: a structure was replaced by the table of its atoms, and a run.json by a table of poses.
#[test]
fn no_file_is_written_over_one_that_is_read_nor_over_another_unasked() {
    let place = Place::new();
    let same = "is one of the input files";
    let ligand = fs::read(place.path().join("ligand.pdb")).unwrap();
    for name in ["ligand.pdb", "./ligand.pdb"] {
        let inspect = ["inspect", "ligand.pdb", "--atoms", name, "--force"];
        says(&place.refused(&inspect), same);
    }
    place.write("notes.txt", "mine");
    let inspect = ["inspect", "ligand.pdb", "--atoms", "notes.txt"];
    says(&place.refused(&inspect), "already there");
    let poses = "rank,qw,qx,qy,qz,tx,ty,tz\n1,1,0,0,0,0,0,0\n";
    place.write("poses.csv", poses);
    let molecules = ["receptor.pdb", "ligand.pdb"];
    let evaluate = |output: &'static str, force: &[&'static str]| {
        let mut words = vec!["evaluate", "poses.csv", "-o", output];
        for (options, file) in [
            ["--receptor", "--native-receptor"],
            ["--ligand", "--native-ligand"],
        ]
        .iter()
        .zip(molecules)
        {
            words.extend([options[0], file, options[1], file]);
        }
        words.extend(force);
        words
    };
    says(&place.refused(&evaluate("ligand.pdb", &["--force"])), same);
    says(&place.refused(&evaluate("poses.csv", &[])), "already there");
    assert_eq!(fs::read(place.path().join("ligand.pdb")).unwrap(), ligand);
    let kept = |name| fs::read_to_string(place.path().join(name)).unwrap();
    assert_eq!(
        (kept("notes.txt"), kept("poses.csv")),
        ("mine".into(), poses.into())
    );
    // The table itself may have its columns added, if that is said.
    place
        .command(&evaluate("poses.csv", &["--force"]))
        .assert()
        .success();
    assert!(kept("poses.csv").contains("dockq"));
}

/// A program that requests an object and gets none must get an error code; a person who closes the pipe need not.
#[cfg(target_os = "linux")]
#[test]
fn an_object_that_cannot_be_written_is_a_failure() {
    let place = Place::new();
    let full = fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_knotdock"));
    let command = command.current_dir(place.path()).stdout(full);
    let output = command
        .args(["inspect", "ligand.pdb", "--json"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let reported = String::from_utf8_lossy(&output.stderr);
    assert!(
        reported.contains("cannot write to standard output"),
        "{reported}"
    );
}

/// Found by an audit: the error on a mesh named an option of another command, and a picture with another extension
/// was an SVG all the same.
#[test]
fn a_mesh_too_thin_for_its_grid() {
    let place = Place::new();
    let corner = |x: f64, y: f64, z: f64| format!("v {x} {y} {z}\n");
    let corners = [0.0, 0.1].map(|z| {
        [
            corner(0.0, 0.0, z),
            corner(10.0, 0.0, z),
            corner(10.0, 10.0, z),
            corner(0.0, 10.0, z),
        ]
        .concat()
    });
    let faces = "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    place.write("plate.obj", &(corners.concat() + faces));
    let words = ["sample", "plate.obj", "--grid", "2^12", "-o", "balls.csv"];
    let with = |more: &[&'static str]| [&words[..], more].concat();
    says(
        &place.refused(&with(&["--weights", "fitted"])),
        "there are none",
    );
    says(
        &place.refused(&with(&["--picture", "plate.png"])),
        "--picture writes .svg",
    );
    let output = place.command(&with(&["--json"])).output().unwrap();
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        object["inside_nodes"], 0,
        "or else the plate is too thick for this test"
    );
    assert!(object["volume"].is_null() && object["sets"][0]["volume_missed"].is_null());
    assert_eq!(object["warnings"].as_array().unwrap().len(), 1);
    let reported = place.command(&with(&["--force"])).output().unwrap();
    let reported = String::from_utf8(reported.stdout).unwrap();
    assert!(
        !reported.contains("NaN") && !reported.contains("inf "),
        "{reported}"
    );
    let error = place.refused(&["dock", "plate.obj", "plate.obj", "--sample-grid", "2^12"]);
    assert!(
        error["remedy"].as_str().unwrap().contains("--sample-grid"),
        "{error}"
    );
}

/// clap suggests what is spelled alike. For a weight that would be another option.
#[test]
fn misspelled_words_are_refused_with_a_remedy() {
    for (words, tip, remedy) in [
        (
            "dock a.pdb b.pdb --rotatons 9",
            "'--rotations'",
            "is `--rotations` meant?",
        ),
        ("evalute run", "'evaluate'", "is `evaluate` meant?"),
        (
            "dock a.pdb b.pdb --contact-weight 2",
            "--config terms.contact_weight=VALUE",
            "--config terms.contact_weight=VALUE",
        ),
    ] {
        let ended = cargo_bin_cmd!("knotdock")
            .args(words.split(' '))
            .assert()
            .code(2);
        let reported = String::from_utf8_lossy(&ended.get_output().stderr).into_owned();
        assert!(reported.contains(tip), "{reported}");
        let ended = cargo_bin_cmd!("knotdock")
            .arg("--json")
            .args(words.split(' '))
            .assert()
            .code(2);
        let object: serde_json::Value = serde_json::from_slice(&ended.get_output().stdout).unwrap();
        let given = object["error"]["remedy"].as_str().unwrap();
        assert!(given.contains(remedy), "{given}");
    }
}

/// Units and remedies that a new user missed. `1deg` was "a whole number between ...", and 5 was seconds without a
/// notice. One file alone was refused without a hint at rings, and memory was counted in bytes.
#[test]
fn messages_name_units_and_remedies() {
    let place = Place::new();
    let pair = ["dock", "receptor.pdb", "ligand.pdb"];
    let with = |more: &[&str]| place.refused(&[&pair[..], more].concat());
    says(
        &with(&["--rotations", "1deg"]),
        "an angle of at least 1.07 degrees",
    );
    let memory = with(&["--memory", "10M"]);
    says(&memory, "MB of memory, and 10 MB are allowed");
    let config = with(&["--config", "missing.toml"]);
    says(&config, "the file of options cannot be read");
    assert_eq!(config["file"], "missing.toml");
    let alone = place.refused(&["dock", "receptor.pdb"]);
    let remedy = alone["remedy"].as_str().unwrap();
    assert!(remedy.contains("--symmetry C2"), "{remedy}");
}

/// CA atoms alone were ranked by an all-atom score, and the run ended well.
#[test]
fn a_trace_of_a_protein() {
    let place = Place::new();
    let trace: String = molecules::receptor()
        .lines()
        .filter(|line| line.get(12..16) == Some(" CA "))
        .map(|line| format!("{line}\n"))
        .collect();
    place.write("trace.pdb", &trace);
    says(
        &place.dock("trace.pdb"),
        "the receptor is no all-atom model",
    );
    let pose = "--pose=1,0,0,0,0,0,0";
    says(
        &place.refused(&["score", "ligand.pdb", "trace.pdb", pose]),
        "the ligand is no all-atom model",
    );
}
