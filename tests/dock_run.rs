//! A run and what it leaves: the table, the complexes, the record, and the same bytes again.

mod molecules;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

const HEADER: &str = "rank,score,cluster,cluster_size,qw,qx,qy,qz,tx,ty,tz,refined,rotation,score_grid,score_unfiltered,\
                      shape,slice_0,slice_r0,slice_2r0,electrostatics,contact,cluster_score,fine_contact,rank_score,z_score";

/// A folder with the made-up receptor and ligand.
fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("receptor.pdb"), molecules::receptor()).unwrap();
    fs::write(folder.path().join("ligand.pdb"), molecules::ligand()).unwrap();
    folder
}

/// Runs the program in a folder; it must succeed. Returns standard output.
fn run(folder: &Path, arguments: &str) -> String {
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .args(arguments.split_whitespace())
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{arguments}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}

/// All files below a folder, by their path in it.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if entry.path().is_dir() {
            for (inner, bytes) in files(&entry.path()) {
                found.insert(format!("{name}/{inner}"), bytes);
            }
        } else {
            found.insert(name, fs::read(entry.path()).unwrap());
        }
    }
    found
}

/// The files of a run with the parts of run.json taken out that may differ.
fn comparable(run: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = files(run);
    let mut record: Value = serde_json::from_slice(&found["run.json"]).unwrap();
    for part in ["timing", "machine"] {
        assert!(record.as_object_mut().unwrap().remove(part).is_some());
    }
    found.insert("run.json".to_owned(), record.to_string().into_bytes());
    found
}

fn rows(run: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(run.join("poses.csv")).unwrap();
    reader
        .deserialize()
        .map(|row| row.unwrap())
        .collect::<Vec<_>>()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap()
}

#[test]
fn the_table_says_what_its_columns_promise() {
    let folder = place();
    run(
        folder.path(),
        "dock receptor.pdb ligand.pdb --rotations 60 --no-cluster -o run --quiet",
    );
    let run = folder.path().join("run");
    let text = fs::read_to_string(run.join("poses.csv")).unwrap();
    assert_eq!(text.lines().next(), Some(HEADER));
    assert!(!text.contains('\r') && !text.contains("NaN"));
    let rows = rows(&run);
    assert!(!rows.is_empty());
    let (lambda, best) = (9.0, number(&rows[0], "score").abs());
    let mut last = f64::INFINITY;
    for (index, row) in rows.iter().enumerate() {
        assert_eq!(row["rank"], (index + 1).to_string());
        let score = number(row, "score");
        let ranked = number(row, "rank_score");
        assert!(ranked <= last, "ranks must follow rank scores");
        last = ranked;
        let length: f64 = ["qw", "qx", "qy", "qz"]
            .map(|part| number(row, part).powi(2))
            .iter()
            .sum();
        assert!((length - 1.0).abs() < 1e-12 && number(row, "qw") >= 0.0);
        // Behandish & Ilies' score with its sign: the slices alone give the shape term.
        let shape = -lambda * lambda * number(row, "slice_0")
            + 2.0 * lambda * number(row, "slice_r0")
            - number(row, "slice_2r0");
        assert!((shape - number(row, "shape")).abs() <= 1e-9 * best);
        let terms = number(row, "shape") + number(row, "electrostatics") + number(row, "contact");
        assert!((score - terms).abs() <= 1e-9 * best);
        let ranked_by = number(row, "rank_score") - number(row, "fine_contact");
        assert!((score - ranked_by).abs() <= 1e-9 * best);
        // Shortest digits: printing what was read gives the field back.
        for column in ["score", "qx", "tx", "score_grid", "slice_0"] {
            assert_eq!(number(row, column).to_string(), row[column]);
        }
    }
}

#[test]
fn one_row_a_cluster_is_the_first_of_each_of_all_poses() {
    let folder = place();
    let dock = "dock receptor.pdb ligand.pdb --rotations 60 --quiet --write-top 0";
    run(folder.path(), &format!("{dock} --no-cluster -o all"));
    run(folder.path(), &format!("{dock} -o clusters"));
    let mut seen = std::collections::HashSet::new();
    let mut firsts = rows(&folder.path().join("all"));
    firsts.retain(|row| seen.insert(row["cluster"].clone()));
    firsts.sort_by_key(|row| row["cluster"].parse::<usize>().unwrap());
    for row in &firsts {
        let excess = number(row, "cluster_score") - number(row, "rank_score");
        assert_eq!(excess > 1e-9, row["cluster_size"] != "1", "company counts");
    }
    let clusters = rows(&folder.path().join("clusters"));
    assert!(clusters.len() > 1 && clusters.len() < rows(&folder.path().join("all")).len());
    for (index, row) in clusters.iter().enumerate() {
        assert_eq!(
            row["cluster"],
            (index + 1).to_string(),
            "best cluster first"
        );
    }
    for row in firsts.iter_mut() {
        row.insert("rank".to_owned(), row["cluster"].clone());
    }
    assert_eq!(firsts, clusters);
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let folder = place();
    let dock = "dock receptor.pdb ligand.pdb --rotations 60 --quiet --write-top 3";
    run(folder.path(), &format!("{dock} --threads 1 -o one"));
    run(folder.path(), &format!("{dock} --threads 2 -o two"));
    run(
        folder.path(),
        &format!("{dock} --threads 5 --memory 1G -o five"),
    );
    let one = comparable(&folder.path().join("one"));
    assert_eq!(one.len(), 5, "{:?}", one.keys());
    assert_eq!(one, comparable(&folder.path().join("two")));
    assert_eq!(one, comparable(&folder.path().join("five")));
}

