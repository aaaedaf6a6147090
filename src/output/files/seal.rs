//! The seal of a report: its last line, by which it is known to be as it was written.
//!
//! A report shows the time of its run, so it differs from run to run, and run.json does not list its checksum. The last
//! line of the report does.

use std::fs;
use std::path::Path;

use super::checksum::sha256;

/// Name of the report in the directory of a run.
pub const REPORT: &str = "report.html";
/// Beginning of a report.
pub const BEGINNING: &str = "<!DOCTYPE html>\n<!-- A report of knotdock";

const SEAL: &str = "<!-- sha256 of all above: ";

/// A text with its seal.
pub fn sealed(text: String) -> String {
    let checksum = sha256(text.as_bytes());
    text + SEAL + &checksum + " -->\n"
}

/// Whether a file is a report that nobody has changed.
pub fn is_sealed(path: &Path) -> bool {
    let is_file = path.symlink_metadata().is_ok_and(|found| found.is_file());
    let Some(text) = is_file.then(|| fs::read_to_string(path).ok()).flatten() else {
        return false;
    };
    text.rfind(SEAL)
        .is_some_and(|at| sealed(text[..at].to_owned()) == text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_breaks_the_seal() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("report.html");
        let text = sealed("<p>A\n".to_owned());
        fs::write(&path, &text).unwrap();
        assert!(is_sealed(&path));
        for changed in [
            text.replace("<p>", "<b>"),
            format!("{text} "),
            "<p>A\n".to_owned(),
        ] {
            fs::write(&path, changed).unwrap();
            assert!(!is_sealed(&path));
        }
        assert!(!is_sealed(root.path()));
    }
}
