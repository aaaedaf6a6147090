//! The command line: one thin file per command. Each reads its options, calls the library and hands the results to
//! [`knotdock::output`] and the console.
//!
//! The program is [`main`]. Other programs run commands in-process by [`call`] and receive messages by a [`Listener`].

mod arguments;
mod commands;
mod docked;
mod docking;
mod ensemble;
mod inputs;
mod messages;
pub mod plot;
pub mod records;
mod refining;
mod report;
#[cfg(feature = "serve")]
mod serve;
mod shards;
mod solid_files;
pub mod system_limits;
pub mod tables;
mod tradeoff;

use std::borrow::Cow;
use std::ffi::{OsStr, OsString};
use std::sync::LazyLock;

use clap::error::ErrorKind;
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use knotdock::output::records::program::VERSION_WITH_COMMIT;
use knotdock::search::scan_engine::name_runtime_folder;
use knotdock::threads;
use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;

pub use arguments::machine::default_limit as memory_limit;
use arguments::options::{OfReading, OptionArguments};
use arguments::{ProgramArguments, with_negative_numbers};
use inputs::molecules::Input;
use messages::console::Console;
pub use messages::console::Listener;
use messages::shown::shown;
use messages::suggestions::{self, UTF_8, first_paragraph};
pub use report::view_page;
#[cfg(feature = "serve")]
pub use serve::start_by;
use system_limits::{report_as_json, report_end};

/// Docks two structures or two meshes by correlating their spherical decompositions, evaluates and writes the poses,
/// and samples meshes.
///
/// Method: Behandish & Ilies, Computer-Aided Design 70 (2016) 100-115. Lengths are in Å, of meshes in the unit of
/// their files, angles in degrees. Exit codes: 0 done, 2 bad input, 1 any other failure.
#[derive(Debug, Parser)]
#[command(name = "knotdock", version = VERSION_WITH_COMMIT, long_version = long_version())]
struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    program: ProgramArguments,
}

#[derive(Debug, Subcommand)]
enum Command {
    Dock(Box<commands::dock::Dock>),
    Batch(commands::batch::Batch),
    Merge(commands::merge::Merge),
    Serve(commands::serve::Serve),
    Export(commands::export::Export),
    Refine(commands::refine::Refine),
    Evaluate(Box<commands::evaluate::Evaluate>),
    Score(Box<commands::score::Score>),
    Interface(Box<commands::interface::InterfaceCommand>),
    Models(commands::models::ModelsCommand),
    Report(commands::report::Report),
    Inspect(commands::inspect::Inspect),
    Sample(commands::sample::Sample),
    Collide(Box<commands::collide::Collide>),
    Obstacle(Box<commands::obstacle::Obstacle>),
    Morph(Box<commands::morph::Morph>),
    Se3(commands::se3::Se3),
    Tradeoff(Box<commands::tradeoff::TradeoffCommand>),
    #[command(hide = true)]
    Preset(commands::preset::PresetCommand),
    #[command(hide = true)]
    Completions(commands::completions::Completions),
    #[command(hide = true)]
    Man(commands::completions::ManPages),
}

/// The commands that `knotdock --help` lists, by subject.
const SUBJECTS: [(&str, &[&str]); 4] = [
    ("Docking", &["dock", "batch", "merge", "serve"]),
    (
        "Results",
        &[
            "export",
            "refine",
            "evaluate",
            "score",
            "interface",
            "models",
            "report",
            "inspect",
        ],
    ),
    ("Solids", &["sample", "collide", "obstacle", "morph", "se3"]),
    ("Accuracy", &["tradeoff"]),
];

/// Features that the program may be built with, and whether it was.
const FEATURES: [(&str, bool); 3] = [
    ("gpu", cfg!(feature = "gpu")),
    ("serve", cfg!(feature = "serve")),
    ("viewer", cfg!(feature = "viewer")),
];

/// Version, commit and features, as `--version` shows them.
fn long_version() -> &'static str {
    static TEXT: LazyLock<String> = LazyLock::new(|| {
        let features: Vec<&str> = FEATURES
            .iter()
            .filter(|(_, on)| *on)
            .map(|(name, _)| *name)
            .collect();
        let features = match features.join(", ") {
            none if none.is_empty() => "none".to_owned(),
            names => names,
        };
        format!("{VERSION_WITH_COMMIT}\nfeatures: {features}")
    });
    &TEXT
}

