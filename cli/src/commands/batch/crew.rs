//! The pairs of a batch docked in their turns, several at a time.

use std::sync::mpsc::channel;
use std::thread::{Builder, scope};

use knotdock::dock::shared_process::share_process;

use crate::commands::batch::schedule::Turn;
use knotdock_structures::Error;

/// A pair that waits for its turn.
pub struct Job<J> {
    /// Its place in the table, and its threads.
    pub turn: Turn,
    /// What is done.
    pub work: J,
}

/// Hears which pairs are started and what came of them, on one thread.
pub trait Watch<T> {
    /// A pair at a place is about to be docked.
    fn start(&mut self, place: usize) -> Result<(), Error>;
    /// What came of it.
    fn done(&mut self, place: usize, row: T) -> Result<(), Error>;
}

/// Docks pairs in their order by `dock`, as many at once as `threads` suffice for, before the eyes of `watch`.
///
/// # Errors
/// The first of `watch`, after which no pair is started, and [`Error`] where a thread cannot be started.
pub fn dock_all<J: Send, T: Send>(
    jobs: Vec<Job<J>>,
    threads: usize,
    dock: impl Fn(J, usize) -> T + Sync,
    watch: &mut dyn Watch<T>,
) -> Result<(), Error> {
    let (sender, receiver) = channel();
    let mut waiting = jobs.into_iter().peekable();
    let (mut free, mut running) = (threads, 0usize);
    scope(|scope| {
        let mut failed = None;
        loop {
            let fits = |job: &Job<J>| {
                failed.is_none()
                    && (running == 0 || (!job.turn.is_alone && job.turn.threads <= free))
            };
            if let Some(Job { turn, work }) = waiting.next_if(fits) {
                failed = watch.start(turn.pair).err();
                if failed.is_some() {
                    continue;
                }
                if turn.is_alone {
                    failed = watch.done(turn.pair, dock(work, turn.threads)).err();
                    continue;
                }
                share_process();
                let sender = sender.clone();
                let dock = &dock;
                let work = move || {
                    // Where nobody listens any more, the run stands all the same.
                    let _ = sender.send((turn, dock(work, turn.threads)));
                };
                if let Err(error) = Builder::new().spawn_scoped(scope, work) {
                    let message = format!("the system could not start a thread: {error}");
                    failed = Some(Error::machine(message).help("use fewer threads (-j)"));
                    continue;
                }
                free = free.saturating_sub(turn.threads);
                running += 1;
            } else if running > 0 {
                // The sender is held here, so that receiving cannot fail.
                if let Ok((turn, row)) = receiver.recv() {
                    free += turn.threads;
                    running -= 1;
                    let next = watch.done(turn.pair, row).err();
                    failed = failed.or(next);
                }
            } else {
                return failed.map_or(Ok(()), Err);
            }
        }
    })
}
