//! The results of a batch: one row a pair, with the best row of each pair's own table.

use std::collections::HashMap;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;

use serde_json::Value;

use super::whole_file::{FileError, write_whole};

/// Name of the table in the batch's directory.
pub const RESULTS: &str = "results.csv";

/// What is copied of the first row of a pair's poses.csv, where it has the column.
const BEST: [&str; 9] = [
    "score",
    "rank_score",
    "z_score",
    "cluster_size",
    "irmsd",
    "lrmsd",
    "fnat",
    "dockq",
    "capri",
];

/// A pair of the batch and how it went.
#[derive(Clone, Debug)]
pub struct PairResult {
    /// Its name, which is that of the directory of its run.
    pub name: String,
    /// The receptor as the table of pairs has it.
    pub receptor: String,
    /// The ligand likewise.
    pub ligand: String,
    /// What its run left, or why there is none; `None` while it waits.
    pub outcome: Option<Result<RunSummary, String>>,
}

/// What a batch tells of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunSummary {
    /// Poses kept and clusters among them, as run.json has them.
    pub counts: [Option<u64>; 2],
    /// Fields of the first row, in the order of the results' columns; empty where there is no such column or value.
    pub best: [String; BEST.len()],
    /// First rank whose pose is of CAPRI's class acceptable or better; `None` where none is, or nothing is known.
    pub first_acceptable: Option<u64>,
}

impl RunSummary {
    /// Reads the directory of a whole run; what cannot be read stays empty.
    pub fn of(directory: &Path) -> Self {
        let mut summary = Self::default();
        let record = fs::read(directory.join("run.json")).unwrap_or_default();
        let record: Value = serde_json::from_slice(&record).unwrap_or_default();
        summary.counts = ["poses", "clusters"].map(|name| record["results"][name].as_u64());
        let Ok(mut table) = csv::Reader::from_path(directory.join("poses.csv")) else {
            return summary;
        };
        let header = table.headers().cloned().unwrap_or_default();
        let columns: HashMap<&str, usize> = header.iter().zip(0..).collect();
        for (index, row) in table.records().filter_map(Result::ok).enumerate() {
            let field = |name: &str| {
                let place = columns.get(name).copied();
                place
                    .and_then(|place| row.get(place))
                    .unwrap_or("")
                    .to_owned()
            };
            if index == 0 {
                summary.best = BEST.map(field);
            }
            if !["", "incorrect"].contains(&field("capri").as_str()) {
                summary.first_acceptable = field("rank").parse().ok();
                break;
            }
        }
        summary
    }

    /// The value of a column of the first row.
    pub fn best(&self, name: &str) -> &str {
        let place = BEST.iter().position(|column| *column == name);
        place.map_or("", |place| self.best[place].as_str())
    }
}

/// Names of the columns.
fn header() -> Vec<&'static str> {
    let mut header = vec![
        "name", "receptor", "ligand", "status", "error", "poses", "clusters",
    ];
    header.extend(BEST);
    header.push("first_acceptable_rank");
    header
}

/// Whether a file may be replaced by a batch's results: there is none, or it has their header.
pub fn is_ours(path: &Path) -> bool {
    let Ok(file) = fs::File::open(path) else {
        return !path.exists();
    };
    let mut line = String::new();
    // A file that is not text is not ours.
    BufReader::new(file).read_line(&mut line).is_ok() && line.trim_end() == header().join(",")
}

/// Writes the table whole, in the order of the pairs.
///
/// # Errors
/// As [`write_whole`].
pub fn write_results(path: &Path, results: &[PairResult]) -> Result<(), FileError> {
    write_whole(path, |file| {
        let mut table = csv::WriterBuilder::new().from_writer(file);
        table.write_record(header())?;
        for result in results {
            let none = RunSummary::default();
            let (status, error, run) = match &result.outcome {
                None => ("pending", "", &none),
                Some(Ok(run)) => ("done", "", run),
                Some(Err(error)) => ("failed", error.as_str(), &none),
            };
            let count = |count: Option<u64>| count.map_or(String::new(), |n| n.to_string());
            let mut row = vec![
                result.name.clone(),
                result.receptor.clone(),
                result.ligand.clone(),
                status.to_owned(),
                error.to_owned(),
            ];
            row.extend(run.counts.map(count));
            row.extend(run.best.clone());
            row.push(count(run.first_acceptable));
            table.write_record(row)?;
        }
        table.flush()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_is_summed_up_and_what_is_missing_stays_empty() {
        let folder = tempfile::tempdir().unwrap();
        let run = folder.path();
        assert_eq!(RunSummary::of(run), RunSummary::default());
        let poses =
            "rank,score,rank_score,capri\n1,4.5,5.25,incorrect\n2,4,5,acceptable\n3,3,4,medium\n";
        fs::write(run.join("poses.csv"), poses).unwrap();
        fs::write(
            run.join("run.json"),
            r#"{"results":{"poses":9,"clusters":3}}"#,
        )
        .unwrap();
        let summary = RunSummary::of(run);
        assert_eq!(summary.counts, [Some(9), Some(3)]);
        assert_eq!(
            ["score", "rank_score", "dockq", "capri", "nothing"].map(|name| summary.best(name)),
            ["4.5", "5.25", "", "incorrect", ""]
        );
        assert_eq!(summary.first_acceptable, Some(2));
    }

    #[test]
    fn only_results_may_be_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(RESULTS);
        assert!(is_ours(&path));
        let failed = PairResult {
            name: "a".to_owned(),
            receptor: "a.pdb:A,B".to_owned(),
            ligand: "b.pdb".to_owned(),
            outcome: Some(Err("no \"atoms\"\nat all".to_owned())),
        };
        write_results(&path, &[failed]).unwrap();
        assert!(is_ours(&path));
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains("\na,\"a.pdb:A,B\",b.pdb,failed,\"no \"\"atoms\"\"\nat all\",,"));
        fs::write(&path, "name,value\n").unwrap();
        assert!(!is_ours(&path));
    }
}
