//! Folders of batches with other content: the user's files and links, pipes, bombs, records of no shard. All of it is
//! refused by name and stays.

use std::fs::{self, File};
use std::io::Write;
#[cfg(unix)]
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Output;
use std::time::Duration;

use assert_cmd::Command;
use assert_cmd::cargo::cargo_bin_cmd;
use flate2::Compression;
use flate2::write::GzEncoder;
use knotdock::output::files::lock::Lock;
use serde_json::{Value, json};

use super::{place, write_pairs};
use crate::dock_run::run::files;
use crate::program;

const TWO: &str = "name,receptor,ligand\n\
                   a,helices_receptor.pdb,helices_ligand.pdb\n\
                   b,charged_helices_receptor.pdb,charged_helices_ligand.pdb\n";
/// Options that take hardly any time.
const DOCK: &str = "-- --rotations 4 --poses 5 --effects shape --threads 1";
/// After which a call that waits for ever is ended: a guard, no measurement.
const HANGS: Duration = Duration::from_secs(300);

fn command(folder: &Path, words: &str) -> Command {
    let mut command = cargo_bin_cmd!("knotdock");
    command.current_dir(folder).timeout(HANGS);
    command.args(words.split_whitespace());
    command
}

fn call(folder: &Path, words: &str) -> Output {
    command(folder, words).output().unwrap()
}

/// The error of a call that is refused, or of whose pairs one is.
#[track_caller]
fn refused(folder: &Path, words: &str) -> String {
    let output = call(folder, words);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{words}: {said}");
    let is_explained = said.contains("help: ") && !said.contains("panicked");
    assert!(is_explained, "{words}: {said}");
    said
}

/// The command line of a batch of the two pairs.
fn batch(out: &str, words: &str) -> String {
    format!("batch in/pairs.csv -o {out} {words} {DOCK}")
}

/// A folder with the two pairs, and a batch of them in `out`.
fn docked(words: &str) -> tempfile::TempDir {
    let folder = place();
    write_pairs(folder.path(), TWO);
    let output = call(folder.path(), &batch("out", words));
    assert!(output.status.success(), "{output:?}");
    folder
}

/// `--scratch` removed what was in the shard's folder, and folders of the names that it gave its own.
#[test]
fn a_shard_with_a_scratch_folder_removes_nothing_of_the_users() {
    let folder = place();
    let root = folder.path();
    write_pairs(root, TWO);
    let write = |name: &str| {
        let path = root.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, "mine").unwrap();
        path
    };
    let shard = batch("out", "--keep table --shard 1/1 --scratch near");
    let notes = write("out/shards/0001-of-0001/notes.txt");
    let said = refused(root, &shard);
    assert!(said.contains("notes.txt"), "{said}");
    assert_eq!(fs::read(notes).unwrap(), b"mine");
    fs::remove_dir_all(root.join("out")).unwrap();
    let mine = [
        "out/shards/.0001-of-0001.old/thesis.txt",
        "out/shards/.0001-of-0001.new/thesis.txt",
        "near/thesis.txt",
    ];
    let mine = mine.map(write);
    let output = call(root, &shard);
    assert!(output.status.success(), "{output:?}");
    for file in mine {
        assert_eq!(fs::read(file).unwrap(), b"mine");
    }
    assert_eq!(fs::read_dir(root.join("near")).unwrap().count(), 1);
}

/// A folder of a scratch folder's name that is not this batch's is refused.
#[cfg(debug_assertions)]
#[test]
fn a_scratch_folder_of_something_else_stays() {
    let folder = place();
    let root = folder.path();
    write_pairs(root, TWO);
    let shard = |out: &str| batch(out, "--keep table --shard 1/2 --scratch near");
    let mut logged = command(root, &shard("logged"));
    logged.env("KNOTDOCK_FAULT_LOG", root.join("log"));
    assert!(logged.output().unwrap().status.success());
    let log = fs::read_to_string(root.join("log")).unwrap();
    let grows = |line: &str| line.starts_with("append");
    let point = 1 + log.lines().position(grows).unwrap();
    // Ended while its files grow, the shard leaves its folder.
    let mut ended = command(root, &shard("out"));
    ended.env("KNOTDOCK_FAULT", format!("kill {point}"));
    assert_eq!(ended.output().unwrap().status.code(), Some(137));
    let mut left = fs::read_dir(root.join("near")).unwrap();
    let left = left.next().unwrap().unwrap().path();
    fs::remove_file(left.join("batch.json")).unwrap();
    fs::write(left.join("notes.txt"), "mine").unwrap();
    let before = files(&left);
    refused(root, &shard("out"));
    assert!(files(&left) == before);
}

