//! What other programs call in their own process: commands by their words, and structures as commands read them.

use std::ffi::{OsStr, OsString};

use crate::arguments::options::{OfReading, TypedOptions};
use clap::{Args, Command, FromArgMatches};
use knotdock::threads;
use knotdock_structures::molecule::Molecule;

use crate::inputs::molecules::Input;
use crate::messages::console::Console;
use crate::messages::listener::Listener;
use crate::messages::suggestions::UTF_8;
use crate::{in_utf8, parsed, run, unparsed};
use knotdock_structures::Error;

/// Runs a command for a program that hears what it says; the exit code: 0, or that of the parts which failed.
///
/// `words` are those of the command line, without the program's name: a command and its arguments. Its JSON object goes
/// to `listener`.
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
    let command = Command::new("knotdock")
        .no_binary_name(true)
        .disable_help_flag(true);
    let options = TypedOptions::<OfReading>::augment_args(command)
        .try_get_matches_from(words)
        .and_then(|matches| TypedOptions::<OfReading>::from_arg_matches(&matches))
        .map_err(|error| unparsed(&error))?;
    let [input] = Input::read_all([file], &options.options.input.reading())?;
    Ok(input.molecule)
}
