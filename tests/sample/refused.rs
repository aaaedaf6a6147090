//! Meshes that are refused, or read with a warning and refused by `--strict`.

use super::*;

#[test]
fn bad_meshes_are_refused_with_their_line() {
    let place = Place::new();
    let write = |name: &str, text: &str| fs::write(place.path(name), text).unwrap();
    write("nan.obj", &box_obj().replacen("v 4 2 0", "v 4 nan 0", 1));
    let error = place.refused(&["nan.obj"]);
    assert_eq!(
        (error["line"].as_u64(), error["file"].as_str()),
        (Some(4), Some("nan.obj"))
    );
    write("empty.obj", "v 0 0 0\n");
    assert!(
        place.refused(&["empty.obj"])["message"]
            .as_str()
            .unwrap()
            .contains("no triangles")
    );
    write(
        "flat.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n",
    );
    assert!(
        place.refused(&["flat.obj"])["message"]
            .as_str()
            .unwrap()
            .contains("flat")
    );
    write(
        "cut.stl",
        "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n",
    );
    assert_eq!(place.refused(&["cut.stl"])["line"], 2);
    write("letter.txt", "Dear all,\n");
    place.refused(&["letter.txt"]);
    place.refused(&["nowhere.stl"]);
    place.refused(&["."]);
    for arguments in [
        ["--grid", "2^99"],
        ["--grid", "1"],
        ["--mu", "1.5"],
        ["--alpha", "0"],
        ["--set", "a4"],
        ["--level", "0"],
    ] {
        place.refused(&["box.obj", arguments[0], arguments[1]]);
    }
    place.refused(&["box.obj", "--method", "wz", "--mu", "0.5"]);
    // It was ignored without a word.
    let error = place.refused(&["box.obj", "--alpha", "3"]);
    assert!(error["message"].as_str().unwrap().contains("--alpha"));
    place.sample(&[
        "box.obj",
        "--grid",
        "2^9",
        "--alpha",
        "3",
        "--weights",
        "fitted",
    ]);
}

#[test]
fn open_meshes_are_warned_of_and_refused_when_strict() {
    let place = Place::new();
    let open = box_obj().replace("f 5 6 8 7\n", "");
    fs::write(place.path("open.obj"), open).unwrap();
    let error = place.refused(&["open.obj", "--strict"]);
    assert!(error["message"].as_str().unwrap().contains("not closed"));
    let object = place.sample(&["open.obj", "--grid", "2^12"]);
    assert!(object["warnings"][0].as_str().unwrap().contains("4 open"));
    assert_eq!(object["mesh"]["open_edges"], 4);
    let inverted = box_obj().replace("f 1 5 7 3", "f 3 7 5 1");
    fs::write(place.path("mixed.obj"), inverted).unwrap();
    place.refused(&["mixed.obj", "--strict"]);
    place.sample(&["box.obj", "--strict", "--grid", "64", "-o", "sound.csv"]);
}
