//! Content of the table, for any number of threads and with a finer search.

use std::collections::BTreeMap;
use std::fs;

use assert_cmd::cargo::cargo_bin_cmd;
use knotdock_scoring::se3::Pose;
use serde_json::Value;

use super::run::*;

const HEADER: &str = "rank,score,cluster,cluster_size,pose_score,search_score,shape,electrostatics,contact,restraint,\
                      fine_contact,atom_pair,relaxed,active_residues,unresolved,termini,other_copies,sharp,sharp_energy,sharp_clashes,z_score,\
                      qw,qx,qy,qz,tx,ty,tz";
const DIAGNOSTICS: &str =
    "cluster_score,refined,rotation,score_grid,score_unfiltered,slice_0,slice_r0,slice_2r0";

#[test]
fn the_table_says_what_its_columns_promise() {
    let folder = place();
    run(
        folder.path(),
        "dock receptor.pdb ligand.pdb --rotations 60 --no-cluster --diagnostics -o run --quiet",
    );
    let run = folder.path().join("run");
    let text = fs::read_to_string(run.join("poses.csv")).unwrap();
    assert_eq!(
        text.lines().next(),
        Some(format!("{HEADER},{DIAGNOSTICS},complex_clashes").as_str())
    );
    assert!(!text.contains('\r') && !text.contains("NaN"));
    let rows = rows(&run);
    assert!(!rows.is_empty());
    let (lambda, best) = (9.0, number(&rows[0], "search_score").abs());
    let mut last = f64::INFINITY;
    for (index, row) in rows.iter().enumerate() {
        assert_eq!(row["rank"], (index + 1).to_string());
        let score = number(row, "search_score");
        let ranked = number(row, "pose_score");
        assert!(ranked <= last, "ranks must follow pose scores");
        assert_eq!(number(row, "score"), ranked, "poses are rows");
        last = ranked;
        let length: f64 = ["qw", "qx", "qy", "qz"]
            .map(|part| number(row, part).powi(2))
            .iter()
            .sum();
        assert!((length - 1.0).abs() < 1e-12 && number(row, "qw") >= 0.0);
        // Behandish & Ilies' score with its sign: the slices alone give the shape term.
        let shape = -lambda * lambda * number(row, "slice_0")
            + 2.0 * lambda * number(row, "slice_r0")
            - number(row, "slice_2r0");
        assert!((shape - number(row, "shape")).abs() <= 1e-9 * best);
        let terms = number(row, "shape") + number(row, "electrostatics") + number(row, "contact");
        assert!((score - terms).abs() <= 1e-9 * best);
        let rescored = ["fine_contact", "atom_pair", "relaxed"].map(|term| number(row, term));
        let ranked_by = number(row, "pose_score") - rescored.iter().sum::<f64>();
        assert!((score - ranked_by).abs() <= 1e-9 * best);
        // Shortest digits: printing what was read gives the field back.
        for column in ["score", "search_score", "qx", "tx", "score_grid", "slice_0"] {
            assert_eq!(number(row, column).to_string(), row[column]);
        }
    }
}

