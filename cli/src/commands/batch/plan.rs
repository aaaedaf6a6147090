//! The pairs of a batch in their turns, on the threads of the batch.

use knotdock::threads;

use crate::commands::batch::batch_pairs::Pair;
use crate::commands::batch::schedule::{Own, Turn, turns};

/// The turns of some pairs, by their places among them, and the threads of all together: those `given`, or else those
/// that all pairs' own options agree on.
pub fn plan(pairs: &[Pair], given: Option<usize>) -> (Vec<Turn>, usize) {
    // A file of options that cannot be read is a failure of its pair alone.
    let own = pairs.iter().map(|pair| pair.dock.own_threads());
    let own: Vec<(Option<usize>, bool)> = own.map(Result::unwrap_or_default).collect();
    let agreed = match own.as_slice() {
        [(Some(first), _), rest @ ..] if rest.iter().all(|(own, _)| *own == Some(*first)) => {
            Some(*first)
        }
        _ => None,
    };
    let threads = given.or(agreed);
    let threads = threads::or_all(threads);
    // Threads that all pairs agree on are those of the batch.
    let own: Vec<Own> = own
        .into_iter()
        .map(|(own, is_alone)| Own {
            threads: own.filter(|&own| own != threads),
            is_alone,
        })
        .collect();
    let costs: Vec<f64> = pairs.iter().map(|pair| pair.cost).collect();
    (turns(&costs, &own, threads), threads)
}
