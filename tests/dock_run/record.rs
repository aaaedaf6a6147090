//! The directory of a run and its record: repeated, replaced, moved, interrupted.

use std::fs;

use assert_cmd::cargo::cargo_bin_cmd;

use super::run::*;

#[test]
fn a_recorded_run_repeats_to_the_byte() {
    let folder = place();
    run(
        folder.path(),
        "dock receptor.pdb:A ligand.pdb --rotations 47 --lambda 9.3 --offset 1.7 --poses 50 --refine 7 \
         --cluster-radius 4.1 --no-cluster --write-top 2 --native-receptor receptor.pdb:A --native-ligand ligand.pdb \
         -o first --quiet",
    );
    run(
        folder.path(),
        "dock --rerun first/run.json -o again --quiet",
    );
    assert_eq!(
        comparable(&folder.path().join("first")),
        comparable(&folder.path().join("again"))
    );
    // An option cannot contradict the record at the same time.
    for option in [
        "--rotations=60",
        "--no-cluster",
        "--write-top=10",
        "--native=ligand.pdb",
    ] {
        cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(["dock", "--rerun", "first/run.json", "-o", "third", option])
            .assert()
            .code(2);
    }
    // An input that has changed is not the one that was docked.
    fs::write(
        folder.path().join("ligand.pdb"),
        crate::molecules::receptor(),
    )
    .unwrap();
    let failed = cargo_bin_cmd!("knotdock")
        .current_dir(folder.path())
        .args(["dock", "--rerun", "first/run.json", "-o", "third"])
        .assert()
        .code(2);
    let reported = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
    assert!(reported.contains("has changed"), "{reported}");
    assert!(!folder.path().join("third").exists());
}

/// Tables of potentials are part of the record: a run repeats without the files that they came from.
#[test]
fn a_run_with_tables_of_its_own_repeats_to_the_byte() {
    let folder = place();
    let tables = [
        (
            "contact",
            include_str!("../../scoring/src/terms/effect/contact_potential.csv"),
        ),
        (
            "fine-contact",
            include_str!("../../scoring/src/terms/pose/fine_contact_potential.csv"),
        ),
        (
            "atom-pair",
            include_str!("../../scoring/src/terms/pose/atom_pair_potential.csv"),
        ),
    ];
    let options: Vec<String> = tables
        .iter()
        .map(|(name, own)| {
            // The program's own, turned about.
            let turned = own
                .replace(",-", ",+")
                .replace(",0", ",-0")
                .replace(",+", ",");
            assert_ne!(&turned, own);
            fs::write(folder.path().join(format!("{name}.csv")), turned).unwrap();
            format!(
                "--config=terms.{}_potential='{name}.csv'",
                name.replace('-', "_")
            )
        })
        .collect();
    let dock = "dock receptor.pdb ligand.pdb --rotations 20 --quiet";
    run(folder.path(), &format!("{dock} -o own"));
    run(
        folder.path(),
        &format!("{dock} -o first {}", options.join(" ")),
    );
    for (name, _) in tables {
        fs::remove_file(folder.path().join(format!("{name}.csv"))).unwrap();
    }
    run(
        folder.path(),
        "dock --rerun first/run.json -o again --quiet",
    );
    let [own, first, again] =
        ["own", "first", "again"].map(|run| comparable(&folder.path().join(run)));
    assert_eq!(first, again);
    assert_ne!(own, first);
}

#[test]
fn an_older_run_goes_only_when_forced_and_when_the_new_one_is_done() {
    let folder = place();
    let dock = "dock receptor.pdb ligand.pdb --rotations 20 --quiet";
    run(folder.path(), dock);
    let directory = folder.path().join("knotdock_receptor_ligand");
    let before = files(&directory);
    let attempt = |arguments: &str| {
        cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(arguments.split_whitespace())
            .assert()
            .code(2)
    };
    let refused = attempt(dock);
    let reported = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(
        reported.contains("already holds a run") && reported.contains("--force"),
        "{reported}"
    );
    attempt("dock receptor.pdb:Z ligand.pdb -o knotdock_receptor_ligand --force");
    assert_eq!(files(&directory), before);
    run(
        folder.path(),
        "dock receptor.pdb ligand.pdb --rotations 25 --force --write-top 1",
    );
    let after = files(&directory);
    assert_ne!(after["poses.csv"], before["poses.csv"]);
    assert_eq!(
        after.keys().map(String::as_str).collect::<Vec<_>>(),
        [
            "interface.csv",
            "poses.csv",
            "report.html",
            "run.json",
            "top/rank_0001.pdb",
            "view.cxc",
            "view.pml"
        ]
    );
}

