//! Files of balls dock as they are, beside a mesh or another such file.

use super::parts::broken_block;
use super::run::{Place, dock, scored_poses};
use std::fs;

/// Balls of Algorithm 1 of a part as `knotdock sample` writes them, without their weights.
fn sampled(place: &Place, part: &str) {
    let (mesh, table) = (format!("{part}.stl"), format!("{part}_weighted.csv"));
    let output = place
        .command(&["sample", &mesh, "--grid", "2^12", "-o", &table])
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{words}");
    let text = fs::read_to_string(place.path(&table)).unwrap();
    let rows = text.lines().map(|line| line.rsplit_once(',').unwrap().0);
    place.write(&format!("{part}.csv"), &rows.collect::<Vec<_>>().join("\n"));
}

#[test]
fn files_of_balls_dock_as_meshes_do() {
    let place = Place::of(&broken_block(0.05));
    sampled(&place, "receptor");
    sampled(&place, "ligand");
    let quick = [
        "--sampler",
        "bi",
        "--sample-grid",
        "20^3",
        "--rotations",
        "60",
        "--poses",
        "20",
        "--write-top",
        "1",
    ];
    for pair in [
        ["receptor.csv", "ligand.stl"],
        ["receptor.csv", "ligand.csv"],
    ] {
        let run = dock(
            &place,
            &[&pair[..], &quick, &["-o", "run", "--force"]].concat(),
        );
        let receptor = &run["run"]["inputs"]["receptor"];
        assert_eq!(receptor["report"]["balls"], receptor["sampling"]["balls"]);
        let fit = &receptor["sampling"]["double_skin"];
        let [rms, target] = ["rms", "rms_of_target"].map(|name| fit[name].as_f64().unwrap());
        assert!(rms < 0.2 * target, "{fit}");
        let poses = scored_poses(&place.path("run/poses.csv"));
        assert!(poses[0].1 > 0.0);
        let shown = fs::read_to_string(place.path("run/top/rank_0001.obj")).unwrap();
        assert!(shown.lines().filter(|line| line.starts_with("f ")).count() > 80);
        dock(
            &place,
            &["--rerun", "run/run.json", "-o", "again", "--force"],
        );
        let bytes = |run: &str| fs::read(place.path(run).join("poses.csv")).unwrap();
        assert_eq!(bytes("run"), bytes("again"));
    }
    // What cannot be done is refused with the file and a remedy, and a bad row with its line.
    let output = place
        .command(&[
            "dock",
            "--json",
            "receptor.csv",
            "ligand.stl",
            "--sampler",
            "lattice",
            "-o",
            "no",
        ])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let error: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let text = error["error"].to_string();
    assert!(
        text.contains("receptor.csv") && text.contains("--sampler bi"),
        "{text}"
    );
    place.write("bad.csv", "x,y,z,r\n0,0,0,1\n0,0,zero,1\n");
    let output = place
        .command(&[
            "dock",
            "--json",
            "bad.csv",
            "ligand.stl",
            "--sampler",
            "bi",
            "-o",
            "no",
        ])
        .output()
        .unwrap();
    let error: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (output.status.code(), &error["error"]["line"]),
        (Some(2), &3.into())
    );
    assert!(!place.path("no").exists());
}
