//! Refinement of poses at atomic resolution: the ligand moved as a rigid body, side chains of the interface packed, and its
//! atoms moved apart.
//!
//! For each pose four stages follow one another. Each is kept only if it lowers the energy of the sharp fit
//! ([`knotdock_scoring::sharp`]), so that no pose ends above where it began. None takes the ligand farther from the pose
//! than [`RefineOptions::max_move`]: unbound molecules clash in their place, and the lowest energy is then elsewhere.
//!
//! 1. The rigid optimum near the pose: that of [`SharpFit::best_near`] or, if it is too far, of [`SharpFit::descend`].
//! 2. The side chains of the interface, packed for that place by their own energies ([`crate::side_chains`]).
//! 3. The rigid optimum of the packed molecules. Packing is judged after it, for new side chains need a new place.
//! 4. A restrained minimisation of the interface, which leaves few clashes or none (`minimise.rs`).
//!
//! Lengths are in Å, energies of the sharp fit in RT.

mod minimise;
#[cfg(test)]
mod tests;

use knotdock_scoring::se3::Pose;
use knotdock_scoring::sharp::{Energy, Optimum, PairList, SharpFit};
use knotdock_structures::knots::KnotsError;
use knotdock_structures::molecule::{Atom, Molecule};
use knotdock_structures::{Knots, PolarAtom};
use serde::Serialize;

use self::minimise::{bonds, minimised};
use crate::side_chains::{HeldResidue, RepackOptions, Repacker};
use crate::threads;

/// Options of a refinement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefineOptions {
    /// Whether the ligand may move.
    pub moves: bool,
    /// Farthest that it may move, as the root mean square distance of its atoms, in Å.
    pub max_move: f64,
    /// Whether atoms of the interface move: side chains are packed, then all are minimised.
    pub side_chains: bool,
    /// pH that charges are for.
    pub ph: f64,
}

impl RefineOptions {
    /// Those of the complexes that a run writes.
    pub fn usual(ph: f64) -> Self {
        Self {
            moves: true,
            max_move: 3.0,
            side_chains: true,
            ph,
        }
    }

    /// Those that leave poses as they are, and tell their energy.
    pub fn none(ph: f64) -> Self {
        Self {
            moves: false,
            side_chains: false,
            ..Self::usual(ph)
        }
    }
}

/// Two molecules whose poses are to be refined.
pub struct Refiner<'a> {
    molecules: [&'a Molecule; 2],
    polar: [Vec<PolarAtom>; 2],
    /// Bonded atoms of each atom.
    bonds: [Vec<Vec<usize>>; 2],
    fit: SharpFit,
    repacker: Option<Repacker<'a>>,
    options: RefineOptions,
}

/// A refined pose.
#[derive(Clone, Debug)]
pub struct Refined {
    /// Refined pose of the ligand.
    pub pose: Pose,
    /// Root mean square distance in Å of the ligand's atoms between the old pose and this one, side chains as they were.
    pub rmsd_moved: f64,
    /// Energy of the old pose.
    pub before: Energy,
    /// Energy of the refined one; its total is never above that of `before`.
    pub after: Energy,
    /// Side chains of the interface that had to stay, with the reasons; empty without packing.
    pub held: Vec<HeldResidue>,
    /// Outcome of packing; `None` if there was none.
    pub packing: Option<Packing>,
    /// The atoms of receptor and ligand that moved within their molecule: place in the file, and position in its frame.
    pub moved: [Vec<(usize, [f64; 3])>; 2],
}

impl Refined {
    /// Whether an atom moved within its molecule.
    pub fn has_moved_atoms(&self) -> bool {
        self.moved.iter().any(|moved| !moved.is_empty())
    }

    /// Receptor or ligand (0 or 1) with its moved atoms, in its own frame.
    pub fn molecule(&self, side: usize, original: &Molecule) -> Molecule {
        let mut molecule = original.clone();
        for &(place, position) in &self.moved[side] {
            molecule.atoms[place].position = position;
        }
        molecule
    }
}

/// The atoms of a molecule that are elsewhere in another form of it.
fn moved_atoms(from: &Molecule, to: &Molecule) -> Vec<(usize, [f64; 3])> {
    let pairs = from.atoms.iter().zip(&to.atoms).enumerate();
    let moved = pairs.filter(|(_, (from, to))| from.position != to.position);
    moved.map(|(place, (_, to))| (place, to.position)).collect()
}

/// Outcome of packing the side chains of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Packing {
    /// Side chains that moved; 0 if packing did not lower the energy of the sharp fit and was undone.
    pub moved: usize,
    /// Whether every search was exact ([`crate::side_chains::Repacked::exact`]).
    pub exact: bool,
}

/// A place with its energy.
#[derive(Clone, Copy)]
struct Place {
    pose: Pose,
    energy: Energy,
}

