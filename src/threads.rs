//! The threads of a run.
//!
//! Rayon's global pool is never used: it starts on the first parallel iterator outside of a pool, takes its size from
//! the environment (`RAYON_NUM_THREADS`), and panics where its threads cannot be started.

/// Stack of a thread, in bytes: that of most main threads, since files are read and written on it, too. Only the used part
/// takes memory.
const STACK: usize = 8 << 20;

use knotdock_structures::Error;

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
    use rayon::prelude::*;
    use std::collections::HashSet;
    use std::thread::{ThreadId, current};

    fn seen() -> HashSet<ThreadId> {
        (0..10_000)
            .into_par_iter()
            .map(|_| current().id())
            .collect()
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
