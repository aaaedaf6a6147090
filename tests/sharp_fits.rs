//! Sharp fits: a re-docked complex is found at rank 1, exactly; unbound partners keep their ranking.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::dock_run::run::{comparable, rows};
use crate::program::succeed;
use assert_cmd::cargo::cargo_bin_cmd;

const DOCK: &str = "dock receptor.pdb ligand.pdb --rotations 300 --native-receptor native_receptor.pdb \
                    --native-ligand native_ligand.pdb --write-top 1 --quiet";

/// A folder with trypsin and its inhibitor, bound or unbound, the inhibitor turned; and the known complex.
fn place(state: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let example = |name: &str| {
        let file = format!("structures/examples/1ppe_{name}.pdb");
        fs::read_to_string(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(file))
            .unwrap()
    };
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("receptor.pdb", &example(&format!("receptor_{state}")));
    write("ligand.pdb", &turned(&example(&format!("ligand_{state}"))));
    write("native_receptor.pdb", &example("receptor_bound"));
    write("native_ligand.pdb", &example("ligand_bound"));
    folder
}

/// A structure turned, so that its coordinates do not give the answer away.
fn turned(text: &str) -> String {
    let pose = knotdock_scoring::se3::Pose::from_parts([0.5, 0.5, -0.1, 0.7], [0.0; 3]);
    let line = |line: &str| {
        if !line.starts_with("ATOM") && !line.starts_with("HETATM") {
            return line.to_owned();
        }
        let at = |column: usize| line[column..column + 8].trim().parse::<f64>().unwrap();
        let [x, y, z] = pose.apply([at(30), at(38), at(46)]);
        format!("{}{x:8.3}{y:8.3}{z:8.3}{}", &line[..30], &line[54..])
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n") + "\n"
}

fn dock(folder: &Path, options: &str) -> Value {
    succeed(
        folder,
        DOCK.split_whitespace().chain(options.split_whitespace()),
    );
    let directory = options.split_whitespace().last().unwrap();
    let text = fs::read(folder.join(directory).join("run.json")).unwrap();
    serde_json::from_slice(&text).unwrap()
}

/// The bound complex stands first, within half an Ångström and without clashes to speak of, for any number of threads.
/// The row's score is made of its parts.
#[test]
fn a_redocked_complex_is_found_exactly() {
    let folder = place("bound");
    let record = dock(folder.path(), "--threads 1 -o one");
    assert_eq!(record["sharp"]["finding"], "exact-fit");
    assert!(record["sharp"]["margin"].as_f64().unwrap() > 4.5);
    let stages = record["timing"]["stages"].as_array().unwrap();
    assert!(stages.iter().any(|stage| stage["name"] == "sharp"));
    dock(folder.path(), "--threads 2 -o two");
    let run = folder.path().join("one");
    assert!(comparable(&run) == comparable(&folder.path().join("two")));

    let rows = rows(&run);
    let first = &rows[0];
    let number = |name: &str| first[name].parse::<f64>().unwrap();
    assert!(number("irmsd") < 0.5, "{}", first["irmsd"]);
    assert!(number("sharp_clashes") <= 5.0 && number("sharp_energy") < -50.0);
    let parts = [
        "search_score",
        "fine_contact",
        "atom_pair",
        "relaxed",
        "active_residues",
    ];
    let further = ["unresolved", "termini", "sharp"];
    let sum: f64 = parts
        .into_iter()
        .chain(further)
        .filter_map(|name| first[name].parse::<f64>().ok())
        .sum();
    assert!((sum - number("pose_score")).abs() < 1e-9 * sum.abs());
    assert!(run.join("top/rank_0001.pdb").exists());
}

/// Without an exact fit the ranking is that of the soft score: the table is that of `--sharp off` with three columns
/// more. With `on` it is another.
#[test]
fn unbound_partners_keep_their_ranking() {
    let folder = place("unbound");
    let record = dock(folder.path(), "-o auto");
    assert_eq!(record["sharp"]["finding"], "no-exact-fit");
    let off = dock(folder.path(), "--sharp off -o off");
    assert!(off["sharp"].is_null());
    let on = dock(folder.path(), "--sharp on -o on");
    assert_eq!(on["sharp"]["finding"], "requested");

    let mut soft = rows(&folder.path().join("auto"));
    for row in &mut soft {
        assert_eq!(row.remove("sharp").as_deref(), Some(""));
        let energy = row.remove("sharp_energy").unwrap();
        assert_eq!(
            energy.is_empty(),
            row.remove("sharp_clashes").unwrap().is_empty()
        );
    }
    assert!(soft == rows(&folder.path().join("off")));
    let sharp = rows(&folder.path().join("on"));
    assert!(
        sharp
            .iter()
            .any(|row| row["sharp"].parse::<f64>().is_ok_and(|sharp| sharp > 0.0))
    );
}

/// Copies of a ring cannot move alone, so sharp fits of them are refused where they are requested.
#[test]
fn rings_refuse_sharp_fits() {
    let folder = place("bound");
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder.path())
        .args("dock receptor.pdb --symmetry C2 --sharp on -o ring".split_whitespace())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(
        text.contains("sharp is on") && text.contains("--symmetry"),
        "{text}"
    );
    assert!(!folder.path().join("ring").exists());
}