/// Two processes with separate scratch folders each replaced the files of the other, until nothing was left.
#[test]
fn a_shard_is_docked_by_one_process() {
    let folder = place();
    let root = folder.path();
    write_pairs(root, TWO);
    let shard = |near: usize| {
        let words = format!("--keep table --shard 1/1 --scratch near_{near}");
        batch("out", &words)
    };
    let lock = root.join("out/shards/0001-of-0001/.knotdock-lock");
    fs::create_dir_all(lock.parent().unwrap()).unwrap();
    let held = Lock::take(&lock).unwrap();
    let said = refused(root, &shard(1));
    assert!(said.contains("another command is writing"), "{said}");
    assert!(!root.join("near_1").exists());
    drop(held);
    let both = std::thread::scope(|scope| {
        let calls = [1, 2].map(|near| scope.spawn(move || call(root, &shard(near))));
        calls.map(|docking| docking.join().unwrap())
    });
    assert!(both.iter().any(|output| output.status.success()));
    for output in both {
        let said = String::from_utf8_lossy(&output.stderr);
        let is_refused = output.status.code() == Some(2);
        assert!(
            output.status.success() || is_refused && said.contains("another command is writing"),
            "{output:?}"
        );
    }
    program::succeed(root, ["merge", "out"]);
    let results = fs::read_to_string(root.join("out/results.csv")).unwrap();
    assert_eq!(results.matches(",done,").count(), 2, "{results}");
}

/// A shard cut and wrote what links of the names of its files led to.
#[cfg(unix)]
#[test]
fn a_shard_writes_through_no_link() {
    const THESIS: &str = "my thesis\nits last line has no end";
    let folder = docked("--keep table --shard 1/2");
    let root = folder.path();
    let thesis = root.join("thesis.txt");
    for name in ["attempts.csv", "results.csv", "poses.csv.gz", "batch.json"] {
        let file = root.join("out/shards/0001-of-0002").join(name);
        let before = fs::read(&file).unwrap();
        fs::write(&thesis, THESIS).unwrap();
        for is_hard in [false, true] {
            fs::remove_file(&file).unwrap();
            let linked = match is_hard {
                true => fs::hard_link(&thesis, &file),
                false => symlink(&thesis, &file),
            };
            linked.unwrap();
            for near in ["", "--scratch near"] {
                let shard = batch("out", &format!("--keep table --shard 1/2 {near}"));
                match is_hard {
                    // Its name may go to a new file.
                    true => drop(call(root, &shard)),
                    false => drop(refused(root, &shard)),
                }
                let text = fs::read_to_string(&thesis).unwrap();
                assert_eq!(text, THESIS, "{name} {is_hard} {near}");
                let _ = fs::remove_dir_all(root.join("near"));
            }
        }
        fs::remove_file(&file).unwrap();
        fs::write(&file, before).unwrap();
    }
    // One that leads nowhere, and one in the place of the folder.
    let shard = batch("out", "--keep table --shard 2/2");
    let second = root.join("out/shards/0002-of-0002");
    fs::create_dir(&second).unwrap();
    symlink(root.join("new.txt"), second.join("attempts.csv")).unwrap();
    refused(root, &shard);
    assert!(!root.join("new.txt").exists());
    fs::remove_dir_all(&second).unwrap();
    fs::create_dir(root.join("elsewhere")).unwrap();
    symlink(root.join("elsewhere"), &second).unwrap();
    refused(root, &shard);
    assert!(files(&root.join("elsewhere")).is_empty());
}

