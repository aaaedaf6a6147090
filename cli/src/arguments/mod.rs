//! Options of the commands, by subject, and the values that they take.

pub mod conformations;
pub mod machine;
pub mod options;
pub mod output_file;
pub mod ranks;
pub mod solid_output;

use clap::{Args, Command};

use crate::messages::console::{Console, Listener};
use crate::messages::event_lines::EventLines;

/// Options of the whole program.
#[derive(Args, Clone, Copy, Debug)]
pub struct ProgramArguments {
    /// Print one JSON object on standard output, and all messages on standard error.
    #[arg(long, global = true)]
    json: bool,
    /// Print errors only.
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Print more detail.
    #[arg(short, long, global = true)]
    verbose: bool,
    /// Write messages, progress and the result as lines of JSON, and end when standard input does.
    #[arg(long, global = true, hide = true, conflicts_with_all = ["json", "quiet"])]
    events: bool,
}

impl From<ProgramArguments> for Console<'_> {
    fn from(arguments: ProgramArguments) -> Self {
        Self {
            // A command line that is wrong is reported in JSON, too.
            json: arguments.json || arguments.events,
            quiet: arguments.quiet,
            verbose: arguments.verbose,
            listener: (arguments.events).then(|| EventLines::of_process() as &dyn Listener),
        }
    }
}

/// Whether a word is an option of the whole program.
pub fn is_of_program(word: &str) -> bool {
    let program = ProgramArguments::augment_args(Command::new("knotdock"));
    program.get_arguments().any(|option| {
        let long = option.get_long().map(|long| format!("--{long}"));
        let short = option.get_short().map(|short| format!("-{short}"));
        long.as_deref() == Some(word) || short.as_deref() == Some(word)
    })
}

/// A command that takes negative numbers as values, so that errors can name what is wrong with them.
pub fn with_negative_numbers(command: Command) -> Command {
    command.mut_args(|argument| {
        let takes_value = argument.get_action().takes_values();
        argument.allow_negative_numbers(takes_value)
    })
}