/// A finer search can only find better peaks in the cells that it searches, keeps the number of poses, and says where each came from.
#[test]
fn a_finer_search_about_the_best_rotations() {
    let folder = place();
    let dock = |more: &str| {
        let arguments =
            "dock receptor.pdb ligand.pdb --rotations 60 --poses 60 --no-cluster --quiet";
        run(folder.path(), &format!("{arguments} {more}"));
    };
    dock("-o coarse");
    dock("-o fine --fine-rotations 480 --fine-share 0.2 --threads 1");
    dock("-o again --fine-rotations 480 --fine-share 0.2 --threads 2");
    let [coarse, fine, again] =
        ["coarse", "fine", "again"].map(|name| comparable(&folder.path().join(name)));
    assert_eq!(fine, again);
    let [coarse_rows, fine_rows] = ["coarse", "fine"].map(|name| rows(&folder.path().join(name)));
    assert_eq!(coarse_rows.len(), fine_rows.len());
    let best = |rows: &[BTreeMap<String, String>]| {
        let scores = rows.iter().map(|row| number(row, "score_grid"));
        scores.fold(f64::NEG_INFINITY, f64::max)
    };
    assert!(best(&fine_rows) > best(&coarse_rows));
    let finer = |row: &&BTreeMap<String, String>| number(row, "rotation") >= 60.0;
    assert!(fine_rows.iter().any(|row| finer(&row)) && !fine_rows.iter().all(|row| finer(&row)));
    assert!(coarse_rows.iter().all(|row| !finer(&row)));
    // Grid poses of finer rotations score what the fast path said, to its tolerance.
    let scale = best(&fine_rows);
    for row in fine_rows.iter().filter(finer).take(20) {
        let apart = number(row, "score_grid") - number(row, "score");
        assert!(apart.abs() < 0.02 * scale, "{row:?}");
    }
    let record = |files: &BTreeMap<String, Vec<u8>>| -> Value {
        serde_json::from_slice(&files["run.json"]).unwrap()
    };
    let searched = &record(&fine)["finer_search"];
    assert!((96..160).contains(&searched["rotations"].as_u64().unwrap()));
    assert!(record(&coarse)["finer_search"].is_null());
}

#[test]
fn a_recorded_run_repeats_to_the_byte() {
    let folder = place();
    run(
        folder.path(),
        "dock receptor.pdb:A ligand.pdb --rotations 47 --lambda 9.3 --offset 1.7 --poses 50 --refine 7 \
         --cluster-radius 4.1 --no-cluster --write-top 2 --native-receptor receptor.pdb:A --native-ligand ligand.pdb \
         -o first --quiet",
    );
    run(folder.path(), "dock --from first/run.json -o again --quiet");
    assert_eq!(
        comparable(&folder.path().join("first")),
        comparable(&folder.path().join("again"))
    );
    // What is recorded cannot be asked for otherwise at the same time.
    for option in [
        "--rotations=60",
        "--no-cluster",
        "--write-top=10",
        "--native=ligand.pdb",
    ] {
        cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(["dock", "--from", "first/run.json", "-o", "third", option])
            .assert()
            .code(2);
    }
    // An input that has changed is not the one that was docked.
    fs::write(folder.path().join("ligand.pdb"), molecules::receptor()).unwrap();
    let failed = cargo_bin_cmd!("knotdock")
        .current_dir(folder.path())
        .args(["dock", "--from", "first/run.json", "-o", "third"])
        .assert()
        .code(2);
    let told = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
    assert!(told.contains("has changed"), "{told}");
    assert!(!folder.path().join("third").exists());
}

