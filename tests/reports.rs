//! Reports: their content, the files that they touch, and how they are refused. `scripts/browser_checks.sh` opens
//! them in a browser.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::dock_run::run::{place, report_data, rows, run};
use crate::program::refused;

const SMALL: &str = "--rotations 36 --poses 60 --write-top 2 --quiet";

/// What the scripts of a report read.
fn data(report: &Path) -> Value {
    report_data(&fs::read(report).unwrap())
}

/// The rows are those of poses.csv, the placements its poses, and the shares those that the contacts give.
#[test]
fn a_report_holds_what_the_tables_hold() {
    let folder = place();
    run(
        folder.path(),
        &format!("dock receptor.pdb ligand.pdb {SMALL} --no-cluster -o run"),
    );
    let directory = folder.path().join("run");
    let data = data(&directory.join("report.html"));
    let table = rows(&directory);
    let shown = data["rows"].as_array().unwrap();
    assert_eq!(shown.len(), table.len());
    let columns = data["columns"].as_array().unwrap();
    assert_eq!(columns.len(), table[0].len());
    for (row, (fields, placed)) in table
        .iter()
        .zip(shown.iter().zip(data["placed"].as_array().unwrap()))
    {
        for (column, field) in columns.iter().zip(fields.as_array().unwrap()) {
            let name = column["name"].as_str().unwrap();
            match field.as_f64() {
                Some(value) => assert!(
                    (value - row[name].parse::<f64>().unwrap()).abs() < 1e-4,
                    "{name}"
                ),
                None => assert_eq!(field.as_str().unwrap_or(""), row[name], "{name}"),
            }
        }
        let names = ["qw", "qx", "qy", "qz", "tx", "ty", "tz"];
        for (name, value) in names.iter().zip(placed[0].as_array().unwrap()) {
            assert!((row[*name].parse::<f64>().unwrap() - value.as_f64().unwrap()).abs() < 1e-4);
        }
    }
    // Of the first pose of each cluster, how many touch each residue.
    let mut counts: [BTreeMap<u64, u64>; 2] = Default::default();
    let mut seen = std::collections::BTreeSet::new();
    for (row, contacts) in table.iter().zip(data["contacts"].as_array().unwrap()) {
        if seen.len() == 50 || !seen.insert(row["cluster"].clone()) {
            continue;
        }
        let words = contacts.as_str().unwrap().split_whitespace();
        let numbers: Vec<u64> = words.map(|word| word.parse().unwrap()).collect();
        for (side, counts) in counts.iter_mut().enumerate() {
            let touched: std::collections::BTreeSet<u64> =
                numbers.chunks(5).map(|pair| pair[side]).collect();
            for residue in touched {
                *counts.entry(residue).or_default() += 1;
            }
        }
    }
    assert!(!counts[0].is_empty());
    let mut reader = csv::Reader::from_path(directory.join("interface.csv")).unwrap();
    let shares: Vec<BTreeMap<String, String>> =
        reader.deserialize().map(|row| row.unwrap()).collect();
    for (side, name) in ["receptor", "ligand"].into_iter().enumerate() {
        let of_side: Vec<_> = shares.iter().filter(|row| row["side"] == name).collect();
        assert_eq!(
            of_side.len(),
            data["bodies"][side]["residues"].as_array().unwrap().len()
        );
        for (residue, row) in (0..).zip(of_side) {
            let count = counts[side].get(&residue).copied().unwrap_or(0);
            assert_eq!(row["clusters"], count.to_string());
            assert_eq!(data["shares"][side][residue as usize], count);
            let share: f64 = row["share"].parse().unwrap();
            assert!((share - count as f64 / seen.len() as f64).abs() < 1e-9);
        }
    }
}

/// A report goes with its run, unless someone has changed it: then neither it nor the run is replaced unasked.
#[test]
fn a_changed_report_stays() {
    let folder = place();
    let dock = format!("dock receptor.pdb ligand.pdb {SMALL} -o run");
    run(folder.path(), &dock);
    let report = folder.path().join("run/report.html");
    let written = fs::read_to_string(&report).unwrap();
    // Not a request to anywhere, in spite of its content.
    assert!(written.contains("default-src 'none'") && !written.contains("src=\"http"));
    run(folder.path(), &format!("{dock} --force --no-report"));
    assert!(!report.exists());
    // One that was added is the run's own, too.
    run(folder.path(), "report run");
    run(folder.path(), "report run");
    fs::write(&report, written.replace("Summary", "My notes")).unwrap();
    let said = refused(folder.path(), ["report", "run"]).to_string();
    assert!(said.contains("was changed"), "{said}");
    let said = refused(folder.path(), format!("{dock} --force").split(' ')).to_string();
    assert!(said.contains("report.html"), "{said}");
    assert!(fs::read_to_string(&report).unwrap().contains("My notes"));
    run(folder.path(), "report run --force");
    assert!(fs::read_to_string(&report).unwrap().contains("Summary"));
    run(folder.path(), &format!("{dock} --force"));
}

