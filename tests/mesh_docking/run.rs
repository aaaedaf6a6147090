//! A run of meshes as its users see it: files, the same bytes whatever the threads, the same run again.

use std::fs;
use std::path::{Path, PathBuf};

use super::parts::{Pair, broken_block};
use super::scenes::away;
use assert_cmd::Command;
use assert_cmd::cargo::cargo_bin_cmd;
use knotdock::dock::gaps::CLOSER;
use knotdock_scoring::se3::Pose;
use serde_json::Value;

/// A folder with receptor.stl and ligand.stl, the ligand turned away.
pub struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    pub fn empty() -> Self {
        let folder = tempfile::tempdir().unwrap();
        Self { folder }
    }

    pub fn of(pair: &Pair) -> Self {
        let place = Self::empty();
        let ligand = pair.ligand.moved(|point| away().apply(point));
        place.write("receptor.stl", &pair.receptor.stl());
        place.write("ligand.stl", &ligand.stl());
        place
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = cargo_bin_cmd!("knotdock");
        command.current_dir(self.folder.path()).args(arguments);
        command
    }
}

/// Docks, and returns the object on standard output.
pub fn dock(place: &Place, arguments: &[&str]) -> Value {
    let arguments = [&["dock", "--json"], arguments].concat();
    let output = place.command(&arguments).output().unwrap();
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{words}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Header and rows of a table.
fn table(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text
        .lines()
        .map(|line| line.split(',').map(str::to_owned).collect());
    (lines.next().unwrap(), lines.collect())
}

/// Poses and scores of a table.
pub fn scored_poses(path: &Path) -> Vec<(Pose, f64)> {
    let (header, rows) = table(path);
    let read = |row: &[String]| {
        let value = |name: &str| -> f64 {
            let column = header.iter().position(|other| other == name).unwrap();
            row[column].parse().unwrap()
        };
        let pose = Pose::from_parts(
            ["qw", "qx", "qy", "qz"].map(value),
            ["tx", "ty", "tz"].map(value),
        );
        (pose, value("search_score"))
    };
    rows.iter().map(|row| read(row)).collect()
}

/// The pose of the first row.
pub fn rank_one(path: &Path) -> Pose {
    scored_poses(path).swap_remove(0).0
}

/// Few rotations on a coarse grid: these tests do not depend on where the parts end up.
const QUICK: [&str; 8] = [
    "receptor.stl",
    "ligand.stl",
    "--sample-grid",
    "20^3",
    "--rotations",
    "60",
    "--poses",
    "50",
];

fn quick(place: &Place, more: &[&str]) -> Value {
    dock(place, &[&QUICK, more].concat())
}

#[test]
fn threads_change_no_byte_and_a_run_repeats_itself() {
    for sampler in ["lattice", "bi"] {
        repeats_itself(&["--sampler", sampler, "--write-top", "2"]);
    }
}

fn repeats_itself(more: &[&str]) {
    let pair = broken_block(0.05);
    let place = Place::of(&pair);
    let first = quick(&place, &[&["-o", "one", "--threads", "1"], more].concat());
    quick(&place, &[&["-o", "two", "--threads", "2"], more].concat());
    dock(&place, &["--rerun", "one/run.json", "-o", "again"]);
    for name in ["poses.csv", "top/rank_0001.obj", "top/rank_0002.obj"] {
        let bytes = |run: &str| fs::read(place.path(run).join(name)).unwrap();
        assert!(!bytes("one").is_empty());
        assert_eq!(bytes("one"), bytes("two"), "{name}");
        assert_eq!(bytes("one"), bytes("again"), "{name}");
    }
    // What is recorded is the same too, but for time and machine.
    let record = |run: &str| {
        let text = fs::read_to_string(place.path(run).join("run.json")).unwrap();
        let mut run: Value = serde_json::from_str(&text).unwrap();
        for entry in ["timing", "machine"] {
            run.as_object_mut().unwrap().remove(entry);
        }
        run
    };
    assert_eq!(record("one"), record("two"));
    assert_eq!(record("one"), record("again"));
    let run = &first["run"];
    // Only a first run of the lattice searches the gap; its record has the one that is kept.
    let gaps = &run["machine"]["chosen"]["gaps"];
    assert_eq!(gaps.is_null(), more[1] == "bi");
    if let [wide, closer] = gaps.as_array().map_or(&[][..], Vec::as_slice) {
        let of = |gap: &Value, name: &str| gap[name].as_f64().unwrap();
        let ratio = of(closer, "offset") / of(wide, "offset");
        assert!((ratio - CLOSER).abs() < 1e-9);
        // The default gap misses the joint on so coarse a grid.
        let ratio = of(closer, "facing_area") / of(wide, "facing_area");
        assert!(!(0.9..1.1).contains(&ratio), "{ratio}");
        let kept = if ratio > 1.0 { closer } else { wide };
        assert_eq!(run["options"]["kernel"]["offset"], kept["offset"]);
    }
    let again = fs::read_to_string(place.path("again/run.json")).unwrap();
    let again: Value = serde_json::from_str(&again).unwrap();
    assert!(again["machine"]["chosen"].is_null());
    for side in ["receptor", "ligand"] {
        let sampling = &run["inputs"][side]["sampling"];
        assert_eq!(sampling["sampler"], more[1]);
        assert_eq!(sampling["double_skin"].is_null(), more[1] == "lattice");
    }
    assert_eq!(run["plan"]["unit"], "file");
    assert_eq!(run["chains"], Value::Null);
    assert_eq!(run["inputs"]["receptor"]["atoms"], Value::Null);
    for effect in run["effects"].as_array().unwrap() {
        assert_eq!(effect["on"], effect["effect"] == "shape");
    }
}

/// Finer rotations are searched by default, but not beside given ones; a given offset or a time limit fixes the gap, and a
/// batch knows a run again whichever gap it kept.
#[test]
fn defaults_give_way_to_what_is_given() {
    let place = Place::of(&broken_block(0.05));
    let grid = ["receptor.stl", "ligand.stl", "--sample-grid", "20^3"];
    let docked = |more: &[&str]| {
        dock(
            &place,
            &[&grid[..], &["--force", "-o", "run"], more].concat(),
        )
    };
    let brief = ["--poses", "30", "--refine", "5"];
    let default = docked(&brief);
    let search = &default["run"]["options"]["search"];
    assert_eq!(search["fine_rotations"], 30_000);
    assert_eq!(search["fine_share"], 0.2);
    // However few poses are kept, the share is searched.
    let finer = &default["run"]["finer_search"]["rotations"];
    assert!((6000..6100).contains(&finer.as_u64().unwrap()), "{finer}");
    let offset = default["run"]["machine"]["chosen"]["gaps"][0]["offset"].to_string();
    for given in [
        &["--rotations", "60", "--offset", &offset][..],
        &["--budget", "4s"],
    ] {
        let run = &docked(&[&brief[..], given].concat())["run"];
        assert!(run["options"]["search"]["fine_rotations"].is_null());
        assert!(run["machine"]["chosen"]["gaps"].is_null());
    }
    place.write(
        "pairs.csv",
        "name,receptor,ligand\npair,receptor.stl,ligand.stl\n",
    );
    let batch = || {
        let words = [
            "batch",
            "pairs.csv",
            "-o",
            "batch",
            "--json",
            "--",
            "--rotations",
            "20",
        ];
        let output = place
            .command(&[&words[..], &["--sample-grid", "20^3"]].concat())
            .output();
        let output = output.unwrap();
        let words = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{words}");
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        found["pairs"][0]["status"].clone()
    };
    assert_eq!([batch(), batch()], ["docked", "kept"]);
}

/// In another unit every length of a scene is scaled by the same factor, and nothing else changes: no constant is in Å.
/// If the factor is a power of two, not a digit changes.
#[test]
fn the_unit_of_the_files_is_all_that_lengths_depend_on() {
    for sampler in ["lattice", "bi"] {
        only_lengths_scale(&["--sampler", sampler]);
    }
}

fn only_lengths_scale(more: &[&str]) {
    let pair = broken_block(0.05);
    let place = Place::of(&pair);
    quick(&place, &[&["-o", "plain"], more].concat());
    let (header, plain) = table(&place.path("plain/poses.csv"));
    for (factor, name) in [(1024.0, "large"), (1.0 / 1024.0 / 1024.0, "small")] {
        for part in ["receptor", "ligand"] {
            let (mesh, _) =
                knotdock_structures::mesh::read(&place.path(&format!("{part}.stl"))).unwrap();
            let mut text = String::new();
            for position in mesh.positions() {
                let [x, y, z] = position.map(|value| factor * value);
                text += &format!("v {x:?} {y:?} {z:?}\n");
            }
            for [a, b, c] in mesh.triangles() {
                text += &format!("f {} {} {}\n", a + 1, b + 1, c + 1);
            }
            place.write(&format!("{part}_{name}.obj"), &text);
        }
        let mut arguments = QUICK.to_vec();
        let files = ["receptor", "ligand"].map(|part| format!("{part}_{name}.obj"));
        arguments[0] = &files[0];
        arguments[1] = &files[1];
        dock(&place, &[&arguments[..], &["-o", name], more].concat());
        let (_, scaled) = table(&place.path(name).join("poses.csv"));
        assert_eq!(plain.len(), scaled.len());
        for (plain, scaled) in plain.iter().zip(&scaled) {
            for ((name, plain), scaled) in header.iter().zip(plain).zip(scaled) {
                if ["tx", "ty", "tz"].contains(&name.as_str()) {
                    let [plain, scaled]: [f64; 2] = [plain, scaled].map(|x| x.parse().unwrap());
                    assert_eq!(factor * plain, scaled, "{name}");
                } else {
                    assert_eq!(plain, scaled, "{name}");
                }
            }
        }
    }
}

/// The assembly holds both parts as groups, the ligand where the table says; `knotdock export` writes further ones.
#[test]
fn assemblies_hold_both_parts() {
    let pair = broken_block(0.05);
    let place = Place::of(&pair);
    let result = quick(&place, &["-o", "run", "--write-top", "1"]);
    let path = place.path("run/top/rank_0001.obj");
    assert_eq!(result["complexes"].as_array().unwrap().len(), 1);
    let text = fs::read_to_string(&path).unwrap();
    let groups: Vec<&str> = text.lines().filter(|line| line.starts_with("g ")).collect();
    assert_eq!(groups, ["g receptor", "g ligand"]);
    let (both, report) = knotdock_structures::mesh::read(&path).unwrap();
    assert!(report.is_sound() && report.parts == 2);
    let (receptor, _) = knotdock_structures::mesh::read(&place.path("receptor.stl")).unwrap();
    let (ligand, _) = knotdock_structures::mesh::read(&place.path("ligand.stl")).unwrap();
    assert_eq!(
        both.triangles().len(),
        receptor.triangles().len() + ligand.triangles().len()
    );
    assert!((both.volume() - receptor.volume() - ligand.volume()).abs() < 1e-9);
    let pose = rank_one(&place.path("run/poses.csv"));
    for &position in ligand.positions() {
        let image = pose.apply(position);
        let near = both
            .positions()
            .iter()
            .any(|other| (0..3).all(|axis| (other[axis] - image[axis]).abs() < 1e-12));
        assert!(near, "{image:?}");
    }
    let more = place
        .command(&["export", "run", "--rank", "2", "-o", "more"])
        .output()
        .unwrap();
    assert!(
        more.status.success(),
        "{}",
        String::from_utf8_lossy(&more.stderr)
    );
    assert!(place.path("more/rank_0002.obj").is_file());
}

/// `knotdock score` gives the table's score at the table's pose, and its ladder of modes comes as near as it says.
#[test]
fn a_pose_of_meshes_has_its_score_and_ladder() {
    let place = Place::of(&broken_block(0.05));
    for sampler in ["lattice", "bi"] {
        let more = ["--sampler", sampler, "-o", sampler];
        let run = quick(&place, &more);
        let offset = run["run"]["options"]["kernel"]["offset"].to_string();
        let (pose, score) =
            scored_poses(&place.path(&format!("{sampler}/poses.csv"))).swap_remove(0);
        let numbers: Vec<f64> = (pose.quaternion().into_iter())
            .chain(pose.translation.iter().copied())
            .collect();
        let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
        let arguments = [
            "score",
            "--json",
            "receptor.stl",
            "ligand.stl",
            "--sample-grid",
            "20^3",
            "--offset",
            &offset,
        ];
        let (pose, sampler) = (
            format!("--pose={}", words.join(",")),
            ["--sampler", sampler],
        );
        let output = place
            .command(&[&arguments[..], &sampler, &[&pose]].concat())
            .output()
            .unwrap();
        let words = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{words}");
        let scored: Value = serde_json::from_slice(&output.stdout).unwrap();
        let exact = scored["exact"].as_f64().unwrap();
        assert!(
            (exact - score).abs() < 1e-6 * score.abs(),
            "{exact} {score}"
        );
        let last = scored["rows"].as_array().unwrap().last().unwrap();
        assert!(last["error"].as_f64().unwrap() < 1e-3 * scored["scale"].as_f64().unwrap());
        assert_eq!(scored["reached"], true);
        assert_eq!(scored["offset_sensitivity"].is_null(), sampler[1] == "bi");
        assert_eq!(scored["sampling"][1]["sampler"], sampler[1]);
        let force = |of: &str| scored[of]["force"][0].as_f64().unwrap();
        assert!((force("gradient") - force("gradient_modes")).abs() < 0.02 * exact.abs() / 0.05);
    }
}
