//! Limits of memory and of the size of files end a command by a message, and not by a signal.

use std::fs;

use super::place::{Place, error};

/// SIGXFSZ ended the program, and half-written files stayed.
#[test]
fn a_file_beyond_the_limit_is_a_failure_that_leaves_nothing() {
    let place = Place::new();
    let before = place.names();
    let sample = "sample box.obj --grid 2^12 -o knots.csv --json";
    let refused = error(&place.limited("ulimit -f 1", sample), 1);
    assert_eq!(refused["file"], "knots.csv");
    assert!(
        refused["message"].as_str().unwrap().contains("too large"),
        "{refused}"
    );
    assert_eq!(place.names(), before);
    let dock = "dock receptor.pdb ligand.pdb --rotations 4 --write-top 1 -o run --json";
    let refused = error(&place.limited("ulimit -f 1", dock), 1);
    assert!(
        refused["file"].as_str().unwrap().contains("run"),
        "{refused}"
    );
    assert!(!place.path("run/run.json").exists());
    for call in [sample, dock] {
        let again = place.call(call);
        assert!(
            again.status.success(),
            "{}",
            String::from_utf8_lossy(&again.stderr)
        );
    }
}

/// Standard output may be a file, too.
#[test]
fn a_report_beyond_the_limit_is_a_failure() {
    let place = Place::new();
    let mut command = place.command("sh");
    let script = "ulimit -f 1; exec \"$@\" > report";
    command
        .args(["-c", script, "sh"])
        .arg(assert_cmd::cargo::cargo_bin!("knotdock"));
    let output = command.args(["dock", "--help"]).output().unwrap();
    // Help is not a failure even where nobody can read it.
    assert!(output.status.code().is_some(), "{:?}", output.status);
    assert!(fs::metadata(place.path("report")).unwrap().len() <= 1024);
}

/// The library ended the program by SIGABRT, without an object.
#[cfg(target_os = "linux")]
#[test]
fn a_lack_of_memory_is_a_failure_with_a_remedy() {
    let place = Place::new();
    for threads in [1, 3] {
        // The grid's values alone take 8 bytes for each of 2^26 nodes.
        let sample = format!("sample box.obj --grid 2^26 -o knots.csv -j {threads}");
        let refused = place.limited("ulimit -v 400000", &format!("{sample} --json"));
        let refused = error(&refused, 1);
        let [message, remedy] = ["message", "remedy"].map(|part| refused[part].as_str().unwrap());
        assert!(message.contains("no memory left"), "{message}");
        assert!(
            remedy.contains("ulimit -v") && remedy.contains("--memory"),
            "{remedy}"
        );
        let words = place.limited("ulimit -v 400000", &sample);
        assert_eq!(words.status.code(), Some(1));
        assert!(String::from_utf8_lossy(&words.stderr).contains("\n  help: "));
    }
    assert!(!place.path("knots.csv").exists());
}

/// Ctrl-C ended a command without a word. It still ends it as the signal does.
#[cfg(unix)]
#[test]
fn a_command_that_is_interrupted_says_so() {
    use std::os::unix::process::ExitStatusExt;
    use std::process::{Command, Stdio};

    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.pdb");
    let made = Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    for signal in [libc::SIGINT, libc::SIGTERM] {
        // The program waits for whoever writes to the pipe.
        let program = Command::new(env!("CARGO_BIN_EXE_knotdock"))
            .args(["dock", "--json"])
            .args([&pipe, &pipe])
            .current_dir(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // It opens the pipe once it is set up, and this end opens when it has.
        let writer = std::fs::OpenOptions::new().write(true).open(&pipe).unwrap();
        // SAFETY: the process is a child that has not been waited for.
        unsafe { libc::kill(program.id() as i32, signal) };
        let output = program.wait_with_output().unwrap();
        drop(writer);
        assert_eq!(output.status.signal(), Some(signal));
        let reported = String::from_utf8(output.stderr).unwrap();
        assert!(reported.contains("was interrupted"), "{reported}");
        let object: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(object["error"]["message"], "the command was interrupted");
    }
}
