//! The command line as people see it: help of a screen, presets, options that files alone give, completions, pages of
//! the manual, and the output of a run.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::molecules;
use crate::program::{refused, succeed};
use serde_json::Value;

fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("receptor.pdb"), molecules::receptor()).unwrap();
    fs::write(folder.path().join("ligand.pdb"), molecules::ligand()).unwrap();
    folder
}

fn printed(folder: &Path, arguments: &str) -> String {
    let output = succeed(folder, arguments.split_whitespace());
    String::from_utf8(output.stdout).unwrap()
}

/// The options of a run, by a command line.
fn options(folder: &Path, arguments: &str) -> Value {
    let dock = format!(
        "dock receptor.pdb ligand.pdb --poses 20 --write-top 0 --no-report {arguments} --json"
    );
    let reported: Value =
        serde_json::from_str(&printed(folder, &format!("{dock} --force"))).unwrap();
    reported["run"]["options"].clone()
}

#[test]
fn the_short_help_fits_a_screen_and_the_long_one_has_everything() {
    let folder = tempfile::tempdir().unwrap();
    let short = printed(folder.path(), "dock -h");
    assert!(short.lines().count() < 45, "{short}");
    assert!(
        short.lines().all(|line| line.chars().count() <= 100),
        "{short}"
    );
    for part in [
        "--preset <NAME>",
        "--native <FILE>",
        "--active-receptor",
        "Examples:",
        "-j, --threads",
    ] {
        assert!(short.contains(part), "{part}");
    }
    assert!(!short.contains("--tolerance"));
    let long = printed(folder.path(), "dock --help");
    for part in [
        "--tolerance <SHARE>",
        "--offset <ANGSTROM>",
        "--poses <COUNT>",
        "Restraints (molecules):",
    ] {
        assert!(long.contains(part), "{part}");
    }
    assert!(!long.contains("-weight <"), "{long}");
}

/// The lists wrap at the width of the terminal.
#[test]
fn commands_are_listed_by_subject() {
    for (words, width) in [("--help", 100), ("-h", 60), ("help", 60)] {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("knotdock"));
        command.env("COLUMNS", width.to_string()).arg(words);
        let help = String::from_utf8(command.output().unwrap().stdout).unwrap();
        assert!(
            help.lines().all(|line| line.chars().count() <= width),
            "{help}"
        );
        let is_heading = |line: &&str| line.ends_with(':') && !line.starts_with(' ');
        let headings: Vec<&str> = help.lines().filter(is_heading).collect();
        assert_eq!(
            headings,
            ["Docking:", "Results:", "Solids:", "Accuracy:", "Options:"],
            "{help}"
        );
        for part in [
            "\n\nDocking:\n  dock       Dock a ligand",
            "\n\nResults:\n  export ",
            "\n  interface  Describe",
            "\n\nSolids:\n  sample ",
            "\n\nAccuracy:\n  tradeoff ",
            "\n\nOptions:\n      --json",
        ] {
            assert!(help.contains(part), "{part}: {help}");
        }
        for hidden in ["preset", "completions", "man"] {
            assert!(!help.contains(&format!("\n  {hidden} ")), "{help}");
        }
    }
}

#[test]
fn a_preset_is_a_file_and_later_files_win_over_it() {
    let place = place();
    let folder = place.path();
    fs::write(folder.join("preset.toml"), printed(folder, "preset shape")).unwrap();
    fs::write(folder.join("more.toml"), "[search]\nrotations = 30\n").unwrap();
    let by_name = options(folder, "--preset shape --rotations 24");
    assert_eq!(by_name["kernel"]["effects"], "shape");
    assert_eq!(
        by_name,
        options(folder, "--config preset.toml --rotations 24")
    );
    let both = options(
        folder,
        "--preset fast --config preset.toml --config more.toml --effects auto",
    );
    assert_eq!(both["search"]["rotations"], 30);
    assert_eq!(both["kernel"]["effects"], "auto");
    let lines = options(
        folder,
        "--config search.rotations=24 --config terms.contact_weight=7",
    );
    assert_eq!(lines["terms"]["contact_weight"], 7.0);
    assert_eq!(lines["search"]["rotations"], 24);
}

#[test]
fn weights_are_not_typed_and_the_error_says_where_they_go() {
    let place = place();
    let dock = ["dock", "receptor.pdb", "ligand.pdb", "--peptidase-weight=0"];
    let error = refused(place.path(), dock);
    let remedy = error["remedy"].as_str().unwrap();
    assert!(
        remedy.contains("--config restraints.peptidase_weight=VALUE"),
        "{remedy}"
    );
    let error = refused(
        place.path(),
        [
            "dock",
            "receptor.pdb",
            "ligand.pdb",
            "--config",
            "terms.weight=1",
        ],
    );
    assert_eq!(error["file"], "terms.weight=1");
    let error = refused(
        place.path(),
        ["dock", "receptor.pdb", "ligand.pdb", "--rotatoins", "9"],
    );
    assert_eq!(error["remedy"], "is `--rotations` meant?");
}

