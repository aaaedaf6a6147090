//! Effects on demand: what auto turns on, what an effect that is off leaves untouched, and what cannot be forced.

mod molecules;
mod program;

use std::fs;
use std::path::Path;

use assert_cmd::cargo::cargo_bin_cmd;
use knotdock::search::{DockOptions, Effect, Scene};
use knotdock_scoring::engine::Plan;
use knotdock_scoring::exact::ExactScorer;
use knotdock_scoring::rescoring::Workspace;
use knotdock_scoring::se3::Pose;
use knotdock_structures::molecule::{InputSpec, ReadOptions, read};
use program::succeed;
use serde_json::Value;

fn example(name: &str) -> String {
    format!(
        "{}/structures/examples/1ppe_{name}.pdb",
        env!("CARGO_MANIFEST_DIR")
    )
}

/// Runs the program in a folder; it must succeed. Returns standard output and standard error.
fn run(folder: &Path, arguments: &[&str]) -> (String, String) {
    let output = succeed(folder, arguments.iter().copied());
    [output.stdout, output.stderr]
        .map(|bytes| String::from_utf8(bytes).unwrap())
        .into()
}

/// Docks and returns the JSON object with the bytes of the table.
fn dock(folder: &Path, receptor: &str, ligand: &str, options: &[&str]) -> (Value, String) {
    let mut arguments = vec!["dock", receptor, ligand, "-o", "run", "--force", "--json"];
    arguments.extend(options);
    let (object, _) = run(folder, &arguments);
    let table = fs::read_to_string(folder.join("run/poses.csv")).unwrap();
    (serde_json::from_str(&object).unwrap(), table)
}

/// An effect that is off changes not one bit, whatever its weight; one that is on does.
#[test]
fn an_effect_that_is_off_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let table = |options: &[&str]| {
        let mut all = vec!["--rotations", "24", "--poses", "40", "--refine", "5"];
        all.extend(options);
        dock(folder.path(), &receptor, &ligand, &all).1
    };
    let weights = [
        "--electrostatics-weight",
        "77",
        "--contact-weight",
        "3",
        "--ph",
        "2",
    ];
    let shape = table(&["--effects", "shape"]);
    let mut others = vec!["--effects", "shape"];
    others.extend(weights);
    assert_eq!(shape, table(&others));
    assert_ne!(shape, table(&["--effects", "shape,electrostatics"]));
    assert_ne!(shape, table(&["--effects", "shape,contact"]));
    // Columns of effects that are off are empty.
    let mut reader = csv::Reader::from_reader(shape.as_bytes());
    for row in reader.deserialize::<std::collections::BTreeMap<String, String>>() {
        let row = row.unwrap();
        assert_eq!(
            (row["electrostatics"].as_str(), row["contact"].as_str()),
            ("", "")
        );
    }
}

/// A protein pair turns everything on, and every reported row adds up and scores the same again.
#[test]
fn a_protein_pair_calls_for_all_and_a_reported_pose_scores_the_same_again() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let options = ["--rotations", "24", "--poses", "40", "--refine", "5"];
    let (object, _) = dock(folder.path(), &receptor, &ligand, &options);
    let effects = object["run"]["effects"].as_array().unwrap();
    let names: Vec<&Value> = effects.iter().map(|effect| &effect["effect"]).collect();
    assert_eq!(names, ["shape", "electrostatics", "contact", "restraint"]);
    // Neither is an antibody.
    for effect in effects {
        assert_eq!(effect["on"], effect["effect"] != "restraint", "{effect}");
    }
    // Bovine trypsin has 14 lysines and 2 arginines against 6 aspartates and 4 glutamates; its ends cancel.
    assert_eq!(object["run"]["plan"]["labels"][0]["net_charge"], 6.0);
    let number = |value: &Value| value.as_f64().unwrap();
    for row in object["best"].as_array().unwrap().iter().take(1) {
        let terms = ["shape", "electrostatics", "contact"].map(|name| number(&row[name]));
        let score = number(&row["score"]);
        assert!((terms.iter().sum::<f64>() - score).abs() < 1e-9 * score.abs());
        let pose: Vec<String> = ["qw", "qx", "qy", "qz", "tx", "ty", "tz"]
            .iter()
            .map(|part| row[part].to_string())
            .collect();
        let pose = pose.join(",");
        let (again, _) = run(
            folder.path(),
            &["score", &receptor, &ligand, "--pose", &pose, "--json"],
        );
        let again: Value = serde_json::from_str(&again).unwrap();
        assert!((number(&again["exact"]) - score).abs() < 1e-6 * score.abs());
        for (name, term) in ["shape", "electrostatics", "contact"].iter().zip(terms) {
            assert!((number(&again["terms"][name]) - term).abs() < 1e-6 * score.abs());
        }
        for name in [
            "fine_contact",
            "atom_pair",
            "relaxed",
            "attraction",
            "missing",
            "chain_ends",
            "rank_score",
        ] {
            assert!((number(&again[name]) - number(&row[name])).abs() < 1e-6 * score.abs());
        }
        assert_eq!(
            number(&row["rank_score"]),
            score
                + (number(&row["fine_contact"])
                    + number(&row["atom_pair"])
                    + number(&row["relaxed"])
                    + number(&row["attraction"])
                    + number(&row["missing"])
                    + number(&row["chain_ends"]))
        );
    }
}