/// A table of results, and a pair's folder, were written through links that no option named.
#[cfg(unix)]
#[test]
fn a_batch_writes_through_no_link() {
    let folder = docked("--keep table");
    let root = folder.path();
    let (results, backup) = (root.join("out/results.csv"), root.join("backup.csv"));
    fs::rename(&results, &backup).unwrap();
    let before = fs::read(&backup).unwrap();
    let is_untouched =
        || fs::read(&backup).unwrap() == before && results.symlink_metadata().unwrap().is_symlink();
    symlink(&backup, &results).unwrap();
    refused(root, &batch("out", "--keep table"));
    assert!(is_untouched());
    // Nor is a directory with a link taken, for a batch or for shards.
    for words in ["", "--shard 1/1"] {
        fs::remove_dir_all(root.join("out")).unwrap();
        fs::create_dir(root.join("out")).unwrap();
        symlink(&backup, &results).unwrap();
        refused(root, &batch("out", words));
        assert!(is_untouched());
    }
    fs::remove_dir_all(root.join("out")).unwrap();
    let shard = batch("out", "--keep table --shard 1/1");
    assert!(call(root, &shard).status.success());
    symlink(&backup, &results).unwrap();
    for words in ["merge out", "merge out --force"] {
        refused(root, words);
        assert!(is_untouched());
    }
    for keep in ["top", "all"] {
        let shard = |index: usize| batch(keep, &format!("--keep {keep} --shard {index}/2"));
        assert!(call(root, &shard(1)).status.success());
        let elsewhere = root.join(format!("elsewhere_{keep}"));
        fs::create_dir(&elsewhere).unwrap();
        symlink(&elsewhere, root.join(keep).join("b")).unwrap();
        refused(root, &shard(2));
        assert!(files(&elsewhere).is_empty(), "{keep}");
    }
}

/// A pipe in the place of a shard's file, or of a merged one, was waited for without end.
#[cfg(unix)]
#[test]
fn a_pipe_is_not_waited_for() {
    let folder = docked("--keep table --shard 1/1");
    let root = folder.path();
    let pipe = |path: &Path| {
        fs::remove_file(path).unwrap();
        let made = std::process::Command::new("mkfifo").arg(path).status();
        assert!(made.unwrap().success());
    };
    assert!(call(root, "merge out").status.success());
    for name in ["attempts.csv", "results.csv", "poses.csv.gz", "batch.json"] {
        let file = root.join("out/shards/0001-of-0001").join(name);
        let before = fs::read(&file).unwrap();
        pipe(&file);
        for near in ["", "--scratch near"] {
            let shard = batch("out", &format!("--keep table --shard 1/1 {near}"));
            refused(root, &shard);
            let _ = fs::remove_dir_all(root.join("near"));
        }
        // What was begun is of no interest then.
        if name != "attempts.csv" {
            refused(root, "merge out");
        }
        fs::remove_file(&file).unwrap();
        fs::write(&file, before).unwrap();
    }
    for name in ["results.csv", "poses.csv.gz"] {
        let file = root.join("out").join(name);
        let before = fs::read(&file).unwrap();
        pipe(&file);
        for words in ["merge out", "merge out --force"] {
            refused(root, words);
        }
        fs::remove_file(&file).unwrap();
        fs::write(&file, before).unwrap();
    }
    assert!(call(root, "merge out").status.success());
}

/// A hundred kilobytes were unpacked to as much memory as their writer wanted, as one line or as the poses of one pair.
#[test]
fn a_bomb_is_not_unpacked() {
    let folder = docked("--keep table --shard 1/1");
    let root = folder.path();
    let poses = root.join("out/shards/0001-of-0001/poses.csv.gz");
    for byte in [b'0', b'\n'] {
        let mut packed = GzEncoder::new(File::create(&poses).unwrap(), Compression::best());
        let part = vec![byte; 1 << 20];
        for _ in 0..100 {
            packed.write_all(&part).unwrap();
        }
        packed.finish().unwrap();
        let before = fs::read(&poses).unwrap();
        assert!(before.len() < 1 << 20);
        for words in ["merge out", &batch("out", "--keep table --shard 1/1")] {
            let said = refused(root, words);
            assert!(said.contains("file of poses"), "{said}");
        }
        assert!(fs::read(&poses).unwrap() == before);
        assert!(!root.join("out/poses.csv.gz").exists());
    }
}