/// A table by shape alone names a place once: no row lies within a step of the search of a better refined one of its
/// cluster. Rows that lie little farther are kept. A step is a turn by the covering radius and a shift by the
/// spacing, as RMSD of the ligand's CA atoms. Clusters are so wide here that the step decides.
#[test]
fn refined_rows_stand_for_what_lies_within_a_step() {
    let folder = place();
    run(
        folder.path(),
        "dock receptor.pdb ligand.pdb --effects shape --rotations 600 --poses 400 --refine 300 --cluster-radius 30 \
         --no-cluster --diagnostics --write-top 0 -o run --quiet",
    );
    let run = folder.path().join("run");
    let record: Value = serde_json::from_slice(&fs::read(run.join("run.json")).unwrap()).unwrap();
    let plan = |name: &str| record["plan"][name].as_f64().unwrap();
    let ligand = crate::molecules::ligand();
    let alphas: Vec<[f64; 3]> = ligand
        .lines()
        .filter(|line| line.get(12..16) == Some(" CA "))
        .map(|line| [30, 38, 46].map(|at| line[at..at + 8].trim().parse().unwrap()))
        .collect();
    assert!(alphas.len() >= 3);
    let mean_square = |a: &[[f64; 3]], b: &dyn Fn(usize, usize) -> f64| {
        let square = |(i, x): (usize, &[f64; 3])| -> f64 {
            (0..3).map(|axis| (x[axis] - b(i, axis)).powi(2)).sum()
        };
        a.iter().enumerate().map(square).sum::<f64>() / a.len() as f64
    };
    let middle = [0, 1, 2].map(|k| alphas.iter().map(|x| x[k]).sum::<f64>() / alphas.len() as f64);
    let gyration = mean_square(&alphas, &|_, axis| middle[axis]);
    let turn = plan("covering_radius_degrees").to_radians();
    let step = (plan("spacing").powi(2) + 4.0 / 3.0 * (1.0 - turn.cos()) * gyration).sqrt();
    let rows = rows(&run);
    let placed: Vec<Vec<[f64; 3]>> = rows
        .iter()
        .map(|row| {
            let pose = Pose::from_parts(
                ["qw", "qx", "qy", "qz"].map(|part| number(row, part)),
                ["tx", "ty", "tz"].map(|part| number(row, part)),
            );
            alphas.iter().map(|&x| pose.apply(x)).collect()
        })
        .collect();
    let mut nearest = f64::INFINITY;
    for (index, row) in rows.iter().enumerate() {
        for better in 0..index {
            let other = &rows[better];
            if other["cluster"] == row["cluster"] && other["refined"] == "true" {
                let distance =
                    mean_square(&placed[index], &|i, axis| placed[better][i][axis]).sqrt();
                nearest = nearest.min(distance);
            }
        }
    }
    println!("{} rows, step {step}, nearest {nearest}", rows.len());
    assert!(rows.iter().any(|row| row["refined"] == "false"));
    assert!(
        nearest > step && nearest < 1.1 * step,
        "{nearest} of {step}"
    );
}

#[test]
fn one_row_a_cluster_is_the_first_of_each_of_all_poses() {
    let folder = place();
    let dock = "dock receptor.pdb ligand.pdb --rotations 60 --quiet --write-top 0";
    run(
        folder.path(),
        &format!("{dock} --no-cluster --diagnostics -o all"),
    );
    run(folder.path(), &format!("{dock} --exact all -o clusters"));
    let mut seen = std::collections::HashSet::new();
    let mut firsts = rows(&folder.path().join("all"));
    firsts.retain(|row| seen.insert(row["cluster"].clone()));
    firsts.sort_by_key(|row| row["cluster"].parse::<usize>().unwrap());
    for row in &firsts {
        let excess = number(row, "cluster_score") - number(row, "pose_score");
        assert_eq!(excess > 1e-9, row["cluster_size"] != "1", "company counts");
    }
    let path = folder.path().join("clusters/poses.csv");
    let text = fs::read_to_string(path).unwrap();
    assert_eq!(text.lines().next(), Some(HEADER));
    let clusters = rows(&folder.path().join("clusters"));
    assert!(clusters.len() > 1 && clusters.len() < rows(&folder.path().join("all")).len());
    for (index, row) in clusters.iter().enumerate() {
        assert_eq!(
            row["cluster"],
            (index + 1).to_string(),
            "best cluster first"
        );
    }
    // Of a table of clusters the score is the cluster's; the rest is its best pose's.
    let diagnostics: Vec<&str> = DIAGNOSTICS.split(',').collect();
    for row in firsts.iter_mut() {
        row.insert("rank".to_owned(), row["cluster"].clone());
        row.insert("score".to_owned(), row["cluster_score"].clone());
        row.retain(|column, _| !diagnostics.contains(&column.as_str()));
    }
    assert_eq!(firsts, clusters);
}

