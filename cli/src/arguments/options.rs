//! The options of a command, as they are typed and as files of `--config` give them.

use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use clap::builder::{PossibleValuesParser, ValueParser};
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches, ValueHint, value_parser};

use knotdock::options::definition::{Definition, Form};
use knotdock::options::file::GivenOption;
use knotdock::options::{DockOptions, Preset, definitions};
use knotdock_structures::Error;

pub trait Selection {
    /// Whether presets and files of options give some, too.
    const HAS_FILES: bool;

    fn has(option: &Definition) -> bool;
}

/// Selections: a name, whether files give options, and whether the command has an option.
macro_rules! selections {
    ($($(#[$doc:meta])* $name:ident, $has_files:literal, $has:expr;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Debug)]
        pub struct $name;

        impl Selection for $name {
            const HAS_FILES: bool = $has_files;

            fn has(option: &Definition) -> bool {
                let has: fn(&Definition) -> bool = $has;
                has(option)
            }
        }
    )*};
}

selections! {
    /// All options: of `knotdock dock`.
    OfDock, true, |_| true;
    /// The options that decide how a pose scores and how meshes are sampled, and the threads: of `knotdock score`.
    OfScore, true, |option| {
        ["input", "sampling", "kernel", "terms", "restraints"].contains(&option.subject())
            || option.name() == "threads"
    };
    /// The options of a sweep, which docks no rings and writes no run: of `knotdock tradeoff`.
    OfTradeoff, true, |option| option.subject() != "output" && option.name() != "symmetry";
    /// The options on reading a structure and on assumptions about it: of `knotdock inspect`.
    OfInspect, true, |option| option.subject() == "input" || option.name() == "ph";
    /// The options on reading molecules.
    OfReading, false, |option| option.subject() == "input";
    /// The options of the machine: of commands that take much memory.
    OfMachine, false, |option| option.subject() == "machine";
}

#[derive(Clone, Debug)]
pub struct OptionArguments<S> {
    typed: Vec<(&'static Definition, String)>,
    preset: Option<Preset>,
    configs: Vec<PathBuf>,
    selection: PhantomData<S>,
}

const PRESET: &str = "preset";

/// Name of the option that names a file of options.
pub const CONFIG: &str = "config";

pub fn preset_parser() -> PossibleValuesParser {
    let values = Preset::ALL
        .into_iter()
        .map(|preset| clap::builder::PossibleValue::new(preset.name).help(preset.about));
    PossibleValuesParser::new(values)
}

fn typed(has: fn(&Definition) -> bool) -> impl Iterator<Item = &'static Definition> {
    let all = definitions().iter();
    all.filter(move |option| !option.is_of_files() && has(option))
}

fn argument(option: &'static Definition) -> Arg {
    let argument = Arg::new(option.name())
        .long(option.long())
        .help_heading(option.heading())
        .help(option.short_help().to_owned());
    let argument = match option.help().contains("\n\n") {
        true => argument.long_help(option.help()),
        false => argument,
    };
    // The program's own short names; `-j` is that of make and of most docking programs.
    let argument = match option.name() {
        "threads" => argument.short('j'),
        _ => argument,
    };
    if option.form() == Form::Flag {
        return argument.action(ArgAction::SetTrue);
    }
    let argument = argument
        .value_name(option.value_name())
        .value_parser(text_parser(option))
        .action(match option.form() {
            Form::List => ArgAction::Append,
            _ => ArgAction::Set,
        })
        .allow_hyphen_values(option.form() == Form::Signed)
        .value_hint(match option.form() {
            Form::File => ValueHint::FilePath,
            _ => ValueHint::Unknown,
        });
    match option.default_text() {
        Some(default) => argument.default_value(default),
        None => argument,
    }
}

/// The parser of an option's text. Files are read later, once.
fn text_parser(option: &'static Definition) -> ValueParser {
    let parse = move |text: &str| -> Result<String, Error> {
        if option.form() != Form::File {
            option.read(&mut DockOptions::default(), text, Path::new(""))?;
        }
        Ok(text.to_owned())
    };
    ValueParser::new(parse)
}

fn typed_value(option: &'static Definition, matches: &ArgMatches) -> Option<String> {
    let name = option.name();
    if matches.value_source(name) != Some(ValueSource::CommandLine) {
        return None;
    }
    if option.form() == Form::Flag {
        return Some("true".to_owned());
    }
    let values = matches.get_many::<String>(name).into_iter().flatten();
    Some(values.cloned().collect::<Vec<_>>().join(","))
}

impl<S: Selection> Args for OptionArguments<S> {
    fn augment_args(command: Command) -> Command {
        let preset = Arg::new(PRESET)
            .long(PRESET)
            .value_name("NAME")
            .value_parser(preset_parser())
            .help("Options by a name; `knotdock preset NAME` prints them");
        let config = Arg::new(CONFIG)
            .long(CONFIG)
            .value_name("FILE")
            .value_hint(ValueHint::FilePath)
            .value_parser(value_parser!(PathBuf))
            .action(ArgAction::Append)
            .help("Options from a TOML file, or one such as terms.contact_weight=1")
            .long_help(
                "Options from a TOML file: tables named as the groups of `knotdock dock --help`, such as [search], and \
                 lines such as rotations = 7200. One option may stand for a file: terms.contact_weight=1. May be given \
                 several times. Later files win over earlier ones and over the preset, and what is typed wins over \
                 files. Weights and potentials of the score are given by files alone (`knotdock preset default --all` \
                 lists them).",
            );
        let command = match S::HAS_FILES {
            true => command.arg(preset).arg(config),
            false => command,
        };
        command.args(typed(S::has).map(argument))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<S: Selection> FromArgMatches for OptionArguments<S> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let value = |option| Some((option, typed_value(option, matches)?));
        let files = S::HAS_FILES.then_some(matches);
        let preset = files.and_then(|matches| matches.get_one::<String>(PRESET));
        let configs = files.and_then(|matches| matches.get_many(CONFIG));
        Ok(Self {
            typed: typed(S::has).filter_map(value).collect(),
            preset: preset.and_then(|name| Preset::named(name)),
            configs: configs.into_iter().flatten().cloned().collect(),
            selection: PhantomData,
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

#[derive(Clone)]
pub struct GivenOptions {
    /// The options, by default where they were not given.
    pub options: DockOptions,
    given: Vec<GivenOption>,
}

impl GivenOptions {
    pub fn has(&self, name: &str) -> bool {
        self.given.iter().any(|given| given.name == name)
    }

    pub fn by_angle(&self) -> bool {
        let rotations = self.given.iter().rfind(|given| given.name == "rotations");
        rotations.is_some_and(|given| given.text.ends_with("deg"))
    }

    /// The options of a search for rings, if it is one.
    pub fn of_rings(self) -> Result<Self, Error> {
        if self.options.search.symmetry.is_some() && self.by_angle() {
            return Err(Error::input(
                "--rotations is an angle here, and a search for rings counts axes",
            )
            .help("give --rotations a number of axes, or leave it out"));
        }
        let rotations_given = self.has("rotations");
        Ok(Self {
            options: self.options.of_rings(rotations_given),
            ..self
        })
    }
}

impl<S: Selection> OptionArguments<S> {
    /// The options: as typed, else as the last file gives them, else as the preset does, else by default.
    pub fn given(&self) -> Result<GivenOptions, Error> {
        let mut options = DockOptions::default();
        let mut given = match self.preset {
            Some(preset) => preset.apply(&mut options)?,
            None => Vec::new(),
        };
        for config in &self.configs {
            let line = config.to_str().filter(|text| text.contains('='));
            given.extend(match line {
                Some(line) if !config.exists() => options.read_line(line)?,
                _ => options.read_file(config)?,
            });
        }
        for (option, text) in &self.typed {
            option.set(&mut options, text)?;
            given.push(GivenOption {
                name: option.name(),
                text: text.clone(),
            });
        }
        Ok(GivenOptions { options, given })
    }
}