/// Atoms that lie past the ends of the other side's chain cost their weight each, of whatever effects; scores stay as they were.
#[test]
fn what_lies_where_residues_are_missing_costs() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let table = |weight: &str| {
        let options = ["--rotations", "24", "--effects", "shape", "--no-cluster"];
        let more = ["--refine", "0", "--missing-weight", weight];
        let none = ["--chain-end-weight", "0"];
        let all = [&options[..], &more, &none].concat();
        let (object, table) = dock(folder.path(), &receptor, &ligand, &all);
        let missing = object["run"]["plan"]["missing_residues"][0].clone();
        let mut reader = csv::Reader::from_reader(table.as_bytes());
        let rows = reader.deserialize().map(|row| row.unwrap());
        let rows: Vec<std::collections::BTreeMap<String, String>> = rows.collect();
        (rows, missing)
    };
    let (rows, told) = table("12.5");
    assert_eq!((&told["ends"], &told["balls"]), (&2.into(), &4.into()));
    let (plain, told) = table("0");
    assert_eq!(told["balls"], 0);
    assert!(plain.iter().all(|row| row["missing"].is_empty()));
    let number = |row: &std::collections::BTreeMap<String, String>, name: &str| -> f64 {
        row[name].parse().unwrap()
    };
    let mut met = 0;
    for row in &rows {
        let missing = number(row, "missing");
        assert!(missing <= 0.0 && (missing / 12.5).fract() == 0.0);
        assert_eq!(number(row, "rank_score"), number(row, "score") + missing);
        met += usize::from(missing < 0.0);
    }
    assert!(met > 0 && met < rows.len(), "{met} of {}", rows.len());
    let scores = |rows: &[std::collections::BTreeMap<String, String>]| {
        let mut scores: Vec<String> = rows.iter().map(|row| row["score"].clone()).collect();
        scores.sort();
        scores
    };
    assert_eq!(scores(&rows), scores(&plain));
}

/// Atoms of the first and last residues of a chain that touch the other side cost their weight each: as many as all pairs of atoms tell.
#[test]
fn contacts_of_ends_of_chains_cost() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let options = "--rotations 24 --effects shape --no-cluster --refine 0 --missing-weight 0 --chain-end-weight 3";
    let options: Vec<&str> = options.split(' ').collect();
    let (object, table) = dock(folder.path(), &receptor, &ligand, &options);
    let plan = &object["run"]["plan"];
    assert_eq!(plan["chain_ends"][0]["residues"], 16);
    assert_eq!(plan["chain_ends"][1]["residues"], 2);
    assert_eq!(plan["missing_residues"][0]["ends"], 0);
    // Of 223 residues eight are near each end, of 29 one; no number of these two files comes twice.
    let atoms = |file: &str, near: usize| -> Vec<([f64; 3], bool)> {
        let text = std::fs::read_to_string(file).unwrap();
        let lines: Vec<&str> = text
            .lines()
            .filter(|line| line.starts_with("ATOM"))
            .collect();
        let mut residues: Vec<&str> = lines.iter().map(|line| &line[22..27]).collect();
        residues.dedup();
        let ends = [&residues[..near], &residues[residues.len() - near..]].concat();
        let coordinate = |line: &str, from: usize| line[from..from + 8].trim().parse().unwrap();
        let atom = |line: &&str| {
            let position = [30, 38, 46].map(|from| coordinate(line, from));
            (position, ends.contains(&&line[22..27]))
        };
        lines.iter().map(atom).collect()
    };
    let (fixed, moving) = (atoms(&receptor, 8), atoms(&ligand, 1));
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let mut met = 0;
    for row in reader.deserialize().take(30) {
        let row: std::collections::BTreeMap<String, String> = row.unwrap();
        let number = |name: &str| -> f64 { row[name].parse().unwrap() };
        let quaternion = ["qw", "qx", "qy", "qz"].map(number);
        let pose = Pose::from_parts(quaternion, ["tx", "ty", "tz"].map(number));
        let placed: Vec<([f64; 3], bool)> = moving
            .iter()
            .map(|(position, end)| (pose.apply(*position), *end))
            .collect();
        let touches = |atom: &[f64; 3], others: &[([f64; 3], bool)]| {
            others.iter().any(|(other, _)| {
                let squares = (0..3).map(|axis| (atom[axis] - other[axis]).powi(2));
                squares.sum::<f64>() < 25.0
            })
        };
        let touching = |own: &[([f64; 3], bool)], others: &[([f64; 3], bool)]| {
            own.iter()
                .filter(|(atom, end)| *end && touches(atom, others))
                .count()
        };
        let atoms = touching(&fixed, &placed) + touching(&placed, &fixed);
        assert_eq!(number("chain_ends"), -3.0 * atoms as f64);
        assert_eq!(number("rank_score"), number("score") + number("chain_ends"));
        met += usize::from(atoms > 0);
    }
    assert!(met > 0, "no pose touches an end");
}

