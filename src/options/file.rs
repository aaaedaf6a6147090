//! The file of `--config`: any of the options, in TOML, a table a subject.
//!
//! ```toml
//! [search]
//! rotations = "15deg"
//!
//! [terms]
//! contact_weight = 1.5
//! ```
//!
//! A value is what may be typed for the option, as text or as a number. One line may stand for a file:
//! `--config terms.contact_weight=1.5`.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::definition::{Definition, definitions_of};
use super::text;
use crate::bounded_read::{MAX_OPTIONS, read_bounded_text};
use crate::plain_path::plain_path;

/// An option that a file gives a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Name of the option.
    pub name: String,
    /// The words of a command line for it; none for a flag that is off.
    pub words: Vec<String>,
}

/// Why a file of options cannot be used.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{message}")]
pub struct ConfigError {
    /// The file.
    pub path: PathBuf,
    /// 1-based line, where one is at fault.
    pub line: Option<u64>,
    /// The fault, in words.
    pub message: String,
    /// Remedy for the user.
    pub remedy: String,
    /// Why a value was refused, where one was: it may be the name of a file with a fault of its own.
    pub refused: Option<Arc<clap::Error>>,
}

/// Reads a file with options of a struct.
///
/// # Errors
/// [`ConfigError`] for a file that cannot be read or is not TOML, an unknown table or option, and a value out of range.
pub fn read<T: Args>(path: &Path) -> Result<Vec<Entry>, ConfigError> {
    let text = read_bounded_text(path, MAX_OPTIONS).map_err(|error| ConfigError {
        path: path.to_owned(),
        line: None,
        message: format!("the file of options cannot be read: {error}"),
        remedy: "check its name; `knotdock preset default > FILE` writes one to change, and one option may stand for a \
                 file, as in --config search.rotations=600"
            .to_owned(),
        refused: None,
    })?;
    read_text::<T>(&text, path)
}

/// Reads the text of a file with options of a struct. Files that it names are looked for from the folder of `path`,
/// which errors name.
///
/// # Errors
/// As those of [`read`].
pub fn read_text<T: Args>(text: &str, path: &Path) -> Result<Vec<Entry>, ConfigError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    entries::<T>(text, folder).map_err(|wrong| ConfigError {
        path: path.to_owned(),
        line: wrong.span.map(|span| line_at(text, span.start)),
        message: wrong.message,
        remedy: wrong.remedy,
        refused: wrong.refused,
    })
}

/// Reads one line with an option, such as `terms.contact_weight=1.5`. A file that it names is looked for from the
/// working directory.
///
/// # Errors
/// As those of [`read`]; they name the line in a file's place.
pub fn read_line<T: Args>(line: &str) -> Result<Vec<Entry>, ConfigError> {
    entries::<T>(line, Path::new("")).map_err(|wrong| ConfigError {
        path: PathBuf::from(line),
        line: None,
        message: wrong.message,
        remedy: wrong.remedy,
        refused: wrong.refused,
    })
}

/// The fault in a part of a file.
struct Wrong {
    span: Option<Range<usize>>,
    message: String,
    remedy: String,
    refused: Option<Arc<clap::Error>>,
}

/// 1-based line of a byte.
fn line_at(text: &str, byte: usize) -> u64 {
    let before = text.as_bytes().iter().take(byte);
    1 + before.filter(|byte| **byte == b'\n').count() as u64
}

