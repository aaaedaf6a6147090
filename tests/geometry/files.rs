//! What the commands report and write.

use std::f64::consts::PI;
use std::fs;

use super::{folder, object, run};

fn volume(object: &serde_json::Value, set: &str) -> f64 {
    object[set]["volume"].as_f64().unwrap()
}

fn ball(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

#[test]
fn the_obstacle_of_two_balls_is_a_ball_in_every_format() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let found = object(
        folder.path(),
        &[
            "obstacle",
            "large.csv",
            "small.csv",
            "--reduce",
            "-o",
            "o.csv",
            "--surface",
            "o.stl",
            "--volume-grid",
            "o.mrc",
            "--picture",
            "o.svg",
            "--cells",
            "32",
        ],
    );
    for set in ["inner", "outer"] {
        let error = found[set]["volume_error"].as_f64().unwrap();
        let off = (volume(&found, set) - ball(2.5)).abs();
        assert!(off <= error && error < 1e-10, "{found}");
        assert_eq!(found[set]["free_regions"], 1);
    }
    assert_eq!(found["epsilon"], 0.0);
    let table = fs::read_to_string(at("o.csv")).unwrap();
    let row = table.lines().nth(1).unwrap();
    let numbers: Vec<f64> = row.split(',').map(|field| field.parse().unwrap()).collect();
    assert_eq!(numbers, [1.0, 1.0, 3.0, 2.5, 1.0]);
    let (mesh, report) = knotdock_structures::mesh::read(&at("o.stl")).unwrap();
    assert!(report.is_sound(), "{report}");
    assert!((mesh.volume() / ball(2.5) - 1.0).abs() < 0.05);
    assert_eq!(&fs::read(at("o.mrc")).unwrap()[208..212], b"MAP ");
    assert!(fs::read_to_string(at("o.svg")).unwrap().starts_with("<svg"));
}

/// Inside the hollow a small ball is free, and cannot come out.
#[test]
fn a_ball_in_a_hollow_is_caged() {
    let folder = folder();
    fs::write(folder.path().join("tiny.csv"), "x,y,z,r\n0,0,0,0.3\n").unwrap();
    let found = object(
        folder.path(),
        &["obstacle", "shell.csv", "tiny.csv", "--cells", "32"],
    );
    assert_eq!(found["outer"]["free_regions"], 2);
    let rows = object(
        folder.path(),
        &[
            "obstacle",
            "shell.csv",
            "tiny.csv",
            "--cells",
            "24",
            "--rotations",
            "4",
            "-o",
            "t.csv",
        ],
    );
    assert_eq!(rows["rotations"].as_array().unwrap().len(), 4);
    let table = fs::read_to_string(folder.path().join("t.csv")).unwrap();
    assert!(
        table.lines().skip(1).all(|row| row.ends_with(",2,2")),
        "{table}"
    );
    // A clearance larger than the hollow leaves the outside alone.
    let found = object(
        folder.path(),
        &[
            "obstacle",
            "shell.csv",
            "tiny.csv",
            "--cells",
            "32",
            "--offset",
            "0.6",
        ],
    );
    assert_eq!(found["inner"]["free_regions"], 1);
}

#[test]
fn without_reduction_every_pair_is_written() {
    let folder = folder();
    for (options, rows) in [
        (&["-o", "all.csv"][..], 600),
        (&["-o", "few.csv", "--reduce"], 1),
    ] {
        let command = [
            &["obstacle", "shell.csv", "large.csv", "--cells", "16"],
            options,
        ]
        .concat();
        object(folder.path(), &command);
        let table = fs::read_to_string(folder.path().join(options[1])).unwrap();
        assert!(table.lines().count() > rows, "{options:?}");
    }
}

