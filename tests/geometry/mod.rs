//! `knotdock obstacle`, `morph` and `se3` from the command line.

mod bounds;
mod files;
mod refusals;

use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;

/// Runs the program in a folder.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("knotdock").unwrap();
    command.current_dir(folder).args(arguments);
    command.output().unwrap()
}

/// The JSON object of a run that succeeds.
fn object(folder: &Path, arguments: &[&str]) -> Value {
    let output = run(folder, &[arguments, &["--json"]].concat());
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {error}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A folder with two balls of radius 2 and 0.5, and a hollow ball of balls about a hole of radius 0.8.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("large.csv", "x,y,z,r\n1,2,3,2\n");
    write("small.csv", "x,y,z,r\n0,1,0,0.5\n");
    let mut shell = "x,y,z,r\n".to_owned();
    for i in 0..600 {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 600.0;
        let angle = 2.399_963_229_728_653 * f64::from(i);
        let across = (1.0 - z * z).sqrt();
        shell += &format!(
            "{},{},{z},0.2\n",
            across * angle.cos(),
            across * angle.sin()
        );
    }
    write("shell.csv", &shell);
    write(
        "line.csv",
        "qw,qx,qy,qz,tx,ty,tz\n1,0,0,0,0,0,0\n1,0,0,0,3,0,0\n",
    );
    folder
}
