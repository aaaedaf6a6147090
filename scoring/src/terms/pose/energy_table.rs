//! The atom pair potential in the layout that sums read: the energies of each pair of kinds lie side by side.

use super::atom_pair_potential::{AtomPairPotential, DISTANCES, STEP, atom_kinds};

/// Distance in Å from which energies are 0: one step beyond the last distance of the potential.
pub(super) const REACH: f64 = DISTANCES[DISTANCES.len() - 1] + STEP;
/// Distance in Å from which smooth energies are 0.
pub(super) const SMOOTH_REACH: f64 = REACH + 0.5 * STEP;
/// Energies stored for a pair of kinds: those of the potential, then zeros. They fill half a cache line.
const NODES: usize = 8;

/// Energies by the kinds of two atoms and their distance, joined by straight lines.
///
/// They are constant below the potential's first distance and fall to 0 over one step after the last.
pub(super) struct EnergyTable {
    /// `[receptor kind][ligand kind]`. The last kind in both is that of atoms without a kind, with energies of 0.
    energies: Vec<[f32; NODES]>,
    kinds: usize,
}

impl EnergyTable {
    /// Table of a potential.
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

    /// Index of the kind of atoms without a kind.
    pub fn unknown(&self) -> usize {
        self.kinds - 1
    }

    /// Energy of a receptor atom and a ligand atom in RT, and its derivative by their distance in RT/Å.
    #[inline(always)]
    pub fn at(&self, receptor: usize, ligand: usize, distance: f64) -> (f64, f64) {
        let nodes = &self.energies[receptor * self.kinds + ligand];
        let place = ((distance - DISTANCES[0]) / STEP).clamp(0.0, (NODES - 1) as f64);
        let node = (place as usize).min(NODES - 2);
        let (low, high) = (f64::from(nodes[node]), f64::from(nodes[node + 1]));
        let rise = if place > 0.0 { high - low } else { 0.0 };
        (low + (place - node as f64) * rise, rise / STEP)
    }

    /// As [`Self::at`], averaged over the distances within a quarter of an Ångström: the derivative is continuous.
    ///
    /// The average of straight lines over one step is the quadratic B-spline of their nodes. They end at
    /// [`SMOOTH_REACH`].
    #[inline(always)]
    pub fn smooth(&self, receptor: usize, ligand: usize, distance: f64) -> (f64, f64) {
        let nodes = &self.energies[receptor * self.kinds + ligand];
        let place = ((distance - DISTANCES[0]) / STEP).clamp(-0.5, (NODES - 2) as f64 + 0.5);
        let node = (place + 0.5) as usize;
        let from = place - node as f64;
        let middle = f64::from(nodes[node]);
        let low = f64::from(nodes[node.saturating_sub(1)]);
        let high = f64::from(nodes[(node + 1).min(NODES - 1)]);
        let (fall, rise) = (middle - low, high - middle);
        let (before, after) = (0.5 - from, 0.5 + from);
        (
            middle + 0.5 * (after * after * rise - before * before * fall),
            (before * fall + after * rise) / STEP,
        )
    }
}
