//! Which file to read and which of its chains: `file` or `file:H,L`.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::error::ReadError;

/// A structure file and the chains asked of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputSpec {
    /// The file.
    pub path: PathBuf,
    /// Author names of the chains to keep, case-sensitive, `_` for the blank name; all chains when `None`.
    pub chains: Option<Vec<String>>,
}

impl InputSpec {
    /// All chains of a file.
    pub fn whole(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            chains: None,
        }
    }

    /// Reads `file` or `file:H,L`.
    ///
    /// A path that exists as written is never cut, nor is a Windows drive (`C:\file.pdb`) or a colon that has a path
    /// separator after it. Repeated chains count once.
    ///
    /// # Errors
    /// [`ReadError::Unnamed`] without a file's name, [`ReadError::Specification`] when a chain after the colon is empty, as in `file.pdb:` or `file.pdb:H,,L`.
    pub fn parse(text: &str) -> Result<Self, ReadError> {
        let (path, names) = match cut(text) {
            Some((path, names)) => (path, Some(names)),
            None => (text, None),
        };
        // A shell's unset variable leaves "" or ":A".
        if path.is_empty() {
            return Err(ReadError::Unnamed {
                text: text.to_string(),
            });
        }
        let Some(names) = names else {
            return Ok(Self::whole(path));
        };
        let mut chains: Vec<String> = Vec::new();
        for name in names.split(',').map(str::trim) {
            if name.is_empty() {
                return Err(ReadError::Specification {
                    text: text.to_string(),
                });
            }
            if !chains.iter().any(|chain| chain == name) {
                chains.push(name.to_string());
            }
        }
        Ok(Self {
            path: PathBuf::from(path),
            chains: Some(chains),
        })
    }
}

/// Splits at the colon before the chains, if there is one.
fn cut(text: &str) -> Option<(&str, &str)> {
    if Path::new(text).exists() {
        return None;
    }
    let (path, names) = text.rsplit_once(':')?;
    let is_drive = path.len() == 1 && path.starts_with(|c: char| c.is_ascii_alphabetic());
    if names.contains(['/', '\\']) || is_drive {
        return None;
    }
    Some((path, names))
}

impl FromStr for InputSpec {
    type Err = ReadError;

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
            assert!(matches!(error, ReadError::Specification { .. }), "{text}");
        }
    }
}
