//! `knotdock sample` as its users see it: files, JSON, refusals.

mod refused;
mod robot;

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

struct Place {
    folder: tempfile::TempDir,
}

/// A box 4 by 2 by 1 as OBJ.
fn box_obj() -> String {
    box_of(1.0)
}

/// The like in another unit.
fn box_of(unit: f64) -> String {
    let mut text = String::new();
    for i in 0..8 {
        let [x, y, z] =
            [4 * (i & 1), 2 * (i >> 1 & 1), i >> 2 & 1].map(|side| f64::from(side) * unit);
        text += &format!("v {x} {y} {z}\n");
    }
    text + "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n"
}

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("box.obj"), box_obj()).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = cargo_bin_cmd!("knotdock");
        command
            .current_dir(self.folder.path())
            .arg("sample")
            .args(arguments);
        command
    }

    fn sample(&self, arguments: &[&str]) -> Value {
        let output = self.command(arguments).arg("--json").output().unwrap();
        let words = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{words}");
        serde_json::from_slice(&output.stdout).unwrap()
    }

    /// The error object of a call that must be refused with exit code 2 and without a trace.
    fn refused(&self, arguments: &[&str]) -> Value {
        let before = self.files();
        let output = self.command(arguments).arg("--json").output().unwrap();
        let words = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{words}");
        let object: Value = serde_json::from_slice(&output.stdout).unwrap();
        let error = object["error"].clone();
        assert!(words.contains(error["message"].as_str().unwrap()));
        assert!(!error["remedy"].as_str().unwrap().is_empty());
        assert_eq!(self.files(), before);
        error
    }

    fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

fn table(path: &Path) -> Vec<[f64; 5]> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("x,y,z,r,weight"));
    lines
        .map(|line| {
            let row: Vec<f64> = line
                .split(',')
                .map(|field| field.parse().unwrap())
                .collect();
            row.try_into().unwrap()
        })
        .collect()
}

#[test]
fn a_mesh_becomes_a_table_of_balls_with_measured_bounds() {
    let place = Place::new();
    let object = place.sample(&[
        "box.obj",
        "--grid",
        "2^12",
        "--picture",
        "box.svg",
        "--export",
        "balls.obj",
    ]);
    assert_eq!(object["set"], "a3");
    assert_eq!(object["grid"]["per_axis"], 16);
    let epsilon = object["grid"]["epsilon"].as_f64().unwrap();
    assert!((epsilon - 3f64.sqrt() * 2.0 / 15.0).abs() < 1e-12);
    assert!((object["mesh"]["volume"].as_f64().unwrap() - 8.0).abs() < 1e-12);
    let sets = object["sets"].as_array().unwrap();
    for (set, name) in sets.iter().zip(["a1", "a2", "a3"]) {
        assert_eq!(set["set"], name);
        assert_eq!(set["inside_nodes"], object["inside_nodes"]);
        assert_eq!(set["epsilon"].as_f64(), Some(epsilon));
        let length = |key: &str| set[key].as_f64().unwrap();
        assert!(length("hausdorff_inward") <= length("inward_bound"));
        assert!(
            length("inward_bound") <= 1.05 * epsilon
                && length("hausdorff_outward") <= epsilon * (1.0 + 1e-12)
        );
        assert!(length("seconds") > 0.0 && set["balls"].as_u64() > Some(0));
    }
    // The table lies in the file's own frame.
    let rows = table(&place.path("knots.csv"));
    assert_eq!(rows.len() as u64, sets[2]["balls"].as_u64().unwrap());
    for [x, y, z, r, weight] in rows {
        assert!((0.0..=4.0).contains(&x) && (0.0..=2.0).contains(&y) && (0.0..=1.0).contains(&z));
        assert!(r > epsilon && r <= 0.5 + epsilon + 1e-12 && weight == 1.0);
    }
    assert!(
        fs::read_to_string(place.path("box.svg"))
            .unwrap()
            .ends_with("</svg>\n")
    );
    let files: Vec<&str> = object["files"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| f.as_str().unwrap())
        .collect();
    assert_eq!(files, ["knots.csv", "balls.obj", "box.svg"]);
}

