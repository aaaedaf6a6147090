//! Errors of the libraries as failures of a command.

use std::error::Error;
use std::fmt::Display;
use std::path::Path;

use crate::error::SearchError;
use crate::options::PotentialFileError;
use crate::options::file::ConfigError;
use crate::options::text::first_paragraph;
use crate::output::files::balls::PseudoAtomError;
use crate::output::files::whole_file::FileError;
use crate::output::records::input_record::InputRecordError;
use crate::output::records::recorded_run::RecordedRunError;
use crate::output::tables::pair_table::PairTableError;
use crate::output::tables::poses_reader::PoseTableError;
use crate::predictions::PredictionError;
use crate::report::{ListError, ViewerError};
use crate::restraints::RestraintFileError;
use crate::threads::ThreadsError;
use knotdock_structures::Error;
use knotdock_structures::molecule::ReadError;

use crate::cli::messages::failure::Failure;

/// Bad input at a place that the reader knows as far as it can be known.
fn unreadable(
    error: &impl Display,
    file: Option<&Path>,
    line: Option<usize>,
    remedy: impl ToString,
) -> Failure {
    let line = line.and_then(|line| u64::try_from(line).ok());
    let failure = Failure::input(error).on_line(line).remedy(remedy);
    match file {
        Some(file) => failure.at(file),
        None => failure,
    }
}

/// What options or inputs a search refuses, at the place in the file that is at fault where there is one.
pub fn refused(error: SearchError) -> Failure {
    let remedy = error.remedy();
    match &error {
        SearchError::Restraints(RestraintFileError { path, line, .. }) => {
            unreadable(&error, Some(path), *line, remedy)
        }
        SearchError::Predictions { error: at, .. } => {
            unreadable(&error, at.path.as_deref(), at.line, remedy)
        }
        _ => Failure::input(&error).remedy(remedy),
    }
}

impl From<ListError> for Failure {
    fn from(error: ListError) -> Self {
        Self::input(&error).at(&error.path).remedy(error.remedy())
    }
}

impl From<ViewerError> for Failure {
    fn from(error: ViewerError) -> Self {
        Self::input(&error).at(&error.path).remedy(error.remedy())
    }
}

impl From<PotentialFileError> for Failure {
    fn from(error: PotentialFileError) -> Self {
        Self::input(&error)
            .at(&error.path)
            .on_line(error.line)
            .remedy(error.remedy)
    }
}

impl From<ConfigError> for Failure {
    fn from(error: ConfigError) -> Self {
        let of_named_file = error.refused.as_deref().and_then(fault_of_named_file);
        if let Some(failure) = of_named_file {
            let advice = failure.advice().unwrap_or_default();
            let line = error.line.map(|line| format!(", line {line}"));
            let named = format!(
                "{advice}; {}{} names the file",
                error.path.display(),
                line.unwrap_or_default()
            );
            return failure.remedy(named);
        }
        Self::input(&error)
            .at(&error.path)
            .on_line(error.line)
            .remedy(&error.remedy)
    }
}

/// The fault in a file that an option names: it is read as the option is.
pub fn fault_of_named_file(error: &clap::Error) -> Option<Failure> {
    let source = error.source()?;
    if let Some(error) = source.downcast_ref::<PotentialFileError>() {
        return Some(error.clone().into());
    }
    if let Some(error) = source.downcast_ref::<PredictionError>() {
        return Some(error.clone().into());
    }
    let error = source.downcast_ref::<RestraintFileError>()?;
    Some(error.clone().into())
}

impl From<clap::Error> for Failure {
    fn from(error: clap::Error) -> Self {
        fault_of_named_file(&error).unwrap_or_else(|| Self::input(first_paragraph(&error)))
    }
}

impl From<PredictionError> for Failure {
    fn from(error: PredictionError) -> Self {
        unreadable(&error, error.path.as_deref(), error.line, error.remedy())
    }
}

impl From<RestraintFileError> for Failure {
    fn from(error: RestraintFileError) -> Self {
        unreadable(&error, Some(&error.path), error.line, error.remedy())
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        unreadable(&error, error.file(), error.line(), error.remedy())
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let failure = match (error.exit_code(), error.may_pass()) {
            (2, _) => Self::input(&error),
            (_, true) => Self::other(&error),
            (_, false) => Self::of_program(&error),
        };
        let mut failure = failure.on_line(error.line());
        if let Some(file) = error.file() {
            failure = failure.at(file);
        }
        match error.remedy() {
            Some(remedy) => failure.remedy(remedy),
            None => failure,
        }
    }
}

impl From<InputRecordError> for Failure {
    fn from(error: InputRecordError) -> Self {
        let remedy = match &error {
            InputRecordError::Read { .. } => {
                "put the file where the run found it, or beside the directory of the run"
            }
            InputRecordError::Stream { .. } => {
                "dock again from a file, or put what was read under that name beside the directory of the run"
            }
            InputRecordError::Changed { .. } => {
                "put back the file that the run was made from, or dock again"
            }
        };
        Self::input(&error).at(error.path()).remedy(remedy)
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        let failure = if error.is_input() {
            Self::input(&error)
        } else {
            Self::other(&error)
        };
        failure.at(error.path()).remedy(error.remedy())
    }
}

impl From<PoseTableError> for Failure {
    fn from(error: PoseTableError) -> Self {
        Self::input(&error)
            .at(error.path())
            .on_line(error.line())
            .remedy(error.remedy())
    }
}

impl From<RecordedRunError> for Failure {
    fn from(error: RecordedRunError) -> Self {
        Self::input(&error)
            .at(error.path())
            .on_line(error.line())
            .remedy(error.remedy())
    }
}

impl From<PseudoAtomError> for Failure {
    fn from(error: PseudoAtomError) -> Self {
        match error {
            PseudoAtomError::Coordinate { .. } => {
                Self::input(&error).remedy("move or scale the mesh, or export the balls as .obj")
            }
            PseudoAtomError::File(error) => error.into(),
        }
    }
}

impl From<ThreadsError> for Failure {
    fn from(error: ThreadsError) -> Self {
        Self::other(&error).remedy(error.remedy())
    }
}

impl From<PairTableError> for Failure {
    fn from(error: PairTableError) -> Self {
        Self::input(&error)
            .at(error.path())
            .on_line(error.line())
            .remedy("give a CSV file with columns `receptor` and `ligand`, optionally `name` and options of \
                `knotdock dock`, and a row for each pair")
    }
}
