//! The JSON object of each command, and the stream of each output.

use crate::molecules;
use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Output, Stdio};

use crate::program::{refused, succeed};
use serde_json::Value;

fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("receptor.pdb"), molecules::receptor()).unwrap();
    fs::write(folder.path().join("ligand.pdb"), molecules::ligand()).unwrap();
    let native = molecules::receptor().replace("END\n", "")
        + &molecules::ligand().replace(" ALA A", " ALA C");
    fs::write(folder.path().join("native.pdb"), native).unwrap();
    folder
}

fn run(folder: &Path, arguments: &str) -> Output {
    succeed(folder, arguments.split_whitespace())
}

fn object(output: &Output) -> Value {
    let text = std::str::from_utf8(&output.stdout).unwrap();
    assert_eq!(text.lines().count(), 1, "one object on one line");
    serde_json::from_str(text).unwrap()
}

/// Names of an object's entries, in alphabetical order.
fn keys(object: &Value) -> Vec<&str> {
    let entries = object.as_object().unwrap().keys();
    let mut names: Vec<&str> = entries.map(String::as_str).collect();
    names.sort_unstable();
    names
}

#[test]
fn dock_says_where_the_run_is_and_what_is_best() {
    let folder = place();
    let output = run(
        folder.path(),
        "dock receptor.pdb ligand.pdb --rotations 40 --write-top 2 --native native.pdb -o run --json",
    );
    let object = object(&output);
    assert_eq!(
        keys(&object),
        ["best", "complexes", "directory", "poses", "report", "run"]
    );
    assert!(
        String::from_utf8_lossy(&output.stderr).contains("receptor.pdb"),
        "words go to standard error"
    );
    let best = object["best"].as_array().unwrap();
    assert!(!best.is_empty() && best.len() <= 10);
    assert_eq!(best[0]["rank"], 1);
    assert!(best[0]["score"].is_number() && best[0]["irmsd"].is_number());
    assert!(best[0]["cluster_size"].is_number() && best[0]["capri"].is_string());
    let complexes = object["complexes"].as_array().unwrap();
    assert_eq!(complexes.len(), 2);
    for path in complexes {
        assert!(folder.path().join(path.as_str().unwrap()).is_file());
    }
    let recorded: Value =
        serde_json::from_slice(&fs::read(folder.path().join("run/run.json")).unwrap()).unwrap();
    assert_eq!(object["run"], recorded);
    assert_eq!(
        keys(&recorded),
        [
            "active_site",
            "chains",
            "commit",
            "cpu_features",
            "effects",
            "error",
            "files",
            "finer_search",
            "inputs",
            "machine",
            "match",
            "options",
            "plan",
            "pose_terms",
            "program",
            "rank",
            "redocking",
            "results",
            "schema",
            "sharp",
            "timing",
            "version"
        ]
    );
    assert!(
        recorded["options"].get("machine").is_none(),
        "threads are the machine's"
    );
    let columns = fs::read_to_string(folder.path().join("run/poses.csv")).unwrap();
    assert!(columns.lines().next().unwrap().ends_with(
        "unresolved,termini,other_copies,sharp,sharp_energy,sharp_clashes,z_score,qw,qx,qy,qz,tx,ty,tz,irmsd,lrmsd,fnat,dockq,capri,complex_clashes,complex_irmsd"
    ));
}

#[test]
fn evaluate_gives_every_pose_and_the_match() {
    let folder = place();
    run(
        folder.path(),
        "dock receptor.pdb ligand.pdb --rotations 40 --no-cluster --write-top 0 -o run --quiet",
    );
    // The ligand at its place in the native: nothing to measure but zeros and ones.
    fs::write(
        folder.path().join("truth.csv"),
        "rank,qw,qx,qy,qz,tx,ty,tz\n1,1,0,0,0,0,0,0\n2,1,0,0,0,0,0,50\n",
    )
    .unwrap();
    let reported = object(&run(
        folder.path(),
        "evaluate truth.csv --receptor receptor.pdb --ligand ligand.pdb --native native.pdb --json",
    ));
    assert_eq!(keys(&reported), ["match", "poses"]);
    let poses = reported["poses"].as_array().unwrap();
    assert_eq!(
        keys(&poses[0]),
        [
            "acceptable",
            "capri",
            "dockq",
            "fnat",
            "irmsd",
            "lrmsd",
            "native_chains",
            "near_native",
            "rank"
        ]
    );
    assert_eq!(poses[0]["acceptable"], true);
    assert_eq!(poses[0]["near_native"], true);
    assert_eq!(poses[1]["acceptable"], false);
    assert_eq!(poses[1]["near_native"], false);
    assert!(poses[0]["irmsd"].as_f64().unwrap() < 1e-3);
    assert_eq!(poses[0]["fnat"], 1.0);
    assert_eq!(poses[0]["capri"], "high");
    assert!((poses[1]["lrmsd"].as_f64().unwrap() - 50.0).abs() < 1e-3);
    assert_eq!(poses[1]["capri"], "incorrect");

    // From a run's directory, and into a table.
    let of_run = object(&run(
        folder.path(),
        "evaluate run --native native.pdb --json -o measured.csv",
    ));
    let table = fs::read_to_string(folder.path().join("run/poses.csv")).unwrap();
    assert_eq!(
        of_run["poses"].as_array().unwrap().len(),
        table.lines().count() - 1
    );
    let measured = fs::read_to_string(folder.path().join("measured.csv")).unwrap();
    for (before, after) in table.lines().zip(measured.lines()) {
        assert!(
            after.starts_with(before),
            "the run's own columns stay as they are"
        );
        let fields = |line: &str| {
            let mut line = csv::ReaderBuilder::new()
                .has_headers(false)
                .from_reader(line.as_bytes());
            line.records().next().unwrap().unwrap().len()
        };
        assert_eq!(fields(after), fields(before) + 6);
    }
}