/// Rescoring follows the contact effect and its own weight, ranks by the sum, and leaves every pose's score as it was.
#[test]
fn rescoring_orders_poses_and_changes_no_score() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let table = |options: &[&str]| {
        let mut all = vec!["--rotations", "24", "--poses", "40", "--no-cluster"];
        all.extend(["--peptidase-weight", "0", "--missing-weight", "0"]);
        all.extend(["--chain-end-weight", "0"]);
        all.extend(options);
        let (_, table) = dock(folder.path(), &receptor, &ligand, &all);
        let mut reader = csv::Reader::from_reader(table.as_bytes());
        reader
            .deserialize()
            .map(|row| row.unwrap())
            .collect::<Vec<std::collections::BTreeMap<String, String>>>()
    };
    let number = |row: &std::collections::BTreeMap<String, String>, name: &str| -> f64 {
        row[name].parse().unwrap()
    };
    const TERMS: [(&str, &str); 3] = [
        ("--fine-contact-weight", "fine_contact"),
        ("--atom-pair-weight", "atom_pair"),
        ("--relaxed-weight", "relaxed"),
    ];
    let weighed = |weights: [&str; 3]| {
        let options = TERMS.iter().zip(weights);
        let options = options.flat_map(|((option, _), weight)| [*option, weight]);
        table(&options.collect::<Vec<_>>())
    };
    let (plain, once, twice) = (weighed(["0"; 3]), weighed(["1"; 3]), weighed(["2"; 3]));
    for row in plain.iter().chain(&table(&["--effects", "shape"])) {
        for (_, term) in TERMS {
            assert_eq!(
                (row[term].as_str(), &row["rank_score"]),
                ("", &row["score"])
            );
        }
    }
    // By default all.
    assert_eq!(table(&[]), weighed(["2", "1", "3"]));
    // Each term by itself.
    for (on, (_, only)) in TERMS.iter().enumerate() {
        let weights = std::array::from_fn(|term| if term == on { "2" } else { "0" });
        for row in weighed(weights) {
            for (term, (_, name)) in TERMS.iter().enumerate() {
                assert_eq!(row[*name].is_empty(), term != on);
            }
            assert_eq!(
                number(&row, "rank_score"),
                number(&row, "score") + number(&row, only)
            );
        }
    }
    let mut moved = 0;
    for row in &twice {
        let same = |other: &&std::collections::BTreeMap<String, String>| {
            ["rotation", "tx", "ty", "tz"]
                .iter()
                .all(|name| other[*name] == row[*name])
        };
        let (before, half) = (
            plain.iter().find(same).unwrap(),
            once.iter().find(same).unwrap(),
        );
        assert_eq!(before["score"], row["score"]);
        moved += usize::from(before["rank"] != row["rank"]);
        let mut all = 0.0;
        for (_, term) in TERMS {
            let (one, two) = (number(half, term), number(row, term));
            assert!(one != 0.0 && (two - 2.0 * one).abs() < 1e-9 * two.abs());
            all += two;
        }
        assert_eq!(number(row, "rank_score"), number(row, "score") + all);
    }
    assert!(moved > 0, "rescoring must matter");
    assert!(
        twice
            .windows(2)
            .all(|pair| number(&pair[0], "rank_score") >= number(&pair[1], "rank_score"))
    );
}

