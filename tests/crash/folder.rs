//! What a folder holds, to compare.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use serde_json::Value;

/// A closed mesh.
pub const TETRAHEDRON: &str =
    "v 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// The files of a folder by their paths, and the folders, those of records without what differs from run to run.
#[derive(Clone, PartialEq, Debug)]
pub struct Snapshot(pub BTreeMap<String, String>);

impl Snapshot {
    pub fn of(folder: &Path) -> Self {
        let mut files = BTreeMap::new();
        add(folder, folder, &mut files);
        Self(files)
    }

    /// Whether a lock is there, or something that is being written or was left.
    pub fn has_litter(&self) -> bool {
        self.0.keys().any(|path| path.contains(MARK))
    }

    /// The same without all of that.
    pub fn without_litter(mut self) -> Self {
        self.0.retain(|path, _| !path.contains(MARK));
        self
    }

    /// Paths of the files that ended commands left, without locks.
    pub fn leftovers(&self) -> BTreeSet<&str> {
        self.0.keys().filter_map(|path| leftover(path)).collect()
    }

    /// The same as the next command finds it: with the older run in its place, if that is aside and nothing has come
    /// after it.
    pub fn put_back(self) -> Self {
        if self.0.contains_key("run") {
            return self;
        }
        let back = |(path, text): (String, String)| match path.strip_prefix(".run.knotdock-old") {
            Some(rest) => (format!("run{rest}"), text),
            None => (path, text),
        };
        Self(self.0.into_iter().map(back).collect())
    }

    /// The paths at which another differs, in a line; empty where none does.
    pub fn difference(&self, other: &Self) -> String {
        let paths = self.0.keys().chain(other.0.keys());
        let mut paths: Vec<&String> = paths.collect();
        paths.sort();
        paths.dedup();
        let one = |path: &String| match (self.0.get(path), other.0.get(path)) {
            (Some(one), Some(other)) if one == other => None,
            (Some(_), Some(_)) => Some(format!("{path} differs")),
            (Some(_), None) => Some(format!("{path} is too many")),
            _ => Some(format!("{path} is missing")),
        };
        let lines: Vec<String> = paths.into_iter().filter_map(one).collect();
        lines.join(", ")
    }

    /// Only what is below a folder.
    pub fn below(&self, folder: &str) -> Self {
        let inside = self.0.iter().filter(|(path, _)| path.starts_with(folder));
        Self(
            inside
                .map(|(path, text)| (path.clone(), text.clone()))
                .collect(),
        )
    }
}

/// What is in the names of locks, of files and folders that are being written, and of those that were left.
const MARK: &str = ".knotdock-";

/// What a command that was ended left, if a path leads to that or into it: its name ends in twelve letters, or in `old`.
fn leftover(path: &str) -> Option<&str> {
    let (before, rest) = path.split_once(MARK)?;
    let ending = rest.split('/').next()?;
    let is_left = ending.len() == 12 || ending == "old";
    is_left.then(|| &path[..before.len() + MARK.len() + ending.len()])
}

fn add(folder: &Path, root: &Path, files: &mut BTreeMap<String, String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path
            .strip_prefix(root)
            .unwrap()
            .to_string_lossy()
            .into_owned();
        if path.is_dir() {
            files.insert(name, "folder".to_owned());
            add(&path, root, files);
        } else {
            let text = String::from_utf8_lossy(&fs::read(&path).unwrap()).into_owned();
            // Records hold the inputs' paths.
            let text = text.replace(&*root.to_string_lossy(), "HERE");
            let text = match name.ends_with("attempts.csv") {
                true => each_once(&text),
                false => settled(text),
            };
            files.insert(name, text);
        }
    }
}

/// The lines of a list, each once: a pair whose docking was ended is begun again.
fn each_once(text: &str) -> String {
    let mut seen = BTreeSet::new();
    let lines = text.lines().filter(|line| seen.insert(*line));
    lines.collect::<Vec<_>>().join("\n")
}

/// A record, or a table whose last column is a time, without times; other text as it is.
fn settled(text: String) -> String {
    if text
        .lines()
        .next()
        .is_some_and(|header| header.ends_with(",microseconds"))
    {
        let rows = text
            .lines()
            .map(|row| row.rsplit_once(',').map_or(row, |(rest, _)| rest));
        return rows.collect::<Vec<_>>().join("\n");
    }
    // A report says how long the run took. Its last line says that all of it is there.
    if text.starts_with("<!DOCTYPE html>") && text.ends_with(" -->\n") {
        return "a whole report".to_owned();
    }
    match serde_json::from_str::<Value>(&text) {
        Ok(Value::Object(mut record)) if record.contains_key("program") => {
            record.remove("timing");
            record.remove("machine");
            Value::Object(record).to_string()
        }
        _ => text,
    }
}

/// Copies a folder.
pub fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            fs::copy(&path, &target).unwrap();
        }
    }
}
