//! `knotdock tradeoff`: its table, its fronts, its advice and its refusals, on two helices and on two meshes.

use crate::docking_parts;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

fn case(name: &str) -> String {
    let path =
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("tests/scoring_table/cases");
    path.join(name).display().to_string()
}

fn tradeoff(folder: &Path, arguments: &[&str]) -> Output {
    cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .arg("tradeoff")
        .args(arguments)
        .output()
        .unwrap()
}

/// A sweep that must succeed: the object on standard output.
fn swept(folder: &Path, arguments: &[&str]) -> Value {
    let output = tradeoff(folder, &[arguments, &["--json"]].concat());
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{words}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The table: header and rows.
fn table(path: PathBuf) -> (Vec<String>, Vec<Vec<String>>) {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let header = reader
        .headers()
        .unwrap()
        .iter()
        .map(str::to_owned)
        .collect();
    let rows = reader
        .records()
        .map(|record| record.unwrap().iter().map(str::to_owned).collect())
        .collect();
    (header, rows)
}

/// Table and JSON say the same, each of them has every column, and nothing on a front is beaten there.
fn check(folder: &Path, object: &Value) {
    let directory = folder.join("out");
    let (header, rows) = table(directory.join("tradeoff.csv"));
    let settings = object["tradeoff"]["settings"].as_array().unwrap();
    assert_eq!(rows.len(), settings.len());
    for (row, setting) in rows.iter().zip(settings) {
        assert_eq!(setting.as_object().unwrap().len(), header.len());
        for (name, field) in header.iter().zip(row) {
            match &setting[name] {
                Value::Null => assert_eq!(field, "", "{name}"),
                Value::String(text) => assert_eq!(field, text, "{name}"),
                Value::Bool(value) => assert_eq!(field, &value.to_string(), "{name}"),
                value => assert_eq!(field.parse::<f64>().ok(), value.as_f64(), "{name}"),
            }
        }
    }
    let number = |setting: &Value, name: &str| setting[name].as_f64().unwrap();
    assert_eq!(settings[0]["setting"], "default");
    assert_eq!(settings[1]["setting"], "reference");
    assert_eq!(number(&settings[1], "agreement"), 1.0);
    let competitors = |own_score: bool| {
        settings.iter().filter(move |setting| {
            setting["parameter"] != "reference"
                && setting["parameter"] != "repeat"
                && (!own_score
                    || ["resolution", "sample_grid"]
                        .iter()
                        .all(|name| setting[name] == settings[0][name]))
        })
    };
    let beats = |a: &Value, b: &Value, loss: &dyn Fn(&Value) -> f64| {
        let (costs, losses) = ([a, b].map(|x| number(x, "cpu_seconds")), [loss(a), loss(b)]);
        costs[0] <= costs[1]
            && losses[0] <= losses[1]
            && (costs[0] < costs[1] || losses[0] < losses[1])
    };
    let error = |setting: &Value| number(setting, "error_rms");
    let missed = |setting: &Value| 1.0 - number(setting, "agreement");
    type Loss<'a> = &'a dyn Fn(&Value) -> f64;
    let fronts: [(&str, bool, Loss); 2] = [
        ("front_error", true, &error),
        ("front_agreement", false, &missed),
    ];
    for (column, own_score, loss) in fronts {
        assert!(competitors(own_score).any(|setting| setting[column] == true));
        assert_eq!(settings[1][column], false);
        for setting in competitors(own_score) {
            let beaten = competitors(own_score).any(|other| beats(other, setting, loss));
            assert_eq!(
                setting[column], !beaten,
                "{column} of {}",
                setting["setting"]
            );
        }
    }
    let advice = &object["tradeoff"]["advice"];
    assert!(
        settings
            .iter()
            .any(|setting| setting["setting"] == advice["take"])
    );
    assert!(advice["text"].as_str().unwrap().starts_with("Take "));
    let svg = fs::read_to_string(directory.join("tradeoff.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.lines().any(|line| line.trim() == "default"));
    let left = fs::read_dir(directory.parent().unwrap()).unwrap();
    assert!(
        left.map(|entry| entry.unwrap().file_name())
            .all(|name| !name.to_string_lossy().contains(".knotdock-"))
    );
}

/// Two helices: every parameter of molecules is moved, a finer tolerance has a smaller error and is nearer to the
/// reference score, and the known complex is ranked.
#[test]
fn molecules() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (case("helices_receptor.pdb"), case("helices_ligand.pdb"));
    let arguments = [
        receptor.as_str(),
        &ligand,
        "--rotations",
        "24",
        "--poses",
        "100",
        "--native-receptor",
        &receptor,
        "--native-ligand",
        &ligand,
        "-o",
        "out",
    ];
    let object = swept(folder.path(), &arguments);
    check(folder.path(), &object);
    let settings = object["tradeoff"]["settings"].as_array().unwrap();
    for parameter in [
        "tolerance",
        "spacing",
        "resolution",
        "rotations",
        "fine-rotations",
        "per-rotation",
        "refine",
        "combination",
    ] {
        assert!(
            settings
                .iter()
                .any(|setting| setting["parameter"] == parameter),
            "{parameter}"
        );
    }
    let of = |name: &str, column: &str| {
        let setting = settings.iter().find(|setting| setting["setting"] == name);
        setting.unwrap()[column].as_f64().unwrap()
    };
    for column in ["error_rms", "error_worst", "definition_rms"] {
        let by_tolerance =
            ["tolerance 0.1", "default", "tolerance 0.001"].map(|name| of(name, column));
        assert!(
            by_tolerance[2] < 0.5 * by_tolerance[1],
            "{column}: {by_tolerance:?}"
        );
        assert!(
            by_tolerance[2] < 0.5 * by_tolerance[0],
            "{column}: {by_tolerance:?}"
        );
    }
    // Another resolution is another score, another tolerance all but the same.
    let other_resolutions = settings
        .iter()
        .filter(|setting| setting["parameter"] == "resolution");
    for setting in other_resolutions {
        assert!(setting["definition_rms"].as_f64().unwrap() > of("default", "definition_rms"));
    }
    assert!(of("default", "definition_correlation") > 0.98);
    assert!(
        settings
            .iter()
            .all(|setting| setting["acceptable_in_100"].is_number())
    );
    assert_eq!(object["tradeoff"]["refused"].as_array().unwrap().len(), 0);

    // What is there stays unless it may go.
    let again = tradeoff(folder.path(), &arguments);
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("--force"));
    let few = [
        &arguments[..],
        &["--force", "--parameters", "rotations", "--quiet"],
    ]
    .concat();
    let few = swept(folder.path(), &few);
    check(folder.path(), &few);
    let parameters = few["tradeoff"]["settings"].as_array().unwrap().iter();
    assert!(
        parameters
            .skip(2)
            .all(|setting| setting["parameter"] == "rotations" || setting["parameter"] == "repeat")
    );
}

/// Two halves of a block: the sampler's grid is a parameter, and a grid that cannot sample the parts is left out with
/// the reason.
#[test]
fn meshes() {
    let folder = tempfile::tempdir().unwrap();
    let pair = docking_parts::broken_block(0.05);
    fs::write(folder.path().join("receptor.stl"), pair.receptor.stl()).unwrap();
    fs::write(folder.path().join("ligand.stl"), pair.ligand.stl()).unwrap();
    let object = swept(
        folder.path(),
        &[
            "receptor.stl",
            "ligand.stl",
            "--sample-grid",
            "20^3",
            "--rotations",
            "24",
            "--poses",
            "60",
            "--parameters",
            "sample-grid,tolerance,rotations",
            "-o",
            "out",
        ],
    );
    check(folder.path(), &object);
    let settings = object["tradeoff"]["settings"].as_array().unwrap();
    let refused = object["tradeoff"]["refused"].as_array().unwrap();
    let grids = settings
        .iter()
        .filter(|setting| setting["parameter"] == "sample-grid");
    assert_eq!(grids.clone().count() + refused.len(), 2);
    // Another grid keeps the gap that the default looks for, which would follow from the grid otherwise.
    for grid in grids {
        assert!(grid["options"].as_str().unwrap().contains("^3 --offset 0."));
    }
    assert!(
        settings
            .iter()
            .all(|setting| setting["sample_wall_seconds"].is_number())
    );
    assert!(
        settings
            .iter()
            .all(|setting| setting["first_acceptable"].is_null())
    );
}

#[test]
fn bad_input_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (case("helices_receptor.pdb"), case("helices_ligand.pdb"));
    for arguments in [
        vec!["missing.pdb", &ligand],
        vec![receptor.as_str(), &ligand, "--parameters", "colour"],
        vec![
            receptor.as_str(),
            &ligand,
            "--parameters",
            "tolerance,sample-grid",
        ],
        vec![receptor.as_str(), &ligand, "--tolerance", "1e-9"],
        vec![receptor.as_str(), &ligand, "--sample-grid", "2^12"],
        vec![receptor.as_str()],
    ] {
        let output = tradeoff(
            folder.path(),
            &[&arguments[..], &["--json", "-o", "out"]].concat(),
        );
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let object: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(object["error"]["message"].is_string());
        assert!(object["error"]["remedy"].is_string(), "{object}");
        assert!(!folder.path().join("out").exists());
    }
}

