//! Names that stand for no file, or for one without an end, where options, records and tables are read.

use std::fs::{self, File};
use std::os::unix::fs::symlink;

use serde_json::Value;

use super::place::{Place, error};

/// A folder with a run in `run`, which `native` was measured against.
fn docked() -> Place {
    let place = Place::new();
    let dock = "dock receptor.pdb:A ligand.pdb --rotations 4 --write-top 1 --native-receptor receptor.pdb:A \
                --native-ligand ligand.pdb -o run --quiet";
    let output = place.call(dock);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    place
}

/// A recorded pipe was opened, and its writer waited for, for ever.
#[test]
fn a_recorded_input_that_is_no_file_is_refused_unopened() {
    let place = docked();
    let pipe = place.pipe("pipe.pdb");
    let record: Value =
        serde_json::from_slice(&fs::read(place.path("run/run.json")).unwrap()).unwrap();
    let names = [
        pipe.to_str().unwrap(),
        "/dev/zero",
        "/dev/stdin",
        "/proc/self/fd/0",
        "/dev/fd/0",
    ];
    for part in [
        "/inputs/receptor/path",
        "/inputs/ligand/path",
        "/inputs/native/partners/receptor/path",
        "/inputs/native/partners/ligand/path",
    ] {
        for name in names {
            let mut changed = record.clone();
            *changed.pointer_mut(part).unwrap() = name.into();
            fs::create_dir_all(place.path("changed")).unwrap();
            fs::write(place.path("changed/run.json"), changed.to_string()).unwrap();
            let call = "dock --rerun changed/run.json -o again --json";
            let refused = error(&place.call(call), 2);
            assert_eq!(refused["file"], name, "{refused}");
            let message = refused["message"].as_str().unwrap();
            assert!(message.contains("is no file"), "{part}: {message}");
            assert!(!place.path("again").exists());
        }
    }
    // A file of the same name and content beside the record stands for it, as for one that was moved.
    let mut changed = record.clone();
    *changed.pointer_mut("/inputs/ligand/path").unwrap() = "/dev/stdin".into();
    fs::write(place.path("changed/run.json"), changed.to_string()).unwrap();
    fs::copy(place.path("ligand.pdb"), place.path("changed/stdin")).unwrap();
    let again = place.call("dock --rerun changed/run.json -o again --quiet");
    assert!(
        again.status.success(),
        "{}",
        String::from_utf8_lossy(&again.stderr)
    );
    let tables = ["run", "again"].map(|run| fs::read(place.path(run).join("poses.csv")).unwrap());
    assert!(tables[0] == tables[1]);
}

/// The whole file of a name was read into memory before it was checked.
#[test]
fn what_is_read_whole_is_read_within_bounds() {
    let place = docked();
    let huge = place.path("huge");
    // Takes no room on a disk: there is nothing in it.
    File::create(&huge).unwrap().set_len(10 << 30).unwrap();
    fs::create_dir_all(place.path("endless")).unwrap();
    symlink("/dev/zero", place.path("endless/run.json")).unwrap();
    fs::create_dir_all(place.path("large")).unwrap();
    symlink(&huge, place.path("large/run.json")).unwrap();
    let pair = "dock receptor.pdb ligand.pdb --json -o none";
    for name in ["huge", "/dev/zero"] {
        for call in [
            format!("{pair} --config {name}"),
            format!("{pair} --config terms.contact_potential='{name}'"),
            format!("{pair} --config terms.fine_contact_potential='{name}'"),
            format!("{pair} --config terms.atom_pair_potential='{name}'"),
            format!("batch {name} --json -o none"),
        ] {
            let refused = error(&place.call(&call), 2);
            let message = refused["message"].as_str().unwrap();
            assert!(
                message.contains("the most that are read"),
                "{call}: {message}"
            );
            assert_eq!(refused["file"], name, "{call}");
        }
    }
    for call in [
        "evaluate huge --receptor receptor.pdb --ligand ligand.pdb --native receptor.pdb --json",
        "export large --rank 1 --json",
        "dock --rerun large/run.json --json",
    ] {
        is_refused(&place, call, "the most that are read");
    }
    for call in [
        "export endless --rank 1 --json",
        "dock --rerun endless/run.json --json",
    ] {
        is_refused(&place, call, "where a file is needed");
    }
}

/// Calls the program, which refuses for a reason.
fn is_refused(place: &Place, call: &str, reason: &str) {
    let refused = error(&place.call(call), 2);
    let message = refused["message"].as_str().unwrap();
    assert!(message.contains(reason), "{call}: {message}");
}

/// A record is looked for in the folder of a run: a pipe there must not be waited for.
#[test]
fn a_pipe_in_the_place_of_a_record_is_not_opened() {
    let place = docked();
    fs::create_dir_all(place.path("piped")).unwrap();
    place.pipe("piped/run.json");
    fs::copy(place.path("run/poses.csv"), place.path("piped/poses.csv")).unwrap();
    for call in [
        "export piped --rank 1 --json",
        "evaluate piped --json",
        "dock --rerun piped/run.json --json",
    ] {
        is_refused(&place, call, "where a file is needed");
    }
}

/// A pipe that has an end is read as a file is: `--config <(...)` of the shell.
#[test]
fn options_and_tables_may_come_through_a_pipe() {
    let place = docked();
    let call = |words: &str, piped: &str| {
        let mut command =
            place.command(assert_cmd::cargo::cargo_bin!("knotdock").to_str().unwrap());
        let output = command
            .args(words.split_whitespace())
            .write_stdin(piped)
            .output()
            .unwrap();
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    };
    let dock = "dock receptor.pdb ligand.pdb -o configured --quiet --config /dev/stdin";
    call(dock, "[search]\nrotations = 4\n");
    let poses = fs::read_to_string(place.path("run/poses.csv")).unwrap();
    let evaluate = "evaluate /dev/stdin --receptor receptor.pdb:A --ligand ligand.pdb --native-receptor receptor.pdb \
                    --native-ligand ligand.pdb --quiet";
    call(evaluate, &poses);
}

/// Recursive readers would use up their stack on nested input.
#[test]
fn nesting_without_end_is_refused() {
    let place = docked();
    let deep = "[".repeat(1_000_000);
    fs::write(place.path("deep.toml"), format!("a = {}", &deep[..500_000])).unwrap();
    fs::create_dir_all(place.path("deep")).unwrap();
    fs::write(place.path("deep/run.json"), format!("{{\"schema\": {deep}")).unwrap();
    fs::write(
        place.path("tables.toml"),
        format!("[{}]", vec!["a"; 100_000].join(".")),
    )
    .unwrap();
    for call in [
        "dock receptor.pdb ligand.pdb --config deep.toml --json -o none",
        "dock receptor.pdb ligand.pdb --config tables.toml --json -o none",
        "export deep --rank 1 --json",
    ] {
        error(&place.call(call), 2);
    }
}
