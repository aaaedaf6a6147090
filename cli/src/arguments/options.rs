//! The options of a command, as they are typed and as a file of `--config` gives them.

use std::ffi::OsString;
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use clap::builder::EnumValueParser;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches, ValueHint, value_parser};
use knotdock::options::definition::Definition;
use knotdock::options::file::{ConfigError, Entry};
use knotdock::options::{DockOptions, Preset, definitions, file, text};

use crate::messages::failure::Failure;

/// Which of the options of `knotdock dock` a command has.
pub trait Selection {
    /// Whether the command has this one.
    fn has(option: &Definition) -> bool;
}

/// All options: of `knotdock dock`.
#[derive(Clone, Debug)]
pub struct OfDock;

impl Selection for OfDock {
    fn has(_: &Definition) -> bool {
        true
    }
}

/// The options that say how a pose scores and how meshes are sampled, and the threads: of `knotdock score`.
#[derive(Clone, Debug)]
pub struct OfScore;

impl Selection for OfScore {
    fn has(option: &Definition) -> bool {
        ["input", "sampling", "kernel", "terms", "restraints"].contains(&option.subject())
            || option.name() == "threads"
    }
}

/// The options of a sweep, which docks no rings and writes no run: of `knotdock tradeoff`.
#[derive(Clone, Debug)]
pub struct OfTradeoff;

impl Selection for OfTradeoff {
    fn has(option: &Definition) -> bool {
        option.subject() != "output" && option.name() != "symmetry"
    }
}

/// The options that say what is read of a structure, and what is assumed of it: of `knotdock inspect`.
#[derive(Clone, Debug)]
pub struct OfInspect;

impl Selection for OfInspect {
    fn has(option: &Definition) -> bool {
        option.subject() == "input" || option.name() == "ph"
    }
}

/// An option with the words that give it a value.
#[derive(Clone, Debug)]
struct Typed {
    name: &'static str,
    words: Vec<OsString>,
}

/// The options of a command as they are typed.
#[derive(Clone, Debug)]
pub struct OptionArguments<S> {
    typed: Vec<Typed>,
    preset: Option<Preset>,
    configs: Vec<PathBuf>,
    selection: PhantomData<S>,
}

/// Name of the option that names a preset.
const PRESET: &str = "preset";

/// Name of the option that names a file of options.
pub const CONFIG: &str = "config";

/// The options of a command that words of the command line give.
fn own<S: Selection>() -> impl Iterator<Item = &'static Definition> {
    let typed = definitions().iter().filter(|option| !option.is_of_files());
    typed.filter(|option| S::has(option))
}

impl<S: Selection> Args for OptionArguments<S> {
    fn augment_args(command: Command) -> Command {
        let preset = Arg::new(PRESET)
            .long(PRESET)
            .value_name("NAME")
            .value_parser(EnumValueParser::<Preset>::new())
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
        own::<S>().fold(command.arg(preset).arg(config), |command, option| {
            command.arg(option.argument().clone())
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<S: Selection> FromArgMatches for OptionArguments<S> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut typed = Vec::new();
        for option in own::<S>() {
            let name = option.name();
            if matches.value_source(name) != Some(ValueSource::CommandLine) {
                continue;
            }
            let words = if option.is_flag() {
                vec![format!("--{}", option.long()).into()]
            } else {
                let values = matches.get_raw(name).into_iter().flatten();
                values
                    .map(|value| {
                        let mut word = OsString::from(option.word(""));
                        word.push(value);
                        word
                    })
                    .collect()
            };
            typed.push(Typed { name, words });
        }
        Ok(Self {
            typed,
            preset: matches.get_one(PRESET).copied(),
            configs: matches
                .get_many(CONFIG)
                .into_iter()
                .flatten()
                .cloned()
                .collect(),
            selection: PhantomData,
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Options, and which of them were given.
#[derive(Clone)]
pub struct GivenOptions {
    /// The options, by default where they were not given.
    pub options: DockOptions,
    given: Vec<String>,
    /// Whether rotations were given by their angle.
    pub by_angle: bool,
}

impl GivenOptions {
    /// Whether an option was typed, or given by a file.
    pub fn has(&self, name: &str) -> bool {
        self.given.iter().any(|given| given == name)
    }

    /// The options of a search for rings, if it is one.
    pub fn of_rings(self) -> Result<Self, Failure> {
        if self.options.search.symmetry.is_some() && self.by_angle {
            return Err(Failure::input(
                "--rotations is an angle here, and a search for rings counts axes",
            )
            .remedy("give --rotations a number of axes, or leave it out"));
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
    ///
    /// # Errors
    /// [`Failure`] for a file of options that cannot be read.
    pub fn given(&self) -> Result<GivenOptions, Failure> {
        let mut from_files = match self.preset {
            Some(preset) => preset.entries()?,
            None => Vec::new(),
        };
        for config in &self.configs {
            let later = entries_of(config)?;
            from_files.retain(|entry| later.iter().all(|later| later.name != entry.name));
            from_files.extend(later);
        }
        let mut words: Vec<OsString> = Vec::new();
        let mut given: Vec<String> = Vec::new();
        for entry in from_files {
            if self.typed.iter().all(|typed| typed.name != entry.name) {
                words.extend(entry.words.into_iter().map(Into::into));
                given.push(entry.name);
            }
        }
        for typed in &self.typed {
            words.extend(typed.words.iter().cloned());
            given.push(typed.name.to_owned());
        }
        let by_angle = words.iter().any(|word| {
            let word = word.to_string_lossy();
            word.starts_with("--rotations=") && word.ends_with("deg")
        });
        let options: DockOptions = text::read(words)?;
        Ok(GivenOptions {
            options,
            given,
            by_angle,
        })
    }
}

/// The options of a value of `--config`: a file, or a line that is none.
fn entries_of(config: &Path) -> Result<Vec<Entry>, ConfigError> {
    let line = config.to_str().filter(|text| text.contains('='));
    match line {
        Some(line) if !config.exists() => file::read_line::<DockOptions>(line),
        _ => file::read::<DockOptions>(config),
    }
}
