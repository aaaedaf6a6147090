//! Refinement of chosen poses of a run: its files, the improvement, and the runs that it refuses.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::program::succeed;
use assert_cmd::cargo::cargo_bin_cmd;
use knotdock::output::tables::poses::PoseTable;
use knotdock_scoring::se3::Pose;
use knotdock_structures::molecule::{InputSpec, Molecule, ReadOptions, read};
use serde_json::Value;

type Row = BTreeMap<String, String>;

fn example(name: &str) -> String {
    format!(
        "{}/structures/examples/1ppe_{name}.pdb",
        concat!(env!("CARGO_MANIFEST_DIR"), "/..")
    )
}

/// A folder with a quick run of the example pair, or of the inhibitor's parts that `more` makes of it.
fn docked(ligand: &str, more: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example(ligand));
    let mut words = vec!["dock", &receptor, &ligand, "-o", "run", "--quiet"];
    words.extend(["--rotations", "60", "--poses", "60", "--write-top", "0"]);
    words.extend(more);
    succeed(folder.path(), words);
    folder
}

fn refine(folder: &Path, words: &str) -> Value {
    let words = format!("refine run --json {words}");
    let output = succeed(folder, words.split_whitespace());
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The standard error of a call that must be refused.
fn refused(folder: &Path, words: &str) -> String {
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .args(words.split_whitespace())
        .output()
        .unwrap();
    let reported = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{words}: {reported}");
    reported
}

fn rows(path: &Path) -> Vec<Row> {
    let mut table = csv::Reader::from_path(path).unwrap();
    table.deserialize().map(Result::unwrap).collect()
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap()
}

fn molecule(path: impl AsRef<Path>) -> Molecule {
    read(&InputSpec::whole(path.as_ref()), &ReadOptions::default()).unwrap()
}

/// All files of a folder with their content.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    entries
        .filter(|entry| entry.path().is_file())
        .map(|entry| {
            let name = entry.file_name().into_string().unwrap();
            (name, fs::read(entry.path()).unwrap())
        })
        .collect()
}

/// Largest distance in Å between the ligand's backbone in a complex and where a pose places it: side chains may differ.
fn off(complex: &Molecule, ligand: &Molecule, pose: &Pose) -> f64 {
    let placed = &complex.atoms[complex.atoms.len() - ligand.atoms.len()..];
    let pairs = placed.iter().zip(&ligand.atoms);
    let backbone = pairs.filter(|(_, atom)| ["N", "CA", "C", "O"].contains(&atom.name.as_str()));
    let distances = backbone.map(|(placed, atom)| {
        assert_eq!(placed.name, atom.name);
        let image = pose.apply(atom.position);
        let squares = (0..3).map(|axis| (image[axis] - placed.position[axis]).powi(2));
        squares.sum::<f64>().sqrt()
    });
    distances.fold(0.0, f64::max)
}

