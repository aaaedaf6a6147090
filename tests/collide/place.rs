//! A folder with solids of every kind.

use std::fs;

use assert_cmd::Command;
use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

pub struct Place {
    folder: tempfile::TempDir,
}

/// A box with its corners at low and high, faces outward.
pub fn block(low: [f64; 3], high: [f64; 3]) -> String {
    let mut text = String::new();
    for i in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            if i >> axis & 1 == 1 {
                high[axis]
            } else {
                low[axis]
            }
        });
        text += &format!("v {x:?} {y:?} {z:?}\n");
    }
    text + "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n"
}

/// Fields of a column, by its name.
pub fn column(table: &str, name: &str) -> Vec<String> {
    let mut lines = table.lines();
    let place = lines
        .next()
        .unwrap()
        .split(',')
        .position(|other| other == name)
        .unwrap();
    lines
        .map(|line| line.split(',').nth(place).unwrap().to_owned())
        .collect()
}

impl Place {
    pub fn new() -> Self {
        let place = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        place.write("cube.obj", &block([-1.0; 3], [1.0; 3]));
        place.write("ball.csv", "x,y,z,r\n0,0,0,1\n");
        place.write("small.csv", "0,0,0,0.5\n");
        place.write(
            "robot.yml",
            "collision_spheres:\n  arm:\n    - {center: [0, 0, 7], radius: 0.1}\n  hand:\n    - center: [0.0, 0.1, 0.0]\n      radius: 0.6\n",
        );
        place.write(
            "spheres.json",
            r#"[{"mean": 0.1, "spheres": [{"origin": [0, 0, 0.2], "radius": 0.7}]}]"#,
        );
        place.write(
            "atoms.pdb",
            "ATOM      1  CA  GLY A   1       0.000   0.100   0.000  1.00  0.00           C\n\
             ATOM      2  CA  GLY B   1      90.000   0.000   0.000  1.00  0.00           C\nEND\n",
        );
        place
    }

    pub fn write(&self, name: &str, text: &str) {
        fs::write(self.folder.path().join(name), text).unwrap();
    }

    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.folder.path().join(name)).unwrap()
    }

    pub fn is_there(&self, name: &str) -> bool {
        self.folder.path().join(name).exists()
    }

    /// Poses turned every way, from deep in each other to far apart.
    pub fn write_poses(&self, name: &str, count: u32) {
        let mut text = "qw,qx,qy,qz,tx,ty,tz\n".to_owned();
        for step in 1..=count {
            let part = |by: f64| 2.0 * (f64::from(step) * by).fract() - 1.0;
            let turn = [part(0.8191), part(0.671), part(0.5497), part(0.4503)];
            let length = turn.iter().map(|part| part * part).sum::<f64>().sqrt();
            let [w, x, y, z] = turn.map(|part| part / length);
            let [a, b, c] = [part(0.31), part(0.77), part(0.193)].map(|part| 3.0 * part);
            text += &format!("{w},{x},{y},{z},{a},{b},{c}\n");
        }
        self.write(name, &text);
    }

    /// The command on a coarse grid, since tests ask much of little.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = cargo_bin_cmd!("knotdock");
        command
            .current_dir(self.folder.path())
            .args(["collide", "--grid", "2^12"])
            .args(arguments);
        command
    }

    pub fn collide(&self, arguments: &[&str]) -> Value {
        let output = self.command(arguments).arg("--json").output().unwrap();
        let words = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {words}");
        serde_json::from_slice(&output.stdout).unwrap()
    }

    /// The error object of a call that must be refused with exit code 2.
    pub fn refused(&self, arguments: &[&str]) -> Value {
        let output = self.command(arguments).arg("--json").output().unwrap();
        let words = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {words}");
        let object: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(
            object["error"]["remedy"]
                .as_str()
                .is_some_and(|text| !text.is_empty()),
            "{object}"
        );
        object["error"].clone()
    }
}
