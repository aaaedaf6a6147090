//! The directory of a run is knotdock's own. What else is in it or beside it, and links of its name, are refused or
//! named, and stay.

use std::collections::BTreeMap;
use std::fs;
#[cfg(unix)]
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

use knotdock::output::files::lock::Lock;
use serde_json::Value;

use super::run::*;
use crate::program::{refused, succeed};

/// Options that take hardly any time.
const SHORT: &str = "--rotations 4 --per-rotation 2 --poses 6 --resolution 12 --effects shape --no-cluster \
                     --write-top 2";
/// A closed mesh.
const TETRAHEDRON: &str =
    "v 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

fn dock(more: &str) -> String {
    format!("dock receptor.pdb ligand.pdb {SHORT} {more}")
}

/// A folder with the molecules, a mesh, and a run in `run`.
fn docked() -> tempfile::TempDir {
    let folder = place();
    fs::write(folder.path().join("a.obj"), TETRAHEDRON).unwrap();
    run(folder.path(), &dock("-o run"));
    folder
}

/// All that is in a folder by its path: what files hold, and where links lead.
fn state(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let kind = path.symlink_metadata().unwrap();
        let content = if kind.is_symlink() {
            let target = fs::read_link(&path).unwrap();
            target.into_os_string().into_encoded_bytes()
        } else if kind.is_dir() {
            found.extend(state(&path));
            Vec::new()
        } else {
            fs::read(&path).unwrap()
        };
        found.insert(path, content);
    }
    found
}

/// The error of a call that is refused and changes nothing in the folder.
#[track_caller]
fn unchanged(folder: &Path, words: &str) -> Value {
    let before = state(folder);
    let error = refused(folder, words.split_whitespace());
    let after = state(folder);
    assert!(
        after.keys().eq(before.keys()),
        "{words}: {:?}",
        after.keys()
    );
    assert!(after == before, "{words}");
    error
}

/// The user's files in an older run, and files of it that were edited, were mixed with the new one.
#[test]
fn a_run_with_anything_of_the_users_is_not_replaced() {
    let folder = docked();
    let root = folder.path();
    let directory = root.join("run");
    let force = dock("-o run --force");
    for name in ["notes.txt", "top/session.cxs", "new/deep/figure.png"] {
        let file = directory.join(name);
        let made = file.parent().unwrap();
        fs::create_dir_all(made).unwrap();
        fs::write(&file, "mine").unwrap();
        let error = unchanged(root, &force);
        assert!(error["message"].as_str().unwrap().contains(name), "{error}");
        fs::remove_file(&file).unwrap();
        if name.starts_with("new/") {
            fs::remove_dir_all(directory.join("new")).unwrap();
        }
    }
    for name in [
        "poses.csv",
        "top/rank_0002.pdb",
        "report.html",
        "view.pml",
        "interface.csv",
    ] {
        let file = directory.join(name);
        let before = fs::read(&file).unwrap();
        fs::write(&file, [&before[..], b"edited\n"].concat()).unwrap();
        let error = unchanged(root, &force);
        assert!(error["message"].as_str().unwrap().contains(name), "{error}");
        fs::write(&file, before).unwrap();
    }
    // Of many at most three are named, none twice.
    for number in 1..=5 {
        fs::write(directory.join(format!("mine_{number}.txt")), "mine").unwrap();
    }
    let error = unchanged(root, &force);
    let message = error["message"].as_str().unwrap();
    assert_eq!(message.matches("mine_").count(), 3, "{message}");
    for number in 1..=5 {
        fs::remove_file(directory.join(format!("mine_{number}.txt"))).unwrap();
    }
    #[cfg(unix)]
    {
        // A link to a file of the same content is none of the run's files.
        let file = directory.join("top/rank_0001.pdb");
        fs::rename(&file, root.join("moved.pdb")).unwrap();
        symlink(root.join("moved.pdb"), &file).unwrap();
        unchanged(root, &force);
        fs::remove_file(&file).unwrap();
        fs::rename(root.join("moved.pdb"), &file).unwrap();
    }
    // A file that is gone is in nobody's way.
    fs::remove_file(directory.join("view.cxc")).unwrap();
    run(root, &force);
    assert!(directory.join("view.cxc").exists());
}

