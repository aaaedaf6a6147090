//! States that cannot be in the best answer.
//!
//! A state r of a site is a dead end if another state t of it is better whatever the other sites do. That is so if
//! E(r) - E(t) + sum_j min_s (E(r, s) - E(t, s)) > 0, over the states s of the other sites j. The search ends when a
//! pass over all sites finds none. Source: Goldstein, Biophys. J. 66 (1994) 1335-1340.

use super::{Problem, SiteTable, TIE, site_tables};

/// The states of each site that are left, rising.
pub(super) fn survivors(problem: &Problem) -> Vec<Vec<usize>> {
    let tables = site_tables(problem);
    let counts = problem.own.iter().map(Vec::len);
    let mut alive: Vec<Vec<usize>> = counts.map(|count| (0..count).collect()).collect();
    loop {
        let mut dropped = false;
        for site in 0..alive.len() {
            let states = alive[site].clone();
            let mut left = states.clone();
            for &state in &states {
                // A state that has gone by now may still show that another is worse, but for ties.
                let is_dead = left.iter().any(|&other| {
                    other != state
                        && is_worse(&problem.own[site], &tables[site], &alive, [state, other])
                });
                if is_dead {
                    left.retain(|&kept| kept != state);
                }
            }
            dropped |= left.len() < states.len();
            alive[site] = left;
        }
        if !dropped {
            return alive;
        }
    }
}

/// Whether state `r` costs more than `t` whatever the other sites do.
fn is_worse(own: &[f64], tables: &[SiteTable], alive: &[Vec<usize>], [r, t]: [usize; 2]) -> bool {
    let mut gain = own[r] - own[t];
    for table in tables {
        let (of_r, of_t) = (table.row(r), table.row(t));
        let differences = alive[table.other]
            .iter()
            .map(|&state| of_r[state] - of_t[state]);
        gain += differences.fold(f64::INFINITY, f64::min);
    }
    gain > TIE
}
