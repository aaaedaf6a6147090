//! Packing of one pose: which side chains, their energies, and the molecules with the new ones.

use knotdock_scoring::se3::Pose;
use knotdock_structures::molecule::{HeldSideChain, Molecule, Partner};
use serde::Serialize;

use super::scene::{Body, cells, clashes};
use super::search::{Search, search};
use super::sites::{Setting, Site};

/// Options of packing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RepackOptions {
    /// Side chains with an atom, CB included, this near to the other molecule are packed, in Å.
    pub reach: f64,
    /// Least gain of energy for which a side chain moves, so that trusted ones do not jitter; at least 0.
    ///
    /// Chosen so that nearly all side chains of bound complexes stay, while most clashes of unbound ones go.
    pub threshold: f64,
    /// Weight of the rotamers' logarithm of probability.
    pub rotamer_weight: f64,
}

impl Default for RepackOptions {
    fn default() -> Self {
        Self {
            reach: 6.0,
            threshold: 6.0,
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
    /// Side chains of the interface that had to stay, with the reasons.
    pub held: Vec<HeldResidue>,
    /// Number of side chains of the interface that could move.
    pub considered: usize,
    /// Energy of the side chains that may move, within themselves and with all else, in the present states; about kcal/mol.
    pub energy_before: f64,
    /// That energy in the new states; never above `energy_before`.
    pub energy_after: f64,
    /// Pairs of heavy atoms across the interface nearer than 0.8 of the sum of their radii, before.
    pub clashes_before: usize,
    /// Such pairs after.
    pub clashes_after: usize,
    /// Whether every search was exact: the rotamers, and then the finer steps about them, were the best together of
    /// those tried. If not, some components were annealed.
    pub exact: bool,
}

/// A side chain that moved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RepackedResidue {
    /// Its molecule.
    pub partner: Partner,
    /// The author's name of the chain; may be empty.
    pub chain: String,
    /// The author's number with the insertion code, e.g. `52A`.
    pub number: String,
    /// The residue's name in the file.
    pub name: String,
    /// Its chi angles in radians, -pi to pi, before.
    pub chi_before: Vec<f64>,
    /// Its chi angles after.
    pub chi_after: Vec<f64>,
}

/// A side chain of the interface that had to stay.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeldResidue {
    /// Its molecule.
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
        let weight = self.options.rotamer_weight;
        let setting = Setting::new(&self.bodies, &positions, &packed, weight);
        let Search {
            sites,
            problem,
            solution,
            exact,
        } = search(&setting, self.threshold());
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

    fn threshold(&self) -> f64 {
        self.options.threshold.max(0.0)
    }

    /// The ligand's centre at the pose: the origin of the computation.
    fn origin(&self, pose: &Pose) -> [f64; 3] {
        let atoms = &self.bodies[1].molecule.atoms;
        let mean = |axis: usize| {
            atoms.iter().map(|atom| atom.position[axis]).sum::<f64>() / atoms.len().max(1) as f64
        };
        pose.apply(std::array::from_fn(mean))
    }

    /// The side chains near the other molecule: those that may move, as the body and the place among its side chains, and
    /// those that have to stay.
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

    /// A molecule in its own frame with its side chains in these states.
    fn with_states(&self, body: usize, sites: &[Site<'_>], states: &[usize]) -> Molecule {
        let mut molecule = self.bodies[body].molecule.clone();
        let positions = molecule.atoms.iter().map(|atom| atom.position);
        let mut positions: Vec<[f64; 3]> = positions.collect();
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
                .copied()
                .map(within_turn)
                .collect(),
        };
        moved.map(of).collect()
    }
}

/// An angle in radians, from -pi to pi.
fn within_turn(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}
