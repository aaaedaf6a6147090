//! Clashes of a pose, counted.

use knotdock_structures::molecule::Molecule;

use super::energy::REACH;
use super::scene::{cells, minus};

/// Two atoms clash if they are nearer than this share of the sum of their radii: carbons at 3.0 Å, a nitrogen and an
/// oxygen at 2.4 Å.
const CLASH: f64 = 0.8;

/// Pairs of heavy atoms of two placed molecules that clash; `origin` (Å) lies near both.
pub(super) fn clashes(receptor: &Molecule, ligand: &Molecule, origin: [f64; 3]) -> usize {
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
