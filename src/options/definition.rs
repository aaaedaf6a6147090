//! Definitions of options: name, subject, scope, help and default, and the rule by which text becomes a value.
//!
//! The macro `options!` makes the struct of a subject, its defaults and the definitions of its options from one list.

use std::fmt::Display;
use std::path::Path;
use std::str::FromStr;

use knotdock_structures::Error;
use serde::Serialize;
use serde::de::value::StrDeserializer;
use serde::de::{DeserializeOwned, IntoDeserializer};

use super::DockOptions;
use crate::plain_path::plain_path;

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

/// Form of an option's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// On if the option is given; no value.
    Flag,
    /// A value.
    Value,
    /// One of the names in [`Definition::value_name`].
    Choice,
    /// A value that may begin with a minus.
    Signed,
    /// Values with commas between them, or in several places.
    List,
    /// The name of a file.
    File,
}

/// How the text of an option becomes a value, and which values it may have.
pub trait Rule<T> {
    /// The value of a text. Files are looked for from `folder`.
    ///
    /// # Errors
    /// The demand on the value; or the fault of a file, which the error then names.
    fn read(&self, text: &str, folder: &Path) -> Result<T, Error>;

    /// Refuses a value that no text could give, with the demand on it.
    fn check(&self, _value: &T) -> Result<(), Error> {
        Ok(())
    }

    /// The value as text; `None` if it is off, absent or too long for a line.
    fn text(&self, value: &T) -> Option<String>;

    /// The form of the value.
    fn form(&self) -> Form {
        Form::Value
    }
}

/// One option.
#[derive(Debug)]
pub struct Definition {
    pub(super) name: &'static str,
    pub(super) long: String,
    pub(super) heading: &'static str,
    pub(super) subject: String,
    pub(super) scope: Scope,
    pub(super) help: Vec<String>,
    pub(super) value_name: &'static str,
    pub(super) form: Form,
    pub(super) is_of_files: bool,
    pub(super) access: Access,
}

/// Functions that read, check, show and compare the value of an option.
#[derive(Debug)]
pub(super) struct Access {
    pub(super) read: fn(&mut DockOptions, &str, &Path) -> Result<(), Error>,
    pub(super) check: fn(&DockOptions) -> Result<(), Error>,
    pub(super) text: fn(&DockOptions) -> Option<String>,
    pub(super) is_same: fn(&DockOptions, &DockOptions) -> bool,
}

impl Definition {
    /// The name: of the field and of the key in files.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The name on the command line, without its dashes.
    pub fn long(&self) -> &str {
        &self.long
    }

    /// The heading of its group in the help, with the inputs that it has an effect on.
    pub fn heading(&self) -> String {
        let scope = match self.scope {
            Scope::Both => "",
            Scope::Molecules => " (molecules)",
            Scope::Meshes => " (meshes)",
        };
        format!("{}{scope}", self.heading)
    }

    /// The subject: the name of the table in files.
    pub fn subject(&self) -> &str {
        &self.subject
    }

    /// The inputs that the option has an effect on.
    pub fn scope(&self) -> Scope {
        self.scope
    }

    /// The help, details included, a paragraph each.
    pub fn help(&self) -> String {
        self.help.join("\n\n")
    }

    /// The help in a line, without a period.
    pub fn short_help(&self) -> &str {
        let line = self.help.first().map_or("", String::as_str);
        line.strip_suffix('.').unwrap_or(line)
    }