/// Runs the program on arguments, of which the first is the name it was called by; its exit code.
pub fn main(arguments: Vec<OsString>) -> u8 {
    report_end();
    name_runtime_folder();
    let json = wants_json(&arguments);
    if json {
        report_as_json();
    }
    let cli = match parsed(&arguments) {
        Ok(cli) => cli,
        Err(error) => return refuse(&escaped(error, &arguments), &arguments, json),
    };
    let console = Console::from(cli.program);
    if let Err(error) = threads::stay_on_main() {
        console.fail(&error);
        return 1;
    }
    match run(cli.command, console).and_then(|code| Console::all_said().map(|()| code)) {
        Ok(code) => code,
        Err(failure) => {
            console.fail(&failure);
            failure.exit_code()
        }
    }
}

/// Runs a command; its exit code.
fn run(command: Command, console: Console) -> Result<u8, Error> {
    let done = match command {
        Command::Dock(command) => command.run(console),
        Command::Batch(command) => return command.run(console),
        Command::Merge(command) => command.run(console),
        Command::Serve(command) => command.run(console),
        Command::Export(command) => command.run(console),
        Command::Refine(command) => command.run(console),
        Command::Evaluate(command) => return command.run(console),
        Command::Score(command) => command.run(console),
        Command::Interface(command) => return command.run(console),
        Command::Models(command) => return command.run(console),
        Command::Report(command) => command.run(console),
        Command::Inspect(command) => command.run(console),
        Command::Sample(command) => command.run(console),
        Command::Collide(command) => command.run(console),
        Command::Obstacle(command) => command.run(console),
        Command::Morph(command) => command.run(console),
        Command::Se3(command) => command.run(console),
        Command::Tradeoff(command) => command.run(console),
        Command::Preset(command) => command.run(console),
        Command::Completions(shell) => shell.run(command_line(), console),
        Command::Man(pages) => pages.run(command_line(), console),
    };
    done.map(|()| 0)
}

/// Whether a JSON object is requested, by a command line that may be wrong.
fn wants_json(arguments: &[OsString]) -> bool {
    arguments
        .iter()
        .take_while(|argument| *argument != "--")
        .any(|argument| argument == "--json" || argument == "--events")
}

fn command_line() -> clap::Command {
    by_subject(Cli::command())
        .mut_subcommands(with_negative_numbers)
        .mut_subcommands(commands::dock::in_brief)
        .mut_subcommand("dock", commands::dock::refusing_recorded)
}

/// A command line whose help lists the commands by subject: clap has one heading for all of them.
fn by_subject(command: clap::Command) -> clap::Command {
    // clap lists them once, so that it aligns, wraps and colours them. The headings go between.
    let mut list = clap::Command::new("knotdock")
        .disable_help_subcommand(true)
        .help_template("{subcommands}");
    for name in SUBJECTS.iter().flat_map(|(_, names)| *names) {
        let about = command
            .find_subcommand(name)
            .and_then(clap::Command::get_about);
        let listed = clap::Command::new(*name);
        list = list.subcommand(listed.about(about.cloned().unwrap_or_default()));
    }
    let mut commands = list.render_help().ansi().to_string();
    let styles = command.get_styles();
    let (header, literal) = (styles.get_header(), styles.get_literal());
    for (subject, names) in SUBJECTS {
        let first = format!("  {literal}{}{literal:#}", names[0]);
        let headed = format!("\n{header}{subject}:{header:#}\n{first}");
        commands = commands.replacen(&first, &headed, 1);
    }
    let template = format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n{commands}\n\
         {header}Options:{header:#}\n{{options}}"
    );
    command.help_template(template)
}

fn parsed(arguments: &[OsString]) -> Result<Cli, clap::Error> {
    for word in arguments.iter().skip(1) {
        in_utf8(word).map_err(|fault| {
            let text = format!("{fault}\n\n  tip: {}", UTF_8);
            command_line().error(ErrorKind::InvalidUtf8, text)
        })?;
    }
    command_line()
        .try_get_matches_from(arguments)
        .and_then(|matches| Cli::from_arg_matches(&matches))
        .map_err(suggestions::explained)
}