/// A run was mixed with whatever was in its directory.
#[test]
fn a_directory_of_something_else_is_refused() {
    let folder = docked();
    let root = folder.path();
    let record = fs::read_to_string(root.join("run/run.json")).unwrap();
    let blank = "\0".repeat(100);
    let other = record.replace("\"knotdock\"", "\"another\"");
    assert_ne!(other, record);
    let is_refused = |words: &str| {
        for force in ["", "--force"] {
            let error = unchanged(root, &format!("{words} {force}"));
            let message = error["message"].as_str().unwrap();
            assert!(message.contains("holds no run of knotdock"), "{message}");
        }
    };
    let directory = root.join("other");
    fs::create_dir(&directory).unwrap();
    for (name, text) in [
        ("poses.csv", "rank\n"),
        ("run.json", ""),
        ("run.json", &record[..100]),
        ("run.json", blank.as_str()),
        ("run.json", other.as_str()),
        ("notes.txt", "mine"),
    ] {
        fs::write(directory.join(name), text).unwrap();
        is_refused(&dock("-o other"));
        fs::remove_file(directory.join(name)).unwrap();
    }
    // Nor does an ensemble, or a sweep, go there.
    fs::write(directory.join("notes.txt"), "mine").unwrap();
    fs::copy(root.join("receptor.pdb"), root.join("copy.pdb")).unwrap();
    is_refused(&dock("--receptor-also copy.pdb -o other"));
    is_refused("tradeoff receptor.pdb ligand.pdb --rotations 4 -o other");
    // An empty directory is as good as none, and a file is none.
    fs::create_dir(root.join("empty")).unwrap();
    run(root, &dock("-o empty"));
    assert!(root.join("empty/run.json").exists());
    unchanged(root, &dock("-o receptor.pdb --force"));
}

/// What a link leads to is not what was named after -o.
#[cfg(unix)]
#[test]
fn nothing_is_written_through_a_link() {
    let folder = docked();
    let root = folder.path();
    fs::write(root.join("thesis.txt"), "mine").unwrap();
    for name in ["there", "more"] {
        fs::create_dir(root.join(name)).unwrap();
    }
    for (to, link) in [
        ("there", "folder"),
        ("run", "older"),
        ("thesis.txt", "file.csv"),
        ("thesis.txt", "picture.svg"),
        ("nowhere", "dangling.csv"),
        ("thesis.txt", "more/rank_0001.pdb"),
    ] {
        symlink(root.join(to), root.join(link)).unwrap();
    }
    let sample = "sample a.obj --grid 2^9";
    for words in [
        dock("-o folder"),
        dock("-o folder/"),
        dock("-o older"),
        dock("-o dangling.csv"),
        "export run --rank 1 -o folder".to_owned(),
        "export run --rank 1 -o dangling.csv".to_owned(),
        // A complex of a name that is a link.
        "export run --rank 1-2 -o more".to_owned(),
        "refine run --ranks 1 -o folder".to_owned(),
        format!("{sample} -o file.csv"),
        format!("{sample} -o dangling.csv"),
        format!("{sample} --picture picture.svg"),
    ] {
        for force in ["", "--force"] {
            unchanged(root, &format!("{words} {force}"));
        }
    }
    // Links above are followed.
    run(root, &dock("-o folder/run"));
    assert!(root.join("there/run/run.json").exists());
    run(root, &format!("{sample} -o folder/knots.csv"));
    assert!(root.join("there/knots.csv").exists());
}

/// A complex that someone has edited is replaced on request alone, in a run and elsewhere. What was added to a run is
/// the run's own.
#[test]
fn edited_complexes_are_replaced_on_request() {
    let folder = docked();
    let root = folder.path();
    run(root, "export run --rank 1-4");
    run(root, "export run --rank 1-4 -o more");
    let added: Value =
        serde_json::from_slice(&fs::read(root.join("run/added.json")).unwrap()).unwrap();
    assert_eq!(added["program"], "knotdock");
    assert!(added["files"]["top/rank_0004.pdb"].is_string(), "{added}");
    assert!(!root.join("run/top/exported.json").exists());
    let names: Vec<String> = files(&root.join("more")).into_keys().collect();
    let complexes = [1, 2, 3, 4].map(|rank| format!("rank_000{rank}.pdb"));
    assert_eq!(names, complexes);
    for (file, out) in [
        ("run/top/rank_0001.pdb", ""),
        ("run/top/rank_0004.pdb", ""),
        ("more/rank_0001.pdb", "-o more"),
    ] {
        let export = format!("export run --rank 1,3-4 {out}");
        let whole = fs::read(root.join(file)).unwrap();
        fs::write(root.join(file), "edited").unwrap();
        let error = unchanged(root, &export);
        let name = file.rsplit('/').next().unwrap();
        assert!(error.to_string().contains(name), "{error}");
        run(root, &format!("{export} --force"));
        assert!(fs::read(root.join(file)).unwrap() == whole, "{file}");
        // The same content is no matter.
        run(root, &export);
    }
    run(root, &dock("-o run --force"));
    let replaced = files(&root.join("run"));
    assert!(!replaced.contains_key("added.json") && !replaced.contains_key("top/rank_0004.pdb"));
}

