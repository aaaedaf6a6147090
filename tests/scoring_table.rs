//! Scores, terms, slices and ranks of the example and of six small cases against committed tables.
//!
//! `poses.csv` says which poses of which case are scored; `scores.csv` what came of it, with the rank of each pose
//! among its case's; `search.csv` the first poses of a small search. These are regression tables, our own output of
//! the day they were blessed; what can be known otherwise is tested as such below: closed forms, signs, sums.
//! `scripts/reference/pair_sum.py`, an independent witness, sums shape, slices, electrostatics and contact of every
//! pose in Python.
//!
//! What moved, by how much, and in which term: `cargo test -p knotdock-cli --test all scoring_table -- --nocapture`. After a change
//! that is meant: `KNOTDOCK_BLESS=1 cargo test -p knotdock-cli --test all scoring_table`, and say in the change what moved and why.
//! The cases are made by `scripts/reference/scoring_cases.py`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use knotdock::dock::scene::Scene;
use knotdock::options::DockOptions;
use knotdock::progress::NoProgress;
use knotdock_scoring::engine::Plan;
use knotdock_scoring::exact::{ExactScore, ExactScorer};
use knotdock_scoring::se3::Pose;
use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::terms::pose::{POSE_TERMS, TermValues, Workspace};
use knotdock_structures::molecule::{InputSpec, Molecule, ReadOptions, read};

/// What may move: this share of the largest magnitude of a column in its case. Sums run in f64 in one order; other
/// processors round otherwise.
const TOLERANCE: f64 = 1e-6;
/// The tolerance for values that the fast path computed in f32.
const FAST_TOLERANCE: f64 = 1e-4;
/// Rotations of the small searches, and poses of each that the table has.
const ROTATIONS: usize = 60;
const SEARCHED: usize = 5;
/// Cases that are searched: those without ties.
const SEARCHES: [&str; 4] = ["helices", "charged_helices", "nucleic", BLOCKED];
/// The helices once more, at the same poses, with residues of both sides blocked.
const BLOCKED: &str = "blocked_helices";

/// Columns of `scores.csv` between the effects and the pose terms.
const SLICES: [&str; 4] = ["slice_0", "slice_r0", "slice_2r0", "unfiltered"];

fn folder() -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("tests/scoring_table")
}

/// The options that a case is scored and searched with: the defaults but for blocked residues.
fn options(case: &str) -> DockOptions {
    let blocked = |residues: &str| (case == BLOCKED).then(|| residues.parse().unwrap());
    DockOptions::default().changed(|options| {
        options.restraints.block_receptor = blocked("A:1-8");
        options.restraints.block_ligand = blocked("A:6");
    })
}

fn molecules(case: &str) -> [Molecule; 2] {
    let case = if case == BLOCKED { "helices" } else { case };
    ["receptor", "ligand"].map(|side| {
        let path = if case == "example" {
            folder().join(format!("../../structures/examples/1ppe_{side}_unbound.pdb"))
        } else {
            folder().join(format!("cases/{case}_{side}.pdb"))
        };
        read(&InputSpec::whole(path), &ReadOptions::default()).unwrap()
    })
}

/// Poses of each case by number, in the order of the file.
fn poses() -> Vec<(String, Vec<(u32, Pose)>)> {
    let mut cases: Vec<(String, Vec<(u32, Pose)>)> = Vec::new();
    let mut table = csv::Reader::from_path(folder().join("poses.csv")).unwrap();
    for record in table.records() {
        let record = record.unwrap();
        let numbers: Vec<f64> = (2..9).map(|place| record[place].parse().unwrap()).collect();
        let [qw, qx, qy, qz, tx, ty, tz] = numbers[..] else {
            panic!("{record:?}");
        };
        let pose = Pose::from_parts([qw, qx, qy, qz], [tx, ty, tz]);
        if cases.last().is_none_or(|(case, _)| *case != record[0]) {
            cases.push((record[0].to_owned(), Vec::new()));
        }
        let (_, poses) = cases.last_mut().unwrap();
        poses.push((record[1].parse().unwrap(), pose));
    }
    let helices = cases.iter().find(|(case, _)| case == "helices");
    let blocked = (BLOCKED.to_owned(), helices.unwrap().1.clone());
    cases.push(blocked);
    cases
}

