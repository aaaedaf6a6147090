//! `knotdock collide` as its users see it: verdicts, files, JSON, refusals.

mod hard;
mod place;
mod refused;

use place::{Place, column};
use serde_json::Value;

/// Two cubes and a ball: every kind of file on either side.
#[test]
fn every_kind_of_solid_collides_with_every_other() {
    let place = Place::new();
    let solids = [
        "cube.obj",
        "ball.csv",
        "robot.yml:hand",
        "spheres.json",
        "atoms.pdb:A",
    ];
    place.write("two.csv", "1,0,0,0,0,0,0\n1,0,0,0,9,0,0\n");
    for (number, first) in solids.into_iter().enumerate() {
        for second in &solids[number..] {
            // Each pair in the order that the other pairs do not have.
            let pair = if number % 2 == 0 {
                [first, second]
            } else {
                [second, first]
            };
            let object = place.collide(&[pair[0], pair[1], "--poses", "two.csv"]);
            assert_eq!(
                (&object["hit"], &object["free"]),
                (&1.into(), &1.into()),
                "{pair:?}"
            );
            let [hit, free] = [0, 1].map(|row| &object["poses"][row]);
            assert_eq!(hit["certified_by"], "inner_balls", "{pair:?}");
            assert_eq!(free["certified_by"], "outer_balls", "{pair:?}");
            assert!(free["distance_low"].as_f64() > Some(0.0));
            assert_eq!(
                (&free["overlap_volume"], &free["force_x"]),
                (&0.0.into(), &0.0.into())
            );
        }
    }
}

/// Two balls of radius 1 and 0.5: all of a row in closed form.
#[test]
fn a_row_of_two_balls() {
    let place = Place::new();
    let object = place.collide(&["ball.csv", "small.csv", "--pose", "1,0,0,0,1.2,0,0"]);
    let row = &object["poses"][0];
    let number = |name: &str| row[name].as_f64().unwrap();
    assert_eq!(row["verdict"], "hit");
    assert!(
        (number("distance_low") + 0.3).abs() < 1e-9
            && (number("distance_high") + 0.3).abs() < 1e-12
    );
    assert_eq!([number("witness_a_x"), number("witness_b_x")], [1.0, 0.7]);
    let lens = std::f64::consts::PI * 0.09 * (1.44 + 2.0 * 1.2 * 1.5 - 3.0 * 0.25) / (12.0 * 1.2);
    assert!(
        (number("overlap_volume") - lens).abs() <= number("overlap_volume_bound")
            && number("overlap_volume_bound") < 1e-12
    );
    assert!(number("overlap_energy") > 0.0 && number("force_x") > 0.0);
    // The torque of a central force is none.
    for name in ["force_y", "force_z", "torque_x", "torque_y", "torque_z"] {
        assert!(number(name).abs() < 1e-12, "{name}");
    }
    let only = place.collide(&["ball.csv", "small.csv", "--compute", "verdict"]);
    let row = &only["poses"][0];
    assert!(row["distance_low"].is_null() && row["force_x"].is_null() && row["verdict"] == "hit");
}

#[test]
fn tables_are_the_same_for_any_number_of_threads() {
    let place = Place::new();
    place.write_poses("poses.csv", 300);
    let mut tables = Vec::new();
    for threads in ["1", "2"] {
        let file = format!("out{threads}.csv");
        let object = place.collide(&[
            "cube.obj",
            "cube.obj",
            "--poses",
            "poses.csv",
            "-o",
            &file,
            "-j",
            threads,
        ]);
        assert!(object["poses"].is_null() && object["table"] == file.as_str());
        let counts = ["hit", "free", "undecided"].map(|name| object[name].as_u64().unwrap());
        assert_eq!(counts.iter().sum::<u64>(), 300);
        assert!(counts[0] > 20 && counts[1] > 20, "{counts:?}");
        // All but the time.
        let text = place.read(&file);
        let rows = text
            .lines()
            .map(|line| line.rsplit_once(',').unwrap().0.to_owned());
        tables.push(rows.collect::<Vec<_>>());
    }
    assert_eq!(tables[0], tables[1]);
    // The same poses from standard input.
    let text = place.read("poses.csv");
    let piped = place
        .command(&[
            "cube.obj", "cube.obj", "--poses", "-", "-o", "out3.csv", "--quiet",
        ])
        .write_stdin(text)
        .output()
        .unwrap();
    assert!(piped.status.success());
    assert_eq!(
        column(&place.read("out3.csv"), "verdict"),
        column(&place.read("out1.csv"), "verdict")
    );
}