/// A record of shard 1/0 made `merge` panic, and one of a million millions took memory without a bound.
#[test]
fn a_shard_that_cannot_be_is_refused() {
    let folder = docked("--keep table --shard 1/1");
    let root = folder.path();
    let path = root.join("out/shards/0001-of-0001/batch.json");
    let record: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    for (key, value) in [
        ("shard", json!("1/0")),
        ("shard", json!("0/1")),
        ("shard", json!("2/1")),
        ("shard", json!("1/1000000000000")),
        ("shard", json!({"index": 1, "count": 0})),
        ("pairs", json!(u64::MAX)),
        ("pairs", json!(-1)),
    ] {
        let mut changed = record.clone();
        changed[key] = value;
        fs::write(&path, changed.to_string()).unwrap();
        program::refused(root, ["merge", "out"]);
        assert!(!root.join("out/results.csv").exists(), "{changed}");
    }
    for shard in ["1/0", "0/1", "1/1000001", "1/1000000000000"] {
        let words = format!("batch in/pairs.csv -o far --shard {shard}");
        program::refused(root, words.split(' '));
        assert!(!root.join("far").exists(), "{shard}");
    }
}

/// A pair called report.html cost the batch its report, and one called poses.csv.gz all its poses when they were docked.
#[test]
fn no_pair_has_the_name_of_a_file_of_the_batch() {
    let folder = place();
    let root = folder.path();
    for name in [
        "results.csv",
        "poses.csv.gz",
        "report.html",
        "Report.HTML",
        "batch.json",
        "attempts.csv",
        "shards",
        "SHARDS",
    ] {
        write_pairs(root, &TWO.replace("\nb,", &format!("\n{name},")));
        for keep in ["all", "top", "table", "none"] {
            let words = format!("batch in/pairs.csv -o out --keep {keep}");
            let error = program::refused(root, words.split(' '));
            assert_eq!(error["line"], 3, "{error}");
            assert!(error["message"].as_str().unwrap().contains(name), "{error}");
            assert!(!root.join("out").exists(), "{name}");
        }
    }
}

/// Rows of another table would be mixed with those of this one; the message names them.
#[test]
fn a_table_that_has_changed_is_refused_by_its_rows() {
    for keep in ["table", "all"] {
        let call_again = batch("out", &format!("--keep {keep}"));
        let folder = docked(&format!("--keep {keep}"));
        let root = folder.path();
        let out = root.join("out");
        let before = files(&out);
        let without_b: String = TWO.split_inclusive('\n').take(2).collect();
        for (table, rows) in [
            (TWO.replace("\na,helices", "\na,charged_helices"), "1 (a)"),
            (TWO.replace("\nb,", "\nother,"), "2 (other)"),
            (
                format!("{TWO}new,helices_ligand.pdb,helices_ligand.pdb\n"),
                "3 (new)",
            ),
            (without_b, "2 (b)"),
        ] {
            write_pairs(root, &table);
            let said = refused(root, &call_again);
            assert!(said.contains(rows), "{said}");
            assert!(files(&out) == before, "{rows}");
        }
        write_pairs(root, TWO);
        assert!(call(root, &call_again).status.success());
    }
}

/// A lock has no content. What has its name and is none is not taken for one.
#[test]
fn a_lock_that_is_none_stays() {
    let folder = docked("--keep none");
    let root = folder.path();
    let again = batch("out", "--keep none");
    let lock = root.join("out/.knotdock-lock");
    fs::write(&lock, "mine").unwrap();
    let said = refused(root, &again);
    assert!(said.contains(".knotdock-lock"), "{said}");
    assert_eq!(fs::read(&lock).unwrap(), b"mine");
    fs::remove_file(&lock).unwrap();
    fs::create_dir(&lock).unwrap();
    refused(root, &again);
    fs::remove_dir(&lock).unwrap();
    #[cfg(unix)]
    {
        let empty = root.join("empty.txt");
        fs::write(&empty, "").unwrap();
        symlink(&empty, &lock).unwrap();
        refused(root, &again);
        assert!(lock.symlink_metadata().unwrap().is_symlink() && empty.exists());
        fs::remove_file(&lock).unwrap();
    }
    // One that a killed command left is taken over.
    fs::write(&lock, "").unwrap();
    assert!(call(root, &again).status.success());
    assert!(!lock.exists());
}
