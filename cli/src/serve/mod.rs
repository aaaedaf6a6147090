//! The server of `knotdock serve`: pages, uploads, the queue of runs and their results, on one thread.
//!
//! It computes nothing: every structure is read and every run is made by a process of this program, with the command line
//! that the page shows. What it keeps is in the folder that is served ([`folder`]).

mod api;
mod folder;
mod guard;
mod jobs;
mod listing;
mod request;

use std::ffi::OsString;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use serde_json::json;
use tokio::net::{TcpListener, lookup_host};
use tokio::runtime::Builder;

use crate::messages::console::Console;
use folder::Folder;
use guard::Guard;
use jobs::Jobs;
use knotdock_structures::Error;

/// The first words of the command of a child, if it is not this executable.
static PROGRAM: OnceLock<Vec<OsString>> = OnceLock::new();

/// Sets the words that start this program, for programs that have it built in. The first call counts.
pub fn start_by(words: Vec<OsString>) {
    PROGRAM.get_or_init(|| words);
}

/// What all requests share.
struct Server {
    folder: Folder,
    guard: Guard,
    jobs: Jobs,
    /// The first words of every command.
    program: Vec<OsString>,
}

/// The folder of the runs and the address of the page.
pub struct Place {
    pub folder: PathBuf,
    pub port: u16,
    /// Address or name to listen at; this machine alone without it.
    pub host: Option<String>,
}

/// Serves until the process ends.
pub fn serve(place: &Place, opens_browser: bool, console: Console) -> Result<(), Error> {
    let program = match PROGRAM.get() {
        Some(words) => words.clone(),
        None => vec![std::env::current_exe().map_err(Error::machine)?.into()],
    };
    let runtime = Builder::new_current_thread()
        .enable_all()
        .build()
        .map_err(Error::machine)?;
    runtime.block_on(async {
        let folder = Folder::open(&place.folder)?;
        let host = place.host.as_deref().unwrap_or("127.0.0.1");
        let listener = listen(host, place.port).await?;
        let address = listener.local_addr().map_err(Error::machine)?;
        let guard = Guard::new(place.host.as_deref(), address)?;
        let link = guard.link(host);
        let server = Arc::new(Server {
            jobs: Jobs::recovered(&folder)?,
            folder,
            guard,
            program,
        });
        console.say(format!(
            "The page is at {link}\nRuns go to {}. Ctrl-C ends the server.",
            place.folder.display()
        ));
        console.result(&json!({ "link": link, "folder": place.folder }))?;
        if opens_browser && open::that_detached(&link).is_err() {
            console.warn("no browser can be opened here; open the link in one");
        }
        let serving = axum::serve(listener, api::router(Arc::clone(&server)));
        tokio::select! {
            ended = serving => ended.map_err(Error::machine),
            never = jobs::run_all(server) => match never {},
        }
    })
}

async fn listen(host: &str, port: u16) -> Result<TcpListener, Error> {
    let failed = |error: std::io::Error| {
        Error::input(format!("cannot listen at {host}, port {port}: {error}")).help(
            "give another --port (0 is any that is free), or an address of this machine as --host",
        )
    };
    let addresses: Vec<SocketAddr> = lookup_host((host, port)).await.map_err(failed)?.collect();
    TcpListener::bind(addresses.as_slice())
        .await
        .map_err(failed)
}