/// One face of two vertices had the whole file refused; a STEP file by a mesh's name was a count of triangles that it
/// did not have.
#[test]
fn what_is_left_out_is_a_warning_and_other_kinds_are_named() {
    let place = Place::new();
    fs::write(place.path("more.obj"), box_obj() + "f 1 2\n").unwrap();
    let arguments = ["more.obj", "--grid", "2^9", "-o", "more.csv"];
    let strict = [&arguments[..], &["--strict"]].concat();
    let error = place.refused(&strict);
    assert!(error["message"].as_str().unwrap().contains("line 15"));
    let object = place.sample(&arguments);
    let warnings = object["warnings"].as_array().unwrap();
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].as_str().unwrap().contains("line 15"));
    assert_eq!(object["mesh"]["reading_notes"][0], warnings[0]);
    assert_eq!(object["mesh"]["seam_vertices"], 0);
    fs::write(place.path("part.stl"), "ISO-10303-21;\nHEADER;\n").unwrap();
    let error = place.refused(&["part.stl"]);
    assert!(error["message"].as_str().unwrap().contains("STEP"));
}

/// A step half-way up is in the picture's slice, where points are neither inside nor outside.
#[test]
fn a_face_in_the_plane_of_the_picture_is_no_hindrance() {
    let place = Place::new();
    let mut step = String::new();
    // The box's own three units up, and another on half of it: corners of each by the bits of their number.
    for (low, high) in [([0, 0, 0], [4, 4, 1]), ([0, 0, 1], [2, 4, 2])] {
        for i in 0..8 {
            let [x, y, z] = [0, 1, 2].map(|axis| {
                if i >> axis & 1 == 0 {
                    low[axis]
                } else {
                    high[axis]
                }
            });
            step += &format!("v {x} {y} {z}\n");
        }
        for face in [
            "1 5 7 3", "2 4 8 6", "1 2 6 5", "3 7 8 4", "1 3 4 2", "5 6 8 7",
        ] {
            let corners = face
                .split(' ')
                .map(|corner| corner.parse::<i32>().unwrap() - 9);
            step += &corners.fold("f".to_owned(), |text, corner| text + &format!(" {corner}"));
            step += "\n";
        }
    }
    fs::write(place.path("step.obj"), step).unwrap();
    place.sample(&["step.obj", "--grid", "2^12", "--picture", "step.svg"]);
    assert!(
        fs::read_to_string(place.path("step.svg"))
            .unwrap()
            .ends_with("</svg>\n")
    );
}

/// Nodes of a plate's middle are inside, and all points of the finer grid beside them outside: its volume is that of
/// the nodes.
#[test]
fn weights_of_a_plate_thinner_than_the_grid_are_numbers() {
    let place = Place::new();
    let plate = box_obj().replace(" 1\n", " 0.005\n");
    fs::write(place.path("plate.obj"), plate).unwrap();
    let object = place.sample(&["plate.obj", "--grid", "35937", "--weights", "fitted"]);
    for name in ["volume_unit", "volume_fitted"] {
        assert!(
            object["weights"][name]
                .as_f64()
                .is_some_and(|share| share > 0.0),
            "{object}"
        );
    }
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let place = Place::new();
    for options in [
        "--weights fitted --picture balls.svg",
        "--method wz --export balls.obj",
        "--method octree --weights fitted",
        "--method voxels --level 40 --picture balls.svg",
        "--mu 0.6 --set a2 --export balls.pdb",
    ] {
        let mut written: Vec<(String, Vec<Vec<u8>>)> = Vec::new();
        for threads in ["1", "2", "5"] {
            let mut arguments = vec!["box.obj", "--grid", "4096", "--force", "--json", "-j"];
            arguments.push(threads);
            arguments.extend(options.split(' '));
            let output = place.command(&arguments).output().unwrap();
            let words = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.success(), "{words}");
            let object: Value = serde_json::from_slice(&output.stdout).unwrap();
            let names = object["files"].as_array().unwrap().iter();
            let files = names.map(|name| fs::read(place.path(name.as_str().unwrap())).unwrap());
            written.push((threads.to_owned(), files.collect()));
        }
        for (threads, files) in &written[1..] {
            assert!(*files == written[0].1, "{options} with {threads} threads");
        }
    }
}

