//! Runs of the made-up pair, and reading what they leave.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;

use crate::program::succeed;

/// A folder with the made-up receptor and ligand.
pub fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("receptor.pdb"),
        crate::molecules::receptor(),
    )
    .unwrap();
    fs::write(folder.path().join("ligand.pdb"), crate::molecules::ligand()).unwrap();
    folder
}

/// Runs the program in a folder; it must succeed. Returns standard output.
pub fn run(folder: &Path, arguments: &str) -> String {
    let output = succeed(folder, arguments.split_whitespace());
    String::from_utf8(output.stdout).unwrap()
}

/// All files below a folder, by their path in it.
pub fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
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

/// What the scripts of a report read.
pub fn report_data(report: &[u8]) -> Value {
    let text = std::str::from_utf8(report).unwrap();
    let (_, rest) = text.split_once("id=\"data\">").unwrap();
    let packed = STANDARD.decode(rest.split_once('<').unwrap().0).unwrap();
    let reader = flate2::read::GzDecoder::new(packed.as_slice());
    serde_json::from_reader(reader).unwrap()
}

/// The part of a report that does not differ from run to run: its words say how long the run took, and where it lies.
pub fn comparable_report(report: &[u8]) -> Vec<u8> {
    report_data(report).to_string().into_bytes()
}

/// The files of a run with the parts of run.json and of the report taken out that may differ.
pub fn comparable(run: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = files(run);
    let mut record: Value = serde_json::from_slice(&found["run.json"]).unwrap();
    for part in ["timing", "machine"] {
        assert!(record.as_object_mut().unwrap().remove(part).is_some());
    }
    found.insert("run.json".to_owned(), record.to_string().into_bytes());
    if let Some(report) = found.get_mut("report.html") {
        *report = comparable_report(report);
    }
    found
}

pub fn rows(run: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(run.join("poses.csv")).unwrap();
    reader
        .deserialize()
        .map(|row| row.unwrap())
        .collect::<Vec<_>>()
}

pub fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap()
}
