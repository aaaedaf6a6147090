//! Improvement of components that are too entangled to be solved exactly.
//!
//! From the first states on, each site in turn takes the state that is best beside its neighbours' present ones. When
//! that changes nothing, pairs of sites take the best two states together. The search ends when neither lowers the
//! energy, so it never ends above where it began.

use super::{Problem, TIE};

/// Most passes over a component; the energy falls at each, and few are needed.
const MAX_PASSES: usize = 200;

/// Improves the states of a component's sites, from those given.
pub(super) fn improve(
    problem: &Problem,
    sites: &[usize],
    alive: &[Vec<usize>],
    states: &mut [usize],
) {
    let row = |site: usize| problem.own[site].len();
    // Energy of a state of a site beside the present ones of all but `except`.
    let beside = |site: usize, state: usize, except: Option<usize>, states: &[usize]| -> f64 {
        let pairs = problem.pairs.iter().filter_map(|pair| match pair.sites {
            [a, b] if a == site && Some(b) != except => Some(pair.energies[state * row(b) + states[b]]),
            [a, b] if b == site && Some(a) != except => Some(pair.energies[states[a] * row(b) + state]),
            _ => None,
        });
        problem.own[site][state] + pairs.sum::<f64>()
    };
    for _ in 0..MAX_PASSES {
        let mut moved = false;
        for &site in sites {
            let mut best = (beside(site, states[site], None, states), states[site]);
            for &state in &alive[site] {
                let energy = beside(site, state, None, states);
                if energy < best.0 - TIE {
                    best = (energy, state);
                }
            }
            moved |= best.1 != states[site];
            states[site] = best.1;
        }
        if moved {
            continue;
        }
        for pair in problem.pairs.iter().filter(|pair| sites.contains(&pair.sites[0])) {
            let [a, b] = pair.sites;
            let of = |site: usize, except: usize| -> Vec<(usize, f64)> {
                let present = std::iter::once(states[site]);
                let all = present.chain(alive[site].iter().copied());
                all.map(|state| (state, beside(site, state, Some(except), states)))
                    .collect()
            };
            let (first, second) = (of(a, b), of(b, a));
            let mut best = (f64::INFINITY, states[a], states[b]);
            for &(r, of_r) in &first {
                for &(s, of_s) in &second {
                    let energy = of_r + of_s + pair.energies[r * row(b) + s];
                    // The present two come first.
                    if energy < best.0 - TIE {
                        best = (energy, r, s);
                    }
                }
            }
            moved |= (best.1, best.2) != (states[a], states[b]);
            (states[a], states[b]) = (best.1, best.2);
        }
        if !moved {
            return;
        }
    }
}
