//! Interface and ligand RMSD of a pose, each in a time that does not depend on the number of atoms.

use std::collections::HashSet;

use knotdock_scoring::se3::Pose;

use super::contacts::AcrossPair;
use super::residues::Residues;
use crate::evaluate::matching::superposition::{PointPair, Superposition};

/// The backbone atoms that both residues of a pair have, for each (user's, native's) pair of residues.
pub(super) fn backbone_pairs(
    user: &Residues,
    native: &Residues,
    pairs: impl Iterator<Item = (usize, usize)>,
) -> Vec<PointPair> {
    pairs
        .flat_map(|(i, j)| {
            let (ours, theirs) = (&user.residues[i].backbone, &native.residues[j].backbone);
            ours.iter().zip(theirs).filter_map(|(x, y)| (*x).zip(*y))
        })
        .collect()
}

/// One side of a complex: the user's molecule, the native's, and which residue is which.
#[derive(Clone, Copy)]
pub(super) struct Side<'a> {
    /// The user's molecule as docked.
    pub user: &'a Residues,
    /// The native's.
    pub native: &'a Residues,
    /// (index of the user's residue, index of the native's).
    pub pairs: &'a [(usize, usize)],
}

impl Side<'_> {
    fn superposition(&self, keep: impl Fn(usize) -> bool) -> Superposition {
        let pairs = self
            .pairs
            .iter()
            .copied()
            .filter(|&(_, native)| keep(native));
        Superposition::new(&backbone_pairs(self.user, self.native, pairs))
    }
}

/// The RMSDs of one pose, in Å.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rmsds {
    /// Backbone of the interface residues, superposed.
    pub interface: f64,
    /// Backbone of the smaller group, with the larger superposed.
    pub ligand: f64,
}

/// Data from which the RMSDs of any pose are computed.
#[derive(Clone, Debug)]
pub(super) struct RmsdForms {
    receptor: Superposition,
    ligand: Superposition,
    receptor_interface: Superposition,
    ligand_interface: Superposition,
    ligand_is_smaller: bool,
}

impl RmsdForms {
    /// Prepares for the two sides; `across` are the native's residue pairs within 10 Å.
    ///
    /// The interface is what DockQ 2.1.3 makes it: of the *matched* residues those within 10 Å of a matched one across.
    pub fn new(receptor: Side, ligand: Side, across: &[AcrossPair]) -> Self {
        let matched =
            |side: Side| -> HashSet<usize> { side.pairs.iter().map(|pair| pair.1).collect() };
        let (receptor_matched, ligand_matched) = (matched(receptor), matched(ligand));
        let near: Vec<_> = across
            .iter()
            .filter(|pair| {
                receptor_matched.contains(&pair.receptor) && ligand_matched.contains(&pair.ligand)
            })
            .collect();
        let receptor_near: HashSet<_> = near.iter().map(|pair| pair.receptor).collect();
        let ligand_near: HashSet<_> = near.iter().map(|pair| pair.ligand).collect();
        Self {
            receptor: receptor.superposition(|_| true),
            ligand: ligand.superposition(|_| true),
            receptor_interface: receptor.superposition(|native| receptor_near.contains(&native)),
            ligand_interface: ligand.superposition(|native| ligand_near.contains(&native)),
            ligand_is_smaller: ligand_is_smaller(receptor.native, ligand.native),
        }
    }

    /// Numbers of backbone atoms matched: receptor, ligand.
    pub fn atoms(&self) -> (usize, usize) {
        (self.receptor.count as usize, self.ligand.count as usize)
    }

    /// Numbers of backbone atoms that the interface RMSD is of: receptor, ligand.
    pub fn interface_atoms(&self) -> [usize; 2] {
        [&self.receptor_interface, &self.ligand_interface].map(|side| side.count as usize)
    }

    /// Superposed RMSD of the user's receptor and ligand alone with the native's, in Å: what no rigid docking can
    /// correct.
    pub fn of_the_parts(&self) -> (f64, f64) {
        (
            self.receptor.rmsd(&self.receptor.best),
            self.ligand.rmsd(&self.ligand.best),
        )
    }

    /// The RMSDs with the ligand at `pose`.
    pub fn at(&self, pose: &Pose) -> Rmsds {
        let (_, interface) = self
            .receptor_interface
            .superpose_with(&self.ligand_interface, pose);
        let ligand = if self.ligand_is_smaller {
            self.ligand.rmsd(&self.receptor.best.after(pose))
        } else {
            // Superposing the placed ligand means: back from the pose, then the ligand's own best fit.
            self.receptor.rmsd(&self.ligand.best.after(&pose.inverse()))
        };
        Rmsds {
            interface: finite(interface),
            ligand: finite(ligand),
        }
    }
}

/// Whether DockQ 2.1.3 takes the ligand's group for its ligand: it takes the one of fewer native residues, and of two
/// equal ones the first, which is the receptor.
pub(super) fn ligand_is_smaller(receptor: &Residues, ligand: &Residues) -> bool {
    receptor.residues.len() > ligand.residues.len()
}

/// The largest number in place of one that overflowed (a pose beyond 1e150 Å): no NaN reaches a table.
fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::MAX }
}