/// The options that a text gives. Files that it names are looked for from `folder`.
fn entries<T: Args>(text: &str, folder: &Path) -> Result<Vec<Entry>, Wrong> {
    let definitions = definitions_of::<T>();
    let document = DeTable::parse(text).map_err(|error| Wrong {
        span: error.span(),
        message: error.message().to_owned(),
        remedy: "write TOML: tables such as [search], and lines such as rotations = 900".to_owned(),
        refused: None,
    })?;
    let mut entries = Vec::new();
    for (subject, table) in document.into_inner() {
        let known = |option: &&Definition| option.subject() == subject.get_ref().as_ref();
        let options: Vec<&Definition> = definitions.iter().filter(known).collect();
        let (false, DeValue::Table(table)) = (options.is_empty(), table.into_inner()) else {
            return Err(no_table(&subject, &definitions));
        };
        for (name, value) in table {
            let known = |option: &&&Definition| option.name() == name.get_ref().as_ref();
            let Some(option) = options.iter().find(known) else {
                return Err(no_option(&name, subject.get_ref(), &definitions));
            };
            let (span, value) = (value.span(), value.into_inner());
            let wrong = |message: String| Wrong {
                span: Some(span.clone()),
                message,
                remedy: remedy_of(option),
                refused: None,
            };
            let words = words(option, &value, folder).map_err(wrong)?;
            text::read::<T>(words.iter().map(Into::into)).map_err(|error| {
                let refused = text::refused(&error);
                let message = format!(
                    "{} = {}: it must be {}",
                    option.name(),
                    refused.value,
                    refused.bound
                );
                Wrong {
                    refused: Some(Arc::new(error)),
                    ..wrong(message)
                }
            })?;
            entries.push(Entry {
                name: option.name().to_owned(),
                words,
            });
        }
    }
    Ok(entries)
}

/// Where an option is described.
fn remedy_of(option: &Definition) -> String {
    match option.is_of_files() {
        true => format!("see `{}` in `knotdock preset default --all`", option.name()),
        false => format!("see --{} in `knotdock dock --help`", option.long()),
    }
}

/// A table that no subject has, or an option outside of a table.
fn no_table(found: &Spanned<DeString<'_>>, definitions: &[Definition]) -> Wrong {
    let name = found.get_ref().as_ref();
    let mut subjects: Vec<&str> = definitions.iter().map(Definition::subject).collect();
    subjects.dedup();
    let option = definitions.iter().find(|option| option.name() == name);
    let remedy = match option {
        Some(option) => format!(
            "put `{name}` into the table [{0}]: {0}.{name} = ...",
            option.subject()
        ),
        None => format!("the tables are [{}]", subjects.join("], [")),
    };
    Wrong {
        span: Some(found.span()),
        message: format!("`{name}` is no table of options"),
        remedy,
        refused: None,
    }
}

/// An option that its subject does not have.
fn no_option(found: &Spanned<DeString<'_>>, subject: &str, definitions: &[Definition]) -> Wrong {
    let name = found.get_ref().as_ref();
    let spelled = name.replace('-', "_");
    let elsewhere = definitions.iter().find(|option| option.name() == spelled);
    let remedy = match elsewhere {
        Some(option) => format!("write `{spelled}` in the table [{}]", option.subject()),
        None => {
            let own = definitions.iter().filter(|one| one.subject() == subject);
            let names: Vec<&str> = own.map(Definition::name).collect();
            format!("the options of [{subject}] are {}", names.join(", "))
        }
    };
    Wrong {
        span: Some(found.span()),
        message: format!("there is no option `{name}` in [{subject}]"),
        remedy,
        refused: None,
    }
}

