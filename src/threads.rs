//! The threads of a run.
//!
//! Rayon's global pool is never used: it starts on the first parallel iterator outside of a pool, takes its size from
//! the environment (`RAYON_NUM_THREADS`), and panics where its threads cannot be started.

/// Stack of a thread, in bytes: that of most main threads, since files are read and written on it, too. Only the used part
/// takes memory.
const STACK: usize = 8 << 20;

use knotdock_structures::Error;
use rayon::prelude::*;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Threads that the system could not start.
fn not_started(count: usize, error: &rayon::ThreadPoolBuildError) -> Error {
    let threads = match count {
        1 => "a thread".to_owned(),
        count => format!("{count} threads"),
    };
    Error::machine(format!("the system could not start {threads}: {error}")).help(
        "use fewer --threads (-j 1 starts none), or allow more processes (`ulimit -u`) and memory (`ulimit -v`)",
    )
}

/// The given number of threads, or all hardware threads.
pub fn or_all(count: Option<usize>) -> usize {
    count.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
}

/// Does work on `count` threads: parallel iterators in it share these, and no others. They are those of the caller's pool if
/// it has this number, and else new ones, which end with the work.
///
/// # Errors
/// [`Error`] if they cannot be started, before any of the work is done.
pub fn on<T: Send>(count: usize, work: impl FnOnce() -> T + Send) -> Result<T, Error> {
    let count = count.max(1);
    // Outside of every pool the second call would start the global one.
    if rayon::current_thread_index().is_some() && rayon::current_num_threads() == count {
        return Ok(work());
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .stack_size(STACK)
        .build()
        .map_err(|error| not_started(count, &error))?;
    Ok(pool.install(work))
}

/// Results of `count` pieces of work, in their order. The threads of the pool take one after the other, each with a
/// workspace of its own.
///
/// A parallel iterator shares work out in runs: long ones leave threads idle at the end, and each needs a new workspace.
pub fn each<W, R: Send + Sync>(
    count: usize,
    workspace: impl Fn() -> W + Sync,
    work: impl Fn(usize, &mut W) -> R + Sync,
) -> Vec<R> {
    let results: Vec<OnceLock<R>> = (0..count).map(|_| OnceLock::new()).collect();
    let next = AtomicUsize::new(0);
    let threads = 0..rayon::current_num_threads().min(count);
    threads.into_par_iter().with_max_len(1).for_each(|_| {
        let mut own = workspace();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(result) = results.get(index) else {
                break;
            };
            // Each index is taken once.
            let _ = result.set(work(index, &mut own));
        }
    });
    let results: Vec<R> = results
        .into_iter()
        .filter_map(OnceLock::into_inner)
        .collect();
    assert_eq!(results.len(), count, "work was left out");
    results
}

/// Makes the caller's thread, the main one of a program, a pool by itself and the global one. Work outside of [`on`]
/// is then done on it alone, and so is work on one thread.
///
/// # Errors
/// [`Error`] if the program has used the global pool before.
pub fn stay_on_main() -> Result<(), Error> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build_global()
        .map_err(|error| not_started(1, &error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use std::thread::{ThreadId, current};

    fn seen() -> HashSet<ThreadId> {
        (0..10_000)
            .into_par_iter()
            .map(|_| current().id())
            .collect()
    }

    /// Results come in order, whatever a piece takes, and no more workspaces are made than there are threads.
    #[test]
    fn each_piece_of_work_is_done_once() {
        for threads in [1, 3] {
            for count in [0, 1, 2, 200] {
                let made = AtomicUsize::new(0);
                let workspace = || made.fetch_add(1, Ordering::Relaxed);
                let work = |index: usize, own: &mut usize| {
                    assert!(*own < threads);
                    std::thread::sleep(std::time::Duration::from_micros(7 * index as u64 % 50));
                    index
                };
                let found = on(threads, || each(count, workspace, work)).unwrap();
                assert_eq!(found, Vec::from_iter(0..count));
                assert!(made.into_inner() <= threads.min(count));
            }
        }
    }

    /// Work of as many threads as the caller's pool has is done there; other work has new threads.
    #[test]
    fn work_is_done_on_as_many_threads_as_were_wanted() {
        let outer = on(3, || {
            assert_eq!(rayon::current_num_threads(), 3);
            let own = rayon::broadcast(|_| current().id());
            let within = on(3, || rayon::broadcast(|_| current().id())).unwrap();
            assert_eq!(within, own);
            let other = on(2, || rayon::broadcast(|_| current().id())).unwrap();
            assert_eq!(other.len(), 2);
            assert!(other.iter().all(|id| !own.contains(id)));
            assert!(seen().iter().all(|id| own.contains(id)));
            own
        })
        .unwrap();
        assert!(!outer.contains(&current().id()));
        assert_eq!(on(0, rayon::current_num_threads), Ok(1));
    }
}