#[test]
fn poses_improve_and_the_run_stays() {
    let folder = docked(
        "ligand_unbound",
        &[
            "--native-receptor",
            &example("receptor_bound"),
            "--native-ligand",
            &example("ligand_bound"),
        ],
    );
    let at = |name: &str| folder.path().join(name);
    let run = files(&at("run"));
    let object = refine(folder.path(), "--ranks 2,1,5-6 --threads 2");
    let mut after = files(&at("run"));
    let added: Value = serde_json::from_slice(&after.remove("added.json").unwrap()).unwrap();
    assert!(added["files"]["refined/refined.csv"].is_string());
    assert_eq!(after, run, "the run is not changed");

    let table = rows(&at("run/refined/refined.csv"));
    let ranks: Vec<&str> = table.iter().map(|row| row["rank"].as_str()).collect();
    assert_eq!(ranks, ["2", "1", "5", "6"]);
    let poses = PoseTable::read(&at("run/refined/refined.csv")).unwrap();
    let before = rows(&at("run/poses.csv"));
    let ligand = molecule(example("ligand_unbound"));
    let mut held = Vec::new();
    for ((row, pose), printed) in table
        .iter()
        .zip(poses.rows())
        .zip(object["poses"].as_array().unwrap())
    {
        assert!(number(row, "energy_after") <= number(row, "energy_before"));
        assert!(number(row, "rmsd_moved") <= 3.0);
        assert!(number(row, "side_chains_moved") >= 0.0);
        assert!(["true", "false"].contains(&row["exact"].as_str()));
        let of_run = &before[pose.rank - 1];
        for column in ["irmsd", "lrmsd", "fnat", "dockq", "capri"] {
            assert_eq!(row[&format!("{column}_before")], of_run[column]);
            assert!(!row[&format!("{column}_after")].is_empty());
        }
        let complex = molecule(at("run/refined").join(format!("rank_{:04}.pdb", pose.rank)));
        // Atoms at the interface move apart.
        assert!(off(&complex, &ligand, &pose.pose) < 2.0);
        assert_eq!(printed["rank"], pose.rank);
        held.extend(printed["held"].as_array().unwrap().iter().cloned());
        assert_eq!(
            printed["energy_after"].as_f64(),
            Some(number(row, "energy_after"))
        );
        assert!(
            folder
                .path()
                .join(printed["path"].as_str().unwrap())
                .is_file()
        );
    }
    // Cysteines of trypsin's disulphides line its active site.
    let is_bonded =
        |side_chain: &Value| side_chain["name"] == "CYS" && side_chain["reason"] == "disulphide";
    assert!(held.iter().any(is_bonded), "{held:?}");
    let total = |column: &str| table.iter().map(|row| number(row, column)).sum::<f64>();
    assert!(total("clashes_after") < total("clashes_before"));

    refine(folder.path(), "--ranks 2,1,5-6 --threads 1 -o one");
    assert_eq!(files(&at("one")), files(&at("run/refined")));

    // The same once more is no matter; a table that differs is replaced on request alone.
    let edited = at("one/rank_0001.pdb");
    refine(folder.path(), "--ranks 2,1,5-6 -o one");
    fs::write(&edited, "edited").unwrap();
    for (words, reason) in [
        ("--ranks 2,1,5-6", "is not what would be written"),
        // A second refinement once failed with these words when it was done.
        ("--ranks 1", "refined of other ranks"),
    ] {
        let reported = refused(folder.path(), &format!("refine run {words} -o one"));
        assert!(
            reported.contains(reason) && reported.contains("--force"),
            "{reported}"
        );
    }
    assert_eq!(fs::read_to_string(&edited).unwrap(), "edited");
    refine(folder.path(), "--ranks 1 -o one --force");
    assert_eq!(rows(&at("one/refined.csv")).len(), 1);
    assert_eq!(
        fs::read(&edited).unwrap(),
        fs::read(at("run/refined/rank_0001.pdb")).unwrap()
    );
}

#[test]
fn either_half_may_be_left_out() {
    let folder = docked("ligand_unbound", &[]);
    let at = |name: &str| folder.path().join(name);
    refine(folder.path(), "--ranks 1-2 --no-move -o packed");
    refine(folder.path(), "--ranks 1-2 --no-side-chains -o moved");
    let before = PoseTable::read(&at("run/poses.csv")).unwrap();
    let poses = PoseTable::read(&at("packed/refined.csv")).unwrap();
    assert_eq!(poses.rows(), &before.rows()[..2]);
    for row in rows(&at("packed/refined.csv")) {
        assert_eq!(row["rmsd_moved"], "0");
        assert!(
            !row.contains_key("irmsd_before"),
            "there is no known complex"
        );
    }
    let ligand = molecule(example("ligand_unbound"));
    for pose in PoseTable::read(&at("moved/refined.csv")).unwrap().rows() {
        let complex = molecule(at("moved").join(format!("rank_{:04}.pdb", pose.rank)));
        assert!(off(&complex, &ligand, &pose.pose) < 1e-3);
    }
    for row in rows(&at("moved/refined.csv")) {
        assert_eq!(
            (row["side_chains_moved"].as_str(), row["exact"].as_str()),
            ("", "")
        );
    }
    let reported = refused(
        folder.path(),
        "refine run --ranks 1 --no-move --no-side-chains",
    );
    assert!(reported.contains("cannot be used with"), "{reported}");
}