/// A batch's table may have them in columns.
#[test]
fn a_table_of_pairs_has_weights_in_columns() {
    let place = place();
    let pairs = "receptor,ligand,contact_weight\nreceptor.pdb,ligand.pdb,5\n";
    fs::write(place.path().join("pairs.csv"), pairs).unwrap();
    printed(
        place.path(),
        "batch pairs.csv -o runs -q -- --rotations 24 --poses 20",
    );
    let record = fs::read(place.path().join("runs/receptor_ligand/run.json")).unwrap();
    let record: Value = serde_json::from_slice(&record).unwrap();
    assert_eq!(record["options"]["terms"]["contact_weight"], 5.0);
}

#[test]
fn shells_and_man_learn_every_command() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = printed(folder.path(), &format!("completions {shell}"));
        assert!(script.contains("active-receptor"), "{shell}");
    }
    fs::write(
        folder.path().join("c.bash"),
        printed(folder.path(), "completions bash"),
    )
    .unwrap();
    if let Ok(bash) = Command::new("bash")
        .arg("-n")
        .arg(folder.path().join("c.bash"))
        .status()
    {
        assert!(bash.success());
    }
    printed(folder.path(), "man pages");
    let page = fs::read_to_string(folder.path().join("pages/knotdock-dock.1")).unwrap();
    for part in ["active\\-receptor", "Write no report.html", ".SH EXAMPLES"] {
        assert!(page.contains(part), "{part}: {page}");
    }
    assert!(folder.path().join("pages/knotdock-morph-sum.1").exists());
    let version = printed(folder.path(), "--version");
    assert!(version.contains("features: "), "{version}");
}

/// Five lines at most come before the table; -v says more.
#[test]
fn a_run_says_little_unless_asked() {
    let place = place();
    let dock = "dock receptor.pdb ligand.pdb --rotations 48 --poses 200 --native-receptor receptor.pdb \
                --native-ligand ligand.pdb";
    let brief = printed(place.path(), &format!("{dock} -o brief"));
    let (before, after) = brief.split_once("\n\n").unwrap();
    assert!(before.lines().count() <= 5, "{before}");
    for part in [
        "Receptor: receptor.pdb",
        "Scored by shape",
        "48 rotations",
        "MB on",
    ] {
        assert!(before.contains(part), "{part}: {before}");
    }
    let (table, next) = after.split_once("\n\n").unwrap();
    assert!(table.lines().count() <= 11, "{table}");
    assert!(
        table.lines().all(|line| line.chars().count() <= 100),
        "{table}"
    );
    for part in [
        "Accuracy: scores of the search",
        "shape",
        "open brief/report.html",
        "knotdock export brief --rank 11-",
    ] {
        assert!(next.contains(part), "{part}: {next}");
    }
    let more = printed(place.path(), &format!("{dock} -o more -v"));
    for part in [
        "Effect restraint: off",
        "covering radius",
        "low-pass",
        "CPU s",
    ] {
        assert!(more.contains(part) && !brief.contains(part), "{part}");
    }
    let quiet = printed(place.path(), &format!("{dock} -o quiet -q"));
    assert_eq!(quiet, "");
}

/// A file whose name is not UTF-8 was "invalid UTF-8 in one or more arguments", and a folder of -o was recorded as
/// another one.
#[cfg(unix)]
#[test]
fn words_that_are_not_utf_8_are_refused_by_name() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let place = place();
    let name = OsStr::from_bytes(b"caf\xe9.pdb");
    fs::copy(place.path().join("ligand.pdb"), place.path().join(name)).unwrap();
    let given = OsStr::new("ligand.pdb");
    for words in [
        [OsStr::new("dock"), OsStr::new("receptor.pdb"), name],
        [OsStr::new("inspect"), OsStr::new("receptor.pdb"), name],
        [OsStr::new("score"), name, given],
        [
            OsStr::new("dock"),
            given,
            OsStr::from_bytes(b"--out=caf\xe9.pdb"),
        ],
    ] {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("knotdock"));
        let output = command
            .current_dir(place.path())
            .args(words)
            .arg("--json")
            .output();
        let output = output.unwrap();
        assert_eq!(output.status.code(), Some(2));
        let object: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let [message, remedy] =
            ["message", "remedy"].map(|part| object["error"][part].as_str().unwrap());
        assert!(
            message.contains(r"caf\xE9.pdb") && message.contains("UTF-8"),
            "{message}"
        );
        assert!(remedy.contains("rename"), "{remedy}");
    }
}