/// Which effects were on, and the exact score and pose terms of each pose.
fn scored(
    case: &str,
    poses: &[(u32, Pose)],
) -> ([bool; Effect::ALL.len()], Vec<ExactScore>, Vec<TermValues>) {
    let options = options(case);
    let [receptor, ligand] = molecules(case);
    let scene = Scene::new(&receptor, &ligand, &options).unwrap();
    let rescorer = scene.rescorer(&options);
    let rescored = |pose| {
        let workspace = &mut Workspace::default();
        rescorer.as_ref().map(|terms| terms.score(pose, workspace))
    };
    let rescored = poses
        .iter()
        .map(|(_, pose)| rescored(pose).unwrap_or_default())
        .collect();
    let Scene {
        receptor,
        ligand,
        terms,
        decisions,
        ..
    } = scene;
    let engine = options.kernel.engine();
    let plan = Plan::with_effects(&receptor, &ligand, engine, engine.tolerance, terms).unwrap();
    let scorer =
        ExactScorer::with_effects(plan.kernel(), &receptor, &ligand, plan.effects()).unwrap();
    let on = Effect::ALL.map(|effect| decisions.iter().any(|d| d.effect == effect && d.on));
    let scores = poses.iter().map(|(_, pose)| scorer.score(pose)).collect();
    (on, scores, rescored)
}

/// A table: case and number, then values by column; an empty field is a value that does not exist.
type Table = BTreeMap<(String, u32), Vec<Option<f64>>>;

fn read_table(name: &str) -> Table {
    let path = folder().join(name);
    let Ok(mut table) = csv::Reader::from_path(path) else {
        return Table::new();
    };
    let rows = table.records().map(|record| {
        let record = record.unwrap();
        let values = record.iter().skip(2).map(|field| field.parse().ok());
        (
            (record[0].to_owned(), record[1].parse().unwrap()),
            values.collect(),
        )
    });
    rows.collect()
}

fn write_table(name: &str, columns: &[&str], table: &Table) {
    let mut file = csv::Writer::from_path(folder().join(name)).unwrap();
    file.write_record(columns).unwrap();
    for ((case, number), values) in table {
        let mut record = vec![case.clone(), number.to_string()];
        record.extend(values.iter().map(|value| {
            value.map_or(String::new(), |value| {
                // Ten digits: a thousandth of the tolerance.
                format!("{}", format!("{value:.9e}").parse::<f64>().unwrap() + 0.0)
            })
        }));
        file.write_record(record).unwrap();
    }
    file.flush().unwrap();
}

/// What moved, a line each, with a summary by column.
fn moved(columns: &[&str], expected: &Table, found: &Table, tolerance: &[f64]) -> Vec<String> {
    let mut lines = Vec::new();
    let mut by_column: BTreeMap<&str, (usize, f64)> = BTreeMap::new();
    let keys: BTreeSet<_> = found.keys().chain(expected.keys()).collect();
    for key in keys {
        let (Some(was), Some(is)) = (expected.get(key), found.get(key)) else {
            let place = if found.contains_key(key) {
                "new"
            } else {
                "gone"
            };
            lines.push(format!("{} {}: {place}", key.0, key.1));
            continue;
        };
        for (place, name) in columns.iter().skip(2).enumerate() {
            let case = found.iter().filter(|((case, _), _)| *case == key.0);
            let scale = case
                .filter_map(|(_, values)| values.get(place).copied().flatten())
                .fold(0.0f64, |scale, value| scale.max(value.abs()));
            let (was, is) = (
                was.get(place).copied().flatten(),
                is.get(place).copied().flatten(),
            );
            let off = match (was, is) {
                (None, None) => continue,
                (Some(was), Some(is)) => is - was,
                _ => f64::INFINITY,
            };
            if off.abs() <= tolerance[place] * scale {
                continue;
            }
            let share = off.abs() / scale;
            let entry = by_column.entry(name).or_default();
            *entry = (entry.0 + 1, entry.1.max(share));
            let show = |value: Option<f64>| value.map_or("none".to_owned(), |v| format!("{v:.6}"));
            lines.push(format!(
                "{} {}: {name} {} -> {} ({off:+.3e}, {:.2e} of the case's largest)",
                key.0,
                key.1,
                show(was),
                show(is),
                share
            ));
        }
    }
    for (name, (count, worst)) in by_column {
        lines.push(format!(
            "in all: {name} moved in {count} rows, by at most {worst:.2e} of the case's largest"
        ));
    }
    lines
}

