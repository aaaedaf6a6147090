//! The least energy of sites that take one of several states each, when energies are of single states and of pairs.
//!
//! [`Problem::solve`] drops states that cannot be in the best answer ([`dead_ends`]), separates the components that
//! share no energy, and solves each exactly ([`elimination`]). A component that is too entangled for that is
//! improved from the states given ([`annealing`]).
//!
//! State 0 of every site is the present one. It wins ties, so that nothing moves without a gain.

mod annealing;
mod dead_ends;
mod elimination;
#[cfg(test)]
mod tests;

use annealing::Component;

/// Energies that differ by less than this are equal (the unit of the energies).
const TIE: f64 = 1e-9;

/// Sites, their states and the energies of these.
#[derive(Clone, Debug, Default)]
pub(crate) struct Problem {
    /// Energy of each state of each site by itself.
    pub own: Vec<Vec<f64>>,
    /// Energies of pairs of sites; each pair once.
    pub pairs: Vec<Pair>,
}

/// The energies of two sites' states together.
#[derive(Clone, Debug)]
pub(crate) struct Pair {
    /// The two sites, the lower first.
    pub sites: [usize; 2],
    /// One value for each state of the first and of the second site, the second running fastest.
    pub energies: Vec<f64>,
}

/// A state for each site.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Solution {
    /// The states.
    pub states: Vec<usize>,
    /// Components that were solved exactly.
    pub exact: usize,
    /// Components that were improved only.
    pub improved: usize,
}

impl Problem {
    /// Energy of all sites in these states.
    pub fn energy(&self, states: &[usize]) -> f64 {
        let own = self.own.iter().zip(states).map(|(own, &state)| own[state]);
        let of_pair = |pair: &Pair| {
            let [a, b] = pair.sites;
            pair.energies[states[a] * self.own[b].len() + states[b]]
        };
        own.sum::<f64>() + self.pairs.iter().map(of_pair).sum::<f64>()
    }

    /// The states of least energy; of components whose tables would need more than `limit` entries, states that no
    /// single change improves and that are no worse than those of `start`.
    pub fn solve(&self, start: &[usize], limit: usize) -> Solution {
        let alive = dead_ends::survivors(self);
        let reduced = self.reduced(&alive);
        let mut states: Vec<usize> = start.to_vec();
        let (mut exact, mut improved) = (0, 0);
        for sites in reduced.components() {
            if let Some(best) = elimination::best(&reduced, &sites, limit) {
                exact += 1;
                for (site, state) in sites.iter().zip(best) {
                    states[*site] = alive[*site][state];
                }
            } else {
                improved += 1;
                Component::new(self, &sites, &alive).improve(&mut states);
            }
        }
        Solution {
            states,
            exact,
            improved,
        }
    }

    /// The problem with only these states of each site.
    fn reduced(&self, alive: &[Vec<usize>]) -> Self {
        let own = self.own.iter().zip(alive);
        let own = own.map(|(own, alive)| alive.iter().map(|&state| own[state]).collect());
        let pairs = self.pairs.iter().map(|pair| {
            let [a, b] = pair.sites;
            let row = self.own[b].len();
            let energies = alive[a].iter().flat_map(|first| {
                let row = &pair.energies[first * row..];
                alive[b].iter().map(move |&second| row[second])
            });
            Pair {
                sites: pair.sites,
                energies: energies.collect(),
            }
        });
        let acts = |pair: &Pair| pair.energies.iter().any(|&energy| energy != 0.0);
        Self {
            own: own.collect(),
            pairs: pairs.filter(acts).collect(),
        }
    }

    /// Sites that pairs connect, sorted, each component by itself; the one with the lowest site first.
    fn components(&self) -> Vec<Vec<usize>> {
        let mut root: Vec<usize> = (0..self.own.len()).collect();
        // The lowest site of a component stands for it.
        fn find(root: &[usize], mut site: usize) -> usize {
            while root[site] != site {
                site = root[site];
            }
            site
        }
        for pair in &self.pairs {
            let [a, b] = pair.sites.map(|site| find(&root, site));
            root[a.max(b)] = a.min(b);
        }
        let mut members: Vec<Vec<usize>> = vec![Vec::new(); root.len()];
        for site in 0..root.len() {
            members[find(&root, site)].push(site);
        }
        members.retain(|sites| !sites.is_empty());
        members
    }
}

/// Energies of a site's states with those of another, the other's running fastest.
struct SiteTable {
    other: usize,
    columns: usize,
    energies: Vec<f64>,
}

impl SiteTable {
    /// The energies of one state with all of the other's.
    fn row(&self, state: usize) -> &[f64] {
        &self.energies[state * self.columns..][..self.columns]
    }
}

/// Each site's tables.
fn site_tables(problem: &Problem) -> Vec<Vec<SiteTable>> {
    let mut tables: Vec<Vec<SiteTable>> = problem.own.iter().map(|_| Vec::new()).collect();
    for pair in &problem.pairs {
        let [a, b] = pair.sites;
        let (rows, columns) = (problem.own[a].len(), problem.own[b].len());
        let transposed = (0..rows * columns).map(|k| pair.energies[k % rows * columns + k / rows]);
        tables[b].push(SiteTable {
            other: a,
            columns: rows,
            energies: transposed.collect(),
        });
        tables[a].push(SiteTable {
            other: b,
            columns,
            energies: pair.energies.clone(),
        });
    }
    tables
}
