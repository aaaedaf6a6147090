//! The results of a batch: one row a pair, with the best row of each pair's own table.

use std::collections::HashSet;
use std::path::Path;

use csv::StringRecord;
use serde_json::Value;

use crate::bounded_read::{MAX_RECORD, MAX_TABLE, read_bounded_file};
use crate::output::tables::cells::{TableWriter, unquoted_row};
use crate::output::tables::fields::number;

use crate::output::files::whole_file::{FileError, is_blank, write_whole};
use crate::output::tables::poses::PoseTable;
use crate::output::tables::poses_reader::PoseTableError;

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
    /// Reads the directory of a whole run.
    ///
    /// # Errors
    /// [`PoseTableError`] when its table of poses cannot be read.
    pub fn of(directory: &Path) -> Result<Self, PoseTableError> {
        let table = PoseTable::read(&directory.join("poses.csv"))?;
        let rows = table.objects(0..table.rows().len());
        // An ensemble has a record of its own, with the same counts.
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

    /// A column of the first row as a field.
    fn best(&self, name: &str) -> String {
        match &self.best[name] {
            Value::Null => String::new(),
            Value::String(text) => text.clone(),
            value => value.as_f64().map_or_else(|| value.to_string(), number),
        }
    }
}

/// Status of a pair that was docked.
pub const DONE: &str = "done";

/// Names of the columns.
pub fn header() -> Vec<&'static str> {
    let mut header = vec![
        "name", "receptor", "ligand", "status", "error", "poses", "clusters",
    ];
    header.extend(BEST);
    header.push("first_acceptable_rank");
    header
}

/// Whether a file may be replaced by a batch's results: there is none, it has their header, or it has no content.
pub fn is_ours(path: &Path) -> bool {
    let Ok(bytes) = read_bounded_file(path, MAX_TABLE) else {
        return !path.exists();
    };
    let line = bytes.split(|&byte| byte == b'\n').next();
    let line = line.unwrap_or_default().trim_ascii_end();
    is_blank(&bytes) || line == header().join(",").as_bytes()
}

/// Rows of earlier batches into the same directory, by other names than those of some pairs: they are kept as they
/// stand.
///
/// # Errors
/// What is wrong with the table, where one is there and cannot be read.
pub fn rows_of_others(path: &Path, pairs: &[PairResult]) -> Result<Vec<StringRecord>, csv::Error> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let table = read_bounded_file(path, MAX_TABLE)?;
    // What a power cut left without content is written anew.
    if is_blank(&table) {
        return Ok(Vec::new());
    }
    // Letters of either case are one where file systems think so.
    let own: HashSet<String> = pairs.iter().map(|pair| pair.name.to_lowercase()).collect();
    let mut rows: Vec<StringRecord> = csv::Reader::from_reader(table.as_slice())
        .into_records()
        .map(|row| row.map(|row| unquoted_row(&row)))
        .collect::<Result<_, _>>()?;
    rows.retain(|row| {
        let name = row.get(0).unwrap_or_default();
        !own.contains(&name.to_lowercase())
    });
    Ok(rows)
}

/// The fields of a pair, one a column.
pub fn fields(result: &PairResult) -> Vec<String> {
    let none = RunSummary::default();
    let (status, error, run) = match &result.outcome {
        None => ("pending", "", &none),
        Some(Ok(run)) => (DONE, "", run),
        Some(Err(error)) => ("failed", error.as_str(), &none),
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
    fields
}

/// Writes the table whole, in the order of the pairs, then the rows of `others`.
///
/// # Errors
/// As [`write_whole`].
pub fn write_results(
    path: &Path,
    results: &[PairResult],
    others: &[StringRecord],
) -> Result<(), FileError> {
    write_whole(path, |file| {
        let mut table = TableWriter::new(file);
        table.row(header())?;
        for result in results {
            table.row(fields(result))?;
        }
        for row in others {
            table.row(row)?;
        }
        table.flush()
    })
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
        write_results(&path, std::slice::from_ref(&failed), &[]).unwrap();
        assert!(is_ours(&path));
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains("\na,\"a.pdb:A,B\",b.pdb,failed,\"no \"\"atoms\"\"\nat all\",,"));
        // A second batch keeps the rows of the first, but for pairs that are its own, too.
        let mut other = failed.clone();
        other.name = "b".to_owned();
        let others = rows_of_others(&path, std::slice::from_ref(&other)).unwrap();
        write_results(&path, &[other], &others).unwrap();
        let rows = csv::Reader::from_path(&path).unwrap().into_records();
        let names: Vec<String> = rows.map(|row| row.unwrap()[0].to_owned()).collect();
        assert_eq!(names, ["b", "a"]);
        assert_eq!(rows_of_others(&path, &[failed]).unwrap().len(), 1);
        fs::write(&path, "name,value\n").unwrap();
        assert!(!is_ours(&path));
        // Found by hostile calls: a power cut left an empty table, which every later batch refused.
        for empty in ["", "\0\0\0\0"] {
            fs::write(&path, empty).unwrap();
            assert!(is_ours(&path));
            assert_eq!(rows_of_others(&path, &[]).unwrap().len(), 0);
        }
    }
}