fn check(name: &str, columns: &[&str], found: &Table, tolerance: &[f64]) {
    let lines = moved(columns, &read_table(name), found, tolerance);
    for line in &lines {
        println!("{name}: {line}");
    }
    if std::env::var_os("KNOTDOCK_BLESS").is_some() {
        write_table(name, columns, found);
        println!("{name} blessed");
        return;
    }
    assert!(
        lines.is_empty(),
        "{} moves in tests/scoring_table/{name}, the first of them:\n{}\n\
         If they are meant: KNOTDOCK_BLESS=1 cargo test -p knotdock-cli --test all scoring_table",
        lines.len(),
        lines
            .iter()
            .take(20)
            .cloned()
            .collect::<Vec<_>>()
            .join("\n")
    );
}

fn table_columns() -> Vec<&'static str> {
    ["case", "pose", "rank", "score"]
        .into_iter()
        .chain(Effect::ALL.map(Effect::name))
        .chain(SLICES)
        .chain(POSE_TERMS.iter().map(|term| term.id))
        .collect()
}

#[test]
fn scores_terms_slices_and_ranks_of_poses() {
    let mut found = Table::new();
    for (case, poses) in poses() {
        let (on, scores, rescored) = scored(&case, &poses);
        let ranked: Vec<f64> = scores
            .iter()
            .zip(&rescored)
            .map(|(exact, rescored)| exact.score + rescored.sum())
            .collect();
        for (((number, _), exact), (rescored, by)) in
            poses.iter().zip(&scores).zip(rescored.iter().zip(&ranked))
        {
            let better = ranked.iter().filter(|other| *other > by);
            let term = |effect: Effect| on[effect as usize].then_some(exact.terms[effect as usize]);
            let mut values = vec![Some(1.0 + better.count() as f64), Some(exact.score)];
            values.extend(Effect::ALL.map(term));
            values.extend(exact.slices.map(Some));
            values.push(Some(exact.unfiltered));
            values.extend(rescored.iter().map(|(_, value)| value));
            found.insert((case.clone(), *number), values);
        }
    }
    let columns = table_columns();
    let mut tolerance = vec![TOLERANCE; columns.len() - 2];
    // A rank is the same or it is not.
    tolerance[0] = 0.0;
    check("scores.csv", &columns, &found, &tolerance);
}

#[test]
fn first_poses_of_small_searches() {
    let mut found = Table::new();
    for case in SEARCHES {
        let [receptor, ligand] = molecules(case);
        let options = options(case).changed(|options| {
            options.search.rotations = ROTATIONS;
            options.ranking.no_cluster = true;
            options.machine.threads = 1.into();
        });
        let plan = knotdock::dock::plan::plan(&receptor, &ligand, &options).unwrap();
        let points = knotdock::dock::run::molecule_points(&ligand);
        let outcome = knotdock::dock::run::dock(&plan, &points, &NoProgress).unwrap();
        for (index, row) in outcome.poses.iter().take(SEARCHED).enumerate() {
            let values = vec![
                Some(row.rotation as f64),
                row.search_score,
                Some(row.score_grid),
                row.pose_score,
            ];
            found.insert((case.to_owned(), index as u32 + 1), values);
        }
    }
    let columns = [
        "case",
        "rank",
        "rotation",
        "score",
        "score_grid",
        "pose_score",
    ];
    let tolerance = [0.0, FAST_TOLERANCE, FAST_TOLERANCE, FAST_TOLERANCE];
    check("search.csv", &columns, &found, &tolerance);
}

/// Not from a table: one atom against one scores -lambda^2 psi(d/s) + 2 lambda psi(d/(s+r0)) - psi(d/(s+2 r0)).
///
/// Here s is the sum of the radii, and psi_a(x) = exp(1 / (1 - x^-a)) (Behandish and Ilieş 2016, eqs. 10 and 44, with
/// the sign that their text needs).
#[test]
fn two_atoms_score_the_closed_form() {
    let options = DockOptions::default();
    let bump = |x: f64| {
        if x >= 1.0 {
            0.0
        } else {
            (1.0 / (1.0 - x.powf(-options.kernel.alpha))).exp()
        }
    };
    let (_, poses) = poses()
        .into_iter()
        .find(|(case, _)| case == "two_atoms")
        .unwrap();
    let (_, scores, _) = scored("two_atoms", &poses);
    let mut positive = 0;
    for ((number, pose), exact) in poses.iter().zip(&scores) {
        // Both atoms are at the origin of their files, and an aliphatic carbon has 1.88 Å (Tsai et al. 1999).
        let distance = pose.translation.norm();
        let [zero, skin, twice] =
            [0.0, 1.0, 2.0].map(|k| bump(distance / (2.0 * 1.88 + k * options.kernel.offset)));
        let lambda = options.kernel.lambda;
        let expected = -lambda * lambda * zero + 2.0 * lambda * skin - twice;
        assert!(
            (exact.unfiltered - expected).abs() <= 1e-9 * lambda * lambda,
            "pose {number}: {} is not {expected}",
            exact.unfiltered
        );
        positive += usize::from(expected > 0.0);
    }
    assert!(positive > 0, "no pose of the case touches");
}

