//! Which pairs of a batch are docked at the same time, and on how many threads each.
//!
//! A run on T threads takes s + (1 - s) / T of its time on one (Amdahl), where s is its serial share. Many pairs
//! take the least time on one thread each, T at a time. But the last of them would leave threads idle, and one that is
//! far larger than the others would be waited for. So the largest pairs are docked first, one after another, each on all
//! threads: as many as make the whole batch shortest.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::commands::batch::batch_pairs::Pair;
use knotdock::threads;

/// Serial share of a run: `knotdock dock` of the example is 1.93 times as fast with -j 2 as with -j 1.
const SERIAL: f64 = 0.036;
/// Pairs per thread beyond which the last ones are a small part of the whole, and only the sum of all counts.
const MANY: usize = 64;

/// When and how a pair is docked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// Place among the pairs.
    pub pair: usize,
    pub threads: usize,
    pub is_alone: bool,
}

/// Demands of a pair's own options.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Demand {
    /// Threads, if they name a number.
    threads: Option<usize>,
    is_alone: bool,
}

/// The schedule of some pairs, and the threads of all together: `given`, or those that all pairs' options agree on.
pub fn schedule(pairs: &[Pair], given: Option<usize>) -> (Vec<Slot>, usize) {
    // A file of options that cannot be read is a failure of its pair alone.
    let own = pairs.iter().map(|pair| pair.dock.own_threads());
    let own: Vec<(Option<usize>, bool)> = own.map(Result::unwrap_or_default).collect();
    let first = own.first().and_then(|(threads, _)| *threads);
    let agreed = first.filter(|first| own.iter().all(|(threads, _)| *threads == Some(*first)));
    let threads = threads::or_all(given.or(agreed));
    // Threads that all pairs agree on are those of the batch.
    let demands = own.into_iter().map(|(own, is_alone)| Demand {
        threads: own.filter(|&own| own != threads),
        is_alone,
    });
    let costs: Vec<f64> = pairs.iter().map(|pair| pair.cost).collect();
    (
        slots(&costs, &demands.collect::<Vec<_>>(), threads),
        threads,
    )
}

/// Slots in the order of docking, by expected costs (any unit); pairs that are docked alone come first.
fn slots(costs: &[f64], demands: &[Demand], threads: usize) -> Vec<Slot> {
    let is_free = |&pair: &usize| demands[pair] == Demand::default();
    let (mut order, bound): (Vec<usize>, Vec<usize>) = (0..costs.len()).partition(is_free);
    let mut slots: Vec<Slot> = bound
        .into_iter()
        .map(|pair| {
            let threads_of_pair = demands[pair].threads.unwrap_or(threads);
            let is_alone = demands[pair].is_alone || threads_of_pair >= threads;
            slot(pair, threads_of_pair, is_alone)
        })
        .collect();
    let all = |pair| slot(pair, threads, true);
    if threads == 1 {
        slots.extend(order.into_iter().map(all));
    } else {
        order.sort_by(|&a, &b| costs[b].total_cmp(&costs[a]));
        let sorted: Vec<f64> = order.iter().map(|&pair| costs[pair]).collect();
        let rest = order.split_off(alone(&sorted, threads));
        slots.extend(order.into_iter().map(all));
        slots.extend(rest.into_iter().map(|pair| slot(pair, 1, false)));
    }
    slots.sort_by_key(|slot| !slot.is_alone);
    slots
}

fn slot(pair: usize, threads: usize, is_alone: bool) -> Slot {
    Slot {
        pair,
        threads,
        is_alone,
    }
}

/// How many of the pairs, the most expensive first, are docked by themselves.
fn alone(costs: &[f64], threads: usize) -> usize {
    let share = SERIAL + (1.0 - SERIAL) / threads as f64;
    let time = |count: usize| {
        let (first, rest) = costs.split_at(count);
        first.iter().sum::<f64>() * share + span(rest, threads)
    };
    let most = costs.len().min(2 * threads);
    let counts = 0..=most;
    counts
        .min_by(|&a, &b| time(a).total_cmp(&time(b)))
        .unwrap_or(0)
}

