//! The built program.

use std::path::Path;
use std::process::Output;

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

/// Runs it in a folder with --json; it must refuse its input with a remedy. Returns the error.
#[track_caller]
pub fn refused<'a>(folder: &Path, arguments: impl IntoIterator<Item = &'a str>) -> Value {
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .args(arguments)
        .arg("--json")
        .output()
        .unwrap();
    let mut object: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(2), "{object}");
    let error = object["error"].take();
    assert!(error["remedy"].is_string(), "{error}");
    error
}

/// Runs it in a folder; it must succeed.
pub fn succeed<'a>(folder: &Path, arguments: impl IntoIterator<Item = &'a str>) -> Output {
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap();
    let reported = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{reported}");
    output
}