/// A word as text: records, tables and scripts hold names of files in UTF-8.
fn in_utf8(word: &OsStr) -> Result<&str, String> {
    word.to_str()
        .ok_or_else(|| format!("{word:?} is not text in UTF-8"))
}

/// Whether a terminal may show arguments as they stand.
fn are_plain(arguments: &[OsString]) -> bool {
    let is_plain = |text: Cow<'_, str>| matches!(shown(&text), Cow::Borrowed(_));
    arguments
        .iter()
        .all(|argument| is_plain(argument.to_string_lossy()))
}

/// The error with the control characters of arguments escaped: clap repeats them as they stand, or drops them.
fn escaped(error: clap::Error, arguments: &[OsString]) -> clap::Error {
    if are_plain(arguments) {
        return error;
    }
    let escaped = arguments.iter().map(|argument| {
        let argument = argument.to_string_lossy();
        OsString::from(shown(&argument).as_ref())
    });
    let escaped: Vec<OsString> = escaped.collect();
    match parsed(&escaped) {
        Err(again) if again.kind() == error.kind() => again,
        _ => error,
    }
}

/// Answers a command line that is not one to run: asks for help or the version, or is wrong.
fn refuse(error: &clap::Error, arguments: &[OsString], json: bool) -> u8 {
    let for_information = matches!(
        error.kind(),
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion
    );
    let console = Console {
        json,
        ..Console::default()
    };
    if json && !for_information {
        console.fail(&unparsed(error));
    } else if are_plain(arguments) {
        // A terminal that is gone needs no message.
        let _ = error.print();
    } else {
        console.error(error.render());
    }
    if for_information { 0 } else { 2 }
}

/// A command line that is wrong, as a failure.
fn unparsed(error: &clap::Error) -> Error {
    let remedy = suggestions::suggested(error)
        .unwrap_or_else(|| "see `knotdock --help` and `knotdock COMMAND --help`".to_owned());
    Error::input(first_paragraph(error)).help(remedy)
}

/// Runs a command in-process; the exit code: 0, or that of the parts which failed.
///
/// `words` are a command and its arguments. Messages and the JSON object go to `listener`.
///
/// # Errors
/// [`Error`] for a command line that is none, help being one, and where the command fails.
pub fn call(words: Vec<OsString>, listener: &dyn Listener) -> Result<u8, Error> {
    let name = std::iter::once(OsString::from("knotdock"));
    let cli = parsed(&name.chain(words).collect::<Vec<_>>()).map_err(|error| unparsed(&error))?;
    let console = Console {
        listener: Some(listener),
        ..Console::from(cli.program)
    };
    // Work that names no threads is done on one.
    threads::on(1, || run(cli.command, console))?
}

/// Reads a molecule, `FILE` or `FILE:H,L`, with words such as `--waters=keep`.
///
/// # Errors
/// [`Error`] for words that are no options of reading, and where the file cannot be read.
pub fn read_molecule(file: &OsStr, words: Vec<OsString>) -> Result<Molecule, Error> {
    let file = in_utf8(file).map_err(|fault| Error::input(fault).help(UTF_8))?;
    let command = clap::Command::new("knotdock")
        .no_binary_name(true)
        .disable_help_flag(true);
    let options = OptionArguments::<OfReading>::augment_args(command)
        .try_get_matches_from(words)
        .and_then(|matches| OptionArguments::<OfReading>::from_arg_matches(&matches))
        .map_err(|error| unparsed(&error))?;
    let [input] = Input::read_all([file], &options.given()?.options.input.reading())?;
    Ok(input.molecule)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_listed_command_has_one_subject() {
        let cli = Cli::command();
        let listed = cli
            .get_subcommands()
            .filter(|command| !command.is_hide_set());
        let listed: Vec<&str> = listed.map(clap::Command::get_name).collect();
        let names = SUBJECTS.iter().flat_map(|(_, names)| *names);
        assert_eq!(listed, names.copied().collect::<Vec<&str>>());
    }
}