/// Time until the last of some pairs is done, one thread each: a thread that is free takes the most expensive one.
fn span(costs: &[f64], threads: usize) -> f64 {
    if costs.len() > MANY * threads {
        let largest = costs.first().copied().unwrap_or(0.0);
        return largest.max(costs.iter().sum::<f64>() / threads as f64);
    }
    // Times are compared as their bits, which have the order of numbers that are not negative.
    let mut ends: BinaryHeap<Reverse<u64>> = BinaryHeap::new();
    let mut last = 0.0f64;
    for cost in costs {
        let start = match ends.len() < threads {
            true => 0.0,
            false => ends.pop().map_or(0.0, |Reverse(bits)| f64::from_bits(bits)),
        };
        let end = start + cost.max(0.0);
        last = last.max(end);
        ends.push(Reverse(end.to_bits()));
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;

    fn widths(costs: &[f64], threads: usize) -> Vec<usize> {
        let slots = slots(costs, &vec![Demand::default(); costs.len()], threads);
        let mut widths = vec![0; costs.len()];
        for slot in slots {
            widths[slot.pair] = slot.threads;
        }
        widths
    }

    /// One pair has all threads, as many equal pairs as threads have one each, and a large one goes before the others.
    #[test]
    fn large_pairs_have_all_threads_and_small_ones_share_them() {
        assert_eq!(widths(&[5.0], 8), [8]);
        assert_eq!(widths(&[5.0; 8], 8), [1; 8]);
        assert_eq!(widths(&[5.0; 800], 8), [1; 800]);
        assert_eq!(widths(&[5.0, 5.0], 8), [8, 8]);
        assert_eq!(widths(&[1.0, 1.0, 1.0, 90.0, 1.0], 4)[3], 4);
        let mut many = vec![1.0; 100];
        many[7] = 500.0;
        assert_eq!(widths(&many, 4)[7], 4);
        assert_eq!(widths(&[2.0, 3.0], 1), [1, 1]);
    }

    /// Every pair has one slot; on one thread they come in the order of the table.
    #[test]
    fn every_pair_has_its_slot() {
        let costs = [3.0, 9.0, 1.0, 4.0, 4.0];
        let mut demands = [Demand::default(); 5];
        demands[1].threads = Some(3);
        for threads in 1..6 {
            let slots = slots(&costs, &demands, threads);
            let mut pairs: Vec<usize> = slots.iter().map(|slot| slot.pair).collect();
            assert!(slots.iter().all(|slot| slot.pair != 1 || slot.threads == 3));
            pairs.sort_unstable();
            assert_eq!(pairs, [0, 1, 2, 3, 4]);
        }
        let in_order: Vec<usize> = slots(&costs, &[Demand::default(); 5], 1)
            .iter()
            .map(|t| t.pair)
            .collect();
        assert_eq!(in_order, [0, 1, 2, 3, 4]);
    }

    /// The plan is never longer than either of the plain ones.
    #[test]
    fn no_plain_plan_is_shorter() {
        let mut state = 1u64;
        for threads in [2, 3, 16] {
            for count in [1, 5, 17, 60] {
                let mut costs: Vec<f64> = (0..count)
                    .map(|_| {
                        state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
                        1.0 + (state >> 40) as f64 / 1e5
                    })
                    .collect();
                costs.sort_by(|a, b| b.total_cmp(a));
                let share = SERIAL + (1.0 - SERIAL) / threads as f64;
                let chosen = alone(&costs, threads);
                let time =
                    costs[..chosen].iter().sum::<f64>() * share + span(&costs[chosen..], threads);
                assert!(time <= span(&costs, threads) + 1e-9);
                if count <= 2 * threads {
                    assert!(time <= costs.iter().sum::<f64>() * share + 1e-9);
                }
            }
        }
    }
}
