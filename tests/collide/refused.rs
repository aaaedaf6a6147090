//! Bad input is refused with file, line and remedy, and leaves nothing behind.

use super::place::Place;

#[test]
fn bad_poses() {
    let place = Place::new();
    place.write("empty.csv", "qw,qx,qy,qz,tx,ty,tz\n");
    place.write("nothing.csv", "");
    place.write(
        "row.csv",
        "qw,qx,qy,qz,tx,ty,tz\n1,0,0,0,1,2,3\n1,0,0,0,x,2,3\n",
    );
    place.write("short.csv", "1,0,0,0,1,2,3\n\n1,0,0,0,1,2\n");
    place.write("turn.csv", "1,0,0,0,1,2,3\n2,0,0,0,1,2,3\n");
    for (file, line) in [
        ("empty.csv", None),
        ("nothing.csv", None),
        ("row.csv", Some(3)),
        ("short.csv", Some(3)),
        ("turn.csv", Some(2)),
        ("absent.csv", None),
    ] {
        let error = place.refused(&["ball.csv", "ball.csv", "--poses", file, "-o", "out.csv"]);
        assert_eq!(error["line"].as_u64(), line, "{error}");
        assert!(error["file"].as_str().unwrap().ends_with(file), "{error}");
        assert!(!place.is_there("out.csv"));
    }
    place.refused(&["ball.csv", "ball.csv", "--pose", "1,0,0,0,nan,0,0"]);
    place.refused(&[
        "ball.csv",
        "ball.csv",
        "--pose",
        "1,0,0,0,0,0,0",
        "--poses",
        "row.csv",
    ]);
}

#[test]
fn bad_solids() {
    let place = Place::new();
    place.write("radius.csv", "x,y,z,r\n0,0,0,1\n0,0,0,-1\n");
    place.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    place.write("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for (solid, line) in [
        ("radius.csv", Some(3)),
        ("flat.obj", None),
        ("nan.obj", Some(1)),
        ("robot.yml", None),
        ("robot.yml:foot", None),
        ("ball.csv:hand", None),
        ("cube.obj:A", None),
        ("absent.stl", None),
        ("absent.csv", None),
        ("atoms.pdb:Z", None),
    ] {
        for arguments in [["ball.csv", solid], [solid, "ball.csv"]] {
            let error = place.refused(&arguments);
            assert_eq!(error["line"].as_u64(), line, "{solid}: {error}");
        }
    }
}

/// Squares of such lengths overflowed: a pose was "free" at no distance.
#[test]
fn lengths_that_cannot_be_computed_with() {
    let place = Place::new();
    for (file, text) in [
        ("poses.csv", "1,0,0,0,1,2,3\n1,0,0,0,0,-1e300,3\n"),
        ("far.csv", "0,0,0,1\n0,1e200,0,1\n"),
        ("large.csv", "0,0,0,1\n0,0,0,1e31\n"),
        ("tiny.csv", "0,0,0,1\n0,0,0,1e-200\n"),
        ("heavy.csv", "0,0,0,1,1\n0,0,0,1,1e200\n"),
        ("robot.json", "{\"radius\": 1,\n\"center\": [1e99, 0, 0]}"),
    ] {
        place.write(file, text);
        let error = match file {
            "poses.csv" => place.refused(&["ball.csv", "ball.csv", "--poses", file]),
            _ => place.refused(&[file, "ball.csv"]),
        };
        assert_eq!(error["line"], 2, "{file}: {error}");
    }
    place.refused(&["ball.csv", "ball.csv", "--pose", "1,0,0,0,1e300,0,0"]);
    place.refused(&["ball.csv", "ball.csv", "--margin", "1e300"]);
    // What is just within the limits is computed.
    place.write("large.csv", "0,0,0,1e30\n");
    let object = place.collide(&["large.csv", "large.csv", "--pose", "1,0,0,0,1e30,0,0"]);
    let row = &object["poses"][0];
    let lens = 5.0 * std::f64::consts::PI / 12.0 * 1e90;
    assert!((row["overlap_volume"].as_f64().unwrap() / lens - 1.0).abs() < 1e-12);
    for name in ["distance_low", "overlap_energy", "force_x", "torque_x"] {
        assert!(row[name].as_f64().unwrap().is_finite(), "{row}");
    }
    let object = place.collide(&["ball.csv", "ball.csv", "--pose", "1,0,0,0,1e30,0,0"]);
    let row = &object["poses"][0];
    assert_eq!(row["verdict"], "free");
    assert!((row["distance_low"].as_f64().unwrap() / 1e30 - 1.0).abs() < 1e-12);
}

#[test]
fn bad_options_and_files_in_the_way() {
    let place = Place::new();
    for option in [
        ["--margin", "-1"],
        ["--margin", "nan"],
        ["--deadline", "0"],
        ["--grid", "1"],
        ["--modes", "0"],
    ] {
        place.refused(&["ball.csv", "ball.csv", option[0], option[1]]);
    }
    place.write("mine.csv", "notes");
    place.refused(&["ball.csv", "small.csv", "-o", "mine.csv"]);
    place.refused(&["ball.csv", "small.csv", "-o", "ball.csv", "--force"]);
    place.refused(&["ball.csv", "small.csv", "-o", "nowhere/out.csv"]);
    assert_eq!(place.read("mine.csv"), "notes");
    place.collide(&["ball.csv", "small.csv", "-o", "mine.csv", "--force"]);
    assert!(place.read("mine.csv").starts_with("pose,qw"));
}
