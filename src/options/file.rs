//! The file of `--config`: any of the options, in TOML, a table for each subject.
//!
//! ```toml
//! [search]
//! rotations = "15deg"
//!
//! [terms]
//! contact_weight = 1.5
//! ```
//!
//! A value is text as on the command line, or a number. One line may replace a file:
//! `--config terms.contact_weight=1.5`.

use std::ops::Range;
use std::path::Path;

use knotdock_structures::Error;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::definition::{Definition, Form};
use super::{DockOptions, definitions};
use crate::bounded_read::{MAX_OPTIONS, read_bounded_text};

/// An option that was given, with its value as text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GivenOption {
    /// The option's name.
    pub name: &'static str,
    /// The value as it was written.
    pub text: String,
}

impl DockOptions {
    /// Sets the options of a file; returns them.
    ///
    /// # Errors
    /// [`Error`] for a file that cannot be read or is not TOML, an unknown table or option, and a value out of range.
    pub fn read_file(&mut self, path: &Path) -> Result<Vec<GivenOption>, Error> {
        let text = read_bounded_text(path, MAX_OPTIONS).map_err(|error| {
            Error::input(format!("the file of options cannot be read: {error}"))
                .at(path)
                .help(
                    "check its name; `knotdock preset default > FILE` writes one to change, and one option may stand \
                     for a file, as in --config search.rotations=600",
                )
        })?;
        self.read_toml(&text, path)
    }

    /// Sets the options of a text in TOML; returns them. Files that it names are looked for from the folder of `path`,
    /// which errors name.
    pub fn read_toml(&mut self, text: &str, path: &Path) -> Result<Vec<GivenOption>, Error> {
        self.read_entries(text, path, path.parent().unwrap_or(Path::new("")))
    }

    /// Sets the option of a line such as `terms.contact_weight=1.5`; returns it. A file that it names is looked for from
    /// the working directory. Errors name the line as a file.
    pub fn read_line(&mut self, line: &str) -> Result<Vec<GivenOption>, Error> {
        let read = self.read_entries(line, Path::new(line), Path::new(""));
        // The line of a file that the option names stays.
        read.map_err(|error| match error.file() == Some(Path::new(line)) {
            true => error.on_line(None),
            false => error,
        })
    }

    /// Sets the options of a text, which errors call `path`. Files that it names are looked for from `folder`.
    fn read_entries(
        &mut self,
        text: &str,
        path: &Path,
        folder: &Path,
    ) -> Result<Vec<GivenOption>, Error> {
        let mut read = || {
            let document = DeTable::parse(text).map_err(|error| Fault {
                span: error.span(),
                error: Error::input(error.message())
                    .help("write TOML: tables such as [search], and lines such as rotations = 900"),
            })?;
            let mut given = Vec::new();
            for (subject, table) in document.into_inner() {
                let name = subject.get_ref().as_ref();
                let is_subject = definitions().iter().any(|one| one.subject() == name);
                let (DeValue::Table(table), true) = (table.into_inner(), is_subject) else {
                    return Err(no_table(&subject));
                };
                for (name, value) in table {
                    given.push(self.read_entry(&subject, &name, value, folder)?);
                }
            }
            Ok(given)
        };
        read().map_err(|Fault { span, error }| {
            let line = span.map(|span| line_at(text, span.start));
            if error.file().is_none() {
                return error.at(path).on_line(line);
            }
            // The fault is in a file that the option names.
            let remedy = error.remedy().unwrap_or_default();
            let line = line.map_or_else(String::new, |line| format!(", line {line}"));
            let named = format!("{remedy}; {}{line} names the file", path.display());
            error.help(named)
        })
    }

