//! `knotdock evaluate` with known complexes as people have them: several copies, one chain name, two models, two data
//! blocks.

use std::fs;
use std::path::Path;

use crate::program::succeed;
use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

/// Trypsin or its inhibitor, unbound or bound: the atom records of an example, all of the chain given.
fn atoms(name: &str, chain: char) -> String {
    let file = format!("structures/examples/1ppe_{name}.pdb");
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(file);
    let text = fs::read_to_string(path).unwrap();
    let records = text.lines().filter(|line| line.starts_with("ATOM"));
    records
        .map(|line| format!("{}{chain}{}\n", &line[..21], &line[22..]))
        .collect()
}

/// A folder with the unbound partners and the first pose of docking them, of which DockQ 2.1.3 gives iRMSD 1.672, LRMSD
/// 3.834, fnat 0.620 and DockQ 0.632.
fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("receptor.pdb", &atoms("receptor_unbound", 'A'));
    write("ligand.pdb", &atoms("ligand_unbound", 'B'));
    write(
        "poses.csv",
        "rank,qw,qx,qy,qz,tx,ty,tz\n\
         1,0.6934499004232612,-0.05033358908108056,0.5866542965735043,-0.4152475165259747,\
         10.120215376660942,21.693835874308302,11.632116741294524\n",
    );
    folder
}

const EVALUATE: &str =
    "evaluate poses.csv --receptor receptor.pdb --ligand ligand.pdb --native native.pdb";

