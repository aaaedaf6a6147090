//! `--threads` governs all that is computed: no command starts other threads, whatever the environment says, and
//! threads that the system does not start are a failure like any other.

use std::fs::{self, OpenOptions};
use std::io::Read;
use std::os::unix::fs::OpenOptionsExt;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

use assert_cmd::cargo::cargo_bin;

use super::place::{Place, error, not_run};

/// Commands that compute, each into a separate place.
const COMMANDS: [&str; 8] = [
    "sample box.obj --grid 2^12 --weights fitted --picture balls.svg --force",
    "dock receptor.pdb ligand.pdb --rotations 16 --refine 3 --write-top 1 -o run --force",
    "dock box.obj cube.obj --offset 0.45 --sample-grid 2^12 --rotations 16 --write-top 1 -o parts --force",
    "export parts --rank 1 -o copies --force",
    "evaluate run --native-receptor receptor.pdb --native-ligand ligand.pdb",
    "score receptor.pdb ligand.pdb --pose 1,0,0,0,0,0,0 --resolution 9",
    "inspect receptor.pdb",
    "batch pairs.csv -o many -- --rotations 16 --write-top 1 --force",
];

/// A command with its threads; `inspect` computes on one, and has no option for more.
fn with_threads(command: &str, threads: usize) -> String {
    if command.starts_with("inspect") {
        return command.to_owned();
    }
    // Options of a batch's pairs come last.
    format!("{command} -j {threads}")
}

/// Threads of a process that runs.
fn threads_of(process: u32) -> usize {
    fs::read_dir(format!("/proc/{process}/task"))
        .unwrap()
        .count()
}

/// Sampling took as many threads as RAYON_NUM_THREADS says, or the machine has, and there was no option.
///
/// The program waits in the writing of its table, which goes into a pipe: by then it has started all its threads, of
/// which none has ended.
#[test]
fn a_sample_has_the_threads_that_were_wanted_and_no_more() {
    let place = Place::new();
    let pipe = place.pipe("knots");
    // Opened so, a pipe without a writer is not waited for, nor is one whose writer has failed.
    let mut opening = OpenOptions::new();
    opening.read(true).custom_flags(libc::O_NONBLOCK);
    let mut table = opening.open(&pipe).unwrap();
    for (threads, expected) in [(1, 1), (3, 1 + 3)] {
        let arguments = format!("sample box.obj --grid 2^16 --method voxels -o knots -j {threads}");
        let mut sample = std::process::Command::new(cargo_bin!("knotdock"))
            .current_dir(place.root())
            .args(arguments.split(' '))
            .env("RAYON_NUM_THREADS", "40")
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let mut length = 0;
        let mut part = [0; 4096];
        loop {
            let has_ended = sample.try_wait().unwrap().is_some();
            match table.read(&mut part) {
                Ok(0) if has_ended => break,
                Ok(read) if read > 0 => {
                    if length == 0 {
                        assert_eq!(threads_of(sample.id()), expected);
                    }
                    length += read;
                }
                // Nothing is there yet.
                _ => sleep(Duration::from_millis(2)),
            }
        }
        assert!(sample.wait().unwrap().success());
        // What a pipe holds by itself the program would have written before it was looked at.
        assert!(length > 2 * 65_536, "the table has only {length} bytes");
    }
}

/// Every command, under `strace`, which sees each thread that is started.
#[test]
fn no_command_starts_other_threads() {
    let place = Place::new();
    let traced = |words: &str| {
        let mut command = place.command("strace");
        command.args(["-f", "-qq", "-e", "trace=clone,clone3", "-o", "trace"]);
        command
            .arg(cargo_bin!("knotdock"))
            .args(words.split_whitespace());
        command.env("RAYON_NUM_THREADS", "40").output()
    };
    match traced("--version") {
        Ok(output) if output.status.success() => {}
        _ => {
            let reason = "there is no strace here, or it may trace nothing";
            return not_run("no_command_starts_other_threads", reason);
        }
    }
    for threads in [1, 3] {
        for command in COMMANDS {
            let words = with_threads(command, threads);
            let output = traced(&words).unwrap();
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{words}: {said}");
            let trace = fs::read_to_string(place.path("trace")).unwrap();
            let started = trace.lines().filter(|line| line.contains("clone")).count();
            let is_alone = threads == 1 || command.starts_with("inspect");
            assert_eq!(
                started,
                if is_alone { 0 } else { threads },
                "{words}:\n{trace}"
            );
        }
    }
}

