//! Improvement of components that are too entangled to be solved exactly.
//!
//! By simulated annealing (Kirkpatrick, Gelatt & Vecchi, Science 220 (1983) 671-680) with numbers that are the same in
//! every run, and sweeps after it. In a sweep each site in turn takes the state that is best beside the others', until
//! nothing changes. The result is the better of this and of sweeps alone from the first states, so its energy is never
//! above the first.

use super::{Problem, SiteTable, TIE, site_tables};

/// Temperatures at the start and at the end, in units of the energies.
const TEMPERATURES: [f64; 2] = [5.0, 0.05];
/// Changes tried for each state of the component.
const TRIALS: usize = 400;
/// Most changes tried in all.
const MAX_TRIALS: usize = 1_000_000;
/// Most sweeps; the energy falls at each, and few are needed.
const MAX_SWEEPS: usize = 1000;

/// Sites that share energies, with the states of each that may be in the best answer.
pub(super) struct Component<'a> {
    problem: &'a Problem,
    tables: Vec<Vec<SiteTable>>,
    sites: &'a [usize],
    alive: &'a [Vec<usize>],
}

impl<'a> Component<'a> {
    pub(super) fn new(problem: &'a Problem, sites: &'a [usize], alive: &'a [Vec<usize>]) -> Self {
        Self {
            problem,
            tables: site_tables(problem),
            sites,
            alive,
        }
    }

    /// Improves the states of the sites, from those given.
    pub(super) fn improve(&self, states: &mut [usize]) {
        let mut swept = states.to_vec();
        self.sweep(&mut swept);
        let mut annealed = states.to_vec();
        self.anneal(&mut annealed);
        self.sweep(&mut annealed);
        let energy = |states: &[usize]| self.problem.energy(states);
        let better = energy(&annealed) < energy(&swept) - TIE;
        states.copy_from_slice(if better { &annealed } else { &swept });
    }

    /// Energy of a state of a site beside the others' present ones.
    fn beside(&self, site: usize, state: usize, states: &[usize]) -> f64 {
        let with = self.tables[site]
            .iter()
            .map(|table| table.row(state)[states[table.other]]);
        self.problem.own[site][state] + with.sum::<f64>()
    }

    /// Sweeps until no single change lowers the energy.
    fn sweep(&self, states: &mut [usize]) {
        for _ in 0..MAX_SWEEPS {
            let mut moved = false;
            for &site in self.sites {
                let present = states[site];
                let mut best = (self.beside(site, present, states), present);
                for &state in &self.alive[site] {
                    let energy = self.beside(site, state, states);
                    if energy < best.0 - TIE {
                        best = (energy, state);
                    }
                }
                moved |= best.1 != present;
                states[site] = best.1;
            }
            if !moved {
                return;
            }
        }
    }

    /// Changes single sites at falling temperatures.
    fn anneal(&self, states: &mut [usize]) {
        let (sites, alive) = (self.sites, self.alive);
        let all: usize = sites.iter().map(|&site| alive[site].len()).sum();
        let trials = (TRIALS * all).min(MAX_TRIALS);
        let [hot, cold] = TEMPERATURES;
        let mut numbers = Numbers(1);
        for trial in 0..trials {
            let temperature = hot * (cold / hot).powf(trial as f64 / trials as f64);
            let site = sites[numbers.below(sites.len())];
            let state = alive[site][numbers.below(alive[site].len())];
            let rise = self.beside(site, state, states) - self.beside(site, states[site], states);
            if rise <= 0.0 || numbers.next() < (-rise / temperature).exp() {
                states[site] = state;
            }
        }
    }
}

/// A generator of numbers: SplitMix64, Steele, Lea & Flood, OOPSLA 2014, 453-472.
pub(super) struct Numbers(pub u64);

impl Numbers {
    /// The next number, 0 to 1.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    }

    /// The next whole number below `count`, which is at least 1.
    pub fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize % count
    }
}