    /// Sets the option of an entry.
    fn read_entry(
        &mut self,
        subject: &Spanned<DeString<'_>>,
        name: &Spanned<DeString<'_>>,
        value: Spanned<DeValue<'_>>,
        folder: &Path,
    ) -> Result<GivenOption, Fault> {
        let path = (subject.get_ref().as_ref(), name.get_ref().as_ref());
        let is_named = |one: &&Definition| (one.subject(), one.name()) == path;
        let Some(option) = definitions().iter().find(is_named) else {
            return Err(no_option(name, subject.get_ref()));
        };
        let fault = |error: Error| Fault {
            span: Some(value.span()),
            error: match error.file() {
                Some(_) => error,
                None => error.help(option.remedy()),
            },
        };
        let text = text_of(option, value.get_ref()).map_err(fault)?;
        let read = option.read(self, &text, folder);
        read.map_err(|error| {
            fault(match error.file() {
                Some(_) => error,
                None => error.within(format!("{} = {text}", option.name())),
            })
        })?;
        Ok(GivenOption {
            name: option.name(),
            text,
        })
    }
}

/// A fault at a place in the text.
struct Fault {
    span: Option<Range<usize>>,
    error: Error,
}

/// 1-based line of a byte.
fn line_at(text: &str, byte: usize) -> u64 {
    let before = text.as_bytes().iter().take(byte);
    1 + before.filter(|byte| **byte == b'\n').count() as u64
}

/// A table that is no subject, or an option outside of a table.
fn no_table(found: &Spanned<DeString<'_>>) -> Fault {
    let name = found.get_ref().as_ref();
    let option = definitions().iter().find(|option| option.name() == name);
    let remedy = match option {
        Some(option) => format!(
            "put `{name}` into the table [{0}]: {0}.{name} = ...",
            option.subject()
        ),
        None => {
            let mut subjects: Vec<&str> = definitions().iter().map(Definition::subject).collect();
            subjects.dedup();
            format!("the tables are [{}]", subjects.join("], ["))
        }
    };
    Fault {
        span: Some(found.span()),
        error: Error::input(format!("`{name}` is no table of options")).help(remedy),
    }
}

/// An option that its subject does not have.
fn no_option(found: &Spanned<DeString<'_>>, subject: &str) -> Fault {
    let name = found.get_ref().as_ref();
    let spelled = name.replace('-', "_");
    let elsewhere = definitions().iter().find(|option| option.name() == spelled);
    let remedy = match elsewhere {
        Some(option) => format!("write `{spelled}` in the table [{}]", option.subject()),
        None => {
            let own = definitions().iter().filter(|one| one.subject() == subject);
            let names: Vec<&str> = own.map(Definition::name).collect();
            format!("the options of [{subject}] are {}", names.join(", "))
        }
    };
    Fault {
        span: Some(found.span()),
        error: Error::input(format!("there is no option `{name}` in [{subject}]")).help(remedy),
    }
}

