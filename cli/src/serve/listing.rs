//! The list of runs: what the folder holds.

use std::path::Path;
use std::time::UNIX_EPOCH;

use serde_json::{Map, Value, json};

use super::folder::Folder;
use super::jobs::{Job, JobState};
use super::request::typed;
use crate::records::ENSEMBLE_RECORD;
use crate::records::recorded_run::{RecordedRun, read_record};
use crate::report::DirectoryKind;
use knotdock::options::definition::{Definition, Form};
use knotdock::options::{DockOptions, definitions};
use knotdock::output::records::input_record::InputRecord;
use knotdock_structures::Error;

/// All runs, the latest first.
pub fn all(folder: &Folder) -> Result<Value, Error> {
    let mut names = folder.job_names()?;
    names.extend(folder.folder_names()?);
    names.sort();
    names.dedup();
    let mut runs: Vec<Value> = names.iter().filter_map(|name| one(folder, name)).collect();
    runs.sort_by_key(|run| std::cmp::Reverse(run["time"].as_u64()));
    Ok(Value::Array(runs))
}

/// A run by its name, if there is one.
fn one(folder: &Folder, name: &str) -> Option<Value> {
    let job = Job::read(folder, name);
    let path = folder.run(name).filter(|path| is_run(path));
    let mut entries = Map::new();
    if let Some(path) = &path {
        entries = recorded(path);
        entries.insert("files".to_owned(), json!(files(path)));
    }
    if let Some(job) = &job {
        let words = job.request.words(folder, name);
        entries.insert(
            "command".to_owned(),
            json!(words.map(|words| typed(&words)).ok()),
        );
        entries.insert("job".to_owned(), json!(job));
        entries.entry("time").or_insert(json!(job.requested));
    }
    // A folder that has a run is one, whatever became of the server that asked for it.
    let state = match (&path, &job) {
        (Some(_), _) => JobState::Done,
        (None, Some(job)) if job.state != JobState::Done => job.state,
        _ => return None,
    };
    entries.insert("name".to_owned(), json!(name));
    entries.insert("state".to_owned(), json!(state));
    Some(Value::Object(entries))
}

fn is_run(path: &Path) -> bool {
    path.join("run.json").is_file() || DirectoryKind::of(path).is_some()
}

/// Entries of a run's own files; those that cannot be read are left out.
fn recorded(path: &Path) -> Map<String, Value> {
    let mut entries = Map::new();
    let record = path.join("run.json");
    let dated = if record.is_file() {
        record.clone()
    } else {
        path.join(ENSEMBLE_RECORD)
    };
    let time = dated.metadata().and_then(|file| file.modified()).ok();
    let time = time.and_then(|time| time.duration_since(UNIX_EPOCH).ok());
    entries.insert(
        "time".to_owned(),
        json!(time.map_or(0, |time| time.as_secs())),
    );
    if let Ok(run) = RecordedRun::read(&record) {
        let sides = run.inputs.pair().map(side);
        entries.insert("sides".to_owned(), json!(sides));
        entries.insert("settings".to_owned(), json!(settings(&run.options)));
    }
    let command = read_record(&record).ok();
    let command = command.and_then(|text| serde_json::from_slice::<Value>(&text).ok());
    let words: Option<Vec<String>> = command
        .and_then(|mut record| serde_json::from_value(record["machine"]["command"].take()).ok());
    let words = words.filter(|words| !words.is_empty());
    entries.insert(
        "command".to_owned(),
        json!(words.map(|words| typed(&words[1..]))),
    );
    entries.insert("best".to_owned(), best(path).unwrap_or_default());
    entries
}

fn side(record: &InputRecord) -> String {
    let name = record.path.file_name().unwrap_or_default();
    let chains = record.chains.iter().flatten();
    let chains = chains.map(String::as_str).collect::<Vec<_>>().join(",");
    let separator = if chains.is_empty() { "" } else { ":" };
    format!("{}{separator}{chains}", name.to_string_lossy())
}

/// The options that are not by default.
fn settings(options: &DockOptions) -> Vec<String> {
    let default = DockOptions::default();
    let changed =
        |option: &&Definition| option.subject() != "machine" && !option.is_same(options, &default);
    let word = |option: &Definition| match (option.form(), option.text(options)) {
        (Form::Flag, _) | (_, None) => option.long().to_owned(),
        (_, Some(value)) => format!("{} {value}", option.long()),
    };
    definitions().iter().filter(changed).map(word).collect()
}

/// The first row of the ranked poses.
fn best(path: &Path) -> Option<Value> {
    let mut reader = csv::Reader::from_path(path.join("poses.csv")).ok()?;
    let header = reader.headers().ok()?.clone();
    let row = reader.records().next()?.ok()?;
    let number = |name: &str| {
        let place = header.iter().position(|column| column == name)?;
        row.get(place)?.parse::<f64>().ok()
    };
    Some(
        json!({ "score": number("score"), "z_score": number("z_score"), "cluster_size": number("cluster_size") }),
    )
}

/// Files of a run to look at or to save, by their paths in it.
fn files(path: &Path) -> Vec<String> {
    let named = [
        "report.html",
        "poses.csv",
        "run.json",
        ENSEMBLE_RECORD,
        "view.pml",
        "view.cxc",
    ];
    let mut files: Vec<String> = named
        .into_iter()
        .filter(|name| path.join(name).is_file())
        .map(str::to_owned)
        .collect();
    let top = std::fs::read_dir(path.join("top"))
        .into_iter()
        .flatten()
        .flatten();
    let mut top: Vec<String> = top
        .filter_map(|entry| entry.file_name().into_string().ok())
        .map(|name| format!("top/{name}"))
        .collect();
    top.sort();
    files.append(&mut top);
    files
}

/// The report of a structure by `knotdock inspect`, read from the lines of its output.
pub fn inspected(output: &[u8]) -> Value {
    let lines = output.split(|&byte| byte == b'\n');
    let events = lines.filter_map(|line| serde_json::from_slice::<Value>(line).ok());
    let (mut report, mut warnings) = (json!({}), Vec::new());
    for mut event in events {
        for name in ["result", "error"] {
            if !event[name].is_null() {
                report[name] = event[name].take();
            }
        }
        warnings.extend(event["warn"].as_str().map(str::to_owned));
        if let Some(text) = event["say"].as_str() {
            report["text"] = json!(text);
        }
    }
    report["warnings"] = json!(warnings);
    report
}