/// A ligand without amino acids has no contact types, and one of neutral atoms no charges: auto leaves them off and says why, and to
/// force them is an error.
#[test]
fn what_the_inputs_cannot_feed_is_off_and_cannot_be_forced() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("receptor.pdb"), molecules::receptor()).unwrap();
    let atoms: String = (1..=12)
        .map(|k| {
            let angle = f64::from(k) * std::f64::consts::FRAC_PI_6;
            let (x, y) = (2.6 * angle.cos(), 2.6 * angle.sin());
            format!(
                "HETATM{k:5} C{k:<2}  LIG A   1    {x:8.3}{y:8.3}{:8.3}  1.00  0.00           C\n",
                0.0
            )
        })
        .collect();
    fs::write(folder.path().join("ring.pdb"), atoms + "END\n").unwrap();
    fs::write(folder.path().join("helix.pdb"), molecules::ligand()).unwrap();
    let options = ["--rotations", "8", "--poses", "10", "--refine", "0"];
    let (object, _) = dock(folder.path(), "receptor.pdb", "helix.pdb", &options);
    for effect in object["run"]["effects"].as_array().unwrap() {
        assert_eq!(effect["on"], effect["effect"] != "restraint", "{effect}");
    }
    let (object, _) = dock(folder.path(), "receptor.pdb", "ring.pdb", &options);
    for effect in &object["run"]["effects"].as_array().unwrap()[1..3] {
        assert_eq!(effect["on"], false);
        assert!(
            effect["reason"].as_str().unwrap().contains("ligand"),
            "{effect}"
        );
        assert_eq!(effect["rank"], 0);
    }
    for name in ["electrostatics", "contact"] {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(["dock", "receptor.pdb", "ring.pdb", "-o", "forced", "--json"])
            .args(["--effects", name])
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
        let error: Value = serde_json::from_slice(&output.stdout).unwrap();
        let message = error["error"]["message"].as_str().unwrap();
        assert!(
            message.contains(name) && message.contains("ligand"),
            "{message}"
        );
        assert!(!folder.path().join("forced").exists());
    }
}

/// Blocked residues cost what touches them, attracted ones draw poses, in the search, in the table and in `score`; what cannot be named is an error.
#[test]
fn named_residues_are_kept_free_or_touched() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let rows = |options: &[&str]| {
        let mut all = vec!["--rotations", "48", "--poses", "40"];
        all.extend(options);
        let (object, _) = dock(folder.path(), &receptor, &ligand, &all);
        object["best"].as_array().unwrap().clone()
    };
    let number = |value: &Value| value.as_f64().unwrap();
    // Trypsin's loops about its active site, where the inhibitor goes: what they cost an interface if it touches them.
    let sites = "A:57,A:95-99,A:189-195,A:214-220";
    let options = DockOptions {
        block_receptor: Some(sites.parse().unwrap()),
        ..DockOptions::default()
    };
    let [own, other] = [&receptor, &ligand].map(|path| {
        let input = InputSpec::parse(path).unwrap();
        read(&input, &ReadOptions::default()).unwrap()
    });
    let scene = Scene::new(&own, &other, &options).unwrap();
    let (engine, terms) = (options.engine(), scene.terms.clone());
    let plan = Plan::with_effects(
        &scene.receptor,
        &scene.ligand,
        engine,
        engine.tolerance,
        terms,
    )
    .unwrap();
    let scorer =
        ExactScorer::with_effects(&plan.kernel, &scene.receptor, &scene.ligand, &plan.effects)
            .unwrap();
    let pose = |row: &Value| {
        let quaternion = ["qw", "qx", "qy", "qz"].map(|part| number(&row[part]));
        Pose::from_parts(
            quaternion,
            ["tx", "ty", "tz"].map(|part| number(&row[part])),
        )
    };
    let cost = |row: &Value| scorer.score(&pose(row)).terms[Effect::Restraint as usize];
    let free = rows(&["--peptidase-weight", "0"]);
    let blocked = rows(&["--block-receptor", sites]);
    assert!(free.iter().all(|row| row["restraint"].is_null()));
    for row in &blocked {
        let own = number(&row["restraint"]);
        assert!((cost(row) - own).abs() < 1e-6 * number(&row["score"]).abs());
    }
    let mean = |rows: &[Value]| rows.iter().map(&cost).sum::<f64>() / rows.len() as f64;
    let (before, after) = (mean(&free), mean(&blocked));
    assert!(after > 0.4 * before && before < -100.0, "{before} {after}");

    // Fourteen residues attract, which the inhibitor cannot all reach.
    let drawn = rows(&["--attract-receptor", sites, "--attraction-weight", "4000"]);
    let attracting = DockOptions {
        attract_receptor: options.block_receptor.clone(),
        attraction_weight: 1.0,
        ..DockOptions::default()
    };
    let scene = Scene::new(&own, &other, &attracting).unwrap();
    let rescorer = scene.rescorer(&attracting).unwrap();
    let met = |row: &Value| {
        let rescored = rescorer.score(&pose(row), &mut Workspace::default());
        rescored.attraction.unwrap()
    };
    for row in &drawn {
        assert!((4000.0 * met(row) - number(&row["attraction"])).abs() < 1e-9);
        assert!(number(&row["restraint"]) > 0.0);
    }
    assert!(free.iter().all(|row| row["attraction"].is_null()));
    let mean = |rows: &[Value]| rows.iter().map(&met).sum::<f64>() / rows.len() as f64;
    let (before, after) = (mean(&free), mean(&drawn));
    assert!(after > 0.6 && after > before + 0.1, "{before} {after}");

    for (options, said) in [
        (&["--block-ligand", "Z:1"][..], "block-ligand is Z:1"),
        (&["--attract-ligand", "Z:1"], "attract-ligand is Z:1"),
        (&["--block-receptor", "A:9000"], "among A:"),
        (&["--effects", "restraint"], "there can be no restraint"),
        (
            &["--effects", "shape", "--block-receptor", sites],
            "name restraint too",
        ),
    ] {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(["dock", &receptor, &ligand, "-o", "refused", "--json"])
            .args(options)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
        let error: Value = serde_json::from_slice(&output.stdout).unwrap();
        let message = error["error"]["message"].as_str().unwrap();
        assert!(message.contains(said), "{message}");
        assert!(!folder.path().join("refused").exists());
    }
}