/// Distances bracket the verdicts, and a margin moves them.
#[test]
fn verdicts_agree_with_distances_and_margins() {
    let place = Place::new();
    place.write_poses("poses.csv", 200);
    let run = |margin: &str| {
        let object = place.collide(&[
            "cube.obj",
            "cube.obj",
            "--poses",
            "poses.csv",
            "--margin",
            margin,
            "--compute",
            "distance",
        ]);
        object["poses"].as_array().unwrap().clone()
    };
    let number = |row: &Value, name: &str| row[name].as_f64().unwrap();
    for (margin, rows) in [(0.0, run("0")), (0.5, run("0.5"))] {
        for row in rows {
            let (low, high) = (number(&row, "distance_low"), number(&row, "distance_high"));
            assert!(low <= high);
            match row["verdict"].as_str().unwrap() {
                "hit" => assert!(high <= margin),
                "free" => assert!(low >= margin - 1e-12),
                _ => assert!(high >= margin && low < margin),
            }
        }
    }
}

#[test]
fn modes_find_hits_alone() {
    let place = Place::new();
    let by = |method: &str, pose: &str| {
        let object = place.collide(&[
            "cube.obj",
            "cube.obj",
            "--method",
            method,
            "--pose",
            pose,
            "--compute",
            "force",
        ]);
        object["poses"][0].clone()
    };
    let deep = "1,0,0,0,0.3,0.2,0.1";
    let modes = by("modes", deep);
    assert_eq!(
        (&modes["verdict"], &modes["certified_by"]),
        (&"hit".into(), &"modes".into())
    );
    assert!(modes["modes"].as_u64() > Some(0));
    assert_eq!(by("modes", "1,0,0,0,9,0,0")["verdict"], "undecided");
    let tree = by("tree", deep);
    let error = (modes["overlap_energy"].as_f64().unwrap()
        - tree["overlap_energy"].as_f64().unwrap())
    .abs();
    assert!(
        error <= modes["energy_bound"].as_f64().unwrap() + tree["energy_bound"].as_f64().unwrap()
    );
    assert_eq!(by("hybrid", deep)["verdict"], "hit");
}

#[test]
fn a_path_has_a_time_of_impact() {
    let place = Place::new();
    place.write(
        "path.csv",
        "qw,qx,qy,qz,tx,ty,tz\n1,0,0,0,5,0,0\n1,0,0,0,0,0,0\n",
    );
    let object = place.collide(&["ball.csv", "small.csv", "--path", "path.csv"]);
    // Contact at x = 1.5, after 3.5 of 5.
    let time = object["impact"]["free_until"].as_f64().unwrap();
    assert!((time - 0.7).abs() < 1e-5, "{time}");
    place.write("past.csv", "1,0,0,0,5,2,0\n1,0,0,0,-5,2,0\n");
    let object = place.collide(&["ball.csv", "small.csv", "--path", "past.csv"]);
    assert_eq!(
        (
            &object["impact"]["free_until"],
            &object["impact"]["verdict"]
        ),
        (&1.0.into(), &"free".into())
    );
    assert!(object["impact"]["quaternion"].is_null());
}

#[test]
fn a_deadline_ends_a_pose_early_with_bounds() {
    let place = Place::new();
    let rows = |deadline: &[&str]| {
        let pose = "0.5,0.5,0.5,0.5,1.1,0.4,0.2";
        let arguments = [
            &[
                "cube.obj",
                "cube.obj",
                "--compute",
                "distance",
                "--pose",
                pose,
            ],
            deadline,
        ]
        .concat();
        place.collide(&arguments)["poses"][0].clone()
    };
    let (whole, early) = (rows(&[]), rows(&["--deadline", "1us"]));
    let number = |row: &Value, name: &str| row[name].as_f64().unwrap();
    assert!(number(&early, "distance_low") <= number(&whole, "distance_high"));
    assert!(number(&early, "distance_high") >= number(&whole, "distance_high"));
}
