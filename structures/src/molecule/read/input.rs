//! A file to read, and the part of it to read: `file`, `file:H,L` or `file:H:1-120,L`, and perhaps one of its models.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::Error;
use crate::molecule::model::{InputSpec, ResidueSelection};

impl InputSpec {
    /// Reads `file`, `file:H,L` or `file:H:1-120,L`.
    ///
    /// A path that exists as written is never cut, nor is a Windows drive (`C:\file.pdb`) or a colon that has a path
    /// separator after it. Of several colons the last is taken that has a file before it, or where there is no such
    /// file the first that has chains and residues behind it. Repeated chains count once.
    ///
    /// # Errors
    /// The file has no name, or what follows the colon names neither chains nor residues, as in `file.pdb:`,
    /// `file.pdb:H,,L` or `file.pdb:H:x`.
    pub fn parse(text: &str) -> Result<Self, Error> {
        let (path, names) = cut(text).map_or((text, None), |(path, names)| (path, Some(names)));
        // A shell's unset variable leaves "" or ":A".
        if path.is_empty() {
            return Err(Error::input(format!("'{text}' names no file")).help(REMEDY));
        }
        let Some(names) = names else {
            return Ok(Self::whole(path));
        };
        if !is_selection(names) {
            return Err(bad_selection(text));
        }
        let mut chains: Vec<String> = Vec::new();
        for name in names.split(',').map(str::trim) {
            // A number may be of another chain than the same number before.
            if names.contains(':') || !chains.iter().any(|chain| chain == name) {
                chains.push(name.to_string());
            }
        }
        Ok(Self {
            path: PathBuf::from(path),
            chains: Some(chains),
            model: None,
        })
    }

    /// The same part of the file, of this model.
    pub fn of_model(self, model: usize) -> Self {
        Self {
            model: Some(model),
            ..self
        }
    }
}

/// Remedy of a specification that names no file, no chain or no residues.
const REMEDY: &str = "write FILE to read all chains, FILE:H,L to pick chains by their author names, or FILE:H:1-120,L to \
                      pick residues";

/// The error of a specification whose chains and residues cannot be read.
pub(crate) fn bad_selection(text: &str) -> Error {
    Error::input(format!(
        "'{text}' names no chain and no residues after the colon"
    ))
    .help(REMEDY)
}

fn is_selection(text: &str) -> bool {
    text.parse::<ResidueSelection>().is_ok()
}

fn cut(text: &str) -> Option<(&str, &str)> {
    if Path::new(text).exists() {
        return None;
    }
    let colons = text.match_indices(':');
    let cuts = colons.map(|(at, _)| (&text[..at], &text[at + 1..]));
    let is_cut = |(path, names): &(&str, &str)| {
        let is_drive = path.len() == 1 && path.starts_with(|c: char| c.is_ascii_alphabetic());
        !names.contains(['/', '\\']) && !is_drive
    };
    let cuts: Vec<(&str, &str)> = cuts.filter(is_cut).collect();
    let is_there = |(path, _): &&(&str, &str)| Path::new(path).is_file();
    let there = cuts.iter().rev().find(is_there);
    let readable = || cuts.iter().find(|(_, names)| is_selection(names));
    there.or_else(readable).or(cuts.last()).copied()
}

impl FromStr for InputSpec {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::parse(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chains(text: &str) -> (PathBuf, Option<Vec<String>>) {
        let spec = InputSpec::parse(text).unwrap();
        (spec.path, spec.chains)
    }

    #[test]
    fn chains_follow_the_last_colon() {
        assert_eq!(chains("a.pdb"), ("a.pdb".into(), None));
        assert_eq!(
            chains("a.pdb:H,L"),
            ("a.pdb".into(), Some(vec!["H".into(), "L".into()]))
        );
        // Author names are case-sensitive and may have several characters in mmCIF.
        assert_eq!(
            chains("a.cif:h,AA-2,h"),
            ("a.cif".into(), Some(vec!["h".into(), "AA-2".into()]))
        );
        assert_eq!(
            chains("a:b.cif:A"),
            ("a:b.cif".into(), Some(vec!["A".into()]))
        );
    }

    #[test]
    fn residues_follow_their_chain() {
        let parts = |parts: &[&str]| Some(parts.iter().map(ToString::to_string).collect());
        for (text, path, expected) in [
            ("a.pdb:A:1-250", "a.pdb", parts(&["A:1-250"])),
            ("a.pdb:A:1-50,B", "a.pdb", parts(&["A:1-50", "B"])),
            (
                "a.pdb:A:1-50,60-90,B:3",
                "a.pdb",
                parts(&["A:1-50", "60-90", "B:3"]),
            ),
            (
                "a.pdb:A:5,B:5,6,B:6",
                "a.pdb",
                parts(&["A:5", "B:5", "6", "B:6"]),
            ),
            ("a.pdb:_:-5-20", "a.pdb", parts(&["_:-5-20"])),
            ("x/a:b.cif:AA-2:5A", "x/a:b.cif", parts(&["AA-2:5A"])),
            (r"C:\x\a.pdb:A:1-5", r"C:\x\a.pdb", parts(&["A:1-5"])),
            ("C:a.pdb:A:1-5", "C:a.pdb", parts(&["A:1-5"])),
        ] {
            assert_eq!(chains(text), (path.into(), expected), "{text}");
        }
    }

    /// The file that is there says where its name ends.
    #[test]
    fn a_file_that_exists_ends_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x:A");
        std::fs::write(&path, "").unwrap();
        let text = format!("{}:5", path.display());
        assert_eq!(chains(&text), (path, Some(vec!["5".into()])));
        let other = folder.path().join("x:B:5").display().to_string();
        let plain = folder.path().join("x");
        assert_eq!(chains(&other), (plain, Some(vec!["B:5".into()])));
    }

    #[test]
    fn drives_and_folders_are_not_chains() {
        assert_eq!(chains(r"C:\x\a.pdb"), (r"C:\x\a.pdb".into(), None));
        assert_eq!(chains("C:a.pdb"), ("C:a.pdb".into(), None));
        assert_eq!(
            chains(r"C:\x\a.pdb:A"),
            (r"C:\x\a.pdb".into(), Some(vec!["A".into()]))
        );
        assert_eq!(chains("odd:dir/a.pdb"), ("odd:dir/a.pdb".into(), None));
    }

    #[test]
    fn a_file_that_exists_as_a_whole_is_not_cut() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a:B");
        std::fs::write(&path, "").unwrap();
        assert_eq!(chains(path.to_str().unwrap()), (path.clone(), None));
    }

    #[test]
    fn a_colon_needs_chains() {
        for text in ["a.pdb:", "a.pdb:H,,L", "a.pdb:H,"] {
            let error = InputSpec::parse(text).unwrap_err();
            assert!(error.message().contains("names no chain"), "{text}");
        }
    }
}