#[test]
fn an_older_run_goes_only_when_told_and_when_the_new_one_is_done() {
    let folder = place();
    let dock = "dock receptor.pdb ligand.pdb --rotations 20 --quiet";
    run(folder.path(), dock);
    let directory = folder.path().join("knotdock_receptor_ligand");
    fs::write(directory.join("notes.txt"), "mine").unwrap();
    let before = files(&directory);
    let attempt = |arguments: &str| {
        cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(arguments.split_whitespace())
            .assert()
            .code(2)
    };
    let refused = attempt(dock);
    let told = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(
        told.contains("already holds a run") && told.contains("--force"),
        "{told}"
    );
    attempt("dock receptor.pdb:Z ligand.pdb -o knotdock_receptor_ligand --force");
    assert_eq!(files(&directory), before);
    run(
        folder.path(),
        "dock receptor.pdb ligand.pdb --rotations 25 --force --write-top 1",
    );
    let after = files(&directory);
    assert_ne!(after["poses.csv"], before["poses.csv"]);
    assert_eq!(after["notes.txt"], b"mine");
    assert_eq!(
        after.keys().map(String::as_str).collect::<Vec<_>>(),
        ["notes.txt", "poses.csv", "run.json", "top/rank_0001.pdb"]
    );
}

#[test]
fn the_same_chain_on_both_sides_docks() {
    let folder = place();
    run(
        folder.path(),
        "dock receptor.pdb:A receptor.pdb:A --rotations 20 --write-top 1 -o run --quiet",
    );
    let text = fs::read_to_string(folder.path().join("run/top/rank_0001.pdb")).unwrap();
    let chains: std::collections::BTreeSet<&str> = text
        .lines()
        .filter(|line| line.starts_with("ATOM"))
        .map(|line| &line[21..22])
        .collect();
    assert_eq!(
        chains.len(),
        2,
        "receptor and ligand need names of their own"
    );
}

#[test]
fn a_zero_radius_is_refused_by_the_search() {
    use knotdock::search::{DockOptions, plan};
    use knotdock_structures::molecule::{InputSpec, ReadOptions, read};
    let folder = place();
    let receptor = folder.path().join("receptor.pdb");
    let mut molecule = read(&InputSpec::whole(receptor), &ReadOptions::default()).unwrap();
    let whole = molecule.clone();
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        molecule.atoms[3].radius = radius;
        for (receptor, ligand) in [(&molecule, &whole), (&whole, &molecule)] {
            let error = plan(receptor, ligand, &DockOptions::default())
                .err()
                .unwrap();
            assert!(error.to_string().contains("radius"), "{error}");
        }
    }
}

#[test]
fn complexes_hold_the_receptor_as_it_was_and_the_ligand_in_its_place() {
    let folder = place();
    run(
        folder.path(),
        "dock receptor.pdb ligand.pdb --rotations 40 --no-cluster --write-top 2 -o run --quiet",
    );
    let run_folder = folder.path().join("run");
    run(folder.path(), "complex run --rank 2,4-5 -o more --quiet");
    assert_eq!(
        fs::read(folder.path().join("more/rank_0002.pdb")).unwrap(),
        fs::read(run_folder.join("top/rank_0002.pdb")).unwrap(),
        "the same complex whoever writes it"
    );
    let row = &rows(&run_folder)[3];
    let quaternion = ["qw", "qx", "qy", "qz"].map(|part| number(row, part));
    let translation = ["tx", "ty", "tz"].map(|part| number(row, part));
    let pose = knotdock_scoring::se3::Pose::from_parts(quaternion, translation);
    let complex = positions(&fs::read_to_string(folder.path().join("more/rank_0004.pdb")).unwrap());
    let receptor = positions(&molecules::receptor());
    let ligand = positions(&molecules::ligand());
    assert_eq!(complex.len(), receptor.len() + ligand.len());
    assert_eq!(complex[..receptor.len()], receptor);
    for (placed, original) in complex[receptor.len()..].iter().zip(&ligand) {
        let expected = pose.apply(*original);
        for axis in 0..3 {
            assert!(
                (placed[axis] - expected[axis]).abs() < 6e-4,
                "PDB keeps three decimals"
            );
        }
    }
    let failed = cargo_bin_cmd!("knotdock")
        .current_dir(folder.path())
        .args(["complex", "run", "--rank", "99999"])
        .assert()
        .code(2);
    let told = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
    assert!(told.contains("no rank 99999"), "{told}");
}

fn positions(pdb: &str) -> Vec<[f64; 3]> {
    pdb.lines()
        .filter(|line| line.starts_with("ATOM"))
        .map(|line| [30, 38, 46].map(|start| line[start..start + 8].trim().parse().unwrap()))
        .collect()
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
    run(&moved, "complex run --rank 1 --quiet");
    assert!(moved.join("run/top/rank_0001.pdb").exists());
}

