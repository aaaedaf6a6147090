//! Failures: what went wrong, as text or as JSON, and the exit code that goes with it.

use std::path::{Path, PathBuf};

use crate::messages::shown::shown_name;

/// Whose fault it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// The input's or the command line's: exit code 2.
    Input,
    /// Anything else: exit code 1.
    Other,
    /// Anything else that would happen again: exit code 1.
    Lasting,
}

/// A failure of a command.
#[derive(Clone, Debug)]
pub struct Failure {
    kind: Kind,
    file: Option<PathBuf>,
    line: Option<u64>,
    message: String,
    remedy: Option<String>,
}

/// A message without the numbers of the system's errors: their words say the same.
fn without_numbers(mut message: String) -> String {
    while let Some(start) = message.find(" (os error ")
        && let Some(length) = message[start..].find(')')
    {
        message.replace_range(start..=start + length, "");
    }
    message
}

impl Failure {
    /// A fault of the input or the command line (exit code 2).
    pub fn input(message: impl ToString) -> Self {
        Self {
            kind: Kind::Input,
            file: None,
            line: None,
            message: without_numbers(message.to_string()),
            remedy: None,
        }
    }

    /// Any other fault (exit code 1).
    pub fn other(message: impl ToString) -> Self {
        Self {
            kind: Kind::Other,
            ..Self::input(message)
        }
    }

    /// A fault that is not the input's and would happen again (exit code 1): of the program, or a limit that is met.
    pub fn of_program(message: impl ToString) -> Self {
        Self {
            kind: Kind::Lasting,
            ..Self::input(message)
        }
    }

    /// Whether the same again may succeed.
    pub fn may_pass(&self) -> bool {
        self.kind == Kind::Other
    }

    /// Names the file in question.
    pub fn at(self, file: &Path) -> Self {
        Self {
            file: Some(file.to_owned()),
            ..self
        }
    }

    /// Names the 1-based line in question, where there is one.
    pub fn on_line(self, line: Option<u64>) -> Self {
        Self { line, ..self }
    }

    /// Says what the user can do.
    pub fn remedy(self, remedy: impl ToString) -> Self {
        Self {
            remedy: Some(remedy.to_string()),
            ..self
        }
    }

    /// What went wrong.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The file in question.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Its 1-based line in question.
    pub fn line(&self) -> Option<u64> {
        self.line
    }

    /// What the user can do.
    pub fn advice(&self) -> Option<&str> {
        self.remedy.as_deref()
    }

    /// 2 for bad input, 1 for the rest.
    pub fn exit_code(&self) -> u8 {
        match self.kind {
            Kind::Input => 2,
            Kind::Other | Kind::Lasting => 1,
        }
    }

    /// Names the model of the file in question.
    pub fn in_model(self, model: usize) -> Self {
        Self {
            message: format!("model {model}: {}", self.message),
            ..self
        }
    }

    /// What went wrong and where, in a line for a table.
    pub fn line_of_table(&self) -> String {
        let mut line = self.message.clone();
        let file = self.file.as_ref().map(|file| file.display().to_string());
        if let Some(file) = file.filter(|file| !line.contains(file.as_str())) {
            line += &format!(" (in {file}");
            if let Some(number) = self.line {
                line += &format!(", line {number}");
            }
            line.push(')');
        }
        line
    }

    /// The lines for a person.
    pub fn text(&self) -> String {
        let mut text = format!("error: {}", self.message);
        if let Some(file) = &self.file {
            text += &format!("\n  in {}", shown_name(&file.display().to_string()));
            if let Some(line) = self.line {
                text += &format!(", line {line}");
            }
        }
        if let Some(remedy) = &self.remedy {
            text += &format!("\n  help: {remedy}");
        }
        text
    }

    /// The object for a program: `{"error": {"file", "line", "message", "remedy"}}`.
    pub fn json(&self) -> serde_json::Value {
        serde_json::json!({ "error": {
            "file": self.file.as_ref().map(|file| file.display().to_string()),
            "line": self.line,
            "message": self.message,
            "remedy": self.remedy,
        }})
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_the_system_s_errors_are_left_out() {
        let failure =
            Failure::input("cannot read a: Is a directory (os error 21), nor b (os error 2)");
        assert_eq!(failure.message(), "cannot read a: Is a directory, nor b");
        assert_eq!(Failure::input("(os error").message(), "(os error");
    }
}