/// The words of a command line for a value.
fn words(option: &Definition, value: &DeValue<'_>, folder: &Path) -> Result<Vec<String>, String> {
    if option.is_flag() {
        return match value {
            DeValue::Boolean(true) => Ok(vec![format!("--{}", option.long())]),
            DeValue::Boolean(false) => Ok(Vec::new()),
            _ => Err(format!("{} must be true or false", option.name())),
        };
    }
    let text = |value: &DeValue<'_>| match value {
        DeValue::String(text) if option.names_file() => {
            let path = plain_path(&folder.join(text.as_ref()));
            Ok(path.to_string_lossy().into_owned())
        }
        DeValue::String(text) => Ok(text.to_string()),
        DeValue::Integer(number) => {
            // Hexadecimal and the like, too.
            let decimal = i64::from_str_radix(number.as_str(), number.radix());
            decimal
                .map(|number| number.to_string())
                .map_err(|error| error.to_string())
        }
        DeValue::Float(number) => Ok(number.as_str().to_owned()),
        DeValue::Boolean(truth) => Ok(truth.to_string()),
        _ => Err(format!("{} must be text or a number", option.name())),
    };
    match value {
        DeValue::Array(values) if option.takes_several() => values
            .iter()
            .map(|value| Ok(option.word(&text(value.get_ref())?)))
            .collect(),
        value => Ok(vec![option.word(&text(value)?)]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::DockOptions;

    fn words_of(text: &str) -> Vec<String> {
        let entries = match entries::<DockOptions>(text, Path::new("folder")) {
            Ok(entries) => entries,
            Err(wrong) => panic!("{}", wrong.message),
        };
        entries.into_iter().flat_map(|entry| entry.words).collect()
    }

    /// The line, the message and the remedy of what is wrong.
    fn wrong_in(text: &str) -> (Option<u64>, String) {
        let Err(wrong) = entries::<DockOptions>(text, Path::new("")) else {
            panic!("{text}");
        };
        let line = wrong.span.map(|span| line_at(text, span.start));
        (line, format!("{}; {}", wrong.message, wrong.remedy))
    }

    #[test]
    fn values_are_text_numbers_truths_and_lists() {
        for (text, words) in [
            ("[search]\nrotations = \"15deg\"", "--rotations=15deg"),
            ("search.rotations = 1_000", "--rotations=1000"),
            ("[kernel]\ntolerance = 1e-3", "--tolerance=1e-3"),
            ("[kernel]\nlambda = 3", "--lambda=3"),
            ("[sampling]\nsample_grid = 0x8000", "--sample-grid=32768"),
            ("[ranking]\nno_cluster = true", "--no-cluster"),
            ("[ranking]\nno_cluster = false", ""),
            ("[machine]\nmemory = \"4GiB\"", "--memory=4GiB"),
            ("[input]\nmodel = 2", "--model=2"),
            (
                "[input]\ndrop_residue = [\"HEM\", \"ZN\"]",
                "--drop-residue=HEM --drop-residue=ZN",
            ),
            ("# nothing\n[terms]\n", ""),
        ] {
            assert_eq!(words_of(text).join(" "), words, "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_found_by_its_line() {
        for (text, line, part) in [
            ("[search]\nrotations = 0\n", 2, "between 1 and 10000000"),
            ("[search]\n\nrotation = 9\n", 3, "fine_rotations"),
            ("[search]\nlambda = 9\n", 2, "the table [kernel]"),
            (
                "[search]\nfine-rotations = 9\n",
                2,
                "write `fine_rotations`",
            ),
            ("lambda = 9\n", 1, "the table [kernel]"),
            ("[serach]\nrotations = 9\n", 1, "[search]"),
            ("[search]\nrotations = [9, 8]\n", 2, "text or a number"),
            ("[search]\nrotations = 9\nrotations = 8\n", 3, "duplicate"),
            ("[ranking]\nno_cluster = 1\n", 2, "true or false"),
            ("[kernel]\nlambda = inf\n", 2, "finite"),
            ("[search]\nprecision = \"half\"\n", 2, "single, double"),
            ("[search\n", 1, "TOML"),
        ] {
            let (found, message) = wrong_in(text);
            assert_eq!(found, Some(line), "{text}: {message}");
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    /// A file that the file names lies in its folder.
    #[test]
    fn files_are_looked_for_from_the_file_s_folder() {
        let folder = tempfile::tempdir().unwrap();
        let table = include_str!("../../scoring/src/terms/effect/contact_potential.csv");
        std::fs::write(folder.path().join("own.csv"), table).unwrap();
        let text = "[terms]\ncontact_potential = \"own.csv\"\n";
        let path = folder.path().join("run.toml");
        std::fs::write(&path, text).unwrap();
        let entries = read::<DockOptions>(&path).unwrap();
        let expected = folder.path().join("own.csv").display().to_string();
        assert!(entries[0].words[0].ends_with(&expected));
        std::fs::write(&path, text.replace("own", "other")).unwrap();
        assert_eq!(read::<DockOptions>(&path).unwrap_err().line, Some(2));
    }
}