#[test]
fn complex_lists_files_by_rank() {
    let folder = place();
    run(
        folder.path(),
        "dock receptor.pdb ligand.pdb --rotations 40 --no-cluster --write-top 0 -o run --quiet",
    );
    let reported = object(&run(folder.path(), "export run --rank 3,1 --json"));
    assert_eq!(keys(&reported), ["chains", "files"]);
    let files = reported["files"].as_array().unwrap();
    assert_eq!(
        files
            .iter()
            .map(|file| file["rank"].as_u64().unwrap())
            .collect::<Vec<_>>(),
        [3, 1]
    );
    for file in files {
        assert!(folder.path().join(file["path"].as_str().unwrap()).is_file());
    }
}

#[test]
fn quiet_is_quiet() {
    let folder = place();
    let output = run(
        folder.path(),
        "dock receptor.pdb ligand.pdb --rotations 20 -o run --quiet",
    );
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
}

#[test]
fn a_reader_that_goes_away_does_not_stop_the_run() {
    let folder = place();
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin!("knotdock"))
        .current_dir(folder.path())
        .args("dock receptor.pdb ligand.pdb --rotations 20 -o run".split_whitespace())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut reported = String::new();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut reported)
        .unwrap();
    assert!(child.wait().unwrap().success());
    assert!(!reported.contains("panic"), "{reported}");
    assert!(folder.path().join("run/run.json").is_file());
}

#[test]
fn inspect_says_what_was_read_and_assumed() {
    let folder = place();
    let output = run(folder.path(), "inspect receptor.pdb:A --json");
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        keys(&object),
        [
            "accessible_area",
            "active_sites",
            "antibody",
            "chains",
            "input",
            "labels",
            "pose_terms",
            "terminus_residues",
            "unresolved_residues",
            "volume",
            "volume_error"
        ]
    );
    assert_eq!(object["input"]["chains"], serde_json::json!(["A"]));
    // A helix of sixteen alanines: its two ends cancel.
    assert_eq!(object["input"]["atoms"], 80);
    let residues = object["chains"][0]["residues"].as_array().unwrap();
    assert_eq!(
        (object["chains"][0]["chain"].as_str(), residues.len()),
        (Some("A"), 16)
    );
    assert_eq!(
        residues[15],
        serde_json::json!({ "number": "16", "name": "ALA", "letter": "A" })
    );
    assert_eq!(object["labels"]["net_charge"], 0.0);
    assert_eq!(object["labels"]["termini"], serde_json::json!([1, 1]));
    assert_eq!(object["labels"]["typed_atoms"], 80);
    assert!(object["accessible_area"].as_f64().unwrap() > 1000.0);
    let volume = object["volume"].as_f64().unwrap();
    // Eighty atoms of 1.42 to 1.88 Å that overlap their neighbours.
    assert!((800.0..1600.0).contains(&volume), "{volume}");
    assert!(object["volume_error"].as_f64().unwrap() < 1e-3 * volume);
}

/// A mesh has a surface in place of chains.
#[test]
fn inspect_reads_a_mesh() {
    let folder = place();
    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    fs::write(folder.path().join("mesh.obj"), tetrahedron).unwrap();
    let object = object(&run(folder.path(), "inspect mesh.obj --json"));
    assert_eq!(keys(&object), ["input", "surface"]);
    assert_eq!(object["surface"]["triangle_count"], 4);
    let words = ["inspect", "mesh.obj", "--atoms", "atoms.csv"];
    let error = refused(folder.path(), words);
    assert!(
        error["message"].as_str().unwrap().contains("mesh"),
        "{error}"
    );
}