/// Identities, not from a table:
///
/// - Terms add up to the score, weighted slices to shape.
/// - A pose out of reach scores nothing at all.
/// - Unlike charges score better.
/// - Blocked residues only lower the score, and leave other terms as they are.
#[test]
fn what_every_row_must_satisfy() {
    let weights = DockOptions::default()
        .kernel
        .engine()
        .kernel
        .slice_weights();
    for (case, poses) in poses() {
        let (on, scores, _) = scored(&case, &poses);
        for ((number, pose), exact) in poses.iter().zip(&scores) {
            let size = exact
                .slices
                .iter()
                .zip(weights)
                .map(|(s, w)| (s * w).abs())
                .sum::<f64>();
            let terms: f64 = exact.terms.iter().sum();
            assert!(
                (terms - exact.score).abs() <= 1e-9 * (size + 1.0),
                "{case} {number}"
            );
            let shape: f64 = exact.slices.iter().zip(weights).map(|(s, w)| s * w).sum();
            let off = shape - exact.terms[Effect::Shape as usize];
            assert!(off.abs() <= 1e-9 * (size + 1.0), "{case} {number}: {off}");
            if pose.translation.norm() > 250.0 {
                assert_eq!(*exact, ExactScore::default(), "{case} {number}");
            }
        }
        if case == BLOCKED {
            let (_, free, _) = scored("helices", &poses);
            let mut paid = 0;
            for (exact, free) in scores.iter().zip(&free) {
                let restraint = exact.terms[Effect::Restraint as usize];
                // The low-pass leaves ripples about the contact's function.
                assert!(restraint < 1.0, "{restraint}");
                paid += usize::from(restraint < -10.0);
                for effect in [Effect::Shape, Effect::Electrostatics, Effect::Contact] {
                    let [own, before] = [exact, free].map(|exact| exact.terms[effect as usize]);
                    assert!(
                        (own - before).abs() <= 1e-9 * (before.abs() + 1.0),
                        "{effect}"
                    );
                }
            }
            assert!(paid > 0, "no pose touches what is blocked");
        }
        if case == "salt_bridge" {
            assert!(on[Effect::Electrostatics as usize]);
            // Lysine's nitrogen over aspartate's oxygens.
            assert!(scores[0].terms[Effect::Electrostatics as usize] > 0.0);
        }
    }
}

/// The comparison itself must detect a change of a hundred-thousandth, a lost row, and a rank that changes.
#[test]
fn changes_are_detected() {
    let columns = ["case", "pose", "rank", "score"];
    let table = |rank: f64, score: f64| -> Table {
        let other = vec![Some(2.0), Some(-50.0)];
        [
            (("a".to_owned(), 1), vec![Some(rank), Some(score)]),
            (("a".to_owned(), 2), other),
        ]
        .into()
    };
    let before = table(1.0, 100.0);
    let heard = |found: &Table| moved(&columns, &before, found, &[0.0, TOLERANCE]);
    assert!(heard(&before).is_empty());
    assert!(heard(&table(1.0, 100.0 + 1e-5)).is_empty());
    let lines = heard(&table(1.0, 100.001));
    assert!(
        lines[0].contains("a 1: score 100.000000 -> 100.001000"),
        "{lines:?}"
    );
    assert!(
        lines[1].contains("in all: score moved in 1 rows"),
        "{lines:?}"
    );
    assert!(heard(&table(3.0, 100.0))[0].contains("rank 1.000000 -> 3.000000"));
    let mut fewer = before.clone();
    fewer.remove(&("a".to_owned(), 2));
    assert!(heard(&fewer)[0].contains("gone"));
}
