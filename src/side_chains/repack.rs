//! Packing of one pose: which side chains, their energies, and the molecules with the new ones.

use knotdock_scoring::se3::Pose;
use knotdock_structures::molecule::{
    HeldSideChain, Molecule, Partner, SideChain, log_probability, rotamers,
};
use knotdock_structures::neighbours::CellList;
use serde::Serialize;

use super::candidates::{around, candidates};
use super::energy::{Particle, REACH, pair_energy};
use super::packing::{Pair, Problem, Solution};
use super::scene::{Body, cells, minus};

/// Two atoms across the interface clash if they are nearer than this share of the sum of their radii: carbons at 3.0 Å,
/// a nitrogen and an oxygen at 2.4 Å.
const CLASH: f64 = 0.8;
/// States that cost more than the site's best by this much by themselves are not tried.
const HOPELESS: f64 = 20.0;
/// Steps in degrees by which angles are refined once rotamers are found, one search each.
const STEPS: [f64; 3] = [8.0, 4.0, 4.0];
/// Most entries of a table of the exact search.
const TABLE_LIMIT: usize = 1 << 22;

/// How side chains are packed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RepackOptions {
    /// Side chains with an atom, CB included, this near to the other molecule are packed, in Å.
    pub reach: f64,
    /// Least gain of energy for which a side chain moves, so that trusted ones do not jitter; at least 0.
    pub threshold: f64,
    /// Weight of the rotamers' logarithm of probability.
    pub rotamer_weight: f64,
}

impl Default for RepackOptions {
    fn default() -> Self {
        Self {
            reach: 6.0,
            threshold: 3.0,
            rotamer_weight: 1.0,
        }
    }
}

/// A pose with its side chains packed anew.
#[derive(Clone, Debug)]
pub struct Repacked {
    /// The receptor in its own frame.
    pub receptor: Molecule,
    /// The ligand in its own frame, not placed.
    pub ligand: Molecule,
    /// Side chains that moved, the receptor's first, in file order.
    pub moved: Vec<RepackedResidue>,
    /// Side chains of the interface that had to stay, and why.
    pub held: Vec<HeldResidue>,
    /// How many side chains of the interface might move.
    pub considered: usize,
    /// Energy of what may move, within itself and with all else, in the present states; about kcal/mol.
    pub energy_before: f64,
    /// The same in the new states; never above `energy_before`.
    pub energy_after: f64,
    /// Pairs of heavy atoms across the interface nearer than 0.8 of the sum of their radii, before.
    pub clashes_before: usize,
    /// The same after.
    pub clashes_after: usize,
    /// Whether every search was exact: the rotamers, and then the finer steps about them, were the best together of
    /// those tried. Where not, some components were annealed.
    pub exact: bool,
}

/// A side chain that moved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RepackedResidue {
    /// Whose it is.
    pub partner: Partner,
    /// The author's name of the chain; may be empty.
    pub chain: String,
    /// The author's number with the insertion code, e.g. `52A`.
    pub number: String,
    /// The residue's name in the file.
    pub name: String,
    /// Its chi angles in radians, -pi to pi, before.
    pub chi_before: Vec<f64>,
    /// The same after.
    pub chi_after: Vec<f64>,
}

/// A side chain of the interface that had to stay.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeldResidue {
    /// Whose it is.
    pub partner: Partner,
    /// The author's name of the chain; may be empty.
    pub chain: String,
    /// The author's number with the insertion code, e.g. `52A`.
    pub number: String,
    /// The residue's name in the file.
    pub name: String,
    /// Why it stays.
    pub reason: HeldSideChain,
}

/// Two molecules whose side chains can be packed anew for any pose.
pub struct Repacker<'a> {
    bodies: [Body<'a>; 2],
    options: RepackOptions,
}

/// A side chain that may move.
struct Site<'a> {
    /// 0 the receptor's, 1 the ligand's.
    body: usize,
    side_chain: &'a SideChain,
    /// Places of the heavy atoms that move.
    mobile: Vec<usize>,
    /// Chi angles of each state, radians; the present one first.
    states: Vec<Vec<f64>>,
    /// The mobile atoms of each state, one state after another.
    particles: Vec<Particle>,
    /// Energy of each state with all that does not move.
    own: Vec<f64>,
}

/// The last search: its sites, their energies and its answer.
struct Search<'a> {
    sites: Vec<Site<'a>>,
    problem: Problem,
    solution: Solution,
    /// Whether it and those before were exact.
    exact: bool,
}

/// An atom that does not move, and where it comes from.
#[derive(Clone, Copy)]
struct Fixed {
    particle: Particle,
    body: usize,
    atom: usize,
}

