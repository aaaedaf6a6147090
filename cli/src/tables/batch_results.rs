//! The results of a batch: one row per pair, with the best row of each pair's own table.

use std::path::Path;

use csv::StringRecord;
use serde_json::Value;

use crate::tables::field;
use knotdock::bounded_read::{MAX_RECORD, read_bounded_file};
use knotdock::output::tables::poses::PoseTable;
use knotdock::table_text::cells::{TableWriter, unquoted};
use knotdock_structures::Error;

/// Name of the table in the batch's directory.
pub const RESULTS: &str = "results.csv";

/// What is copied of the first row of a pair's poses.csv, where it has the column.
const BEST: [&str; 10] = [
    "score",
    "pose_score",
    "search_score",
    "z_score",
    "cluster_size",
    "irmsd",
    "lrmsd",
    "fnat",
    "dockq",
    "capri",
];

#[derive(Clone, Debug)]
pub struct PairResult {
    /// Its name, which is that of the directory of its run.
    pub name: String,
    /// The receptor as the table of pairs has it.
    pub receptor: String,
    pub ligand: String,
    /// What its run left, or why there is none.
    pub outcome: Result<RunSummary, String>,
}

/// Report of a batch on one run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunSummary {
    /// Poses kept and clusters among them, as run.json has them.
    pub counts: [Option<u64>; 2],
    /// The first row of its table by column; `null` where it has none.
    pub best: Value,
    /// First rank whose pose is of CAPRI's class acceptable or better; `None` where none is, or nothing is known.
    pub first_acceptable: Option<u64>,
}

impl RunSummary {
    pub fn of(directory: &Path) -> Result<Self, Error> {
        let table = PoseTable::read(&directory.join("poses.csv"))?;
        let rows = table.objects(0..table.rows().len());
        // An ensemble has its own record, with the same counts.
        let read = |name: &str| read_bounded_file(&directory.join(name), MAX_RECORD);
        let record = read("run.json").or_else(|_| read("ensemble.json"));
        let record = record.unwrap_or_default();
        let record: Value = serde_json::from_slice(&record).unwrap_or_default();
        let counts = ["poses", "clusters"].map(|name| record["results"][name].as_u64());
        Ok(Self::of_rows(counts, rows))
    }

    /// Sums up the rows of a table of poses, by their columns.
    pub fn of_rows(counts: [Option<u64>; 2], rows: Vec<Value>) -> Self {
        let acceptable = |row: &&Value| {
            row["capri"]
                .as_str()
                .is_some_and(|class| class != "incorrect")
        };
        Self {
            counts,
            first_acceptable: rows
                .iter()
                .find(acceptable)
                .and_then(|row| row["rank"].as_u64()),
            best: rows.into_iter().next().unwrap_or_default(),
        }
    }

    /// The run in a line of a batch's report; `seconds` on the clock if it was docked in this call.
    pub fn line(&self, seconds: Option<f64>) -> String {
        let best = |column: &str, digits: usize| {
            let value = self.best[column].as_f64();
            value.map(|value| format!("{value:.digits$}"))
        };
        let mut words = format!(
            "{} clusters, best pose score {}",
            self.counts[1].unwrap_or(0),
            best("pose_score", 1).unwrap_or_default()
        );
        for (name, column, digits) in [("z-score", "z_score", 1), ("DockQ", "dockq", 2)] {
            if let Some(value) = best(column, digits) {
                words += &format!(", {name} {value}");
            }
        }
        if let Some(rank) = self.first_acceptable {
            words += &format!("; the first acceptable one at rank {rank}");
        }
        words
            + &seconds.map_or("; done before".to_owned(), |seconds| {
                format!("; {seconds:.1} s")
            })
    }

    /// A column of the first row as a field.
    fn best(&self, name: &str) -> String {
        field(&self.best[name])
    }
}

/// Status of a pair that was docked.
pub const DONE: &str = "done";

pub fn header() -> Vec<&'static str> {
    let mut header = vec![
        "name", "receptor", "ligand", "status", "error", "poses", "clusters",
    ];
    header.extend(BEST);
    header.push("first_acceptable_rank");
    header
}