#[test]
fn operations_bracket_what_is_known() {
    let folder = folder();
    let run = |command: &str| {
        let words: Vec<&str> = command.split(' ').collect();
        object(folder.path(), &[&["morph"], &words[..]].concat())
    };
    let grid = "--complement-grid 2^12";
    for (command, exact) in [
        ("sum large.csv small.csv".to_owned(), ball(2.5)),
        (format!("difference large.csv small.csv {grid}"), ball(1.5)),
        (format!("open large.csv small.csv {grid}"), ball(2.0)),
        (format!("close large.csv small.csv {grid}"), ball(2.0)),
        ("offset large.csv --distance 0.5".to_owned(), ball(2.5)),
        (
            format!("offset large.csv --distance -0.5 {grid}"),
            ball(1.5),
        ),
        (
            "sweep small.csv --path line.csv --step 0.1".to_owned(),
            ball(0.5) + 3.0 * PI * 0.25,
        ),
        (
            "product small.csv --poses line.csv".to_owned(),
            2.0 * ball(0.5),
        ),
        (
            format!("quotient large.csv --poses line.csv {grid}"),
            PI * (8.0 + 3.0) / 12.0,
        ),
    ] {
        let found = run(&command);
        let [low, high] = ["inner", "outer"].map(|set| volume(&found, set));
        assert!(
            low <= 1.005 * exact && 0.995 * exact <= high,
            "{command}: {low} {exact} {high}"
        );
        assert!(found["operation"].is_string());
    }
}

#[test]
fn poses_are_measured_and_written() {
    let folder = folder();
    let half = "0.7071067811865476,0,0,0.7071067811865476,0,3,0";
    let found = object(folder.path(), &["se3", "distance", "1,0,0,0,0,0,0", half]);
    let exact = (PI * PI / 2.0 + 9.0).sqrt();
    assert!((found["distance"].as_f64().unwrap() - exact).abs() < 1e-12);
    object(
        folder.path(),
        &[
            "se3",
            "interpolate",
            "1,0,0,0,0,0,0",
            half,
            "--steps",
            "4",
            "-o",
            "path.csv",
        ],
    );
    object(
        folder.path(),
        &[
            "se3",
            "ball",
            "-1,0,0,0,-2,0,0",
            "--radius",
            "0.1",
            "--count",
            "20",
            "-o",
            "ball.csv",
        ],
    );
    for (name, rows) in [("path.csv", 5), ("ball.csv", 20)] {
        let table = fs::read_to_string(folder.path().join(name)).unwrap();
        assert_eq!(table.lines().count(), rows + 1);
        object(
            folder.path(),
            &["morph", "product", "small.csv", "--poses", name],
        );
    }
    assert!(run(folder.path(), &["se3", "--help"]).status.success());
    // The squares of such lengths overflowed: a ball of poses took forever, and distances were infinite.
    let far = "1,0,0,0,1e200,0,0";
    let ball = ["se3", "ball", "1,0,0,0,0,0,0", "-o", "far.csv", "--radius"];
    for refused in [
        &["se3", "distance", "1,0,0,0,0,0,0", far][..],
        &["se3", "interpolate", "1,0,0,0,0,0,0", far, "-o", "far.csv"],
        &[&ball[..], &["1e308"]].concat(),
        &["morph", "offset", "small.csv", "--distance", "1e200"],
        &["obstacle", "small.csv", "small.csv", "--offset", "1e200"],
    ] {
        assert_eq!(
            run(folder.path(), refused).status.code(),
            Some(2),
            "{refused:?}"
        );
    }
    let found = object(folder.path(), &[&ball[..], &["1e30"]].concat());
    assert_eq!(found["poses"], 100);
    // A path of 1e30 steps needs more memory than there is; it was sampled until there was none.
    let poses = "1,0,0,0,0,0,0\n1,0,0,0,1e30,0,0\n";
    fs::write(folder.path().join("long.csv"), poses).unwrap();
    let sweep = ["morph", "sweep", "small.csv", "--path", "long.csv"];
    assert_eq!(run(folder.path(), &sweep).status.code(), Some(2));
}

/// Threads change no byte.
#[test]
fn results_are_the_same_on_any_number_of_threads() {
    let folder = folder();
    let written = |threads: &str| {
        let name = format!("{threads}.csv");
        let command = [
            "morph",
            "close",
            "shell.csv",
            "small.csv",
            "--set",
            "outer",
            "--complement-grid",
            "2^12",
            "-j",
            threads,
            "-o",
            &name,
        ];
        object(folder.path(), &command);
        fs::read(folder.path().join(name)).unwrap()
    };
    assert_eq!(written("1"), written("3"));
}