/// Trypsin's active site counts in the ranking and nowhere else; whoever asks is told of it.
#[test]
fn the_active_site_of_a_peptidase_ranks_poses_and_moves_none() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let rows = |weight: &str| {
        let options = [
            "--rotations",
            "48",
            "--poses",
            "40",
            "--no-cluster",
            "--peptidase-weight",
            weight,
        ];
        let (object, table) = dock(folder.path(), &receptor, &ligand, &options);
        let mut reader = csv::Reader::from_reader(table.as_bytes());
        let rows: Vec<std::collections::BTreeMap<String, String>> =
            reader.deserialize().map(|row| row.unwrap()).collect();
        (object["run"]["active_site"].clone(), rows)
    };
    let (none, plain) = rows("0");
    let (site, ranked) = rows("1000");
    assert!(none.is_null());
    assert_eq!(site["partner"], "receptor");
    assert_eq!(site["sites"][0]["family"], "S1");
    assert_eq!(
        site["sites"][0]["residues"],
        serde_json::json!(["A:57", "A:195"])
    );
    let (told, words) = run(
        folder.path(),
        &[
            "score",
            &receptor,
            &ligand,
            "--pose",
            "1,0,0,0,0,0,0",
            "--json",
        ],
    );
    let told: Value = serde_json::from_str(&told).unwrap();
    assert_eq!(told["active_site"], site);
    assert!(words.contains("family S1 like trypsin (catalytic A:57, A:195)"));
    let number = |text: &String| text.parse::<f64>().unwrap();
    let place = |row: &std::collections::BTreeMap<String, String>| {
        let parts = ["rotation", "tx", "ty", "tz", "score", "relaxed"];
        parts.map(|part| row[part].clone())
    };
    let sorted = |rows: &[std::collections::BTreeMap<String, String>]| {
        let mut places: Vec<_> = rows.iter().map(place).collect();
        places.sort();
        places
    };
    assert_eq!(sorted(&plain), sorted(&ranked));
    assert!(plain.iter().all(|row| row["attraction"].is_empty()));
    let mut seen = std::collections::BTreeSet::new();
    for row in &ranked {
        let own = plain.iter().find(|other| place(other) == place(row));
        let before = number(&own.unwrap()["rank_score"]);
        let earned = number(&row["attraction"]);
        assert!((number(&row["rank_score"]) - before - earned).abs() < 1e-9 * before.abs());
        seen.insert(row["attraction"].clone());
    }
    // None, one or both of the two residues touch.
    let shares = ["0", "500", "1000"].map(str::to_owned);
    assert!(seen.iter().all(|share| shares.contains(share)), "{seen:?}");
    assert!(seen.len() > 1, "{seen:?}");
}