pub fn head() -> Vec<u8> {
    line(&header())
}

/// The row of a pair, one line.
pub fn row(result: &PairResult) -> Vec<u8> {
    let none = RunSummary::default();
    let (status, error, run) = match &result.outcome {
        Ok(run) => (DONE, "", run),
        Err(error) => ("failed", error.as_str(), &none),
    };
    let count = |count: Option<u64>| count.map_or(String::new(), |n| n.to_string());
    let mut fields = vec![
        result.name.clone(),
        result.receptor.clone(),
        result.ligand.clone(),
        status.to_owned(),
        error.to_owned(),
    ];
    fields.extend(run.counts.map(count));
    fields.extend(BEST.map(|name| run.best(name)));
    fields.push(count(run.first_acceptable));
    // So that a row that is cut short is seen to be.
    for field in &mut fields {
        *field = field.replace(['\n', '\r'], " ");
    }
    line(&fields)
}

fn line<T: AsRef<str>>(cells: &[T]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut table = TableWriter::new(&mut bytes);
    // A vector takes whatever is written.
    let _ = table.row(cells).and_then(|()| table.flush());
    drop(table);
    bytes
}

/// The name of a row's pair and whether it was docked; `None` if it is no row.
pub fn name_and_status(line: &[u8]) -> Option<(String, bool)> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(line);
    let mut record = StringRecord::new();
    let is_row = reader.read_record(&mut record).ok()? && record.len() == header().len();
    is_row.then(|| (unquoted(&record[0]).to_owned(), &record[3] == DONE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_run_is_summed_up_and_what_is_missing_stays_empty() {
        let folder = tempfile::tempdir().unwrap();
        let run = folder.path();
        assert!(RunSummary::of(run).is_err());
        let rows = |classes: [&str; 3]| {
            let [first, second, third] = classes;
            format!(
                "rank,qw,qx,qy,qz,tx,ty,tz,score,pose_score,capri\n1,1,0,0,0,0,0,0,4.5,0.0000001,{first}\n\
                 2,1,0,0,0,0,0,0,4,5,{second}\n3,1,0,0,0,0,0,0,3,4,{third}\n"
            )
        };
        let known = rows(["incorrect", "acceptable", "medium"]);
        fs::write(run.join("poses.csv"), known).unwrap();
        fs::write(
            run.join("run.json"),
            r#"{"results":{"poses":9,"clusters":3}}"#,
        )
        .unwrap();
        let summary = RunSummary::of(run).unwrap();
        assert_eq!(summary.counts, [Some(9), Some(3)]);
        assert_eq!(
            ["score", "pose_score", "dockq", "capri", "nothing"].map(|name| summary.best(name)),
            ["4.5", "0.0000001", "", "incorrect", ""]
        );
        assert_eq!(summary.first_acceptable, Some(2));
        fs::write(run.join("poses.csv"), rows([""; 3])).unwrap();
        assert_eq!(RunSummary::of(run).unwrap().first_acceptable, None);
    }

    #[test]
    fn a_row_says_what_became_of_a_pair() {
        let failed = PairResult {
            name: "=a".to_owned(),
            receptor: "a.pdb:A,B".to_owned(),
            ligand: "b.pdb".to_owned(),
            outcome: Err("no \"atoms\"\nat all".to_owned()),
        };
        let line = row(&failed);
        let text = String::from_utf8(line.clone()).unwrap();
        assert!(text.starts_with("'=a,\"a.pdb:A,B\",b.pdb,failed,\"no \"\"atoms\"\" at all\",,"));
        assert_eq!(text.matches('\n').count(), 1);
        assert_eq!(name_and_status(&line), Some(("=a".to_owned(), false)));
        let docked = PairResult {
            outcome: Ok(RunSummary::default()),
            ..failed
        };
        assert_eq!(
            name_and_status(&row(&docked)),
            Some(("=a".to_owned(), true))
        );
        assert_eq!(name_and_status(b"name,value"), None);
    }
}