    /// The name of the value in the help: its unit or its choices.
    pub fn value_name(&self) -> &'static str {
        self.value_name
    }

    /// The form of the value.
    pub fn form(&self) -> Form {
        self.form
    }

    /// Whether only files of options give it, not words of a command line: weights and potentials, which were fitted
    /// and which few people change.
    pub fn is_of_files(&self) -> bool {
        self.is_of_files
    }

    /// The default as text, if there is one.
    pub fn default_text(&self) -> Option<String> {
        self.text(&DockOptions::default())
    }

    /// The value in some options as text, if it can be written in a line.
    pub fn text(&self, options: &DockOptions) -> Option<String> {
        (self.access.text)(options)
    }

    /// Whether two sets of options agree in this one.
    pub fn is_same(&self, one: &DockOptions, other: &DockOptions) -> bool {
        (self.access.is_same)(one, other)
    }

    /// Sets the option from text. Files are looked for from `folder`.
    pub fn read(&self, options: &mut DockOptions, text: &str, folder: &Path) -> Result<(), Error> {
        (self.access.read)(options, text, folder)
    }

    /// As [`Self::read`], with errors for a command line, which name the option.
    pub fn set(&self, options: &mut DockOptions, text: &str) -> Result<(), Error> {
        let read = self.read(options, text, Path::new(""));
        read.map_err(|error| match error.file() {
            Some(_) => error,
            None => self.refusal(text, error.message()),
        })
    }

    /// Refuses a value out of range.
    pub(super) fn check(&self, options: &DockOptions) -> Result<(), Error> {
        (self.access.check)(options).map_err(|error| {
            let value = self.text(options).unwrap_or_default();
            self.refusal(&value, error.message())
        })
    }

    /// The refusal of a value; `bound` states what it must be.
    pub fn refusal(&self, value: &str, bound: &str) -> Error {
        let name = &self.long;
        Error::input(format!("--{name} is {value}; {bound}")).help(self.remedy())
    }

    /// The place of the option's description.
    pub(super) fn remedy(&self) -> String {
        match self.is_of_files {
            true => format!("see `{}` in `knotdock preset default --all`", self.name),
            false => format!("see --{} in `knotdock dock --help`", self.long),
        }
    }

    /// The line of a file of options that gives the option a value, its table included: `terms.contact_weight=1.5`.
    pub fn line(&self, value: &str) -> String {
        let value = match value.parse::<f64>() {
            Ok(_) => value.to_owned(),
            // A text of JSON is one of TOML.
            Err(_) => serde_json::Value::from(value).to_string(),
        };
        format!("{}.{}={value}", self.subject, self.name)
    }
}

/// Paragraphs of a doc comment, from its lines.
pub(super) fn paragraphs(lines: &[&str]) -> Vec<String> {
    let lines: Vec<&str> = lines.iter().map(|line| line.trim()).collect();
    let parts = lines.split(|line| line.is_empty());
    parts.map(|part| part.join(" ")).collect()
}

