//! Options as words of a command line, and back.

use std::error::Error;
use std::ffi::OsString;

use clap::error::{ContextKind, ContextValue};
use clap::{Args, Command};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::definition::{Definition, definitions_of};
use super::values::BOUND;

/// Why an option cannot have a value.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name} is {value}; it must be {bound}")]
pub struct OptionError {
    /// Name of the option on the command line, without its dashes.
    pub name: String,
    /// The value.
    pub value: String,
    /// What it must be.
    pub bound: String,
}

/// Options from words such as `--lambda=9`. An option that no word names has its default.
///
/// # Errors
/// As clap states them.
pub fn read<T: Args>(words: impl IntoIterator<Item = OsString>) -> Result<T, clap::Error> {
    let command = Command::new("knotdock")
        .no_binary_name(true)
        .disable_help_flag(true);
    let matches = T::augment_args(command).try_get_matches_from(words)?;
    T::from_arg_matches(&matches)
}

/// The options of an empty command line.
pub(super) fn defaults<T: Args>() -> T {
    match read([]) {
        Ok(options) => options,
        Err(error) => unreachable!("every option has a default or may be left out: {error}"),
    }
}

/// The words that give an option its value in `options`. None for a value of `None`, a flag that is off and a table,
/// which was checked when it was read.
fn words_of(option: &Definition, options: &Value) -> Result<Vec<OsString>, OptionError> {
    let Some(value) = value_of(option, options) else {
        return Ok(Vec::new());
    };
    let word = |text: &str| OsString::from(option.word(text));
    Ok(match value {
        Value::Bool(true) => vec![format!("--{}", option.long()).into()],
        Value::Bool(false) => Vec::new(),
        Value::Number(number) => vec![word(&number.to_string())],
        Value::String(text) => vec![word(text)],
        Value::Array(values) if !option.names_file() => {
            let texts = values.iter().filter_map(Value::as_str);
            texts.map(word).collect()
        }
        Value::Array(_) | Value::Object(_) => Vec::new(),
        // JSON has neither infinity nor NaN.
        Value::Null if option.has_default() => {
            return Err(OptionError {
                name: option.long().to_owned(),
                value: "not finite".to_owned(),
                bound: "a finite number".to_owned(),
            });
        }
        Value::Null => Vec::new(),
    })
}

/// The options that differ from their defaults.
pub fn given<'a, T: Serialize>(
    options: &T,
    default: &T,
    definitions: &'a [Definition],
) -> impl Iterator<Item = &'a Definition> + use<'a, T> {
    let [own, default] = [options, default].map(|options| recorded(options).unwrap_or_default());
    definitions.iter().filter(move |option| {
        let [own, default] = [&own, &default].map(|record| value_of(option, record));
        own != default
    })
}

/// The value of an option in a record; `None` for one that is not recorded, as those of the machine are not.
fn value_of<'a>(option: &Definition, record: &'a Value) -> Option<&'a Value> {
    record.get(option.subject())?.get(option.name())
}

/// Checks the range of each option as if its value were typed.
///
/// # Errors
/// [`OptionError`] for the first that is out of range.
pub fn check<T: Args + Serialize>(options: &T) -> Result<(), OptionError> {
    let recorded = recorded(options)?;
    let mut words = Vec::new();
    for option in definitions_of::<T>() {
        words.extend(words_of(&option, &recorded)?);
    }
    read::<T>(words).map(drop).map_err(|error| refused(&error))
}

/// The options with the value of one changed, as if it were typed in place of what was.
///
/// # Errors
/// [`OptionError`] for a name that is no option's and a value out of range.
pub fn with<T>(options: &T, name: &str, text: &str) -> Result<T, OptionError>
where
    T: Args + Serialize + DeserializeOwned,
{
    let definitions = definitions_of::<T>();
    let option = definitions.iter().find(|option| option.name() == name);
    let unknown = |bound: String| OptionError {
        name: name.to_owned(),
        value: text.to_owned(),
        bound,
    };
    let option = option.ok_or_else(|| unknown("the value of an option".to_owned()))?;
    let typed: T = read([option.word(text).into()]).map_err(|error| refused(&error))?;
    let (mut all, typed) = (recorded(options)?, recorded(&typed)?);
    all[option.subject()][name] = typed[option.subject()][name].clone();
    serde_json::from_value(all).map_err(|error| unknown(error.to_string()))
}

/// The options as in `run.json`.
fn recorded(options: &impl Serialize) -> Result<Value, OptionError> {
    serde_json::to_value(options).map_err(|error| OptionError {
        name: "options".to_owned(),
        value: "no record".to_owned(),
        bound: error.to_string(),
    })
}

/// What clap found wrong with a value.
pub(super) fn refused(error: &clap::Error) -> OptionError {
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.clone(),
        _ => String::new(),
    };
    let argument = text(ContextKind::InvalidArg);
    let name = argument.trim_start_matches('-').split([' ', '=']).next();
    let bound = match (error.source(), error.get(ContextKind::ValidValue)) {
        (Some(source), _) => source.to_string(),
        (None, Some(ContextValue::Strings(values))) => format!("one of {}", values.join(", ")),
        (None, _) => first_paragraph(error),
    };
    OptionError {
        name: name.unwrap_or_default().to_owned(),
        value: text(ContextKind::InvalidValue),
        bound: bound.strip_prefix(BOUND).unwrap_or(&bound).to_owned(),
    }
}

/// What is wrong with a command line, without the lines on usage.
pub fn first_paragraph(error: &clap::Error) -> String {
    // clap's text is the message with usage lines; its first paragraph is the message.
    let text = error.render().to_string();
    let message = text.split("\n\n").next().unwrap_or(&text);
    message.trim_start_matches("error: ").trim().to_owned()
}
