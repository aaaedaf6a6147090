//! `knotdock preset`: sets of options as files of `--config`.

use std::fmt::Write as _;

use clap::Args;
use serde_json::{Value, json};

use crate::arguments::options::preset_parser;
use crate::messages::console::Console;
use knotdock::options::definition::Definition;
use knotdock::options::{DockOptions, Preset, definitions};
use knotdock_structures::Error;

/// Print the options of a preset as a file for --config.
///
/// `knotdock dock --preset NAME` takes them without a file.
#[derive(Args, Debug)]
pub struct PresetCommand {
    /// The preset.
    #[arg(value_name = "NAME", value_parser = preset_parser())]
    name: String,
    /// Print every option with its value, weights and potentials among them.
    #[arg(long)]
    all: bool,
}

impl PresetCommand {
    pub fn run(self, console: Console) -> Result<(), Error> {
        // The parser takes no other name.
        let preset = Preset::named(&self.name).unwrap_or(Preset::ALL[0]);
        let text = match self.all {
            true => all_options(preset)?,
            false => preset.text.to_owned(),
        };
        console.say(text.trim_end());
        console.result(&json!({ "text": text }))
    }
}

/// Every option as a line of a file, one table per subject. Options without a value are in comments.
fn all_options(preset: Preset) -> Result<String, Error> {
    let mut options = DockOptions::default();
    preset.apply(&mut options)?;
    let record = serde_json::to_value(&options).map_err(Error::machine)?;
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

    use super::*;

    #[test]
    fn a_file_of_all_options_is_the_preset() {
        for preset in Preset::ALL {
            let file = all_options(preset).unwrap();
            let [mut read, mut expected] = [(); 2].map(|()| DockOptions::default());
            read.read_toml(&file, Path::new("all.toml")).unwrap();
            preset.apply(&mut expected).unwrap();
            assert_eq!(read, expected);
            for option in definitions() {
                assert!(file.contains(&format!("{} =", option.name())));
            }
        }
    }
}
