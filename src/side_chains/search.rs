//! The searches of one pose: rotamers first, then finer steps about those found.

use knotdock_structures::molecule::{SideChain, rotamers};

use super::packing::{Pair, Problem, Solution};
use super::sites::{Setting, Site, pair_energies};

/// Steps in degrees by which angles are refined once rotamers are found, one search each.
const STEPS: [f64; 3] = [8.0, 4.0, 4.0];
/// Most entries of a table of the exact search.
const TABLE_LIMIT: usize = 1 << 20;

/// The last search: its sites, their energies and its answer.
pub(super) struct Search<'a> {
    pub sites: Vec<Site<'a>>,
    pub problem: Problem,
    pub solution: Solution,
    /// Whether it and those before were exact.
    pub exact: bool,
}

/// Searches the rotamers, then finer steps about those found. Every state but the present one costs `threshold`.
pub(super) fn search<'a>(setting: &Setting<'a>, threshold: f64) -> Search<'a> {
    let present = setting.present();
    let lists = setting.side_chains().zip(&present);
    let lists = lists.map(|(side_chain, present)| candidates(side_chain, present));
    let start = vec![0; present.len()];
    let mut search = solved(setting, threshold, lists.collect(), &start);
    for step in STEPS {
        let found = search.sites.iter().zip(&search.solution.states);
        let lists = found.zip(&present).map(|((site, &state), present)| {
            around(present, &site.states[state], step.to_radians())
        });
        let lists = lists.collect();
        // The present state costs no threshold: side chains that have not moved start from there.
        let states = search.solution.states.iter();
        let start: Vec<usize> = states.map(|&state| usize::from(state != 0)).collect();
        let next = solved(setting, threshold, lists, &start);
        search = Search {
            exact: search.exact && next.exact,
            ..next
        };
    }
    search
}

/// One search over lists of states, the present one first, from a start that is one of the first two.
fn solved<'a>(
    setting: &Setting<'a>,
    threshold: f64,
    lists: Vec<Vec<Vec<f64>>>,
    start: &[usize],
) -> Search<'a> {
    let sites = setting.sites(lists);
    let problem = problem(&sites, threshold);
    let solution = problem.solve(start, TABLE_LIMIT);
    Search {
        exact: solution.improved == 0,
        sites,
        problem,
        solution,
    }
}

/// The energies of all states and of all pairs of them; every state but the present one costs the threshold too.
fn problem(sites: &[Site<'_>], threshold: f64) -> Problem {
    let own = sites.iter().map(|site| {
        let costs = site.own.iter().enumerate();
        let cost = |state: usize| if state == 0 { 0.0 } else { threshold };
        costs.map(|(state, energy)| energy + cost(state)).collect()
    });
    let mut pairs = Vec::new();
    for second in 1..sites.len() {
        for first in 0..second {
            let energies = pair_energies(&sites[first], &sites[second]);
            pairs.extend(energies.map(|energies| Pair {
                sites: [first, second],
                energies,
            }));
        }
    }
    Problem {
        own: own.collect(),
        pairs,
    }
}

/// Step in the first two angles from a rotamer, and from the present angles, in radians: 10 degrees.
const STEP: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// The chi angles of each state in radians: the present ones, their neighbours, and the rotamers of the backbone with
/// theirs.
///
/// A neighbour differs by 10 degrees in the first or the second angle.
fn candidates(side_chain: &SideChain, present: &[f64]) -> Vec<Vec<f64>> {
    let mut states = neighbourhood(present, 2, STEP);
    let [phi, psi] = side_chain.backbone;
    for rotamer in rotamers(side_chain.residue, phi, psi) {
        let mean = rotamer.chi.get(..present.len()).unwrap_or_default();
        states.extend(neighbourhood(mean, 2, STEP));
    }
    states
}

/// The present angles, those found, and those that differ from them by `step` (radians) in one angle.
fn around(present: &[f64], found: &[f64], step: f64) -> Vec<Vec<f64>> {
    let mut states = vec![present.to_vec()];
    states.extend(neighbourhood(found, found.len(), step));
    states
}

/// Angles, and those one step away in one of the first `count`.
fn neighbourhood(chi: &[f64], count: usize, step: f64) -> Vec<Vec<f64>> {
    let mut all = vec![chi.to_vec()];
    for k in 0..chi.len().min(count) {
        for step in [step, -step] {
            let mut near = chi.to_vec();
            near[k] += step;
            all.push(near);
        }
    }
    all
}