/// Defines the struct of a subject: `NAME as FIELD, "HEADING", SCOPE { OPTIONS }`. FIELD is its field in
/// [`DockOptions`], HEADING its heading in the help and, in lower case, its table in files.
///
/// An option is `name: Type = default, "VALUE", rule;` under its doc comment, which is its help. VALUE is the name of
/// the value in the help. `in files` after the rule leaves the option out of command lines.
macro_rules! options {
    (
        $(#[doc = $about:literal])*
        $name:ident as $field:ident, $heading:literal, $scope:ident {
            $(
                $(#[doc = $doc:literal])+
                $(#[serde($($serde:tt)*)])?
                $option:ident: $type:ty = $default:expr, $value:literal, $rule:expr $(, in $files:ident)?;
            )*
        }
    ) => {
        $(#[doc = $about])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            $(
                $(#[doc = $doc])+
                $(#[serde($($serde)*)])?
                pub $option: $type,
            )*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($option: $default,)* }
            }
        }

        impl $name {
            /// The definitions of its options.
            pub(in crate::options) fn definitions() -> Vec<$crate::options::definition::Definition> {
                use $crate::options::definition::{Access, Definition, Rule, Scope, paragraphs};
                vec![$(Definition {
                    name: stringify!($option),
                    long: stringify!($option).replace('_', "-"),
                    heading: $heading,
                    subject: $heading.to_lowercase(),
                    scope: Scope::$scope,
                    help: paragraphs(&[$($doc),+]),
                    value_name: $value,
                    form: Rule::<$type>::form(&$rule),
                    is_of_files: !["", $(stringify!($files))?].concat().is_empty(),
                    access: Access {
                        read: |options, text, folder| {
                            options.$field.$option = Rule::<$type>::read(&$rule, text, folder)?;
                            Ok(())
                        },
                        check: |options| Rule::<$type>::check(&$rule, &options.$field.$option),
                        text: |options| Rule::<$type>::text(&$rule, &options.$field.$option),
                        is_same: |one, other| one.$field.$option == other.$field.$option,
                    },
                },)*]
            }
        }
    };
}
pub(super) use options;

/// A flag.
pub(super) struct Flag;

impl Rule<bool> for Flag {
    fn read(&self, text: &str, _: &Path) -> Result<bool, Error> {
        let value = text.parse();
        value.map_err(|_| Error::input("it must be true or false"))
    }

    fn text(&self, value: &bool) -> Option<String> {
        value.then(|| "true".to_owned())
    }

    fn form(&self) -> Form {
        Form::Flag
    }
}

/// A value that serde reads from text and writes as text.
pub(super) struct Word;

impl<T: DeserializeOwned + Serialize> Rule<T> for Word {
    fn read(&self, text: &str, _: &Path) -> Result<T, Error> {
        let text: StrDeserializer<'_, serde::de::value::Error> = text.into_deserializer();
        T::deserialize(text).map_err(Error::input)
    }

    fn text(&self, value: &T) -> Option<String> {
        Some(name_of(value))
    }
}

/// One of the names that serde gives to the variants of an enum.
pub(super) struct Choice;

impl<T: DeserializeOwned + Serialize> Rule<T> for Choice {
    fn read(&self, text: &str, folder: &Path) -> Result<T, Error> {
        // serde's sentence is "unknown variant `x`, expected `a` or `b`".
        Word.read(text, folder).map_err(|error: Error| {
            let text = error.to_string();
            let names = text.rsplit("expected ").next().unwrap_or_default();
            Error::input(format!("it must be {}", names.replace('`', "")))
        })
    }

    fn text(&self, value: &T) -> Option<String> {
        Word.text(value)
    }

    fn form(&self) -> Form {
        Form::Choice
    }
}

/// The name of a choice.
pub fn name_of(choice: impl Serialize) -> String {
    match serde_json::to_value(choice) {
        Ok(serde_json::Value::String(name)) => name,
        _ => String::new(),
    }
}

/// A value of a type that reads and writes itself.
pub(super) struct Parsed;

impl<T: FromStr<Err: Display> + Display> Rule<T> for Parsed {
    fn read(&self, text: &str, _: &Path) -> Result<T, Error> {
        text.parse().map_err(Error::input)
    }

    fn text(&self, value: &T) -> Option<String> {
        Some(value.to_string())
    }
}

/// As [`Word`], of a value that may begin with a minus.
pub(super) struct Signed;

impl<T: DeserializeOwned + Serialize> Rule<T> for Signed {
    fn read(&self, text: &str, folder: &Path) -> Result<T, Error> {
        Word.read(text, folder)
    }

    fn text(&self, value: &T) -> Option<String> {
        Word.text(value)
    }

    fn form(&self) -> Form {
        Form::Signed
    }
}

/// A value that may be absent.
pub(super) struct Optional<R>(pub(super) R);

impl<T, R: Rule<T>> Rule<Option<T>> for Optional<R> {
    fn read(&self, text: &str, folder: &Path) -> Result<Option<T>, Error> {
        self.0.read(text, folder).map(Some)
    }

    fn check(&self, value: &Option<T>) -> Result<(), Error> {
        value.as_ref().map_or(Ok(()), |value| self.0.check(value))
    }

    fn text(&self, value: &Option<T>) -> Option<String> {
        value.as_ref().and_then(|value| self.0.text(value))
    }

    fn form(&self) -> Form {
        self.0.form()
    }
}

/// A name. It states what is needed, for a text that is none.
pub(super) struct Name(pub(super) &'static str);

impl Rule<String> for Name {
    fn read(&self, text: &str, _: &Path) -> Result<String, Error> {
        let name = text.trim().to_owned();
        self.check(&name).map(|()| name)
    }

    fn check(&self, name: &String) -> Result<(), Error> {
        match name.trim().is_empty() {
            true => Err(Error::input(self.0)),
            false => Ok(()),
        }
    }

    fn text(&self, name: &String) -> Option<String> {
        Some(name.clone())
    }
}

/// Names with commas between them.
pub(super) struct Names(pub(super) Name);

impl Rule<Vec<String>> for Names {
    fn read(&self, text: &str, folder: &Path) -> Result<Vec<String>, Error> {
        text.split(',')
            .map(|name| self.0.read(name, folder))
            .collect()
    }

    fn check(&self, names: &Vec<String>) -> Result<(), Error> {
        names.iter().try_for_each(|name| self.0.check(name))
    }

    fn text(&self, names: &Vec<String>) -> Option<String> {
        (!names.is_empty()).then(|| names.join(","))
    }

    fn form(&self) -> Form {
        Form::List
    }
}

/// The content of a file.
pub(super) struct Content<T>(pub(super) fn(&Path) -> Result<T, Error>);

impl<T> Rule<T> for Content<T> {
    fn read(&self, text: &str, folder: &Path) -> Result<T, Error> {
        (self.0)(&plain_path(&folder.join(text)))
    }

    fn text(&self, _: &T) -> Option<String> {
        None
    }

    fn form(&self) -> Form {
        Form::File
    }
}
