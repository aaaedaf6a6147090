//! Hard cases: needle, plate, shell, uneven radii, far and tiny coordinates, open and degenerate meshes.

use super::place::{Place, block};

/// A needle and a plate that no node of the grid is in: the sampler's balls along the surface find them.
#[test]
fn needles_and_plates() {
    let place = Place::new();
    place.write(
        "needle.obj",
        &block([-5.0, -0.005, -0.005], [5.0, 0.005, 0.005]),
    );
    place.write("plate.obj", &block([-5.0, -5.0, -0.005], [5.0, 5.0, 0.005]));
    for (first, second) in [("needle.obj", "plate.obj"), ("plate.obj", "needle.obj")] {
        // The needle is upright on the plate: through it, and beside it.
        for (y, free) in [(0.0, false), (6.5, true)] {
            let pose = format!("0.7071067811865476,0,0.7071067811865476,0,0,{y},0");
            let object = place.collide(&[first, second, "--pose", &pose, "--compute", "distance"]);
            let row = &object["poses"][0];
            assert_eq!(row["verdict"] == "free", free, "{first}: {row}");
            let (low, high) = (
                row["distance_low"].as_f64().unwrap(),
                row["distance_high"].as_f64().unwrap(),
            );
            let exact = if free { 1.495 } else { -0.005 };
            assert!(low <= exact && (exact <= high || !free), "{row}");
        }
    }
}

/// Doubling lengths, and a far origin, change no verdict.
#[test]
fn size_and_place_do_not_matter() {
    let place = Place::new();
    for (name, unit, offset) in [("small", 1e-6, 0.0), ("large", 1e6, 0.0), ("far", 1.0, 1e6)] {
        let low = [offset - unit, -unit, -unit];
        let high = [offset + unit, unit, unit];
        let file = format!("{name}.obj");
        place.write(&file, &block(low, high));
        for (gap, verdict) in [(-0.5, "hit"), (0.6, "free")] {
            let shift = (2.0 + gap) * unit;
            let pose = format!("1,0,0,0,{shift:e},0,0");
            let object = place.collide(&[&file, &file, "--pose", &pose]);
            let row = &object["poses"][0];
            assert_eq!(row["verdict"], verdict, "{name} {gap}: {row}");
            let (low, high) = (
                row["distance_low"].as_f64().unwrap(),
                row["distance_high"].as_f64().unwrap(),
            );
            assert!(
                low <= (gap + 1e-9) * unit && (gap - 1e-9) * unit <= high,
                "{name} {gap}: {low} {high}"
            );
        }
    }
}

#[test]
fn radii_a_million_apart() {
    let place = Place::new();
    place.write("uneven.csv", "0,0,0,1e6\n1000001,0,0,1\n");
    let at = |x: f64| {
        let pose = format!("1,0,0,0,{x},0,0");
        place.collide(&["uneven.csv", "small.csv", "--pose", &pose])["poses"][0].clone()
    };
    for (x, verdict) in [
        (1_000_002.4, "hit"),
        (1_000_002.6, "free"),
        (999_999.0, "hit"),
        (0.0, "hit"),
    ] {
        assert_eq!(at(x)["verdict"], verdict, "{x}");
    }
    let gap = at(1_000_002.6)["distance_high"].as_f64().unwrap();
    assert!((gap - 0.1).abs() < 1e-8, "{gap}");
}

/// What an open mesh was meant to bound is sampled, with a warning; degenerate triangles bound nothing.
#[test]
fn open_and_degenerate_meshes() {
    let place = Place::new();
    let whole = block([-1.0; 3], [1.0; 3]);
    place.write("open.obj", whole.trim_end_matches("f 5 6 8 7\n"));
    place.write("degenerate.obj", &(whole + "f 1 1 2\nf 1 2 1\n"));
    for file in ["open.obj", "degenerate.obj"] {
        let object = place.collide(&[file, "small.csv"]);
        assert_eq!(object["poses"][0]["verdict"], "hit", "{file}");
        let warned = !object["a"]["warnings"].as_array().unwrap().is_empty();
        assert_eq!(warned, file == "open.obj", "{object}");
        let object = place.collide(&[file, "small.csv", "--pose", "1,0,0,0,4,0,0"]);
        assert_eq!(object["poses"][0]["verdict"], "free", "{file}");
    }
}