/// In double precision the fast path meets tolerances that are refused in single precision, and its ranking is the
/// same.
#[test]
fn double_precision_goes_where_single_cannot() {
    let folder = place();
    let dock = |options: &str, name: &str| {
        run(
            folder.path(),
            &format!(
                "dock receptor.pdb ligand.pdb --rotations 8 --per-rotation 1 --no-cluster --effects shape --diagnostics {options} \
                 -o {name} --quiet"
            ),
        );
        let record = fs::read(folder.path().join(name).join("run.json")).unwrap();
        let record: Value = serde_json::from_slice(&record).unwrap();
        let worst = record["error"]["worst"].as_f64().unwrap();
        (rows(&folder.path().join(name)), worst)
    };
    let (single, worst) = dock("--tolerance 1e-4", "single");
    assert!(worst <= 1e-4, "{worst:e}");
    let (double, worst) = dock("--tolerance 1e-4 --precision double", "double");
    assert!(worst <= 1e-4, "{worst:e}");
    let best = number(&single[0], "score_grid").abs();
    assert_eq!(single.len(), double.len());
    let mut exact_digits = 0;
    for (one, other) in single.iter().zip(&double) {
        let [one, other] = [one, other].map(|row| number(row, "score_grid"));
        assert!((one - other).abs() < 1e-5 * best);
        // Widened single precision has few digits.
        exact_digits += usize::from(f64::from(other as f32) == other);
    }
    assert!(exact_digits < double.len() / 2, "double in name only");
    let (_, worst) = dock("--tolerance 1e-6 --precision double", "finest");
    assert!(worst <= 1e-6, "{worst:e}");
    let refused = |options: &str| {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args("dock receptor.pdb ligand.pdb -o refused".split(' '))
            .args(options.split(' '))
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(refused("--tolerance 1e-5").contains("--precision double"));
    assert!(refused("--tolerance 1e-7 --precision double").contains("1e-6 or more"));
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let folder = place();
    let dock = "dock receptor.pdb ligand.pdb --rotations 60 --quiet --write-top 3";
    run(folder.path(), &format!("{dock} --threads 1 -o one"));
    run(folder.path(), &format!("{dock} --threads 2 -o two"));
    run(
        folder.path(),
        &format!("{dock} --threads 5 --memory 1G -o five"),
    );
    let one = comparable(&folder.path().join("one"));
    assert_eq!(one.len(), 9, "{:?}", one.keys());
    assert_eq!(one, comparable(&folder.path().join("two")));
    assert_eq!(one, comparable(&folder.path().join("five")));
}

/// A finer search can only find better peaks in the cells that it searches, keeps the number of poses, and says where
/// each came from.
#[test]
fn a_finer_search_about_the_best_rotations() {
    let folder = place();
    let dock = |more: &str| {
        let arguments = "dock receptor.pdb ligand.pdb --rotations 60 --poses 60 --no-cluster --diagnostics --quiet";
        run(folder.path(), &format!("{arguments} {more}"));
    };
    dock("-o coarse");
    dock("-o fine --fine-rotations 480 --fine-share 0.2 --threads 1");
    dock("-o again --fine-rotations 480 --fine-share 0.2 --threads 2");
    let [coarse, fine, again] =
        ["coarse", "fine", "again"].map(|name| comparable(&folder.path().join(name)));
    assert_eq!(fine, again);
    let [coarse_rows, fine_rows] = ["coarse", "fine"].map(|name| rows(&folder.path().join(name)));
    assert_eq!(coarse_rows.len(), fine_rows.len());
    let best = |rows: &[BTreeMap<String, String>]| {
        let scores = rows.iter().map(|row| number(row, "score_grid"));
        scores.fold(f64::NEG_INFINITY, f64::max)
    };
    assert!(best(&fine_rows) > best(&coarse_rows));
    let finer = |row: &&BTreeMap<String, String>| number(row, "rotation") >= 60.0;
    assert!(fine_rows.iter().any(|row| finer(&row)) && !fine_rows.iter().all(|row| finer(&row)));
    assert!(coarse_rows.iter().all(|row| !finer(&row)));
    // Grid poses of finer rotations score what the fast path said, to its tolerance.
    let scale = best(&fine_rows);
    for row in fine_rows.iter().filter(finer).take(20) {
        let difference = number(row, "score_grid") - number(row, "search_score");
        assert!(difference.abs() < 0.02 * scale, "{row:?}");
    }
    let record = |files: &BTreeMap<String, Vec<u8>>| -> Value {
        serde_json::from_slice(&files["run.json"]).unwrap()
    };
    let searched = &record(&fine)["finer_search"];
    assert!((96..160).contains(&searched["rotations"].as_u64().unwrap()));
    assert!(record(&coarse)["finer_search"].is_null());
}
