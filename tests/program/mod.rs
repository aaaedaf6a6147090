//! The built program.

use std::path::Path;
use std::process::Output;

use assert_cmd::cargo::cargo_bin_cmd;

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