impl<'a> Repacker<'a> {
    /// Prepares two molecules, in the frames in which a pose places the ligand.
    pub fn new(receptor: &'a Molecule, ligand: &'a Molecule, options: RepackOptions) -> Self {
        Self {
            bodies: [Body::new(receptor), Body::new(ligand)],
            options,
        }
    }

    /// Packs the side chains of the interface that the ligand at `pose` makes.
    ///
    /// Single-threaded; poses may be packed side by side.
    pub fn repack(&self, pose: &Pose) -> Repacked {
        let origin = self.origin(pose);
        let positions = [
            self.bodies[0].positions(&Pose::identity(), origin),
            self.bodies[1].positions(pose, origin),
        ];
        let (packed, held) = self.interface(&positions);
        let search = self.search(&packed, &positions);
        let Search {
            sites,
            problem,
            solution,
            exact,
        } = search;
        let moves = solution.states.iter().filter(|&&state| state != 0).count();
        let energy_before = problem.energy(&vec![0; sites.len()]);
        let cost = self.threshold() * moves as f64;
        let [receptor, ligand] =
            [0, 1].map(|body| self.with_states(body, &sites, &solution.states));
        let clashes = |ligand: &Molecule, receptor: &Molecule| {
            clashes(receptor, &ligand.map_positions(|x| pose.apply(x)), origin)
        };
        Repacked {
            clashes_before: clashes(self.bodies[1].molecule, self.bodies[0].molecule),
            clashes_after: clashes(&ligand, &receptor),
            receptor,
            ligand,
            moved: self.moved(&sites, &solution.states, &positions),
            held,
            considered: sites.len(),
            energy_before,
            energy_after: problem.energy(&solution.states) - cost,
            exact,
        }
    }

