//! What other programs call in their own process: commands by their words, and structures as commands read them.

use std::ffi::{OsStr, OsString};

use knotdock::options::InputOptions;
use knotdock::options::text;
use knotdock::threads;
use knotdock_structures::molecule::Molecule;

use crate::inputs::molecules::Input;
use crate::messages::console::Console;
use crate::messages::failure::Failure;
use crate::messages::listener::Listener;
use crate::messages::suggestions::UTF_8;
use crate::{in_utf8, parsed, run, unparsed};

/// Runs a command for a program that hears what it says; the exit code: 0, or that of the parts which failed.
///
/// `words` are those of the command line, without the program's name: a command and its arguments. Its JSON object goes
/// to `listener`.
///
/// # Errors
/// [`Failure`] for a command line that is none, help being one, and where the command fails.
pub fn call(words: Vec<OsString>, listener: &dyn Listener) -> Result<u8, Failure> {
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
/// [`Failure`] for words that are no options of reading, and where the file cannot be read.
pub fn read_molecule(file: &OsStr, words: Vec<OsString>) -> Result<Molecule, Failure> {
    let file = in_utf8(file).map_err(|fault| Failure::input(fault).remedy(UTF_8))?;
    let options: InputOptions = text::read(words).map_err(|error| unparsed(&error))?;
    let [input] = Input::read_all([file], &options.reading())?;
    Ok(input.molecule)
}
