//! `knotdock score`: the ladder reaches the exact score, and poses that are none are refused.

use crate::molecules;
use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

fn example(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .join(format!("structures/examples/1ppe_{name}.pdb"))
}

fn score(receptor: &Path, ligand: &Path, arguments: &[&str]) -> Value {
    let output = cargo_bin_cmd!("knotdock")
        .arg("score")
        .args([receptor, ligand])
        .args(arguments)
        .arg("--json")
        .output()
        .unwrap();
    let reported = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{reported}");
    assert!(!reported.contains("warning"), "{reported}");
    let text = std::str::from_utf8(&output.stdout).unwrap();
    assert_eq!(text.lines().count(), 1);
    serde_json::from_str(text).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Checks what every object of the command must satisfy; returns the rows.
fn check(reported: &Value) -> Vec<Value> {
    let (exact, scale) = (number(&reported["exact"]), number(&reported["scale"]));
    assert!(scale > 0.0);
    let rows = reported["rows"].as_array().unwrap().clone();
    let full = rows.last().unwrap();
    assert!(
        number(&full["error"]) < 1e-3 * exact.abs().max(scale),
        "{full}"
    );
    assert!(rows.iter().any(|row| row["modes"] == 4096));
    let mut last = 0;
    for row in &rows {
        let modes = row["modes"].as_u64().unwrap();
        let kept = row["modes_kept"].as_u64().unwrap();
        assert!(modes > last && kept <= modes);
        last = modes;
        let error = number(&row["error"]);
        assert!((error - (number(&row["value"]) - exact).abs()).abs() <= 1e-9 * scale);
        for time in ["seconds", "seconds_prepare", "seconds_new_rotation"] {
            assert!(number(&row[time]) > 0.0);
        }
    }
    // The sensitivity to the offset, by the lifted axis and by differences of the exact sum.
    let sensitivity = &reported["offset_sensitivity"];
    let size = |value: &Value| number(value).abs();
    let slices = sensitivity["exact_slices"].as_array().unwrap();
    let weights = [100.0, 20.0, 1.0];
    let largest: f64 = (0..3).map(|i| weights[i] * size(&slices[i])).sum();
    for i in 0..3 {
        let off = number(&sensitivity["slices"][i]) - number(&slices[i]);
        assert!(
            off.abs() <= 2e-3 * size(&slices[2]),
            "slice {i}: {sensitivity}"
        );
    }
    let off = number(&sensitivity["score"]) - number(&sensitivity["exact_score"]);
    assert!(off.abs() <= 2e-3 * largest, "{sensitivity}");
    for part in ["force", "torque"] {
        for axis in 0..3 {
            let a = number(&reported["gradient"][part][axis]);
            let b = number(&reported["gradient_modes"][part][axis]);
            assert!((a - b).abs() <= 0.05 * scale, "{part}: {reported}");
        }
    }
    rows
}

#[test]
fn the_example_pair_reaches_its_exact_score() {
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    // The unbound partners come superposed on the complex: near the native pose.
    let reported = score(
        &receptor,
        &ligand,
        &[
            "--pose",
            "1,0,0,0,0,0,0",
            "--modes",
            "1000",
            "--config",
            "kernel.resolution=8",
        ],
    );
    let rows = check(&reported);
    assert!(rows.iter().any(|row| row["modes"] == 1000));
}

/// A small pair; a pose far away, where the score is nothing; a kernel without reward, where no score is above zero.
#[test]
fn hard_poses_and_kernels_reach_theirs_too() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (folder.path().join("a.pdb"), folder.path().join("b.pdb"));
    fs::write(&receptor, molecules::receptor()).unwrap();
    fs::write(&ligand, molecules::ligand()).unwrap();
    let near = ["--pose", "1,0,0,0,0,0,0"];
    let reported = score(&receptor, &ligand, &near);
    let rows = check(&reported);
    // By magnitude fewer modes do the same: at every count less is left out.
    let other = score(
        &receptor,
        &ligand,
        &[&near[..], &["--order", "magnitude"]].concat(),
    );
    assert_eq!(reported["exact"], other["exact"]);
    for (low, by_magnitude) in rows.iter().zip(&check(&other)) {
        assert!(number(&by_magnitude["rms"]) <= 1.01 * number(&low["rms"]));
    }
    check(&score(
        &receptor,
        &ligand,
        &["--pose", "0.6,0,-0.8,0.0002,3,-2,1", "--lambda", "0"],
    ));
    let far = score(&receptor, &ligand, &["--pose", "-1,0,0,0,500,0,0"]);
    assert_eq!(far["exact"], 0.0);
    check(&far);
    assert_eq!(
        far["pose"],
        serde_json::json!([1.0, 0.0, 0.0, 0.0, 500.0, 0.0, 0.0])
    );
}

#[test]
fn poses_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.pdb"), molecules::receptor()).unwrap();
    for pose in ["1,0,0,0,0,0", "1,0,0,0,0,0,nan", "1,1,0,0,0,0,0", "x", ""] {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(["score", "a.pdb", "a.pdb", "--json", "--pose", pose])
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{pose}");
        let reported: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(
            reported["error"]["message"]
                .as_str()
                .unwrap()
                .contains("--pose")
        );
        assert!(reported["error"]["remedy"].is_string());
    }
    let output = cargo_bin_cmd!("knotdock")
        .current_dir(folder.path())
        .args(["score", "a.pdb", "a.pdb", "--json"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
}
