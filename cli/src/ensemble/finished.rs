//! A finished run or ensemble: which rows of its table are of which run.

use std::path::{Path, PathBuf};

use crate::records::{MEMBERS, is_ensemble};
use knotdock::ensemble::table::MEMBER;
use knotdock::output::tables::poses::PoseTable;
use knotdock_structures::Error;

pub struct RunRows {
    /// Path of its run.json.
    pub run: PathBuf,
    /// Places of its rows in the table, in the order given.
    pub rows: Vec<usize>,
}

/// The runs of some rows of a directory's table: one run, or members of an ensemble in the order of the rows.
pub fn runs(directory: &Path, table: &PoseTable, rows: &[usize]) -> Result<Vec<RunRows>, Error> {
    if !is_ensemble(directory) {
        let run = directory.join("run.json");
        let rows = rows.to_vec();
        return Ok(vec![RunRows { run, rows }]);
    }
    let mut found: Vec<(String, RunRows)> = Vec::new();
    for &row in rows {
        let name = table.field(row, MEMBER).unwrap_or_default();
        if !is_member(name) {
            let error = format!("'{name}' in column `{MEMBER}` is no member of an ensemble");
            return Err(Error::input(error).at(&directory.join("poses.csv")).help(
                "take the table as `knotdock dock` wrote it, or name the run of a member: a folder in members/",
            ));
        }
        match found.iter_mut().find(|(known, _)| known == name) {
            Some((_, member)) => member.rows.push(row),
            None => {
                let run = directory.join(MEMBERS).join(name).join("run.json");
                found.push((
                    name.to_owned(),
                    RunRows {
                        run,
                        rows: vec![row],
                    },
                ));
            }
        }
    }
    Ok(found.into_iter().map(|(_, member)| member).collect())
}

/// Whether a name may be that of a member. No name in a table leads into another folder.
fn is_member(name: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "._".contains(c);
    name.starts_with('r') && name.chars().all(is_plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_leads_out_of_the_folder() {
        for name in ["r1_l1", "r2.13_l1"] {
            assert!(is_member(name), "{name}");
        }
        for name in ["", "..", "/etc", "r/../../x", ".", "r1\\l1"] {
            assert!(!is_member(name), "{name}");
        }
    }
}
