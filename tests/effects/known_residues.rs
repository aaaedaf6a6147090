//! Residues that are known to touch or not, and active sites.

use super::*;

/// Contacts of blocked residues cost and active residues draw poses, in the search, the table and `score`. Unknown
/// names are errors.
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
    let options = DockOptions::default()
        .changed(|options| options.restraints.block_receptor = Some(sites.parse().unwrap()));
    let [own, other] = [&receptor, &ligand].map(|path| {
        let input = InputSpec::parse(path).unwrap();
        read(&input, &ReadOptions::default()).unwrap()
    });
    let scene = Scene::new(&own, &other, &options).unwrap();
    let (engine, terms) = (options.kernel.engine(), scene.terms.clone());
    let plan = Plan::with_effects(
        &scene.receptor,
        &scene.ligand,
        engine,
        engine.tolerance,
        terms,
    )
    .unwrap();
    let scorer = ExactScorer::with_effects(
        plan.kernel(),
        &scene.receptor,
        &scene.ligand,
        plan.effects(),
    )
    .unwrap();
    let pose = |row: &Value| {
        let quaternion = ["qw", "qx", "qy", "qz"].map(|part| number(&row[part]));
        Pose::from_parts(
            quaternion,
            ["tx", "ty", "tz"].map(|part| number(&row[part])),
        )
    };
    let cost = |row: &Value| scorer.score(&pose(row)).terms[Effect::Restraint as usize];
    let free = rows(&["--config", "restraints.peptidase_weight=0"]);
    let blocked = rows(&["--block-receptor", sites]);
    assert!(free.iter().all(|row| row["restraint"].is_null()));
    for row in &blocked {
        let own = number(&row["restraint"]);
        assert!((cost(row) - own).abs() < 1e-6 * number(&row["search_score"]).abs());
    }
    let mean = |rows: &[Value]| rows.iter().map(&cost).sum::<f64>() / rows.len() as f64;
    let (before, after) = (mean(&free), mean(&blocked));
    assert!(after > 0.4 * before && before < -100.0, "{before} {after}");

    // Fourteen residues are active, which the inhibitor cannot all reach.
    let drawn = rows(&[
        "--active-receptor",
        sites,
        "--config",
        "terms.active_weight=4000",
    ]);
    let attracting = DockOptions::default().changed(|attracting| {
        attracting.restraints.active_receptor = options.restraints.block_receptor.clone();
        attracting.terms.active_weight = 1.0;
    });
    let scene = Scene::new(&own, &other, &attracting).unwrap();
    let rescorer = scene.rescorer(&attracting).unwrap();
    let met = |row: &Value| {
        let rescored = rescorer.score(&pose(row), &mut Workspace::default());
        rescored.get("active_residues").unwrap()
    };
    for row in &drawn {
        assert!((4000.0 * met(row) - number(&row["active_residues"])).abs() < 1e-9);
        assert!(number(&row["restraint"]) > 0.0);
    }
    assert!(free.iter().all(|row| row["active_residues"].is_null()));
    let mean = |rows: &[Value]| rows.iter().map(&met).sum::<f64>() / rows.len() as f64;
    let (before, after) = (mean(&free), mean(&drawn));
    assert!(after > 0.6 && after > before + 0.1, "{before} {after}");

    for (options, said) in [
        (&["--block-ligand", "Z:1"][..], "block-ligand is Z:1"),
        (&["--active-ligand", "Z:1"], "active-ligand is Z:1"),
        (&["--block-receptor", "A:9000"], "among A:"),
        (&["--effects", "restraint"], "restraint cannot be scored"),
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

/// Trypsin's active site counts in the ranking and nowhere else, and reports name it.
#[test]
fn the_active_site_of_a_peptidase_ranks_poses_and_moves_none() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let rows = |weight: &str| {
        let weight = format!("restraints.peptidase_weight={weight}");
        let options = [
            "--rotations",
            "48",
            "--poses",
            "40",
            "--no-cluster",
            "--diagnostics",
            "--config",
            &weight,
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
    let (printed, words) = run(
        folder.path(),
        &[
            "score",
            &receptor,
            &ligand,
            "--pose",
            "1,0,0,0,0,0,0",
            // Few modes: sites do not depend on them, and the ladder takes most of the time.
            "--resolution",
            "20",
            "--json",
        ],
    );
    let scored: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(scored["active_site"], site);
    assert!(words.contains("family S1 like trypsin (catalytic A:57, A:195)"));
    let number = |text: &String| text.parse::<f64>().unwrap();
    let place = |row: &std::collections::BTreeMap<String, String>| {
        let parts = ["rotation", "tx", "ty", "tz", "search_score", "relaxed"];
        parts.map(|part| row[part].clone())
    };
    let sorted = |rows: &[std::collections::BTreeMap<String, String>]| {
        let mut places: Vec<_> = rows.iter().map(place).collect();
        places.sort();
        places
    };
    assert_eq!(sorted(&plain), sorted(&ranked));
    assert!(plain.iter().all(|row| row["active_residues"].is_empty()));
    let mut seen = std::collections::BTreeSet::new();
    for row in &ranked {
        let own = plain.iter().find(|other| place(other) == place(row));
        let before = number(&own.unwrap()["pose_score"]);
        let earned = number(&row["active_residues"]);
        assert!((number(&row["pose_score"]) - before - earned).abs() < 1e-9 * before.abs());
        seen.insert(row["active_residues"].clone());
    }
    // None, one or both of the two residues touch.
    let shares = ["0", "500", "1000"].map(str::to_owned);
    assert!(seen.iter().all(|share| shares.contains(share)), "{seen:?}");
    assert!(seen.len() > 1, "{seen:?}");
}
