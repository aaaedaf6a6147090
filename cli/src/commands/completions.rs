//! `knotdock completions` and `knotdock man`: what shells and `man` know of the command line, from its definition.

use std::path::{Path, PathBuf};

use clap::{Args, Command};
use clap_complete::Shell;
use clap_mangen::Man;
use serde_json::json;

use crate::messages::console::Console;
use knotdock::output::files::file_error;
use knotdock::output::files::whole_file::write_whole;
use knotdock_structures::Error;

/// Print the completions of a shell.
///
/// bash: knotdock completions bash > ~/.local/share/bash-completion/completions/knotdock
/// zsh: knotdock completions zsh > _knotdock, in a folder of $fpath
/// fish: knotdock completions fish > ~/.config/fish/completions/knotdock.fish
#[derive(Args, Debug)]
#[command(verbatim_doc_comment)]
pub struct Completions {
    /// The shell.
    #[arg(value_enum, value_name = "SHELL")]
    shell: Shell,
}

impl Completions {
    pub fn run(self, mut command: Command, console: Console) -> Result<(), Error> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut command, "knotdock", &mut script);
        let script = String::from_utf8(script).map_err(Error::machine)?;
        console.say(script.trim_end());
        console.result(&json!({ "text": script }))
    }
}

/// Write the manual pages of all commands.
///
/// `man -l DIR/knotdock-dock.1` shows one; in a folder man1 of $MANPATH, `man knotdock-dock` does.
#[derive(Args, Debug)]
pub struct ManPages {
    /// Folder for the pages, knotdock.1, knotdock-dock.1 and so on; it is made if need be.
    #[arg(value_name = "DIR")]
    directory: PathBuf,
}

impl ManPages {
    pub fn run(self, command: Command, console: Console) -> Result<(), Error> {
        let directory = &self.directory;
        let unwritable = |source| file_error::unwritable(directory, source);
        std::fs::create_dir_all(directory).map_err(unwritable)?;
        let mut command = shown_in_full(command.disable_help_subcommand(true));
        command.build();
        let mut pages = Vec::new();
        write_page(&command, directory, &mut pages)?;
        console.say(format!("{} pages in {}", pages.len(), directory.display()));
        console.result(&json!({ "pages": pages }))
    }
}

/// A command with all options in its short help: pages leave out what that leaves out.
fn shown_in_full(command: Command) -> Command {
    let command = command.mut_args(|argument| argument.hide_short_help(false));
    command.mut_subcommands(shown_in_full)
}

fn write_page(command: &Command, directory: &Path, pages: &mut Vec<String>) -> Result<(), Error> {
    let name = command
        .get_display_name()
        .unwrap_or_else(|| command.get_name())
        .to_owned();
    let path = directory.join(format!("{name}.1"));
    let mut page = Vec::new();
    Man::new(command.clone())
        .render(&mut page)
        .map_err(Error::machine)?;
    let page = String::from_utf8(page).map_err(Error::machine)?;
    let page = page.replace(".SH EXTRA", ".SH EXAMPLES");
    write_whole(&path, |file| file.write_all(page.as_bytes()))?;
    pages.push(path.display().to_string());
    for below in command.get_subcommands() {
        write_page(below, directory, pages)?;
    }
    Ok(())
}
