//! `knotdock serve`: a page to dock from.

use std::path::PathBuf;

use clap::Args;

use crate::messages::console::Console;
use knotdock_structures::Error;

/// Dock from a page in the browser: drop structures, mark residues, start runs and look at them.
///
/// The page is served by this machine to this machine, and nothing leaves it. Runs are folders as `knotdock dock` writes
/// them, and the page shows the command of each. One runs at a time; others wait. Runs that wait survive the end of this
/// command, and the one that was going on can be started again.
#[derive(Args, Debug)]
pub struct Serve {
    /// Folder of the runs; it is made if it does not exist.
    #[arg(long, value_name = "DIR", default_value = "knotdock_runs")]
    pub folder: PathBuf,
    /// Port of the page; 0 is any that is free.
    #[arg(long, value_name = "N", default_value_t = 8037)]
    pub port: u16,
    /// Address or name to listen at, for other machines or users.
    ///
    /// Without it, everyone who is logged in to this machine can open the page, and nobody else. With it, only those who
    /// have the link that is printed, 127.0.0.1 included. The connection is not encrypted: use it in networks that you
    /// trust, or through SSH (ssh -L 8037:127.0.0.1:8037 MACHINE).
    #[arg(long, value_name = "ADDRESS")]
    pub host: Option<String>,
    /// Print the link of the page, and do not open a browser.
    #[arg(long)]
    pub no_browser: bool,
}

impl Serve {
    #[cfg(feature = "serve")]
    pub fn run(self, console: Console) -> Result<(), Error> {
        crate::serve::serve(&self, console)
    }

    #[cfg(not(feature = "serve"))]
    pub fn run(self, _: Console) -> Result<(), Error> {
        Err(Error::input("this build has no page to dock from")
            .help("build it with --features serve, or take a release"))
    }
}
