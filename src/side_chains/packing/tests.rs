use super::annealing::Numbers;
use super::*;

/// Up to `sites` sites of up to `states` states; two of them share energies by a chance of `density`.
fn problem(numbers: &mut Numbers, sites: usize, states: usize, density: f64) -> Problem {
    let counts: Vec<usize> = (0..1 + numbers.below(sites))
        .map(|_| 1 + numbers.below(states))
        .collect();
    let own = counts
        .iter()
        .map(|&count| (0..count).map(|_| 4.0 * numbers.next()).collect());
    let own = own.collect();
    let mut pairs = Vec::new();
    for b in 0..counts.len() {
        for a in 0..b {
            if numbers.next() < density {
                let size = counts[a] * counts[b];
                pairs.push(Pair {
                    sites: [a, b],
                    energies: (0..size)
                        .map(|_| 10.0 * numbers.next().powi(4) - 1.0)
                        .collect(),
                });
            }
        }
    }
    Problem { own, pairs }
}

/// The least energy of all combinations, one by one.
fn brute_force(problem: &Problem) -> f64 {
    let mut states = vec![0; problem.own.len()];
    let mut least = f64::INFINITY;
    loop {
        least = least.min(problem.energy(&states));
        let mut site = 0;
        while site < states.len() && states[site] + 1 == problem.own[site].len() {
            states[site] = 0;
            site += 1;
        }
        if site == states.len() {
            return least;
        }
        states[site] += 1;
    }
}

#[test]
fn the_search_finds_the_least_of_all_combinations() {
    let mut numbers = Numbers(42);
    for round in 0..200 {
        let density = [0.2, 0.5, 1.0][round % 3];
        let problem = problem(&mut numbers, 6, 5, density);
        let solution = problem.solve(&vec![0; problem.own.len()], 1 << 20);
        assert_eq!(solution.improved, 0);
        let found = problem.energy(&solution.states);
        assert!((found - brute_force(&problem)).abs() < 1e-9, "{problem:?}");
    }
}

#[test]
fn dropped_states_are_not_in_the_best_answer() {
    let mut numbers = Numbers(7);
    let mut dropped = 0;
    for _ in 0..100 {
        let problem = problem(&mut numbers, 5, 5, 0.5);
        let alive = dead_ends::survivors(&problem);
        let all: usize = problem.own.iter().map(Vec::len).sum();
        dropped += all - alive.iter().map(Vec::len).sum::<usize>();
        let reduced = problem.reduced(&alive);
        assert!((brute_force(&reduced) - brute_force(&problem)).abs() < 1e-12);
    }
    assert!(dropped > 100, "{dropped}");
}

/// Without room for tables the search still never ends above the first states, and single states are best.
#[test]
fn entangled_components_are_improved() {
    let mut numbers = Numbers(1);
    let mut lowered = 0;
    for _ in 0..100 {
        let problem = problem(&mut numbers, 8, 6, 1.0);
        let solution = problem.solve(&vec![0; problem.own.len()], 0);
        assert_eq!(solution.exact, 0);
        let (before, after) = (
            problem.energy(&vec![0; problem.own.len()]),
            problem.energy(&solution.states),
        );
        assert!(after <= before + 1e-9);
        lowered += usize::from(after < before);
        for site in 0..problem.own.len() {
            for state in 0..problem.own[site].len() {
                let mut changed = solution.states.clone();
                changed[site] = state;
                assert!(problem.energy(&changed) >= after - 1e-7);
            }
        }
    }
    assert!(lowered > 60, "{lowered}");
}

/// Among equal states the present one stays, and sites that share no energy are separate components.
#[test]
fn ties_keep_the_present_state() {
    let problem = Problem {
        own: vec![vec![1.0, 1.0], vec![2.0, 2.0, 1.0], vec![0.0]],
        pairs: vec![Pair {
            sites: [0, 2],
            energies: vec![0.5, 0.5],
        }],
    };
    let solution = problem.solve(&vec![0; problem.own.len()], 100);
    assert_eq!(solution.states, [0, 2, 0]);
    assert_eq!((solution.exact, solution.improved), (2, 0));
    let nothing = Problem::default().solve(&[], 100);
    assert_eq!(nothing.states, Vec::<usize>::new());
}