#[test]
fn methods_sets_levels_and_weights() {
    let place = Place::new();
    let count = |arguments: &[&str]| {
        let mut all = vec!["box.obj", "--grid", "2^12", "--force"];
        all.extend(arguments);
        let object = place.sample(&all);
        assert_eq!(
            table(&place.path("knots.csv")).len() as u64,
            object["balls"].as_u64().unwrap()
        );
        (object["balls"].as_u64().unwrap(), object)
    };
    let (a1, _) = count(&["--set", "a1", "--mu", "0.5"]);
    let (a2, _) = count(&["--set", "a2", "--mu", "0.5"]);
    let (a3, _) = count(&["--mu", "0.5"]);
    assert!(a1 == a2 && a3 < a2);
    let (voxels, object) = count(&["--method", "voxels"]);
    assert_eq!(object["inside_nodes"].as_u64(), Some(voxels));
    assert!(count(&["--method", "octree"]).0 < voxels);
    assert_eq!(count(&["--method", "wz"]).1["sets"][0]["nodes_missed"], 0);
    let (seven, object) = count(&["--level", "7"]);
    assert_eq!(seven, 7);
    assert_eq!(object["level"]["nodes_missed"], 0);
    let (_, object) = count(&["--weights", "fitted"]);
    let share = |key: &str| object["weights"][key].as_f64().unwrap();
    assert!(share("rms_fitted") < share("rms_unit"));
    assert!(share("volume_fitted") < share("volume_unit"));
}

/// A box about another, both facing outward, as some programs write cavities: the union, as documented, with a
/// warning.
#[test]
fn boxes_within_boxes_are_warned_of_and_refused_when_strict() {
    let place = Place::new();
    let mut nested = box_obj();
    for line in box_of(0.25).lines() {
        nested += &match line.strip_prefix("v ") {
            Some(numbers) => {
                let moved = numbers
                    .split(' ')
                    .map(|number| number.parse::<f64>().unwrap() + 0.25);
                moved.fold("v".to_owned(), |text, number| text + &format!(" {number}"))
            }
            None => line
                .split(' ')
                .skip(1)
                .fold("f".to_owned(), |text, number| {
                    text + &format!(" {}", number.parse::<u32>().unwrap() + 8)
                }),
        };
        nested += "\n";
    }
    fs::write(place.path("nested.obj"), nested).unwrap();
    let object = place.sample(&["nested.obj", "--grid", "2^12"]);
    assert!((object["mesh"]["volume"].as_f64().unwrap() - 8.0).abs() < 1e-12);
    // Counted on a coarse grid.
    assert!((object["volume"].as_f64().unwrap() - 8.0).abs() < 1.0);
    let warnings = object["warnings"].as_array().unwrap();
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].as_str().unwrap().contains("is it a cavity?"));
    let error = place.refused(&["nested.obj", "--strict", "-o", "strict.csv"]);
    assert!(error["message"].as_str().unwrap().contains("cavity"));
}

/// A closed surface that crosses itself, so that half of its solid is inside out and lost. No warning said so at first,
/// though the balls end far from the surface there and the documented bounds fail.
#[test]
fn a_closed_mesh_that_breaks_the_bounds_is_warned_of() {
    let place = Place::new();
    // A box whose top lies under its bottom at the far end.
    let crossed = "v 0 0 0\nv 4 0 2\nv 0 2 0\nv 4 2 2\nv 0 0 3\nv 4 0 0\nv 0 2 3\nv 4 2 0\n\
                  f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\n\
                  f 2 4 8\nf 2 8 6\n";
    fs::write(place.path("crossed.obj"), crossed).unwrap();
    let object = place.sample(&["crossed.obj", "--grid", "2^12"]);
    assert!(
        object["added"]["unreachable_samples"].as_u64() > Some(0),
        "{object}"
    );
    let warnings = object["warnings"].as_array().unwrap();
    let has = |part: &str| {
        warnings
            .iter()
            .any(|warning| warning.as_str().unwrap().contains(part))
    };
    assert!(has("nothing of the solid under them"), "{warnings:?}");
    let error = place.refused(&[
        "crossed.obj",
        "--grid",
        "2^12",
        "--strict",
        "-o",
        "strict.csv",
    ]);
    assert!(error["message"].as_str().unwrap().contains("closed"));
}

