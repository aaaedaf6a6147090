//! The error that a user sees.

use std::fmt;
use std::path::{Path, PathBuf};

/// Cause of an error, which decides the exit code of the program and whether another attempt makes sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cause {
    /// The input or the options.
    Input,
    /// The machine, for now: a full disk, for instance.
    Machine,
    /// The program or a limit that was set: another attempt ends in the same way.
    Lasting,
}

/// An error for users: its message, the file and line at fault, and a remedy.
///
/// It is made where the fault is found, by [`Error::input`] and the methods that add to it. `Display` shows the
/// message alone.
///
/// ```
/// use std::path::Path;
/// use knotdock_structures::Error;
///
/// let error = Error::input("radius -1 is below 0")
///     .at(Path::new("balls.csv"))
///     .on_line(3)
///     .help("give every ball a radius above 0");
/// assert_eq!((error.exit_code(), error.line()), (2, Some(3)));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Error {
    cause: Cause,
    file: Option<PathBuf>,
    line: Option<u64>,
    message: String,
    remedy: Option<String>,
}

impl fmt::Display for Error {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(&self.message)
    }
}

impl std::error::Error for Error {}

impl Error {
    /// A fault of the input or the options (exit code 2).
    pub fn input(message: impl fmt::Display) -> Self {
        Self {
            cause: Cause::Input,
            file: None,
            line: None,
            message: without_numbers(message.to_string()),
            remedy: None,
        }
    }

    /// A fault of the machine that may pass (exit code 1): a full disk, for instance.
    pub fn machine(message: impl fmt::Display) -> Self {
        Self {
            cause: Cause::Machine,
            ..Self::input(message)
        }
    }

    /// A fault of the program, or a limit that was set and is reached (exit code 1).
    pub fn lasting(message: impl fmt::Display) -> Self {
        Self {
            cause: Cause::Lasting,
            ..Self::input(message)
        }
    }

    /// Adds the file at fault, unless the error has one.
    #[must_use]
    pub fn at(mut self, file: &Path) -> Self {
        self.file.get_or_insert_with(|| file.to_owned());
        self
    }

    /// Sets the 1-based line at fault.
    #[must_use]
    pub fn on_line(self, line: impl Into<Option<u64>>) -> Self {
        Self {
            line: line.into(),
            ..self
        }
    }

    /// Sets what the user can do.
    #[must_use]
    pub fn help(self, remedy: impl fmt::Display) -> Self {
        Self {
            remedy: Some(remedy.to_string()),
            ..self
        }
    }

    /// Puts words before the message: `model 3: ...`.
    #[must_use]
    pub fn within(self, context: impl fmt::Display) -> Self {
        Self {
            message: format!("{context}: {}", self.message),
            ..self
        }
    }

    /// Adds words to the message.
    #[must_use]
    pub fn and(self, more: impl fmt::Display) -> Self {
        Self {
            message: format!("{}; {more}", self.message),
            ..self
        }
    }

    /// The message.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The file at fault.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// The 1-based line at fault.
    pub fn line(&self) -> Option<u64> {
        self.line
    }

    /// What the user can do.
    pub fn remedy(&self) -> Option<&str> {
        self.remedy.as_deref()
    }

    /// Whether the input or the options are at fault.
    pub fn is_input(&self) -> bool {
        self.cause == Cause::Input
    }

    /// The exit code of a program that fails with it: 2 for bad input or options, 1 for the rest.
    pub fn exit_code(&self) -> u8 {
        match self.cause {
            Cause::Input => 2,
            Cause::Machine | Cause::Lasting => 1,
        }
    }

    /// Whether another attempt may succeed.
    pub fn may_pass(&self) -> bool {
        self.cause == Cause::Machine
    }

    /// Message, file and line on one line, for a cell of a table.
    pub fn in_one_line(&self) -> String {
        let mut text = self.message.clone();
        let file = self.file.as_ref().map(|file| file.display().to_string());
        if let Some(file) = file.filter(|file| !text.contains(file.as_str())) {
            text += &format!(" (in {file}");
            if let Some(line) = self.line {
                text += &format!(", line {line}");
            }
            text.push(')');
        }
        text
    }
}

impl From<crate::knots::KnotsError> for Error {
    fn from(error: crate::knots::KnotsError) -> Self {
        Self::input(error).help("check the structure's coordinates and radii")
    }
}

/// A message without the numbers of the system's errors, which repeat their words.
fn without_numbers(mut message: String) -> String {
    while let Some(start) = message.find(" (os error ")
        && let Some(length) = message[start..].find(')')
    {
        message.replace_range(start..=start + length, "");
    }
    message
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_the_system_s_errors_are_left_out() {
        let error = Error::input("cannot read a: Is a directory (os error 21), nor b (os error 2)");
        assert_eq!(error.message(), "cannot read a: Is a directory, nor b");
        assert_eq!(Error::input("(os error").message(), "(os error");
    }
}