impl<'a> Refiner<'a> {
    /// Prepares receptor and ligand, each in its file's frame.
    pub fn new(molecules: [&'a Molecule; 2], options: RefineOptions) -> Result<Self, KnotsError> {
        let [receptor, ligand] = molecules;
        let repacker = || Repacker::new(receptor, ligand, RepackOptions::default());
        Ok(Self {
            molecules,
            polar: molecules.map(Molecule::polar_atoms),
            bonds: molecules.map(bonds),
            fit: sharp_fit(molecules, options.ph)?,
            repacker: options.side_chains.then(repacker),
            options,
        })
    }

    /// Refines poses side by side.
    pub fn all(&self, poses: &[Pose]) -> Result<Vec<Refined>, KnotsError> {
        let refine = |index: usize, list: &mut PairList| self.refine(&poses[index], list);
        let refined = threads::each(poses.len(), PairList::default, refine);
        refined.into_iter().collect()
    }

    /// Refines a pose. Single-threaded; poses may be refined side by side, each thread with its own list.
    ///
    /// # Errors
    /// [`KnotsError`], which no molecule gives that [`Self::new`] took.
    pub fn refine(&self, pose: &Pose, list: &mut PairList) -> Result<Refined, KnotsError> {
        let start = Place {
            pose: *pose,
            energy: self.fit.energy(pose),
        };
        let mut place = self.settled(&self.fit, start, pose, list);
        let (mut packing, mut molecules, mut held) = (None, None, Vec::new());
        if let Some(repacker) = &self.repacker {
            let found = repacker.repack(&place.pose);
            let mut moved = 0;
            if !found.moved.is_empty() {
                let fit = sharp_fit([&found.receptor, &found.ligand], self.options.ph)?;
                let unmoved = Place {
                    pose: place.pose,
                    energy: fit.energy(&place.pose),
                };
                let after = self.settled(&fit, unmoved, pose, list);
                if after.energy.total() < place.energy.total() {
                    place = after;
                    moved = found.moved.len();
                    molecules = Some([found.receptor, found.ligand]);
                }
            }
            packing = Some(Packing {
                moved,
                exact: found.exact,
            });
            held = found.held;
            let before = molecules
                .as_ref()
                .map_or(self.molecules, |both| both.each_ref());
            let polar = self.polar.each_ref().map(Vec::as_slice);
            let bonds = self.bonds.each_ref().map(Vec::as_slice);
            if let Some(minimised) = minimised(before, polar, bonds, &place.pose) {
                let fit = sharp_fit(minimised.each_ref(), self.options.ph)?;
                let energy = fit.energy(&place.pose);
                if energy.total() < place.energy.total() {
                    place.energy = energy;
                    molecules = Some(minimised);
                }
            }
        }
        let moved =
            molecules.map(|both| [0, 1].map(|side| moved_atoms(self.molecules[side], &both[side])));
        Ok(Refined {
            pose: place.pose,
            rmsd_moved: rmsd_between(self.molecules[1], pose, &place.pose),
            before: start.energy,
            after: place.energy,
            held,
            packing,
            moved: moved.unwrap_or_default(),
        })
    }

    /// The rigid optimum near a place; the place itself if none is lower and near enough to the pose that is refined.
    fn settled(&self, fit: &SharpFit, from: Place, pose: &Pose, list: &mut PairList) -> Place {
        if !self.options.moves {
            return from;
        }
        let ligand = self.molecules[1];
        let is_better = |found: &Optimum| {
            found.energy.total() < from.energy.total()
                && rmsd_between(ligand, pose, &found.pose) <= self.options.max_move
        };
        let best = fit.best_near(&from.pose, list).filter(is_better);
        let best = best.or_else(|| fit.descend(&from.pose, list).filter(is_better));
        best.map_or(from, |Optimum { pose, energy }| Place { pose, energy })
    }
}

/// Pairs of heavy atoms of two molecules in place that overlap by more than 0.5 Å.
pub fn clashes(molecules: [&Molecule; 2], ph: f64) -> Result<usize, KnotsError> {
    Ok(sharp_fit(molecules, ph)?.energy(&Pose::identity()).clashes)
}

/// The sharp fit of two molecules with charges at a pH.
fn sharp_fit(molecules: [&Molecule; 2], ph: f64) -> Result<SharpFit, KnotsError> {
    let charged = |molecule: &Molecule| -> Result<Knots, KnotsError> {
        let charges = molecule.labels(ph).charges;
        molecule.knots()?.with_labels(charges, Vec::new())
    };
    let [receptor, ligand] = molecules;
    let polar = molecules.map(Molecule::polar_atoms);
    let [polar_receptor, polar_ligand] = &polar;
    Ok(SharpFit::new(
        [&charged(receptor)?, &charged(ligand)?],
        [polar_receptor, polar_ligand],
    ))
}

/// Root mean square distance in Å of a molecule's atoms between two poses; 0 without atoms.
fn rmsd_between(molecule: &Molecule, one: &Pose, other: &Pose) -> f64 {
    let atoms = &molecule.atoms;
    let square = |atom: &Atom| -> f64 {
        let (a, b) = (one.apply(atom.position), other.apply(atom.position));
        a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
    };
    let squares: f64 = atoms.iter().map(square).sum();
    (squares / atoms.len().max(1) as f64).sqrt()
}