#[test]
fn inspect_lists_every_atom_with_what_became_of_it() {
    let folder = place();
    let water = "HETATM  900  O   HOH A 900       0.000   0.000   0.000  1.00 10.00           O\n";
    fs::write(
        folder.path().join("wet.pdb"),
        molecules::ligand().replace("END\n", water),
    )
    .unwrap();
    for (option, kept, radius, dropped) in
        [("", 60, "", "water"), ("--waters keep", 61, "1.46", "")]
    {
        let reported = object(&run(
            folder.path(),
            &format!("inspect wet.pdb --atoms atoms.csv --force --json {option}"),
        ));
        assert_eq!(reported["input"]["atoms"], kept);
        let table = fs::read_to_string(folder.path().join("atoms.csv")).unwrap();
        assert_eq!(table.lines().count(), 62);
        assert!(
            table.starts_with(
                "line,record,atom,altloc,residue,chain,number,insertion,element,x,y,z,"
            )
        );
        let last = table.lines().last().unwrap();
        assert_eq!(
            last,
            format!("61,HETATM,O,,HOH,A,900,,O,0,0,0,1,10,{radius},{dropped}")
        );
    }
}

/// A run follows its reading options and records them; --rerun, complex and evaluate read alike.
#[test]
fn reading_options_are_recorded_and_followed() {
    let folder = place();
    let models = format!(
        "MODEL        1\n{}ENDMDL\nMODEL        2\n{}ENDMDL\n",
        molecules::ligand().replace("END\n", ""),
        molecules::ligand()
            .replace("END\n", "")
            .replace("  12    ", "  13    ")
    );
    fs::write(folder.path().join("models.pdb"), models).unwrap();
    run(
        folder.path(),
        "dock receptor.pdb models.pdb --model 2 --waters keep --altloc A --rotations 20 --write-top 1 \
         --native native.pdb -o run --quiet",
    );
    let recorded = |name: &str| -> Value {
        serde_json::from_slice(&fs::read(folder.path().join(name).join("run.json")).unwrap())
            .unwrap()
    };
    let first = recorded("run");
    for (name, value) in [
        ("model", serde_json::json!(2)),
        ("waters", "keep".into()),
        ("hetatm", "no-additives".into()),
        ("hydrogens", "drop".into()),
        ("altloc", "A".into()),
    ] {
        assert_eq!(first["options"]["input"][name], value, "{name}");
    }
    run(folder.path(), "dock --rerun run/run.json -o again --quiet");
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(bytes("run/poses.csv"), bytes("again/poses.csv"));
    assert_eq!(recorded("again")["options"], first["options"]);
    run(folder.path(), "export run --rank 1 -o out --quiet");
    assert_eq!(bytes("run/top/rank_0001.pdb"), bytes("out/rank_0001.pdb"));
    let placed = String::from_utf8(bytes("out/rank_0001.pdb")).unwrap();
    assert!(
        placed.lines().any(|line| line.get(22..26) == Some("  13")),
        "the second model is the one placed"
    );
    run(folder.path(), "evaluate run --native native.pdb --quiet");
}

#[test]
fn score_reports_the_geometry_of_the_pose() {
    let folder = place();
    let reported = object(&run(
        folder.path(),
        "score receptor.pdb ligand.pdb --pose 1,0,0,0,0,0,0 --json",
    ));
    let geometry = |name: &str| reported["geometry"][name].as_f64().unwrap();
    let sides = geometry("buried_area_receptor") + geometry("buried_area_ligand");
    assert!((geometry("buried_area") - sides).abs() < 1e-9 && sides > 200.0);
    assert!(geometry("volume_shared") < 0.2 * geometry("volume_ligand"));
    let protrusion = 1.0 - geometry("volume_shared") / geometry("volume_ligand");
    assert!((geometry("protrusion") - protrusion).abs() < 1e-9);
    // On top of itself a molecule overlaps wholly.
    let same = object(&run(
        folder.path(),
        "score ligand.pdb ligand.pdb --pose 1,0,0,0,0,0,0 --json",
    ));
    assert!((same["geometry"]["shape_tanimoto"].as_f64().unwrap() - 1.0).abs() < 1e-9);
}

/// `-v` adds the times of stages and effects to the default output of a run; `-q` leaves all of it out.
#[test]
fn verbose_says_more_and_quiet_says_nothing() {
    let folder = place();
    let said = |options: &str| {
        let command =
            format!("dock receptor.pdb ligand.pdb --rotations 20 -o run --force {options}");
        String::from_utf8(run(folder.path(), &command).stdout).unwrap()
    };
    let [default, verbose, quiet] = ["-j 1", "-v -j 1", "-q -j 1"].map(said);
    assert!(!default.contains("CPU s") && default.contains("Scored by shape"));
    for part in [
        "CPU s",
        "search",
        "cluster",
        "ms a rotation",
        "Effect shape",
    ] {
        assert!(verbose.contains(part), "{part}: {verbose}");
    }
    assert_eq!(quiet, "");
}
