//! A folder with inputs, and calls of the program in it.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::time::Duration;

use assert_cmd::Command;
use assert_cmd::cargo::cargo_bin;
use serde_json::Value;

/// After which a call that waits for ever is ended: a guard, no measurement.
const HANGS: Duration = Duration::from_secs(300);

/// A folder with a small pair of molecules and of meshes.
pub struct Place {
    folder: tempfile::TempDir,
}

/// A box of the sides given as OBJ.
fn box_obj(sides: [f64; 3]) -> String {
    let mut text = String::new();
    for corner in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|axis| sides[axis] * f64::from(corner >> axis & 1));
        text += &format!("v {x} {y} {z}\n");
    }
    text + "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n"
}

impl Place {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in [
            ("receptor.pdb", crate::molecules::receptor()),
            ("ligand.pdb", crate::molecules::ligand()),
            ("box.obj", box_obj([4.0, 2.0, 1.0])),
            ("cube.obj", box_obj([2.0, 2.0, 2.0])),
            (
                "pairs.csv",
                "receptor,ligand\nreceptor.pdb,ligand.pdb\n".to_owned(),
            ),
        ] {
            fs::write(folder.path().join(name), text).unwrap();
        }
        Self { folder }
    }

    pub fn root(&self) -> &Path {
        self.folder.path()
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Names in the folder, in order.
    pub fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// A command in the folder; one that never ends is killed, and fails.
    pub fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.current_dir(self.folder.path()).timeout(HANGS);
        command
    }

    /// The program with arguments.
    pub fn call(&self, arguments: &str) -> Output {
        let mut command = self.command(cargo_bin!("knotdock").to_str().unwrap());
        command.args(arguments.split_whitespace()).output().unwrap()
    }

    /// The program with arguments, after a line of the shell that sets limits.
    pub fn limited(&self, limits: &str, arguments: &str) -> Output {
        let mut command = self.command("sh");
        command.args(["-c", &format!("{limits}; exec \"$@\""), "sh"]);
        command.arg(cargo_bin!("knotdock"));
        command.args(arguments.split_whitespace()).output().unwrap()
    }

    /// Makes a named pipe that nobody writes to.
    pub fn pipe(&self, name: &str) -> PathBuf {
        let made = self.command("mkfifo").arg(name).output().unwrap();
        assert!(made.status.success(), "mkfifo {name}");
        self.path(name)
    }
}

/// Says that a check was not run here, past what the test harness holds back of a test that passes.
pub fn not_run(test: &str, reason: &str) {
    let line = format!("NOT RUN: {test}: {reason}\n");
    std::io::stderr().write_all(line.as_bytes()).unwrap();
}

/// The error of a call that failed with an exit code and printed its JSON object.
pub fn error(output: &Output, code: i32) -> Value {
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!(
        output.status.code(),
        Some(code),
        "{:?}: {words}",
        output.status
    );
    assert!(
        words.contains("error: ") && !words.contains("panicked"),
        "{words}"
    );
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(object["error"]["remedy"].is_string(), "{object}");
    object["error"].clone()
}