fn dock(folder: &Path, arguments: &[&str]) -> Output {
    cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .args(["dock", "--json"])
        .args(arguments)
        .output()
        .unwrap()
}

/// An accuracy sets tolerance and spacing, a budget the rotations; the record has the choice, and `--rerun` repeats
/// it.
#[test]
fn a_docking_within_an_accuracy_and_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (case("helices_receptor.pdb"), case("helices_ligand.pdb"));
    let pair = [receptor.as_str(), &ligand, "--poses", "50"];
    let with = |more: &[&str]| {
        let output = dock(folder.path(), &[&pair[..], more].concat());
        let object: Value = serde_json::from_slice(&output.stdout).unwrap();
        (output.status.code(), object)
    };
    let accuracy = ["--accuracy", "1e-3", "--threads", "1"];
    let plain = with(&[&accuracy[..], &["--rotations", "8", "-o", "plain"]].concat());
    let run = &plain.1["run"];
    let error = run["machine"]["chosen"]["predicted_error"]
        .as_f64()
        .unwrap();
    assert!(error <= 1e-3 && run["error"]["rms"].as_f64().unwrap() < 2.0 * error);
    assert_eq!(run["options"]["search"]["rotations"], 8);
    let (code, object) = with(&[&accuracy[..], &["--budget", "0.5s", "-o", "one"]].concat());
    assert_eq!(code, Some(0));
    let run = &object["run"];
    let planned = run["options"]["search"]["rotations"].as_u64().unwrap();
    assert!((600..=56_250).contains(&planned), "{planned}");
    assert_eq!(
        run["options"]["kernel"]["tolerance"],
        plain.1["run"]["options"]["kernel"]["tolerance"]
    );
    assert_eq!(run["machine"]["chosen"]["budget_seconds"], 0.5);
    let again = dock(folder.path(), &["--rerun", "one/run.json", "-o", "two"]);
    assert!(again.status.success());
    let table = |run: &str| fs::read(folder.path().join(run).join("poses.csv")).unwrap();
    assert_eq!(table("one"), table("two"));

    for (more, word) in [
        (vec!["--accuracy", "1e-9"], "no setting"),
        (vec!["--budget", "soon"], "--budget"),
        (vec!["--budget", "5s", "--rotations", "60"], "--rotations"),
        (
            vec!["--accuracy", "1e-3", "--tolerance", "1e-3"],
            "--tolerance",
        ),
        (vec!["--accuracy", "1e-3", "--spacing", "2"], "--spacing"),
    ] {
        let (code, object) = with(&[&more[..], &["-o", "bad"]].concat());
        assert_eq!(code, Some(2), "{more:?}");
        let message = object["error"]["message"].as_str().unwrap();
        assert!(message.contains(word), "{message}");
        assert!(object["error"]["remedy"].is_string());
        assert!(!folder.path().join("bad").exists());
    }
}

