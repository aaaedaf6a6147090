//! The pairs of a batch docked in their turns, several at a time.

use std::path::PathBuf;
use std::sync::mpsc::channel;
use std::thread::{Builder, scope};

use knotdock::dock::shared_process::share_process;

use crate::cli::batch::row::{DockedRow, dock_row};
use crate::cli::batch::schedule::Turn;
use crate::cli::dock::Dock;
use crate::cli::messages::console::Console;
use crate::cli::messages::failure::Failure;

/// A pair that waits for its turn.
pub struct Job {
    /// Its place in the table, and its threads.
    pub turn: Turn,
    /// Its command line.
    pub dock: Dock,
    /// Its name.
    pub name: String,
    /// The directory of its run.
    pub run: PathBuf,
    /// How its line of the report begins.
    pub head: String,
}

impl Job {
    fn dock(self, console: Console) -> DockedRow {
        let dock = (self.dock, self.turn.threads);
        dock_row(dock, (&self.name, &self.head), &self.run, console)
    }
}

/// Docks pairs in their order, as many at once as `threads` suffice for, and hands what came of each to `done` with its
/// place.
///
/// # Errors
/// The first of `done`, after which no pair is begun, and [`Failure`] where a thread cannot be started.
pub fn dock_all(
    jobs: Vec<Job>,
    threads: usize,
    console: Console,
    mut done: impl FnMut(usize, DockedRow) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let (sender, receiver) = channel();
    let mut waiting = jobs.into_iter().peekable();
    let (mut free, mut running) = (threads, 0usize);
    scope(|scope| {
        let mut failed = None;
        loop {
            let fits = |job: &Job| {
                failed.is_none()
                    && (running == 0 || (!job.turn.is_alone && job.turn.threads <= free))
            };
            if let Some(job) = waiting.next_if(fits) {
                let turn = job.turn;
                if turn.is_alone {
                    failed = done(turn.pair, job.dock(console)).err();
                    continue;
                }
                share_process();
                let sender = sender.clone();
                let work = move || {
                    // Where nobody listens any more, the run stands all the same.
                    let _ = sender.send((turn, job.dock(console)));
                };
                if let Err(error) = Builder::new().spawn_scoped(scope, work) {
                    let message = format!("the system did not start a thread: {error}");
                    failed = Some(Failure::other(message).remedy("use fewer threads (-j)"));
                    continue;
                }
                free = free.saturating_sub(turn.threads);
                running += 1;
            } else if running > 0 {
                // The sender is held here, so that receiving cannot fail.
                if let Ok((turn, row)) = receiver.recv() {
                    free += turn.threads;
                    running -= 1;
                    let next = done(turn.pair, row).err();
                    failed = failed.or(next);
                }
            } else {
                return failed.map_or(Ok(()), Err);
            }
        }
    })
}
