//! The exact least energy of a component, site by site.
//!
//! A site is eliminated by the table of its best state for all states of its neighbours; that table then ties the
//! neighbours to each other. The site whose table is smallest goes first. This is dynamic programming on a tree
//! decomposition of the graph of sites (Bertele & Brioschi, Nonserial Dynamic Programming, 1972; for side chains Xu,
//! RECOMB 2005, 423-439). Its cost grows with the product of the states of a site and its neighbours.

use super::{Problem, TIE};

/// Energies of some sites' states together.
struct Table {
    /// The sites by their places in the component, rising.
    sites: Vec<usize>,
    /// One value for each combination, the last site's state running fastest.
    energies: Vec<f64>,
}

/// An eliminated site, and its best state for each combination of its neighbours' states.
struct Eliminated {
    site: usize,
    neighbours: Vec<usize>,
    best: Vec<u32>,
}

/// The best states of a component's sites in their order; `None` if a table would need more than `limit` entries.
pub(super) fn best(problem: &Problem, sites: &[usize], limit: usize) -> Option<Vec<usize>> {
    let counts: Vec<usize> = sites.iter().map(|&site| problem.own[site].len()).collect();
    let mut tables = tables(problem, sites);
    let mut left: Vec<usize> = (0..sites.len()).collect();
    let mut eliminated = Vec::with_capacity(sites.len());
    while !left.is_empty() {
        let size = |site: usize| {
            let others = neighbours(&tables, site)
                .into_iter()
                .map(|other| counts[other]);
            others.fold(counts[site], usize::saturating_mul)
        };
        let next = *left.iter().min_by_key(|&&site| (size(site), site))?;
        if size(next) > limit {
            return None;
        }
        left.retain(|&site| site != next);
        let neighbours = neighbours(&tables, next);
        let (touching, others): (Vec<Table>, _) = tables
            .into_iter()
            .partition(|table| table.sites.contains(&next));
        tables = others;
        let (table, best) = eliminate(next, &neighbours, &touching, &counts);
        tables.push(table);
        eliminated.push(Eliminated {
            site: next,
            neighbours,
            best,
        });
    }
    let mut states = vec![0; sites.len()];
    for step in eliminated.iter().rev() {
        let place = |place: usize, &site: &usize| place * counts[site] + states[site];
        states[step.site] = step.best[step.neighbours.iter().fold(0, place)] as usize;
    }
    Some(states)
}

/// The component's energies as tables of one and of two sites.
fn tables(problem: &Problem, sites: &[usize]) -> Vec<Table> {
    let place = |site: &usize| sites.binary_search(site).ok();
    let own = sites.iter().enumerate().map(|(at, &site)| Table {
        sites: vec![at],
        energies: problem.own[site].clone(),
    });
    let pairs = problem.pairs.iter().filter_map(|pair| {
        let [a, b] = &pair.sites;
        Some(Table {
            sites: vec![place(a)?, place(b)?],
            energies: pair.energies.clone(),
        })
    });
    own.chain(pairs).collect()
}

/// The sites that share a table with a site, rising.
fn neighbours(tables: &[Table], site: usize) -> Vec<usize> {
    let touching = tables.iter().filter(|table| table.sites.contains(&site));
    let mut others: Vec<usize> = touching
        .flat_map(|table| table.sites.iter().copied())
        .filter(|&other| other != site)
        .collect();
    others.sort_unstable();
    others.dedup();
    others
}

/// The least energy of the tables over a site's states, for each combination of its neighbours' states, and the state
/// that has it: the first of those that tie.
fn eliminate(
    site: usize,
    neighbours: &[usize],
    touching: &[Table],
    counts: &[usize],
) -> (Table, Vec<u32>) {
    let combinations: usize = neighbours.iter().map(|&other| counts[other]).product();
    // Strides of each table: of each neighbour's state, and of the site's own.
    let strides = touching.iter().map(|table| {
        let stride = |site: &usize| -> usize {
            let at = table.sites.iter().position(|one| one == site);
            let inner = at.map(|at| table.sites[at + 1..].iter().map(|&one| counts[one]));
            inner.map_or(0, Iterator::product)
        };
        (neighbours.iter().map(stride).collect(), stride(&site))
    });
    let strides: Vec<(Vec<usize>, usize)> = strides.collect();
    let mut states = vec![0; neighbours.len()];
    let mut energies = Vec::with_capacity(combinations);
    let mut best = Vec::with_capacity(combinations);
    for _ in 0..combinations {
        let mut least = (f64::INFINITY, 0);
        for state in 0..counts[site] {
            let terms = touching.iter().zip(&strides).map(|(table, (steps, own))| {
                let place = steps.iter().zip(&states).map(|(step, state)| step * state);
                table.energies[place.sum::<usize>() + own * state]
            });
            let energy: f64 = terms.sum();
            if energy < least.0 - TIE {
                least = (energy, state);
            }
        }
        energies.push(least.0);
        best.push(least.1 as u32);
        // The next combination, the last neighbour's state running fastest.
        for (state, &other) in states.iter_mut().zip(neighbours).rev() {
            *state += 1;
            if *state < counts[other] {
                break;
            }
            *state = 0;
        }
    }
    let table = Table {
        sites: neighbours.to_vec(),
        energies,
    };
    (table, best)
}