#[test]
fn too_little_memory_is_refused_before_the_search_with_a_spacing_that_fits() {
    let folder = place();
    let attempt = |memory: &str, spacing: &str| {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(["dock", "receptor.pdb", "ligand.pdb", "--rotations", "20"])
            .args([
                "--write-top",
                "0",
                "-o",
                "run",
                "--json",
                "--memory",
                memory,
            ])
            .args(spacing.split_whitespace())
            .output()
            .unwrap();
        let object: Value = serde_json::from_slice(&output.stdout).unwrap();
        (output.status.code(), object)
    };
    let (code, told) = attempt("1M", "");
    assert_eq!(code, Some(2));
    assert!(!folder.path().join("run").exists());
    let message = told["error"]["message"].as_str().unwrap();
    let needed: u64 = message
        .split(|c: char| !c.is_ascii_digit())
        .find_map(|word| word.parse().ok())
        .unwrap();
    let (code, told) = attempt(&(needed * 19 / 20).to_string(), "");
    assert_eq!(code, Some(2), "{told}");
    let remedy = told["error"]["remedy"].as_str().unwrap();
    let spacing = remedy.split(&[' ', ','][..]).nth(2).unwrap();
    let (code, told) = attempt(
        &(needed * 19 / 20).to_string(),
        &format!("--spacing {spacing}"),
    );
    assert_eq!(code, Some(0), "{told}");
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
    run(&inner, "complex run --rank 1 --quiet");
}

#[cfg(target_os = "linux")]
#[test]
fn an_interrupted_run_leaves_nothing_that_looks_whole() {
    use std::os::unix::process::ExitStatusExt;
    use std::time::{Duration, Instant};
    let folder = place();
    let dock = "dock receptor.pdb ligand.pdb --quiet --write-top 1 -o run";
    run(folder.path(), &format!("{dock} --rotations 20"));
    let run_folder = folder.path().join("run");
    let before = files(&run_folder);
    // A shell starts background jobs with SIGINT ignored, and children inherit that: when CI itself ran as such a job, the
    // signal was lost and the search ran on. GNU env gives the child the signal's default back.
    let mut child = std::process::Command::new("env")
        .arg("--default-signal=INT")
        .arg(assert_cmd::cargo::cargo_bin!("knotdock"))
        .current_dir(folder.path())
        .args(dock.split_whitespace())
        .args(["--force", "--rotations", "40000"])
        .spawn()
        .unwrap();
    let start = Instant::now();
    while !run_folder.join(".partial").exists() {
        assert!(start.elapsed() < Duration::from_secs(120) && child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(10));
    }
    std::thread::sleep(Duration::from_millis(100)); // into the search
    std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    let asked = Instant::now();
    let status = child.wait().unwrap();
    assert!(
        asked.elapsed() < Duration::from_secs(2),
        "Ctrl-C ends at once"
    );
    assert_eq!(status.signal(), Some(2));
    let mut after = files(&run_folder);
    after.retain(|name, _| !name.starts_with(".partial"));
    assert_eq!(after, before, "the older run stays as it was");
    // The next run clears what is left.
    run(folder.path(), &format!("{dock} --force --rotations 21"));
    assert!(!run_folder.join(".partial").exists());
    assert_eq!(files(&run_folder).len(), before.len());
}

#[test]
fn mmcif_and_gzip_go_in_and_mmcif_comes_out() {
    use knotdock_structures::molecule::{Format, InputSpec, ReadOptions, read, write_molecule};
    use std::io::Write;
    let folder = place();
    let of = |name: &str| {
        let input = InputSpec::whole(folder.path().join(name));
        read(&input, &ReadOptions::default()).unwrap()
    };
    let mut text = Vec::new();
    write_molecule(&mut text, Format::Mmcif, &of("ligand.pdb"), &[]).unwrap();
    let file = fs::File::create(folder.path().join("ligand.cif.gz")).unwrap();
    let mut packed = flate2::write::GzEncoder::new(file, flate2::Compression::fast());
    packed.write_all(&text).unwrap();
    packed.finish().unwrap();
    let dock = "--rotations 20 --write-top 1 --quiet -o";
    run(
        folder.path(),
        &format!("dock receptor.pdb ligand.pdb {dock} pdb"),
    );
    run(
        folder.path(),
        &format!("dock receptor.pdb ligand.cif.gz {dock} cif"),
    );
    assert_eq!(
        fs::read(folder.path().join("pdb/poses.csv")).unwrap(),
        fs::read(folder.path().join("cif/poses.csv")).unwrap(),
        "the format of a file is no part of the answer"
    );
    assert!(!folder.path().join("cif/top/rank_0001.pdb").exists());
    let complex = of("cif/top/rank_0001.cif");
    let same = of("pdb/top/rank_0001.pdb");
    assert_eq!(complex.atoms.len(), same.atoms.len());
    for (a, b) in complex.atoms.iter().zip(&same.atoms) {
        assert_eq!((&a.name, a.residue_number), (&b.name, b.residue_number));
    }
}