/// A value as the text of a command line.
fn text_of(option: &Definition, value: &DeValue<'_>) -> Result<String, Error> {
    match (option.form(), value) {
        (Form::Flag, DeValue::Boolean(truth)) => Ok(truth.to_string()),
        (Form::Flag, _) => {
            let message = format!("{} must be true or false", option.name());
            Err(Error::input(message))
        }
        (Form::List, DeValue::Array(values)) => {
            let texts = values.iter().map(|value| text_of(option, value.get_ref()));
            Ok(texts.collect::<Result<Vec<_>, _>>()?.join(","))
        }
        (_, DeValue::String(text)) => Ok(text.to_string()),
        // Hexadecimal and the like, too.
        (_, DeValue::Integer(number)) => i64::from_str_radix(number.as_str(), number.radix())
            .map(|number| number.to_string())
            .map_err(Error::input),
        (_, DeValue::Float(number)) => Ok(number.as_str().to_owned()),
        _ => {
            let message = format!("{} must be text or a number", option.name());
            Err(Error::input(message))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The options that a text gives.
    fn given(text: &str) -> Vec<GivenOption> {
        let path = Path::new("folder/run.toml");
        DockOptions::default().read_toml(text, path).unwrap()
    }

    #[test]
    fn values_are_text_numbers_truths_and_lists() {
        for (text, name, value) in [
            ("[search]\nrotations = \"15deg\"", "rotations", "15deg"),
            ("search.rotations = 1_000", "rotations", "1000"),
            ("[kernel]\ntolerance = 1e-3", "tolerance", "1e-3"),
            ("[kernel]\nlambda = 3", "lambda", "3"),
            ("[sampling]\nsample_grid = 0x8000", "sample_grid", "32768"),
            ("[ranking]\nno_cluster = true", "no_cluster", "true"),
            ("[ranking]\nno_cluster = false", "no_cluster", "false"),
            ("[machine]\nmemory = \"4GiB\"", "memory", "4GiB"),
            ("[input]\nmodel = 2", "model", "2"),
            (
                "[input]\ndrop_residue = [\"HEM\", \"ZN\"]",
                "drop_residue",
                "HEM,ZN",
            ),
        ] {
            let text_of_value = value.to_owned();
            let expected = vec![GivenOption {
                name,
                text: text_of_value,
            }];
            assert_eq!(given(text), expected, "{text}");
        }
        assert_eq!(given("# nothing\n[terms]\n"), []);
        let mut options = DockOptions::default();
        let text = "[input]\ndrop_residue = [\"HEM\", \"ZN\"]\n[ranking]\nno_cluster = true\n[search]\nrotations = 9";
        options.read_toml(text, Path::new("")).unwrap();
        assert_eq!(options.input.drop_residue, ["HEM", "ZN"]);
        assert!(options.ranking.no_cluster && options.search.rotations == 9);
        // A later file wins, also over a flag.
        let later = "ranking.no_cluster = false\n[input]\ndrop_residue = \"SO4\"";
        options.read_toml(later, Path::new("")).unwrap();
        assert_eq!(options.input.drop_residue, ["SO4"]);
        assert!(!options.ranking.no_cluster && options.search.rotations == 9);
    }

    #[test]
    fn faults_have_their_line() {
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
            ("[search]\nprecision = \"half\"\n", 2, "single or double"),
            ("[search\n", 1, "TOML"),
        ] {
            let path = Path::new("run.toml");
            let error = DockOptions::default().read_toml(text, path).unwrap_err();
            let message = format!("{error}; {}", error.remedy().unwrap());
            assert_eq!(error.line(), Some(line), "{text}: {message}");
            assert_eq!(error.file(), Some(path));
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    /// A file that the file names is in its folder.
    #[test]
    fn files_are_looked_for_from_the_file_s_folder() {
        let folder = tempfile::tempdir().unwrap();
        let table = include_str!("../../scoring/src/terms/effect/contact_potential.csv");
        std::fs::write(folder.path().join("own.csv"), table).unwrap();
        let text = "[terms]\ncontact_potential = \"own.csv\"\n";
        let path = folder.path().join("run.toml");
        std::fs::write(&path, text).unwrap();
        let mut options = DockOptions::default();
        options.read_file(&path).unwrap();
        assert!(options.terms.contact_potential.is_some());
        std::fs::write(&path, text.replace("own", "other")).unwrap();
        let error = options.read_file(&path).unwrap_err();
        assert_eq!(
            error.file(),
            Some(folder.path().join("other.csv").as_path())
        );
        let remedy = error.remedy().unwrap();
        assert!(
            remedy.ends_with("run.toml, line 2 names the file"),
            "{remedy}"
        );
    }

    /// A file that a line names is looked for from the working directory, and errors have no line.
    #[test]
    fn a_line_stands_for_a_file() {
        let mut options = DockOptions::default();
        let given = options.read_line("terms.contact_weight=1.5").unwrap();
        assert_eq!(
            (given[0].name, options.terms.contact_weight),
            ("contact_weight", 1.5)
        );
        let line = "terms.contact_potential=\"none/own.csv\"";
        let error = options.read_line(line).unwrap_err();
        assert_eq!(error.file(), Some(Path::new("none/own.csv")));
        let error = options.read_line("terms.contact_weight=-1").unwrap_err();
        assert_eq!(error.file(), Some(Path::new("terms.contact_weight=-1")));
        assert_eq!(error.line(), None);
    }

    /// `bfactor` is no file, wherever the file of options lies.
    #[test]
    fn words_in_place_of_a_file_are_no_paths() {
        let mut options = DockOptions::default();
        let text = "restraints.interface_receptor = \"bfactor\"";
        options
            .read_toml(text, Path::new("folder/run.toml"))
            .unwrap();
        assert!(options.restraints.interface_receptor.is_some());
    }
}