/// What ended commands left is named, with its path, and left: nobody else knows whether they still run.
#[test]
fn leftovers_are_named_and_stay() {
    let folder = docked();
    let root = folder.path();
    run(root, "sample a.obj --grid 2^9 -o knots.csv");
    let left = [
        ".run.knotdock-abcdefghijkl",
        ".run.knotdock-0123456789AB",
        ".knots.csv.knotdock-abcdefghijkl",
        // Of other targets, and of none.
        ".other.knotdock-abcdefghijkl",
        ".run.knotdock-short",
    ];
    fs::create_dir_all(root.join(left[0]).join("top")).unwrap();
    fs::write(root.join(left[0]).join("top/rank_0001.pdb"), "mine").unwrap();
    for name in &left[1..] {
        fs::write(root.join(name), "mine").unwrap();
    }
    let hidden = || {
        let mut found = state(root);
        found.retain(|path, _| path.to_string_lossy().contains(".knotdock-"));
        found
    };
    let before = hidden();
    let of_run = dock("-o run --force");
    for (words, named) in [
        (of_run.as_str(), 0..2),
        ("export run --rank 3", 0..2),
        ("sample a.obj --grid 2^9 -o knots.csv --force", 2..3),
        ("sample a.obj --grid 2^9 -o none.csv", 0..0),
    ] {
        let output = succeed(root, words.split_whitespace());
        let said = String::from_utf8(output.stderr).unwrap();
        for (number, name) in left.iter().enumerate() {
            let is_named = said.contains(name);
            assert_eq!(is_named, named.contains(&number), "{words}: {name}: {said}");
        }
        assert!(hidden() == before, "{words}");
    }
}

/// Two commands do not write to one directory at once: the second is refused before it computes anything.
#[test]
fn one_command_writes_to_a_run_at_a_time() {
    let folder = docked();
    let root = folder.path();
    let lock = root.join(".run.knotdock-lock");
    let held = Lock::take(&lock).unwrap();
    let long = "dock receptor.pdb ligand.pdb --rotations 40000 -o run --force";
    for words in [long, "export run --rank 3", "refine run --ranks 1"] {
        let error = unchanged(root, words);
        let message = error["message"].as_str().unwrap();
        assert!(message.contains("another command is writing"), "{error}");
    }
    // Elsewhere nothing of it is in the way.
    run(root, "export run --rank 3 -o more");
    drop(held);
    // After a kill the file is there, and nobody holds it.
    fs::write(&lock, "").unwrap();
    run(root, &dock("-o run --force"));
    assert!(!lock.exists());
}

/// What has the name of a lock and is none is the user's.
#[test]
fn a_lock_that_is_none_stays() {
    let folder = docked();
    let root = folder.path();
    let lock = root.join(".run.knotdock-lock");
    let all = [dock("-o run --force"), "export run --rank 3".to_owned()];
    let are_refused = || {
        for words in &all {
            let error = unchanged(root, words).to_string();
            assert!(error.contains(".run.knotdock-lock"), "{error}");
        }
    };
    fs::write(&lock, "mine").unwrap();
    are_refused();
    fs::remove_file(&lock).unwrap();
    fs::create_dir(&lock).unwrap();
    are_refused();
    fs::remove_dir(&lock).unwrap();
    #[cfg(unix)]
    {
        fs::write(root.join("empty.txt"), "").unwrap();
        symlink(root.join("empty.txt"), &lock).unwrap();
        are_refused();
        assert!(lock.is_symlink());
    }
}

/// On file systems without locks the file itself is the lock. One that was left is named, since only the user knows
/// whether it is in use.
#[cfg(debug_assertions)]
#[test]
fn where_there_are_no_locks_the_file_is_one() {
    let folder = docked();
    let root = folder.path();
    let lock = root.join(".run.knotdock-lock");
    let call = || {
        assert_cmd::cargo::cargo_bin_cmd!("knotdock")
            .current_dir(root)
            .args(dock("-o run --force --json").split_whitespace())
            .env("KNOTDOCK_NO_LOCKS", "1")
            .output()
            .unwrap()
    };
    fs::write(&lock, "").unwrap();
    let before = files(root);
    let output = call();
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    let error = object["error"].to_string();
    assert!(error.contains(".run.knotdock-lock"), "{error}");
    assert!(files(root) == before);
    fs::remove_file(&lock).unwrap();
    let output = call();
    assert!(output.status.success(), "{output:?}");
    assert!(!lock.exists());
}
