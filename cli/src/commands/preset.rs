//! `knotdock preset`: sets of options as files of `--config`.

use std::fmt::Write as _;

use clap::Args;
use serde_json::{Value, json};

use crate::messages::console::Console;
use crate::messages::failure::Failure;
use knotdock::options::definition::Definition;
use knotdock::options::{DockOptions, Preset, definitions, text};

/// Print the options of a preset as a file for --config.
///
/// `knotdock dock --preset NAME` takes them without a file.
#[derive(Args, Debug)]
pub struct PresetCommand {
    /// The preset.
    #[arg(value_enum, value_name = "NAME")]
    name: Preset,
    /// Print every option with its value, weights and potentials among them.
    #[arg(long)]
    all: bool,
}

impl PresetCommand {
    /// Prints it.
    pub fn run(self, console: Console) -> Result<(), Failure> {
        let text = match self.all {
            true => all_options(self.name)?,
            false => self.name.text().to_owned(),
        };
        console.say(text.trim_end());
        console.result(&json!({ "text": text }))
    }
}

/// Every option as a line of a file, a table a subject. Options without a value stand in comments.
fn all_options(preset: Preset) -> Result<String, Failure> {
    let entries = preset.entries()?;
    let words = entries.into_iter().flat_map(|entry| entry.words);
    let options: DockOptions = text::read(words.map(Into::into))?;
    let record = serde_json::to_value(&options).map_err(Failure::other)?;
    let mut file = String::new();
    let mut subject = "";
    for option in definitions() {
        if subject != option.subject() {
            subject = option.subject();
            let gap = if file.is_empty() { "" } else { "\n" };
            let _ = writeln!(file, "{gap}[{subject}]");
        }
        let help = option.short_help();
        let _ = writeln!(file, "# {help}");
        let _ = match value(option, &record) {
            Some(value) => writeln!(file, "{} = {value}", option.name()),
            None => writeln!(file, "# {} =", option.name()),
        };
    }
    Ok(file)
}

/// The value of an option as TOML has it, if it has one. What JSON writes of numbers, texts, truths and lists is TOML.
fn value(option: &Definition, record: &Value) -> Option<String> {
    let value = record.get(option.subject())?.get(option.name())?;
    match value {
        Value::Null | Value::Object(_) => None,
        Value::Array(items) if items.is_empty() => None,
        value => Some(value.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use clap::ValueEnum;

    use super::*;
    use knotdock::options::file::read_text;

    #[test]
    fn a_file_of_all_options_is_the_preset() {
        let read = |entries: Vec<knotdock::options::file::Entry>| -> DockOptions {
            let words = entries.into_iter().flat_map(|entry| entry.words);
            text::read(words.map(Into::into)).unwrap()
        };
        for preset in Preset::value_variants() {
            let file = all_options(*preset).unwrap_or_else(|_| panic!("{preset:?}"));
            let entries = read_text::<DockOptions>(&file, Path::new("all.toml")).unwrap();
            assert_eq!(read(entries), read(preset.entries().unwrap()));
            for option in definitions() {
                assert!(file.contains(&format!("{} =", option.name())));
            }
        }
    }
}
