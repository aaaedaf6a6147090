//! The atom pair potential as sums read it: energies of every pair of kinds side by side, joined by straight lines.

use super::pair_potential::{AtomPairPotential, DISTANCES, STEP, atom_kinds};

/// Distance in Å from which nothing counts: a step beyond the last that the potential has.
pub(super) const REACH: f64 = DISTANCES[DISTANCES.len() - 1] + STEP;
/// Energies of a pair of kinds in memory, one half of a cache line: those of the potential, then zeros.
const NODES: usize = 8;

/// Energies by the kinds of two atoms and their distance: before the first of the potential's distances the first, and from the last one falling to 0 over one step.
pub(super) struct EnergyTable {
    /// `[receptor kind][ligand kind]`, and last in both those of atoms without a kind, which are 0.
    energies: Vec<[f32; NODES]>,
    kinds: usize,
}

impl EnergyTable {
    pub fn new(potential: &AtomPairPotential) -> Self {
        let kinds = atom_kinds().len() + 1;
        let mut energies = vec![[0.0; NODES]; kinds * kinds];
        for a in 0..kinds - 1 {
            for b in 0..kinds - 1 {
                energies[a * kinds + b][..DISTANCES.len()]
                    .copy_from_slice(potential.energies(a, b));
            }
        }
        Self { energies, kinds }
    }

    /// The kind of atoms without one.
    pub fn unknown(&self) -> usize {
        self.kinds - 1
    }

    /// Energy of a receptor's and a ligand's atom by their kinds and distance in Å, in RT, and its derivative by the distance.
    #[inline(always)]
    pub fn at(&self, receptor: usize, ligand: usize, distance: f64) -> (f64, f64) {
        let nodes = &self.energies[receptor * self.kinds + ligand];
        let place = ((distance - DISTANCES[0]) / STEP).clamp(0.0, (NODES - 1) as f64);
        let node = (place as usize).min(NODES - 2);
        let (low, high) = (f64::from(nodes[node]), f64::from(nodes[node + 1]));
        let rise = if place > 0.0 { high - low } else { 0.0 };
        (low + (place - node as f64) * rise, rise / STEP)
    }
}