#[test]
fn what_cannot_be_refined_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("receptor.pdb"), crate::molecules::receptor()).unwrap();
    fs::write(at("ligand.pdb"), crate::molecules::ligand()).unwrap();
    let cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    fs::write(at("a.obj"), cube).unwrap();
    fs::write(at("b.obj"), cube).unwrap();
    for words in [
        "dock receptor.pdb ligand.pdb --rotations 20 -o run",
        "dock receptor.pdb --symmetry C3 --rotations 20 -o ring",
        "dock a.obj b.obj --offset 0.2 --sample-grid 2^12 --rotations 16 -o parts",
    ] {
        let words = format!("{words} --poses 20 --write-top 0 --quiet");
        succeed(folder.path(), words.split(' '));
    }
    for (words, reason) in [
        ("run --ranks 99999", "there is no rank 99999"),
        ("run --ranks 1 --max-move -1", "--max-move"),
        ("run --ranks 1 --max-move nan", "--max-move"),
        ("run --ranks 0", "ranks are counted from 1"),
        ("ring --ranks 1", "of C3, and rings are not refined"),
        ("parts --ranks 1", "a run of meshes"),
        ("run --ranks 1 -o run/top", "holds the run itself"),
        ("run --ranks 1 -o run --force", "holds the run itself"),
        ("nowhere --ranks 1", "cannot read"),
    ] {
        let reported = refused(folder.path(), &format!("refine {words}"));
        assert!(reported.contains(reason), "{words}: {reported}");
    }
    fs::copy(at("receptor.pdb"), at("rank_0001.pdb")).unwrap();
    succeed(
        folder.path(),
        "dock rank_0001.pdb ligand.pdb --rotations 20 --write-top 0 -o other --quiet".split(' '),
    );
    let reported = refused(folder.path(), "refine other --ranks 1 -o . --force");
    assert!(reported.contains("one of the input files"), "{reported}");
    fs::write(at("ligand.pdb"), crate::molecules::receptor()).unwrap();
    let reported = refused(folder.path(), "refine run --ranks 1");
    assert!(reported.contains("ligand.pdb"), "{reported}");
    assert!(!at("run/refined").exists() && !at("ring/refined").exists());
}

/// What people open first has no clashes: `top/` and `export` hold what `refine` makes of the rows, the table counts what
/// is left, and `interface` counts the same. The poses, and the whole table but for that column, are those of `--raw`.
#[test]
fn written_complexes_are_refined_unless_raw() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    for (name, more) in [("run", &[][..]), ("raw", &["--raw"])] {
        let mut words = vec!["dock", &receptor, &ligand, "-o", name, "--quiet"];
        words.extend(["--rotations", "60", "--poses", "60", "--write-top", "3"]);
        words.extend(more);
        succeed(folder.path(), words);
    }
    refine(folder.path(), "--ranks 1-3 -o refined");
    succeed(folder.path(), "export run --rank 1-3 -o out".split(' '));
    succeed(
        folder.path(),
        "export run --rank 1-3 -o raw_out --raw".split(' '),
    );
    let clashes = |complex: &str| {
        let command = format!("interface {complex} --json");
        let output = succeed(folder.path(), command.split(' '));
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        found["complexes"][0]["clashes"].as_u64().unwrap()
    };
    let [mut own, mut raw] =
        ["run", "raw"].map(|name| rows(&folder.path().join(name).join("poses.csv")));
    for rank in 1..=3 {
        let file = format!("rank_{rank:04}.pdb");
        let read = |place: &str| fs::read_to_string(folder.path().join(place).join(&file)).unwrap();
        assert_eq!(read("run/top"), read("refined"));
        assert_eq!(read("run/top"), read("out"));
        assert_eq!(read("raw/top"), read("raw_out"));
        assert!(read("run/top").contains("refined") && !read("raw/top").contains("refined"));
        let [after, before] = [&own, &raw].map(|rows| number(&rows[rank - 1], "complex_clashes"));
        assert!(
            before > 5.0 && after <= 1.0,
            "rank {rank}: {before}, {after}"
        );
        for (place, counted) in [("run", after), ("raw", before)] {
            assert_eq!(clashes(&format!("{place}/top/{file}")), counted as u64);
        }
    }
    assert!(own[3..].iter().all(|row| row["complex_clashes"].is_empty()));
    for row in own.iter_mut().chain(&mut raw) {
        row.remove("complex_clashes");
    }
    assert_eq!(own, raw);
}
