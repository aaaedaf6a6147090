//! What is known of each option: its name, subject, scope, help and default.
//!
//! All of it is read off the command line that clap derives from the structs of options.

use std::sync::OnceLock;

use clap::{Arg, ArgAction, Args, Command, ValueHint};

use super::DockOptions;

/// Inputs that an option has an effect on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// Molecules and meshes.
    Both,
    /// Molecules alone.
    Molecules,
    /// Meshes alone.
    Meshes,
}

/// One option.
#[derive(Clone, Debug)]
pub struct Definition {
    subject: String,
    scope: Scope,
    argument: Arg,
}

impl Definition {
    /// The definition of an argument: its heading in the help is the subject, and perhaps the scope in parentheses.
    fn of(argument: &Arg) -> Self {
        let heading = argument.get_help_heading().unwrap_or_default();
        let (subject, scope) = match heading.split_once(" (") {
            Some((subject, "molecules)")) => (subject, Scope::Molecules),
            Some((subject, "meshes)")) => (subject, Scope::Meshes),
            _ => (heading, Scope::Both),
        };
        Self {
            subject: subject.to_lowercase(),
            scope,
            argument: argument.clone(),
        }
    }

    /// The name: of the field and of the key in files.
    pub fn name(&self) -> &str {
        self.argument.get_id().as_str()
    }

    /// The name on the command line, without its dashes.
    pub fn long(&self) -> &str {
        self.argument.get_long().unwrap_or_default()
    }

    /// The subject: the name of the table in files.
    pub fn subject(&self) -> &str {
        &self.subject
    }

    /// The inputs that the option has an effect on.
    pub fn scope(&self) -> Scope {
        self.scope
    }

    /// The argument of a command line.
    pub fn argument(&self) -> &Arg {
        &self.argument
    }

    /// The help.
    pub fn help(&self) -> String {
        let help = self.argument.get_help();
        help.map(ToString::to_string).unwrap_or_default()
    }

    /// Whether the value is the name of a file.
    pub fn names_file(&self) -> bool {
        names_file(&self.argument)
    }

    /// Whether the option is on where it is given, and takes no value.
    pub fn is_flag(&self) -> bool {
        matches!(self.argument.get_action(), ArgAction::SetTrue)
    }

    /// Whether the option takes several values.
    pub fn takes_several(&self) -> bool {
        matches!(self.argument.get_action(), ArgAction::Append)
    }

    /// Whether there is a value where none is given.
    pub(super) fn has_default(&self) -> bool {
        !self.argument.get_default_values().is_empty()
    }

    /// The word of a command line that gives the option a value.
    pub fn word(&self, value: &str) -> String {
        format!("--{}={value}", self.long())
    }
}

/// Whether the value of an argument is the name of a file.
pub fn names_file(argument: &Arg) -> bool {
    argument.get_value_hint() == ValueHint::FilePath
}

/// The options of a struct, in their order.
pub fn definitions_of<T: Args>() -> Vec<Definition> {
    let command = T::augment_args(Command::new("options"));
    command.get_arguments().map(Definition::of).collect()
}

/// The options of a docking run.
pub fn definitions() -> &'static [Definition] {
    static ALL: OnceLock<Vec<Definition>> = OnceLock::new();
    ALL.get_or_init(definitions_of::<DockOptions>)
}

/// The option of a docking run with a name.
pub fn definition(name: &str) -> Option<&'static Definition> {
    definitions().iter().find(|option| option.name() == name)
}
