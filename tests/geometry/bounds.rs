//! Bounds of the volume of results, and results that are proven empty.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use super::{folder, object, run};

/// The prism over a polygon, from 0 to `height`.
fn prism(corners: &[[f64; 2]], height: f64) -> String {
    let count = corners.len();
    let (mut text, mut ends) = (String::new(), [String::from("f"), String::from("f")]);
    for z in [0.0, height] {
        for [x, y] in corners {
            text += &format!("v {x} {y} {z}\n");
        }
    }
    for a in 0..count {
        let b = (a + 1) % count;
        text += &format!(
            "f {} {} {} {}\n",
            a + 1,
            b + 1,
            b + 1 + count,
            a + 1 + count
        );
        ends[0] += &format!(" {}", count - a);
        ends[1] += &format!(" {}", count + a + 1);
    }
    text + &ends.join("\n") + "\n"
}

fn square(edge: f64) -> [[f64; 2]; 4] {
    [[0.0, 0.0], [edge, 0.0], [edge, edge], [0.0, edge]]
}

/// A cube of edge 10 and an L of the volume 320.
fn meshes() -> tempfile::TempDir {
    let folder = folder();
    let l = [
        [0.0, 0.0],
        [10.0, 0.0],
        [10.0, 4.0],
        [4.0, 4.0],
        [4.0, 10.0],
        [0.0, 10.0],
    ];
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("cube.obj", &prism(&square(10.0), 10.0));
    write("small.obj", &prism(&square(3.0), 3.0));
    write("l.obj", &prism(&l, 5.0));
    write("one.csv", "0,0,0,1\n");
    write("two.csv", "0,0,0,2\n");
    folder
}

/// The bounds of the volume of an operation.
fn volume(folder: &Path, command: &str) -> [f64; 2] {
    let words: Vec<&str> = command.split(' ').collect();
    let found = object(folder, &[&["morph"], &words[..]].concat());
    ["least", "most"].map(|name| found["volume"][name].as_f64().unwrap())
}

/// Each volume is known in closed form, and the bounds are within a tenth of it.
#[test]
fn bounds_of_meshes_hold_the_true_volume() {
    let folder = meshes();
    let r = 2.0f64;
    let opened =
        6f64.powi(3) + 6.0 * 36.0 * r + 3.0 * PI * 6.0 * r * r + 4.0 / 3.0 * PI * r.powi(3);
    let grown = 1000.0 + 600.0 + 3.0 * PI * 10.0 + 4.0 / 3.0 * PI;
    // Two bars of 2 by 3, and what the edge inside leaves of a square.
    let shrunk = 3.0 * (8.0 * 2.0 + 6.0 * 2.0 + 1.0 - 0.25 * PI);
    for (command, exact) in [
        ("open cube.obj two.csv --grid 2^12", opened),
        ("offset cube.obj --distance 1 --grid 2^12", grown),
        ("offset l.obj --distance -1 --grid 2^12", shrunk),
        ("difference l.obj one.csv --grid 2^12", shrunk),
        ("sum cube.obj small.obj --grid 2^9", 2197.0),
        ("sum one.csv cube.obj --grid 2^9", grown),
        ("product cube.obj --poses line.csv --grid 2^12", 1300.0),
        (
            "quotient cube.obj --poses line.csv --grid 2^12 --complement-grid 2^12",
            700.0,
        ),
    ] {
        let [least, most] = volume(folder.path(), command);
        assert!(
            least <= exact && exact <= most,
            "{command}: {least} {exact} {most}"
        );
        assert!(
            most - least <= 0.1 * exact,
            "{command}: {least} {exact} {most}"
        );
    }
    // The closing fills a part of the fillet along the edge inside.
    let [least, most] = volume(folder.path(), "close l.obj two.csv --grid 2^12");
    let filled = 320.0 + 5.0 * 4.0 * (1.0 - 0.25 * PI);
    assert!(
        least <= filled && 320.0 <= most && most - least <= 32.0,
        "{least} {most}"
    );
    // B as a mesh is between balls.
    let coarse = "difference cube.obj small.obj --grid 2^9 --complement-grid 2^12";
    let [least, most] = volume(folder.path(), coarse);
    assert!(least <= 343.0 && 343.0 <= most, "{least} {most}");
}

/// The upper bound of a difference was that of its balls, several times the volume of A.
#[test]
fn a_difference_is_never_larger_than_a() {
    let folder = meshes();
    let [_, most] = volume(folder.path(), "difference large.csv small.csv");
    assert!(most <= 4.0 / 3.0 * PI * 8.0 * (1.0 + 1e-9), "{most}");
}

/// An empty outer set was reported as a lack of balls, which no finer grid can mend, and with -o alone.
#[test]
fn an_empty_result_is_an_answer() {
    let folder = meshes();
    let path = folder.path();
    let command = [
        "morph",
        "offset",
        "small.obj",
        "--distance",
        "-1.6",
        "--grid",
        "2^9",
    ];
    let output = run(path, &command);
    let words = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success());
    assert!(
        words.contains("the result is empty: the solid is thinner than 3.2"),
        "{words}"
    );
    let files = [
        "-o",
        "empty.csv",
        "--surface",
        "empty.stl",
        "--picture",
        "empty.svg",
    ];
    let found = object(path, &[&command[..], &files].concat());
    assert_eq!(found["volume"]["most"], 0.0);
    assert_eq!(found["outer"]["balls"], 0);
    assert!(found["empty"].as_str().unwrap().contains("thinner"));
    let table = fs::read_to_string(path.join("empty.csv")).unwrap();
    assert_eq!(table, "x,y,z,r,weight\n");
    assert_eq!(fs::read(path.join("empty.stl")).unwrap().len(), 84);
    let output = run(
        path,
        &[&command[..], &["--volume-grid", "empty.mrc"]].concat(),
    );
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("leave out --volume-grid"), "{error}");
    let found = object(
        path,
        &[
            "morph",
            "open",
            "large.csv",
            "two.csv",
            "--complement-grid",
            "2^9",
        ],
    );
    assert!(found["empty"].is_null());
}