fn measured(folder: &Path, command: &str) -> Value {
    let output = succeed(folder, command.split_whitespace().chain(["--json"]));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[track_caller]
fn assert_as_dockq(object: &Value) {
    let pose = &object["poses"][0];
    let expected = [
        ("irmsd", 1.672),
        ("lrmsd", 3.834),
        ("fnat", 0.620),
        ("dockq", 0.632),
    ];
    for (name, expected) in expected {
        assert!(
            (pose[name].as_f64().unwrap() - expected).abs() < 2e-3,
            "{name}: {pose}"
        );
    }
    assert_eq!(pose["capri"], "medium");
}

/// The message and remedy of an evaluation that must be refused.
fn refused(folder: &Path, command: &str) -> (String, String) {
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .args(command.split_whitespace().chain(["--json"]))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    let text = |name: &str| object["error"][name].as_str().unwrap().to_owned();
    (text("message"), text("remedy"))
}

/// Records moved along x, with another chain name.
fn copy(records: &str, chain: char, shift: f64) -> String {
    let moved = |line: &str| {
        let x: f64 = line[30..38].trim().parse().unwrap();
        format!(
            "{}{chain}{}{:8.3}{}\n",
            &line[..21],
            &line[22..30],
            x + shift,
            &line[38..]
        )
    };
    records.lines().map(moved).collect()
}

/// What was taken of a native of several copies is said, in words and in the object.
#[test]
fn the_copy_that_is_taken_is_named() {
    let folder = place();
    let (one, other) = (atoms("receptor_bound", 'E'), atoms("ligand_bound", 'I'));
    // The second inhibitor is alone, under the docked ligand's name.
    let native = [copy(&other, 'B', 80.0), one, other].concat();
    fs::write(folder.path().join("native.pdb"), native).unwrap();
    let object = measured(folder.path(), EVALUATE);
    assert_as_dockq(&object);
    let matched = &object["match"];
    assert_eq!(
        matched["complexes"][0]["receptor"],
        serde_json::json!(["E"])
    );
    assert_eq!(matched["complexes"][0]["ligand"], serde_json::json!(["I"]));
    assert!(matched["complexes"][0]["contacts"].as_u64().unwrap() > 50);
    assert_eq!(matched["unused_native_chains"], serde_json::json!(["B"]));
    assert!(matched["ligand"]["docked_share"].as_f64().unwrap() > 0.9);
    assert_eq!(matched["warnings"], serde_json::json!([]));
    let said = |more: &str| {
        let command = format!("{EVALUATE} {more}");
        let output = succeed(folder.path(), command.split_whitespace());
        String::from_utf8(output.stdout).unwrap()
    };
    let (brief, text) = (said(""), said("-v"));
    assert!(brief.contains("not compared: chains B"), "{brief}");
    assert!(
        text.contains("receptor, as the native's E: 223 of 223"),
        "{text}"
    );
    assert!(text.contains("left aside of the native: B"), "{text}");
}

/// Found with both partners under one name: here with a gap of 72 between their numbers, which might be a missing
/// domain but for the TER record.
#[test]
fn a_ter_record_ends_a_chain() {
    let folder = place();
    let renumbered = |records: &str| -> String {
        let number = |line: &str| line[22..26].trim().parse::<i64>().unwrap() + 316;
        let line = |line: &str| format!("{}{:4}{}\n", &line[..22], number(line), &line[26..]);
        records.lines().map(line).collect()
    };
    let (one, other) = (atoms("receptor_bound", 'A'), atoms("ligand_bound", 'A'));
    let native = [&one, "TER\n", &renumbered(&other), "END\n"].concat();
    fs::write(folder.path().join("native.pdb"), native).unwrap();
    let object = measured(folder.path(), EVALUATE);
    assert_as_dockq(&object);
    assert_eq!(
        object["match"]["ligand"]["chains"][0]["native_chain"],
        "A/2"
    );
}

/// Found with assemblies of the archive, whose copies are models, and with files of PyMOL, whose objects are data
/// blocks. The error said that the ligand's sequence was not there, and not that half of the file was not read.
#[test]
fn errors_name_what_was_not_read() {
    let folder = place();
    let (one, other) = (atoms("receptor_bound", 'E'), atoms("ligand_bound", 'I'));
    let models = format!("MODEL        1\n{one}ENDMDL\nMODEL        2\n{other}ENDMDL\n");
    fs::write(folder.path().join("native.pdb"), models).unwrap();
    let (message, _) = refused(folder.path(), EVALUATE);
    assert!(message.contains("ligand"), "{message}");
    assert!(
        message.contains("MODEL 2 of the native's file was not read"),
        "{message}"
    );

    let table = |records: &str| -> String {
        let items = "group_PDB id label_atom_id label_comp_id label_asym_id label_seq_id Cartn_x Cartn_y Cartn_z \
            type_symbol";
        let head: String = items
            .split(' ')
            .map(|item| format!("_atom_site.{item}\n"))
            .collect();
        let row = |line: &str| {
            let columns = [
                (0, 6),
                (6, 11),
                (12, 16),
                (17, 20),
                (21, 22),
                (22, 26),
                (30, 38),
                (38, 46),
                (46, 54),
            ];
            let values = columns.map(|(from, to)| line[from..to].trim().to_owned());
            format!("{} {}\n", values.join(" "), &line[13..14])
        };
        format!(
            "loop_\n{head}{}",
            records.lines().map(row).collect::<String>()
        )
    };
    let blocks = format!("data_rec\n{}data_lig\n{}", table(&one), table(&other));
    fs::write(folder.path().join("native.cif"), blocks).unwrap();
    let (message, _) = refused(folder.path(), &EVALUATE.replace("native.pdb", "native.cif"));
    assert!(message.contains("ligand"), "{message}");
    assert!(
        message.contains("1 further data block with atoms, the first, data_lig"),
        "{message}"
    );
}

/// Whichever file is called the receptor: CAPRI's ligand is the smaller partner. Found with a nanobody as the
/// receptor: the same complex was acceptable one way and incorrect the other.
#[test]
fn figures_are_the_same_with_the_partners_exchanged() {
    let folder = place();
    let native = [atoms("receptor_bound", 'E'), atoms("ligand_bound", 'I')].concat();
    fs::write(folder.path().join("native.pdb"), native).unwrap();
    // The same complexes, of receptor and ligand and of ligand and receptor: DockQ 2.1.3 gives LRMSD 9.448.
    let head = "rank,qw,qx,qy,qz,tx,ty,tz\n";
    let rows = ROWS_OF_ONE_COMPLEX.map(|row| format!("{head}{row}\n"));
    fs::write(folder.path().join("poses.csv"), &rows[0]).unwrap();
    fs::write(folder.path().join("swapped.csv"), &rows[1]).unwrap();
    let direct = measured(folder.path(), EVALUATE);
    let swapped = measured(
        folder.path(),
        "evaluate swapped.csv --receptor ligand.pdb --ligand receptor.pdb --native native.pdb",
    );
    for object in [&direct, &swapped] {
        let pose = &object["poses"][0];
        assert!(
            (pose["lrmsd"].as_f64().unwrap() - 9.448).abs() < 2e-3,
            "{pose}"
        );
        assert!(
            (pose["dockq"].as_f64().unwrap() - 0.269).abs() < 2e-3,
            "{pose}"
        );
        assert_eq!(pose["capri"], "acceptable");
    }
    assert_eq!(direct["match"]["dockq_ligand"], "ligand");
    assert_eq!(swapped["match"]["dockq_ligand"], "receptor");
}

/// Rows of `poses.csv` that make the same complex, the second with the molecules exchanged.
const ROWS_OF_ONE_COMPLEX: [&str; 2] = [
    "334,0.18696203313426699,-0.1310166216455086,0.5704582597886773,-0.7889595787223659,6.819910548451693,20.686046678738595,11.02562402964174",
    "334,0.18696203313426699,0.1310166216455086,-0.5704582597886773,0.7889595787223659,15.376229103972596,15.248683827162377,11.271083018425106",
];

/// Complexes of any program are measured where they stand: those of a run as its table says, the known one as itself, and
/// one that cannot be read costs no other.
#[test]
fn complex_files_are_measured_where_they_stand() {
    let folder = place();
    let native = atoms("receptor_bound", 'E') + &atoms("ligand_bound", 'I');
    fs::write(folder.path().join("native.pdb"), native).unwrap();
    let dock =
        "dock receptor.pdb ligand.pdb --native native.pdb --rotations 60 --write-top 3 --quiet";
    succeed(folder.path(), format!("{dock} --raw -o run").split(' '));
    // A refined complex is measured as it was written.
    succeed(folder.path(), format!("{dock} -o refined").split(' '));
    let evaluate = "evaluate refined/top/rank_0001.pdb --native native.pdb";
    let found = measured(folder.path(), evaluate);
    let row = &crate::dock_run::run::rows(&folder.path().join("refined"))[0];
    let expected: f64 = row["complex_irmsd"].parse().unwrap();
    assert!((found["complexes"][0]["irmsd"].as_f64().unwrap() - expected).abs() < 0.02);
    let rows = crate::dock_run::run::rows(&folder.path().join("run"));
    let files = "run/top/rank_0001.pdb run/top/rank_0002.pdb run/top/rank_0003.pdb";
    let evaluate = format!("evaluate {files} native.pdb --native native.pdb -o models.csv");
    let found = measured(folder.path(), &evaluate);
    let complexes = found["complexes"].as_array().unwrap();
    assert_eq!(complexes.len(), 4);
    for (complex, row) in complexes.iter().zip(&rows[..3]) {
        for column in ["irmsd", "lrmsd", "fnat", "dockq"] {
            let expected: f64 = row[column].parse().unwrap();
            // Files have three decimals, and a contact may lie at its limit.
            let own = complex[column].as_f64().unwrap();
            assert!((own - expected).abs() < 0.02, "{column}: {own} {expected}");
        }
        assert_eq!(complex["capri"], row["capri"].as_str());
    }
    assert!(complexes[3]["irmsd"].as_f64().unwrap() < 1e-6);
    assert!((complexes[3]["dockq"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    let mut table = csv::Reader::from_path(folder.path().join("models.csv")).unwrap();
    assert_eq!(table.records().count(), 4);
    let words = format!("evaluate {files} nowhere.pdb A B --native native.pdb --json");
    let mut program = cargo_bin_cmd!("knotdock");
    let output = program
        .current_dir(folder.path())
        .args(words.split_whitespace())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(said["complexes"].as_array().unwrap().len(), 3);
    for words in [
        "evaluate native.pdb",
        "evaluate native.pdb E --native native.pdb",
        "evaluate native.pdb --native native.pdb --receptor receptor.pdb",
        "evaluate run run --native native.pdb",
    ] {
        crate::program::refused(folder.path(), words.split_whitespace());
    }
}

/// Without `-o` the first ten rows are shown, and all are counted.
#[test]
fn a_long_table_is_summed_up() {
    let folder = place();
    let native = atoms("receptor_bound", 'E') + &atoms("ligand_bound", 'I');
    fs::write(folder.path().join("native.pdb"), native).unwrap();
    let table = fs::read_to_string(folder.path().join("poses.csv")).unwrap();
    let (header, row) = table.trim_end().split_once("\n1,").unwrap();
    let many: String = (1..=30).map(|rank| format!("\n{rank},{row}")).collect();
    fs::write(folder.path().join("poses.csv"), format!("{header}{many}\n")).unwrap();
    let output = succeed(folder.path(), EVALUATE.split_whitespace());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("1 of the first 1, 10 of the first 10, 30 of all 30"),
        "{text}"
    );
    assert!(text.contains("The first 10 of 30 rows are shown"), "{text}");
    assert_eq!(
        text.lines().filter(|line| line.ends_with("medium")).count(),
        10,
        "{text}"
    );
}