/// Walls between the planes of nodes: no node inside, and a volume that was off by half was printed all the same.
#[test]
fn no_node_inside_means_no_volume() {
    let place = Place::new();
    let mut plate = String::new();
    for line in box_obj().lines() {
        plate += &match line.strip_suffix(" 1") {
            Some(start) if line.starts_with("v ") => format!("{start} 0.01\n"),
            _ => format!("{line}\n"),
        };
    }
    fs::write(place.path("plate.obj"), plate).unwrap();
    let object = place.sample(&["plate.obj", "--grid", "2^12", "--level", "2"]);
    assert_eq!(object["inside_nodes"], 0);
    assert!(object["volume"].is_null());
    for fit in object["sets"]
        .as_array()
        .unwrap()
        .iter()
        .chain([&object["level"]])
    {
        assert!(fit["volume_missed"].is_null() && fit["volume_outside"].is_null());
    }
    assert!((object["mesh"]["volume"].as_f64().unwrap() - 0.08).abs() < 1e-12);
}

/// The bound of the outward distance was in the JSON object alone.
#[test]
fn a_level_of_detail_comes_with_its_bound() {
    let place = Place::new();
    let object = place.sample(&["box.obj", "--grid", "2^12", "--level", "1"]);
    let length = |key: &str| object["level"][key].as_f64().unwrap();
    let (seen, bound) = (length("hausdorff_outward"), length("outward_bound"));
    assert!(seen > 0.9 && seen <= bound);
    let output = place
        .command(&["box.obj", "--grid", "2^12", "--level", "1", "--force"])
        .output()
        .unwrap();
    let said = String::from_utf8(output.stdout).unwrap() + &String::from_utf8_lossy(&output.stderr);
    let expected = format!("1 ball, {seen:.6} from the solid outward (at most {bound:.6})");
    assert!(said.contains(&expected), "{said}");
}

#[test]
fn files_that_are_there_stay_there() {
    let place = Place::new();
    fs::write(place.path("knots.csv"), "mine").unwrap();
    let error = place.refused(&["box.obj", "--grid", "64"]);
    assert_eq!(error["file"], "knots.csv");
    assert_eq!(fs::read_to_string(place.path("knots.csv")).unwrap(), "mine");
    place.sample(&["box.obj", "--grid", "64", "--force"]);
    assert!(
        fs::read_to_string(place.path("knots.csv"))
            .unwrap()
            .starts_with("x,y,z")
    );
    place.refused(&["box.obj", "-o", "none/knots.csv"]);
    place.refused(&["box.obj", "-o", "box.obj", "--force"]);
    place.refused(&["box.obj", "-o", "a.svg", "--picture", "a.svg"]);
    place.refused(&["box.obj", "-o", "a.csv", "--export", "a.xyz"]);
}

/// What does not fit into a PDB file's columns is found before the table is written.
#[test]
fn an_export_that_fails_leaves_no_table() {
    let place = Place::new();
    let far = box_obj().replace("v 4 ", "v 40000 ");
    fs::write(place.path("far.obj"), far).unwrap();
    let error = place.refused(&["far.obj", "--grid", "64", "--export", "far.pdb"]);
    assert!(error["message"].as_str().unwrap().contains("columns"));
}

/// Found by an audit: with six decimals all figures of a mesh in small units were zero.
#[test]
fn figures_of_small_meshes_keep_their_digits() {
    let place = Place::new();
    fs::write(place.path("small.obj"), box_of(1e-6)).unwrap();
    let output = place
        .command(&["small.obj", "--grid", "2^12"])
        .output()
        .unwrap();
    let said = String::from_utf8(output.stdout).unwrap() + &String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains("4.000000e-6 x 2.000000e-6 x 1.000000e-6 across, volume 8.000000e-18"),
        "{said}"
    );
    assert!(!said.contains("epsilon 0.000000"), "{said}");
}
