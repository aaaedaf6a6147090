//! Rescoring of the poses that a search keeps.

use super::*;

/// Rescoring follows the contact effect and its own weight, ranks by the sum, and leaves every pose's score as it was.
#[test]
fn rescoring_orders_poses_and_changes_no_score() {
    let folder = tempfile::tempdir().unwrap();
    let (receptor, ligand) = (example("receptor_unbound"), example("ligand_unbound"));
    let table = |options: &[&str]| {
        let mut all = vec![
            "--rotations",
            "24",
            "--poses",
            "40",
            "--no-cluster",
            "--diagnostics",
            "--resolution",
            "8",
        ];
        all.extend(["--config", "restraints.peptidase_weight=0"]);
        all.extend(["--config", "terms.unresolved_weight=0"]);
        all.extend(["--config", "terms.termini_weight=0"]);
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
    const TERMS: [&str; 3] = ["fine_contact", "atom_pair", "relaxed"];
    let weighed = |weights: [&str; 3]| {
        let options = TERMS.iter().zip(weights);
        let options =
            options.map(|(term, weight)| format!("--config=terms.{term}_weight={weight}"));
        let options: Vec<String> = options.collect();
        table(&options.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let (plain, once, twice) = (weighed(["0"; 3]), weighed(["1"; 3]), weighed(["2"; 3]));
    for row in plain.iter().chain(&table(&["--effects", "shape"])) {
        for term in TERMS {
            assert_eq!(
                (row[term].as_str(), &row["pose_score"]),
                ("", &row["search_score"])
            );
        }
    }
    // By default all.
    assert_eq!(table(&[]), weighed(["2", "1", "3"]));
    // Each term by itself.
    for (on, only) in TERMS.iter().enumerate() {
        let weights = std::array::from_fn(|term| if term == on { "2" } else { "0" });
        for row in weighed(weights) {
            for (term, name) in TERMS.iter().enumerate() {
                assert_eq!(row[*name].is_empty(), term != on);
            }
            assert_eq!(
                number(&row, "pose_score"),
                number(&row, "search_score") + number(&row, only)
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
        assert_eq!(before["search_score"], row["search_score"]);
        moved += usize::from(before["rank"] != row["rank"]);
        let mut all = 0.0;
        for term in TERMS {
            let (one, two) = (number(half, term), number(row, term));
            assert!(one != 0.0 && (two - 2.0 * one).abs() < 1e-9 * two.abs());
            all += two;
        }
        assert_eq!(number(row, "pose_score"), number(row, "search_score") + all);
    }
    assert!(moved > 0, "rescoring must matter");
    assert!(
        twice
            .windows(2)
            .all(|pair| number(&pair[0], "pose_score") >= number(&pair[1], "pose_score"))
    );
}