/// A budget is a deadline: the search stops, and the rotations that it searched are recorded, so that the run repeats
/// to the byte. It once went on to its last rotation, at four times the time allowed.
#[test]
fn a_search_stops_at_its_deadline_and_is_repeated_to_the_byte() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (case("helices_receptor.pdb"), case("helices_ligand.pdb"));
    let pair = [receptor.as_str(), &ligand, "--poses", "50"];
    let budget = ["--budget", "0.05s", "--threads", "2", "-o", "one"];
    let output = dock(folder.path(), &[&pair[..], &budget].concat());
    assert!(output.status.success(), "{output:?}");
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    let run = &object["run"];
    let planned = run["options"]["search"]["rotations"].as_u64().unwrap();
    let searched = run["results"]["rotations"].as_u64().unwrap();
    assert!((1..planned).contains(&searched), "{searched} of {planned}");
    assert_eq!(run["options"]["stopped"]["rotations"], searched);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains(&format!("searched {searched} of {planned} rotations")),
        "{said}"
    );
    assert_eq!(
        searched < 600,
        said.contains("the budget left time for"),
        "{said}"
    );

    let again = ["--rerun", "one/run.json", "--threads", "1", "-o", "two"];
    assert!(dock(folder.path(), &again).status.success());
    let file = |run: &str, name: &str| fs::read(folder.path().join(run).join(name)).unwrap();
    assert_eq!(file("one", "poses.csv"), file("two", "poses.csv"));
    let record = |run: &str| -> Value { serde_json::from_slice(&file(run, "run.json")).unwrap() };
    assert_eq!(record("one")["options"], record("two")["options"]);
    assert_eq!(record("one")["results"], record("two")["results"]);
}