    /// Searches the rotamers, then finer steps about those found.
    fn search(&self, packed: &[[usize; 2]], positions: &[Vec<[f64; 3]>; 2]) -> Search<'_> {
        let present: Vec<Vec<f64>> = packed
            .iter()
            .map(|&[body, place]| self.bodies[body].side_chains[place].chi(&positions[body]))
            .collect();
        let lists = packed
            .iter()
            .zip(&present)
            .map(|(&[body, place], present)| {
                candidates(&self.bodies[body].side_chains[place], present)
            });
        let start = vec![0; packed.len()];
        let mut search = self.solved(packed, positions, lists.collect(), &start);
        for step in STEPS {
            let found = search.sites.iter().zip(&search.solution.states);
            let lists = found.zip(&present).map(|((site, &state), present)| {
                around(present, &site.states[state], step.to_radians())
            });
            let lists = lists.collect();
            // The present state costs no threshold, so what has not moved starts from there.
            let start = search
                .solution
                .states
                .iter()
                .map(|&state| usize::from(state != 0));
            let next = self.solved(packed, positions, lists, &start.collect::<Vec<_>>());
            search = Search {
                exact: search.exact && next.exact,
                ..next
            };
        }
        search
    }

    /// One search over lists of states, the present one first, from a start that is one of the first two.
    fn solved(
        &self,
        packed: &[[usize; 2]],
        positions: &[Vec<[f64; 3]>; 2],
        lists: Vec<Vec<Vec<f64>>>,
        start: &[usize],
    ) -> Search<'_> {
        let sites = self.sites(packed, positions, lists);
        let problem = self.problem(&sites);
        let solution = problem.solve(start, TABLE_LIMIT);
        Search {
            exact: solution.improved == 0,
            sites,
            problem,
            solution,
        }
    }

    fn threshold(&self) -> f64 {
        self.options.threshold.max(0.0)
    }

    /// The ligand's middle at the pose, about which all is computed.
    fn origin(&self, pose: &Pose) -> [f64; 3] {
        let atoms = &self.bodies[1].molecule.atoms;
        let mean = |axis: usize| {
            atoms.iter().map(|atom| atom.position[axis]).sum::<f64>() / atoms.len().max(1) as f64
        };
        pose.apply(std::array::from_fn(mean))
    }

    /// The side chains near the other molecule, as the body and the place among its side chains: those that may move,
    /// and what keeps the others.
    fn interface(&self, positions: &[Vec<[f64; 3]>; 2]) -> (Vec<[usize; 2]>, Vec<HeldResidue>) {
        let (mut packed, mut held) = (Vec::new(), Vec::new());
        let reach = self.options.reach;
        for (body, partner) in [(0, Partner::Receptor), (1, Partner::Ligand)] {
            let other = &self.bodies[1 - body].molecule.atoms;
            let heavy = other.iter().zip(&positions[1 - body]);
            let heavy = heavy.filter(|(atom, _)| !atom.is_hydrogen());
            let cells = cells(heavy.map(|(_, &position)| (position, ())), reach.max(1.0));
            for (place, side_chain) in self.bodies[body].side_chains.iter().enumerate() {
                let mut is_near = false;
                for &atom in &side_chain.atoms {
                    cells.visit_within(positions[body][atom], reach, |(), _| is_near = true);
                }
                match side_chain.held {
                    _ if !is_near => {}
                    None => packed.push([body, place]),
                    Some(reason) => held.push(HeldResidue {
                        partner,
                        chain: side_chain.chain.clone(),
                        number: side_chain.number.clone(),
                        name: side_chain.name.clone(),
                        reason,
                    }),
                }
            }
        }
        (packed, held)
    }

    /// The states of the side chains that may move, and their energies with all that does not.
    fn sites(
        &self,
        packed: &[[usize; 2]],
        positions: &[Vec<[f64; 3]>; 2],
        lists: Vec<Vec<Vec<f64>>>,
    ) -> Vec<Site<'_>> {
        let mut is_mobile = [0, 1].map(|body| vec![false; positions[body].len()]);
        let side_chain = |[body, place]: [usize; 2]| &self.bodies[body].side_chains[place];
        for &site in packed {
            for bond in &side_chain(site).bonds {
                for &atom in &bond.moved {
                    is_mobile[site[0]][atom] = true;
                }
            }
        }
        let fixed = [0, 1].into_iter().flat_map(|body| {
            let is_mobile = &is_mobile;
            let atoms = self.bodies[body].molecule.atoms.iter().enumerate();
            let fixed =
                atoms.filter(move |(at, atom)| !is_mobile[body][*at] && !atom.is_hydrogen());
            fixed.map(move |(atom, _)| {
                let particle = self.bodies[body].particle(atom, &positions[body]);
                let fixed = Fixed {
                    particle,
                    body,
                    atom,
                };
                (particle.position, fixed)
            })
        });
        let fixed = cells(fixed, REACH);
        let mut scratch = positions.clone();
        packed
            .iter()
            .zip(lists)
            .map(|(&site, states)| {
                let body = site[0];
                let of = (side_chain(site), states);
                let site = self.site(body, of, &mut scratch[body], &fixed);
                for &atom in &site.side_chain.near_bonds {
                    scratch[body][atom] = positions[body][atom];
                }
                site
            })
            .collect()
    }

    /// One side chain's states; leaves its atoms where the last of them has them.
    fn site<'b>(
        &self,
        body: usize,
        (side_chain, states): (&'b SideChain, Vec<Vec<f64>>),
        positions: &mut [[f64; 3]],
        fixed: &CellList<Fixed>,
    ) -> Site<'b> {
        let [phi, psi] = side_chain.backbone;
        let table = rotamers(side_chain.residue, phi, psi);
        let atoms = &self.bodies[body].molecule.atoms;
        let first = side_chain.bonds.first().map_or(&[][..], |bond| &bond.moved);
        let mobile = first
            .iter()
            .copied()
            .filter(|&atom| !atoms[atom].is_hydrogen());
        let mut site = Site {
            body,
            side_chain,
            mobile: mobile.collect(),
            states: Vec::new(),
            particles: Vec::new(),
            own: Vec::new(),
        };
        let start: Vec<[f64; 3]> = side_chain
            .near_bonds
            .iter()
            .map(|&at| positions[at])
            .collect();
        let mut best = f64::INFINITY;
        for chi in states {
            for (&atom, &position) in side_chain.near_bonds.iter().zip(&start) {
                positions[atom] = position;
            }
            side_chain.set_chi(positions, &chi);
            let particles = site.mobile.iter();
            let particles = particles.map(|&atom| self.bodies[body].particle(atom, positions));
            let particles: Vec<Particle> = particles.collect();
            let mut energy =
                -self.options.rotamer_weight * log_probability(side_chain.residue, table, &chi);
            for one in &particles {
                fixed.visit_within(one.position, REACH, |other, _| {
                    let is_near = other.body == body && side_chain.near_bonds.contains(&other.atom);
                    if !is_near {
                        energy += pair_energy(one, &other.particle);
                    }
                });
            }
            best = best.min(energy);
            site.states.push(chi);
            site.particles.extend(particles);
            site.own.push(energy);
        }
        site.drop_hopeless(best);
        site
    }

    /// The energies of all states and of all pairs of them; every state but the present one costs the threshold too.
    fn problem(&self, sites: &[Site<'_>]) -> Problem {
        let own = sites.iter().map(|site| {
            let costs = site.own.iter().enumerate();
            let cost = |state: usize| if state == 0 { 0.0 } else { self.threshold() };
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

    /// A molecule in its own frame with its side chains in these states.
    fn with_states(&self, body: usize, sites: &[Site<'_>], states: &[usize]) -> Molecule {
        let mut molecule = self.bodies[body].molecule.clone();
        let mut positions: Vec<[f64; 3]> =
            molecule.atoms.iter().map(|atom| atom.position).collect();
        for (site, &state) in sites.iter().zip(states) {
            if site.body == body && state != 0 {
                site.side_chain.set_chi(&mut positions, &site.states[state]);
            }
        }
        for (atom, position) in molecule.atoms.iter_mut().zip(positions) {
            atom.position = position;
        }
        molecule
    }

    fn moved(
        &self,
        sites: &[Site<'_>],
        states: &[usize],
        positions: &[Vec<[f64; 3]>; 2],
    ) -> Vec<RepackedResidue> {
        let moved = sites.iter().zip(states).filter(|(_, state)| **state != 0);
        let of = |(site, &state): (&Site<'_>, &usize)| RepackedResidue {
            partner: [Partner::Receptor, Partner::Ligand][site.body],
            chain: site.side_chain.chain.clone(),
            number: site.side_chain.number.clone(),
            name: site.side_chain.name.clone(),
            chi_before: site.side_chain.chi(&positions[site.body]),
            chi_after: site.states[state]
                .iter()
                .map(|&chi| within_turn(chi))
                .collect(),
        };
        moved.map(of).collect()
    }
}

impl Site<'_> {
    /// Drops states that cost far more than the best, but for the first two, where a search may start.
    fn drop_hopeless(&mut self, best: f64) {
        let count = self.mobile.len();
        let kept: Vec<usize> = (0..self.own.len())
            .filter(|&state| state < 2 || self.own[state] <= best + HOPELESS)
            .collect();
        self.particles = kept
            .iter()
            .flat_map(|&state| self.particles[state * count..][..count].iter().copied())
            .collect();
        self.states = kept
            .iter()
            .map(|&state| self.states[state].clone())
            .collect();
        self.own = kept.iter().map(|&state| self.own[state]).collect();
    }

    /// A ball that holds the mobile atoms of a run of states: centre and radius in Å.
    fn ball(particles: &[Particle]) -> ([f64; 3], f64) {
        let count = particles.len().max(1) as f64;
        let mean =
            |axis: usize| particles.iter().map(|one| one.position[axis]).sum::<f64>() / count;
        let center: [f64; 3] = std::array::from_fn(mean);
        let away = particles
            .iter()
            .map(|one| square(minus(one.position, center)));
        (center, away.fold(0.0, f64::max).sqrt())
    }
}

/// Energies of the states of two sites together, the second's running fastest; `None` where all are zero.
fn pair_energies(first: &Site<'_>, second: &Site<'_>) -> Option<Vec<f64>> {
    let apart = |(a, r): ([f64; 3], f64), (b, s): ([f64; 3], f64)| {
        square(minus(a, b)) >= (r + s + REACH).powi(2)
    };
    if apart(Site::ball(&first.particles), Site::ball(&second.particles)) {
        return None;
    }
    let balls = |site: &Site<'_>| -> Vec<_> {
        let states = site.particles.chunks(site.mobile.len().max(1));
        states.map(Site::ball).collect()
    };
    let (of_first, of_second) = (balls(first), balls(second));
    let states = |site: &'_ Site<'_>, state: usize| {
        let count = site.mobile.len();
        state * count..(state + 1) * count
    };
    let mut energies = Vec::with_capacity(of_first.len() * of_second.len());
    for (r, &ball) in of_first.iter().enumerate() {
        for (s, &other) in of_second.iter().enumerate() {
            let mut energy = 0.0;
            if !apart(ball, other) {
                for a in &first.particles[states(first, r)] {
                    for b in &second.particles[states(second, s)] {
                        energy += pair_energy(a, b);
                    }
                }
            }
            energies.push(energy);
        }
    }
    energies
        .iter()
        .any(|&energy| energy != 0.0)
        .then_some(energies)
}

/// Pairs of heavy atoms of two placed molecules that clash.
fn clashes(receptor: &Molecule, ligand: &Molecule, origin: [f64; 3]) -> usize {
    let heavy = |molecule: &Molecule| -> Vec<([f64; 3], f64)> {
        let atoms = molecule.atoms.iter().filter(|atom| !atom.is_hydrogen());
        atoms
            .map(|atom| (minus(atom.position, origin), atom.radius))
            .collect()
    };
    let receptor = heavy(receptor);
    let largest = receptor
        .iter()
        .fold(0.0_f64, |largest, (_, radius)| largest.max(*radius));
    let cells = cells(receptor.into_iter(), REACH);
    let mut count = 0;
    for (position, radius) in heavy(ligand) {
        cells.visit_within(position, CLASH * (largest + radius), |other, square| {
            count += usize::from(square < (CLASH * (radius + other)).powi(2));
        });
    }
    count
}

/// An angle in radians, from -pi to pi.
fn within_turn(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}

fn square(x: [f64; 3]) -> f64 {
    x[0] * x[0] + x[1] * x[1] + x[2] * x[2]
}