#[test]
fn a_run_moved_with_its_inputs_still_finds_them() {
    let folder = place();
    run(
        folder.path(),
        "dock receptor.pdb ligand.pdb --rotations 20 --write-top 0 -o run --quiet",
    );
    let other = tempfile::tempdir().unwrap();
    let moved = other.path().join("moved");
    fs::create_dir(&moved).unwrap();
    for entry in ["run", "receptor.pdb", "ligand.pdb"] {
        fs::rename(folder.path().join(entry), moved.join(entry)).unwrap();
    }
    run(&moved, "export run --rank 1 --quiet");
    assert!(moved.join("run/top/rank_0001.pdb").exists());
    // From inside the run's own folder, too.
    run(&moved.join("run"), "export . --rank 1 --force --quiet");
    run(&moved.join("run"), "dock --rerun run.json -o again --quiet");
    assert!(moved.join("run/again/poses.csv").exists());
}

#[cfg(target_os = "linux")] // elsewhere such names cannot be made
#[test]
fn a_folder_whose_name_is_not_unicode_is_no_hindrance() {
    use std::os::unix::ffi::OsStrExt;
    let folder = place();
    // JSON cannot hold the inputs' absolute paths; the run must not fail on that when all is done.
    let inner = folder.path().join(std::ffi::OsStr::from_bytes(b"runs\xff"));
    fs::create_dir(&inner).unwrap();
    for file in ["receptor.pdb", "ligand.pdb"] {
        fs::rename(folder.path().join(file), inner.join(file)).unwrap();
    }
    run(
        &inner,
        "dock receptor.pdb ligand.pdb --rotations 20 --write-top 0 -o run --json",
    );
    // Not under its recorded name, but beside the run.
    run(&inner, "export run --rank 1 --quiet");
}

#[cfg(target_os = "linux")]
#[test]
fn an_interrupted_run_leaves_nothing_that_looks_whole() {
    use std::os::unix::process::ExitStatusExt;
    use std::time::Duration;
    let folder = place();
    let dock = "dock receptor.pdb ligand.pdb --quiet --write-top 1 -o run";
    run(folder.path(), &format!("{dock} --rotations 20"));
    let run_folder = folder.path().join("run");
    let before = files(&run_folder);
    // A shell starts background jobs with SIGINT ignored, and children inherit that: when CI itself ran as such a
    // job, the signal was lost and the search ran on. GNU env gives the child the signal's default back.
    let mut child = std::process::Command::new("env")
        .arg("--default-signal=INT")
        .arg(assert_cmd::cargo::cargo_bin!("knotdock"))
        .current_dir(folder.path())
        .args(dock.split_whitespace())
        .args(["--force", "--rotations", "40000"])
        .spawn()
        .unwrap();
    // What is being written, beside the lock.
    let staged = || {
        let names = fs::read_dir(folder.path()).unwrap();
        let mut names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.find(|name| {
            let ending = name.strip_prefix(".run.knotdock-");
            ending.is_some_and(|ending| ending.len() == 12)
        })
    };
    while staged().is_none() {
        assert!(child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(10));
    }
    std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    // Had the run gone on to its end it would have ended by itself, and replaced the older one.
    let status = child.wait().unwrap();
    assert_eq!(status.signal(), Some(2));
    assert_eq!(files(&run_folder), before, "the older run stays as it was");
    // The next run names what is left, and leaves it to the user; the lock it takes over.
    let left = staged().unwrap();
    let words = format!("{dock} --force --rotations 21").replace(" --quiet", "");
    let next = crate::program::succeed(folder.path(), words.split_whitespace());
    let said = String::from_utf8(next.stderr).unwrap();
    assert!(said.contains(&left), "{said}");
    assert_eq!(staged(), Some(left));
    assert!(!folder.path().join(".run.knotdock-lock").exists());
    assert_eq!(files(&run_folder).len(), before.len());
}
