//! Bad input: exit code 2, the file and the remedy, and nothing written.

use std::fs;

use super::{folder, run};

#[test]
fn bad_input_is_refused_with_a_remedy() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("empty.csv", "qw,qx,qy,qz,tx,ty,tz\n");
    write(
        "broken.csv",
        "qw,qx,qy,qz,tx,ty,tz\n1,0,0,0,0,0,0\n1,0,0,0,0,x,0\n",
    );
    write("there.csv", "mine");
    let before = fs::read_dir(folder.path()).unwrap().count();
    for (command, said) in [
        ("obstacle large.csv nothing.csv", "nothing.csv"),
        ("obstacle large.csv small.csv --rotation 1,0,0", "four"),
        ("obstacle large.csv small.csv --rotation 0,0,0,0", "length"),
        ("obstacle large.csv small.csv --offset nan", "finite"),
        (
            "obstacle large.csv small.csv --surface o.off",
            ".obj, .stl or .ply",
        ),
        ("obstacle large.csv small.csv --volume-grid o.vti", ".nrrd"),
        ("obstacle large.csv small.csv --picture o.png", ".svg"),
        ("obstacle large.csv small.csv -o there.csv", "--force"),
        (
            "obstacle large.csv small.csv -o large.csv --force",
            "input files",
        ),
        ("obstacle large.csv small.csv --cells 100000", "512"),
        (
            "obstacle large.csv small.csv -o a.csv --surface nowhere/a.obj",
            "nowhere",
        ),
        ("morph sweep small.csv --path empty.csv", "no poses"),
        ("morph product small.csv --poses broken.csv", "line 3"),
        ("morph offset small.csv --distance inf", "finite"),
        (
            "morph difference large.csv small.csv -o a.csv --surface a.csv",
            "named twice",
        ),
        ("se3 distance 1,0,0,0,0,0 1,0,0,0,0,0,0", "seven"),
        ("se3 ball 1,0,0,0,0,0,0 --radius -1 -o b.csv", "--radius"),
        (
            "se3 ball 1,0,0,0,0,0,0 --radius 1 --count 99999999999 -o b.csv",
            "at most",
        ),
    ] {
        let words: Vec<&str> = command.split(' ').collect();
        let output = run(folder.path(), &words);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{command}: {error}");
        assert!(error.contains(said), "{command}: {error}");
        let json = run(folder.path(), &[&words[..], &["--json"]].concat());
        let object: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
        assert!(object["error"]["message"].is_string(), "{command}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), before);
    assert_eq!(
        fs::read_to_string(folder.path().join("there.csv")).unwrap(),
        "mine"
    );
}

/// The pairs are counted before any of them is made.
#[test]
fn memory_is_refused_before_the_work() {
    let folder = folder();
    let row = |i: u32| format!("{},0,0,1\n", f64::from(i) * 1e-3);
    let many: String = (0..40_000).map(row).collect();
    fs::write(folder.path().join("many.csv"), format!("x,y,z,r\n{many}")).unwrap();
    for command in ["obstacle many.csv many.csv", "morph sum many.csv many.csv"] {
        let words: Vec<&str> = command.split(' ').chain(["--memory", "1G"]).collect();
        let output = run(folder.path(), &words);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(
            error.contains("--memory") && error.contains("--grid"),
            "{error}"
        );
    }
}