/// What a report needs and does not find is named.
#[test]
fn what_is_missing_is_named() {
    let folder = place();
    let said = refused(folder.path(), ["report", "nowhere"]).to_string();
    assert!(said.contains("run.json"), "{said}");
    run(
        folder.path(),
        &format!("dock receptor.pdb ligand.pdb {SMALL} -o run"),
    );
    let said = refused(folder.path(), ["report", "run", "--viewer", "nowhere"]).to_string();
    assert!(
        said.contains("3Dmol-min.js") && said.contains("npm install 3dmol"),
        "{said}"
    );
    fs::remove_file(folder.path().join("ligand.pdb")).unwrap();
    let said = refused(folder.path(), ["report", "run"]).to_string();
    assert!(said.contains("ligand.pdb"), "{said}");
}

/// Names of files and chains are text in a page, whatever characters they have.
#[cfg(unix)]
#[test]
fn names_are_no_markup() {
    let folder = place();
    let name = "<img src=x onerror=alert(1)>.pdb";
    fs::rename(folder.path().join("ligand.pdb"), folder.path().join(name)).unwrap();
    let words = ["dock", "receptor.pdb", name, "-o", "run"]
        .into_iter()
        .chain(SMALL.split_whitespace());
    crate::program::succeed(folder.path(), words);
    let text = fs::read_to_string(folder.path().join("run/report.html")).unwrap();
    assert!(!text.contains("<img src=x"));
    assert!(text.contains("&lt;img src=x"));
}

/// A report of collisions has the rows of the table, and takes no file's place by mistake.
#[test]
fn collisions_are_shown() {
    let folder = place();
    let poses = "qw,qx,qy,qz,tx,ty,tz\n1,0,0,0,0,0,0\n1,0,0,0,100,0,0\n";
    fs::write(folder.path().join("poses.csv"), poses).unwrap();
    let collide = "collide receptor.pdb ligand.pdb --poses poses.csv";
    run(
        folder.path(),
        &format!("{collide} -o table.csv --report hits.html --quiet"),
    );
    let data = data(&folder.path().join("hits.html"));
    let mut table = csv::Reader::from_path(folder.path().join("table.csv")).unwrap();
    let verdict = data["columns"]
        .as_array()
        .unwrap()
        .iter()
        .position(|one| one["name"] == "verdict");
    for (row, shown) in table.deserialize().zip(data["rows"].as_array().unwrap()) {
        let row: BTreeMap<String, String> = row.unwrap();
        assert_eq!(shown[verdict.unwrap()].as_str().unwrap(), row["verdict"]);
    }
    assert_eq!(data["placed"][1][0][4], 100.0);
    assert!(data["bodies"][0]["triangle_count"].as_u64().unwrap() > 100);
    for words in [
        "--report hits.html",
        "--report new.html -o new.html",
        "--report receptor.pdb --force",
    ] {
        refused(
            folder.path(),
            format!("{collide} {words}").split_whitespace(),
        );
    }
    run(
        folder.path(),
        "morph sum receptor.pdb ligand.pdb --report sum.html --quiet",
    );
    assert!(
        fs::read_to_string(folder.path().join("sum.html"))
            .unwrap()
            .contains("which hold it")
    );
}

/// The known complex is drawn while its file and the figures of the table are those of the run; the figures of clusters are
/// kept from report to report.
#[test]
fn a_report_written_again_has_the_known_complex_and_the_figures() {
    let folder = place();
    let here = |name: &str| folder.path().join(name);
    run(
        folder.path(),
        &format!("dock receptor.pdb ligand.pdb {SMALL} -o first"),
    );
    for (rank, name) in [(1, "known.pdb"), (2, "other.pdb")] {
        fs::copy(here(&format!("first/top/rank_000{rank}.pdb")), here(name)).unwrap();
    }
    run(
        folder.path(),
        &format!("dock receptor.pdb ligand.pdb --native known.pdb {SMALL} -o run"),
    );
    let report = here("run/report.html");
    let read = || {
        let page = fs::read_to_string(&report).unwrap();
        (
            data(&report),
            page.contains("The known complex is not shown"),
        )
    };
    let (written, is_left_out) = read();
    assert!(!is_left_out);
    let overlay = &written["overlay"];
    let rows = written["rows"].as_array().unwrap();
    assert_eq!(overlay["of_row"].as_array().unwrap().len(), rows.len());
    assert!(!overlay["traces"][0][1][0].as_array().unwrap().is_empty());
    for (row, figures) in rows.iter().zip(written["clusters"].as_array().unwrap()) {
        assert_eq!(row[3].as_f64(), figures[0].as_f64(), "cluster_size");
    }
    assert!(data(&here("first/report.html"))["overlay"].is_null());
    run(folder.path(), "report run");
    assert_eq!(read(), (written.clone(), false));

    run(
        folder.path(),
        "evaluate run --native other.pdb -o run/poses.csv --force --quiet",
    );
    run(folder.path(), "report run");
    let (other, is_left_out) = read();
    assert!(is_left_out && other["overlay"].is_null());
    run(
        folder.path(),
        "evaluate run -o run/poses.csv --force --quiet",
    );
    run(folder.path(), "report run");
    assert_eq!(read().0["overlay"], written["overlay"]);
    fs::copy(here("other.pdb"), here("known.pdb")).unwrap();
    run(folder.path(), "report run");
    let (changed, is_left_out) = read();
    assert!(is_left_out && changed["overlay"].is_null());
    assert_eq!(changed["clusters"], written["clusters"]);
    // Figures are lost with the report.
    fs::remove_file(&report).unwrap();
    run(folder.path(), "report run");
    assert!(read().0["clusters"].is_null());
}
