//! The side chains that may move, their states, and the energies of these.

use knotdock_structures::molecule::{SideChain, log_probability, rotamers};
use knotdock_structures::neighbours::CellList;

use super::energy::{Particle, REACH, pair_energy};
use super::scene::{Body, cells, minus};

/// States that cost more than the site's best by this much by themselves are not tried.
const MAX_EXCESS: f64 = 20.0;

/// A side chain that may move.
pub(super) struct Site<'a> {
    /// 0 the receptor's, 1 the ligand's.
    pub body: usize,
    pub side_chain: &'a SideChain,
    /// Places of the heavy atoms that move.
    mobile: Vec<usize>,
    /// Chi angles of each state, radians; the present one first.
    pub states: Vec<Vec<f64>>,
    /// The mobile atoms of each state, one state after another.
    particles: Vec<Particle>,
    /// Energy of each state with the fixed atoms.
    pub own: Vec<f64>,
}

/// An atom that does not move, with its body and index.
#[derive(Clone, Copy)]
struct Fixed {
    particle: Particle,
    body: usize,
    atom: usize,
}

/// The side chains of a pose that may move, among the fixed atoms.
pub(super) struct Setting<'a> {
    bodies: &'a [Body<'a>; 2],
    /// Positions of all atoms of both in one frame (Å).
    positions: &'a [Vec<[f64; 3]>; 2],
    /// The side chains that may move: the body, and the place among its side chains.
    packed: &'a [[usize; 2]],
    rotamer_weight: f64,
    /// All heavy atoms that do not move.
    fixed: CellList<Fixed>,
}

impl<'a> Setting<'a> {
    pub fn new(
        bodies: &'a [Body<'a>; 2],
        positions: &'a [Vec<[f64; 3]>; 2],
        packed: &'a [[usize; 2]],
        rotamer_weight: f64,
    ) -> Self {
        let mut is_mobile = [0, 1].map(|body| vec![false; positions[body].len()]);
        for &[body, place] in packed {
            for bond in &bodies[body].side_chains[place].bonds {
                for &atom in &bond.moved {
                    is_mobile[body][atom] = true;
                }
            }
        }
        let fixed = [0, 1].into_iter().flat_map(|body| {
            let is_mobile = &is_mobile[body];
            let atoms = bodies[body].molecule.atoms.iter().enumerate();
            let fixed = atoms.filter(|(at, atom)| !is_mobile[*at] && !atom.is_hydrogen());
            fixed.map(move |(atom, _)| {
                let particle = bodies[body].particle(atom, &positions[body]);
                let fixed = Fixed {
                    particle,
                    body,
                    atom,
                };
                (particle.position, fixed)
            })
        });
        Self {
            fixed: cells(fixed, REACH),
            bodies,
            positions,
            packed,
            rotamer_weight,
        }
    }

    /// The side chains that may move, in the order in which they were given.
    pub fn side_chains(&self) -> impl Iterator<Item = &'a SideChain> {
        let packed = self.packed.iter();
        packed.map(|&[body, place]| &self.bodies[body].side_chains[place])
    }

    /// The present chi angles of each in radians.
    pub fn present(&self) -> Vec<Vec<f64>> {
        let packed = self.side_chains().zip(self.packed);
        let present = packed.map(|(one, &[body, _])| one.chi(&self.positions[body]));
        present.collect()
    }

    /// The sites with these states each, as chi angles in radians.
    pub fn sites(&self, lists: Vec<Vec<Vec<f64>>>) -> Vec<Site<'a>> {
        let mut scratch = self.positions.clone();
        let packed = self.side_chains().zip(self.packed).zip(lists);
        let sites = packed.map(|((side_chain, &[body, _]), states)| {
            let site = self.site(body, side_chain, states, &mut scratch[body]);
            for &atom in &side_chain.near_bonds {
                scratch[body][atom] = self.positions[body][atom];
            }
            site
        });
        sites.collect()
    }

    /// One side chain's states; leaves its atoms where the last of them has them.
    fn site(
        &self,
        body: usize,
        side_chain: &'a SideChain,
        states: Vec<Vec<f64>>,
        positions: &mut [[f64; 3]],
    ) -> Site<'a> {
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
        let start = side_chain.near_bonds.iter().map(|&at| positions[at]);
        let start: Vec<[f64; 3]> = start.collect();
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
                -self.rotamer_weight * log_probability(side_chain.residue, table, &chi);
            for one in &particles {
                self.fixed.visit_within(one.position, REACH, |other, _| {
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
        site.drop_costly(best);
        site
    }
}

impl Site<'_> {
    /// Drops states that cost far more than the best, but for the first two, where a search may start.
    fn drop_costly(&mut self, best: f64) {
        let kept: Vec<usize> = (0..self.own.len())
            .filter(|&state| state < 2 || self.own[state] <= best + MAX_EXCESS)
            .collect();
        let particles = kept.iter().flat_map(|&state| self.of_state(state));
        self.particles = particles.copied().collect();
        self.states = kept
            .iter()
            .map(|&state| self.states[state].clone())
            .collect();
        self.own = kept.iter().map(|&state| self.own[state]).collect();
    }

    /// The mobile atoms of a state.
    fn of_state(&self, state: usize) -> &[Particle] {
        let count = self.mobile.len();
        &self.particles[state * count..][..count]
    }

    /// A ball that holds the mobile atoms of some states: centre and radius in Å.
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

/// Energies of the states of two sites together, the second's running fastest; `None` if all are zero.
pub(super) fn pair_energies(first: &Site<'_>, second: &Site<'_>) -> Option<Vec<f64>> {
    let are_far = |(a, r): ([f64; 3], f64), (b, s): ([f64; 3], f64)| {
        square(minus(a, b)) >= (r + s + REACH).powi(2)
    };
    if are_far(Site::ball(&first.particles), Site::ball(&second.particles)) {
        return None;
    }
    let balls = |site: &Site<'_>| -> Vec<_> {
        let states = site.particles.chunks(site.mobile.len().max(1));
        states.map(Site::ball).collect()
    };
    let (of_first, of_second) = (balls(first), balls(second));
    let mut energies = Vec::with_capacity(of_first.len() * of_second.len());
    for (r, &ball) in of_first.iter().enumerate() {
        for (s, &other) in of_second.iter().enumerate() {
            let mut energy = 0.0;
            if !are_far(ball, other) {
                for a in first.of_state(r) {
                    for b in second.of_state(s) {
                        energy += pair_energy(a, b);
                    }
                }
            }
            energies.push(energy);
        }
    }
    let acts = energies.iter().any(|&energy| energy != 0.0);
    acts.then_some(energies)
}

fn square(x: [f64; 3]) -> f64 {
    x[0] * x[0] + x[1] * x[1] + x[2] * x[2]
}