/// A million threads were to be started, and a panic said so.
#[test]
fn the_environment_neither_harms_nor_changes_a_result() {
    let place = Place::new();
    let commands = [
        "sample box.obj --grid 2^12 --weights fitted -o knots.csv --force",
        "score receptor.pdb ligand.pdb --pose 1,0,0,0,0,0,0 --resolution 9",
        "dock box.obj cube.obj --offset 0.45 --sample-grid 2^12 --rotations 16 --write-top 1 -o parts --force",
    ];
    let mut results: Vec<Vec<Vec<u8>>> = Vec::new();
    for (name, value) in [
        ("RAYON_NUM_THREADS", "2"),
        ("RAYON_NUM_THREADS", "0"),
        ("RAYON_NUM_THREADS", "1000000"),
        ("RAYON_NUM_THREADS", "many"),
        ("RAYON_RS_NUM_CPUS", "1000000"),
        ("RUST_MIN_STACK", "1000000000000000"),
    ] {
        for words in commands {
            let mut command = place.command(cargo_bin!("knotdock").to_str().unwrap());
            command.args(words.split(' ')).env(name, value);
            let output = command.output().unwrap();
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{name}={value} {words}: {said}");
        }
        let files = ["knots.csv", "parts/poses.csv"];
        results.push(files.map(|file| fs::read(place.path(file)).unwrap()).into());
    }
    assert!(results.iter().all(|result| *result == results[0]));
}

/// Threads without a place for their stacks, on any account.
#[test]
fn threads_that_cannot_be_started_are_a_failure() {
    let place = Place::new();
    for command in COMMANDS {
        if command.starts_with("inspect")
            || command.starts_with("evaluate")
            || command.starts_with("export")
        {
            // The first has none, and the others have nothing to read yet.
            continue;
        }
        // 8 GB of stacks within 2 GB.
        let words = with_threads(&format!("--json {command}"), 1000);
        let output = place.limited("ulimit -v 2000000", &words);
        let refused = if command.starts_with("batch") {
            assert_eq!(output.status.code(), Some(1));
            let object: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
            object["pairs"][0]["error"].clone()
        } else {
            error(&output, 1)
        };
        let message = refused["message"].as_str().unwrap();
        assert!(
            message.contains("could not start 1000 threads"),
            "{words}: {message}"
        );
        assert!(
            refused["remedy"].as_str().unwrap().contains("--threads"),
            "{refused}"
        );
    }
    assert!(!place.path("run").exists() && !place.path("knots.csv").exists());
}

/// The words before a program's that let it have no more processes, nor threads: as another account where the one at
/// hand is the superuser, whose processes are not limited. Not every shell knows `ulimit -u`.
fn without_processes(place: &Place) -> Vec<&'static str> {
    let user = place.command("id").arg("-u").output().unwrap().stdout;
    let other = [
        "setpriv",
        "--reuid=65534",
        "--regid=65534",
        "--clear-groups",
    ];
    let other = if user == b"0\n" { &other[..] } else { &[] };
    [other, &["prlimit", "--nproc=1"]].concat()
}

/// An account that may have no more processes: one thread is enough for all work, and more are refused. Nor does the
/// progress on a terminal need a thread, whose failure was a panic.
#[test]
fn an_account_without_processes_left_can_work_on_one_thread() {
    let name = "an_account_without_processes_left_can_work_on_one_thread";
    let place = Place::new();
    let before = without_processes(&place);
    let limited = |words: &[&str]| {
        let mut command = place.command(before[0]);
        command.args(&before[1..]).args(words).output()
    };
    // The other account has to reach the folder and the program.
    fs::copy(cargo_bin!("knotdock"), place.path("program")).unwrap();
    let mut opening = place.command("chmod");
    let opened = opening.args(["-R", "a+rwX", "."]).output().unwrap();
    assert!(opened.status.success());
    let succeeds = |words: &[&str]| limited(words).is_ok_and(|output| output.status.success());
    if !succeeds(&["./program", "--version"]) || succeeds(&["sh", "-c", "(exit 0); (exit 0)"]) {
        return not_run(
            name,
            "no account with a limit on its processes can be taken here",
        );
    }
    let sample = "./program sample box.obj --grid 2^12 --json -j";
    let sample: Vec<&str> = sample.split(' ').collect();
    let refused = error(&limited(&[&sample[..], &["2"]].concat()).unwrap(), 1);
    let message = refused["message"].as_str().unwrap();
    assert!(message.contains("could not start 2 threads"), "{message}");
    assert!(succeeds(&[&sample[..], &["1"]].concat()));

    let dock = "./program dock box.obj cube.obj --offset 0.45 --sample-grid 2^12 --rotations 16 -o run -j 1";
    let mut terminal = place.command("script");
    terminal.args(["-qec", &format!("{} {dock}", before.join(" ")), "/dev/null"]);
    match terminal.output() {
        Ok(output) => {
            let words = String::from_utf8_lossy(&output.stdout);
            assert!(output.status.success(), "{words}");
            assert!(words.contains(" gone, "), "no progress: {words}");
        }
        Err(_) => not_run(name, "there is no `script` here, which plays a terminal"),
    }
}
