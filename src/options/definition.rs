//! Definitions of all options: name, subject, scope, help and default.
//!
//! All of it is read off the command line that clap derives from the structs of options.

use clap::{Arg, ArgAction, Args, Command, ValueHint};

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

    /// The help, details included.
    pub fn help(&self) -> String {
        let (short, long) = (self.argument.get_help(), self.argument.get_long_help());
        long.or(short).map(ToString::to_string).unwrap_or_default()
    }

    /// The help in a line.
    pub fn short_help(&self) -> String {
        let help = self.argument.get_help();
        help.map(ToString::to_string).unwrap_or_default()
    }

    /// Whether only files of options give it, not words of a command line: weights and potentials, which were fitted
    /// and which few people change.
    pub fn is_of_files(&self) -> bool {
        let name = self.name();
        name.ends_with("_weight") || name.ends_with("_potential")
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

impl Definition {
    /// The line of a file of options that gives the option a value, its table included: `terms.contact_weight=1.5`.
    pub fn line(&self, value: &str) -> String {
        let value = match value.parse::<f64>() {
            Ok(_) => value.to_owned(),
            // A text of JSON is one of TOML.
            Err(_) => serde_json::Value::from(value).to_string(),
        };
        format!("{}.{}={value}", self.subject(), self.name())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::values::number;
    use crate::options::{DockOptions, KernelOptions, definitions, file, text};
    use serde::{Deserialize, Serialize};

    /// A subject with a new option, which is stated here and nowhere else.
    #[derive(Args, Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[command(next_help_heading = "Invented (meshes)")]
    #[serde(deny_unknown_fields)]
    struct InventedOptions {
        /// Weight of inventions: score per patent.
        #[arg(long, value_name = "X", value_parser = number(0.0..=9.0), default_value_t = 2.5)]
        novelty_weight: f64,
        /// Leave out what is known.
        #[arg(long)]
        novel_only: bool,
    }

    #[derive(Args, Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct WithInvented {
        #[command(flatten)]
        kernel: KernelOptions,
        #[command(flatten)]
        invented: InventedOptions,
    }

    /// The new option is in the help, the command line, the defaults, the record, the file and the checks, and can be
    /// varied by name.
    #[test]
    fn a_new_option_arrives_everywhere() {
        let mut command = WithInvented::augment_args(Command::new("dock"));
        let help = command.render_long_help().to_string();
        for part in [
            "Invented (meshes):",
            "--novelty-weight <X>",
            "score per patent",
            "[default: 2.5]",
            "--novel-only",
        ] {
            assert!(help.contains(part), "{part}: {help}");
        }

        let default: WithInvented = text::defaults();
        assert_eq!(default.invented.novelty_weight, 2.5);
        let typed = ["--novelty-weight=3", "--novel-only"].map(Into::into);
        let typed: WithInvented = text::read(typed).unwrap();
        assert!(typed.invented.novel_only && typed.invented.novelty_weight == 3.0);

        let record = serde_json::to_value(&typed).unwrap();
        assert_eq!(record["invented"]["novelty_weight"], 3.0);
        assert_eq!(serde_json::from_value(record).ok(), Some(typed.clone()));

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.toml");
        std::fs::write(&path, "[invented]\nnovelty_weight = 3\nnovel_only = true\n").unwrap();
        let words = file::read::<WithInvented>(&path).unwrap();
        let words = words.into_iter().flat_map(|entry| entry.words);
        assert_eq!(text::read(words.map(Into::into)).ok(), Some(typed.clone()));

        let more = text::with(&typed, "novelty_weight", "4.5").unwrap();
        assert_eq!(more.invented.novelty_weight, 4.5);
        assert!(more.invented.novel_only);
        assert!(text::with(&typed, "novelty_weight", "9.5").is_err());
        assert!(text::with(&typed, "novelty", "1").is_err());

        assert_eq!(text::check(&typed), Ok(()));
        for (value, shown) in [(9.5, "9.5"), (-1.0, "-1.0"), (f64::NAN, "not finite")] {
            let mut wrong = typed.clone();
            wrong.invented.novelty_weight = value;
            let error = text::check(&wrong).unwrap_err();
            let expected = ("novelty-weight", shown);
            assert_eq!((error.name.as_str(), error.value.as_str()), expected);
        }

        let definitions = definitions_of::<WithInvented>();
        let given: Vec<_> = text::given(&typed, &default, &definitions).collect();
        let names: Vec<_> = given.iter().map(|option| option.name()).collect();
        assert_eq!(names, ["novelty_weight", "novel_only"]);
        assert!(given.iter().all(|option| option.scope() == Scope::Meshes));
    }

    /// The heading of each option is the name of its struct's field, and its name that of its own field: so the
    /// command line, files and records agree. Options of the machine are in no record.
    #[test]
    fn names_and_headings_are_those_of_the_fields() {
        let record = serde_json::to_value(DockOptions::default()).unwrap();
        let mut recorded: Vec<String> = Vec::new();
        for (subject, options) in record.as_object().unwrap() {
            let options = options.as_object().into_iter().flatten();
            recorded.extend(options.map(|(name, _)| format!("{subject}.{name}")));
        }
        let defined: Vec<String> = definitions()
            .iter()
            .filter(|option| option.subject() != "machine")
            .map(|option| format!("{}.{}", option.subject(), option.name()))
            .collect();
        assert_eq!(recorded, defined);
        for option in definitions() {
            assert_eq!(option.long(), option.name().replace('_', "-"));
            assert!(!option.help().is_empty(), "{}", option.name());
        }
    }
}
