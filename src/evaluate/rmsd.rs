//! Interface and ligand RMSD of a pose, each in a time that does not depend on the number of atoms.

use std::collections::HashSet;

use knotdock_scoring::se3::Pose;

use super::contacts::AcrossPair;
use super::residues::Residues;
use crate::evaluate::matching::superposition::{PointPair, Superposition};

/// The backbone atoms that both residues of a pair have, for each (user's, native's) pair of residues.
pub(super) fn backbone_pairs<'a>(
    user: &Residues,
    native: &Residues,
    pairs: impl IntoIterator<Item = &'a (usize, usize)>,
) -> Vec<PointPair> {
    let atoms = pairs.into_iter().flat_map(|&(i, j)| {
        let (ours, theirs) = (&user.residues[i].backbone, &native.residues[j].backbone);
        ours.iter().zip(theirs).filter_map(|(x, y)| (*x).zip(*y))
    });
    atoms.collect()
}

/// One side of a complex: the user's molecule, the native's, and which residue is which.
#[derive(Clone, Copy)]
pub(super) struct Side<'a> {
    /// The user's molecule as docked.
    pub user: &'a Residues,
    /// The native's.
    pub native: &'a Residues,
    /// (index of the docked residue, index of the native's).
    pub pairs: &'a [(usize, usize)],
}

impl Side<'_> {
    fn superposition(&self, keep: impl Fn(usize) -> bool) -> Superposition {
        let pairs = self.pairs.iter().filter(|&&(_, native)| keep(native));
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
    /// All matched backbone atoms of receptor and ligand.
    whole: [Superposition; 2],
    /// Those of their interface residues.
    interface: [Superposition; 2],
    ligand_is_smaller: bool,
}

impl RmsdForms {
    /// Prepares receptor and ligand; `across` are the native's residue pairs within 10 Å.
    ///
    /// The interface is that of DockQ 2.1.3: the *matched* residues within 10 Å of a matched one across.
    pub fn new(sides: [Side; 2], across: &[AcrossPair]) -> Self {
        let matched: [HashSet<usize>; 2] =
            sides.map(|side| side.pairs.iter().map(|pair| pair.1).collect());
        let pairs = across.iter().map(|pair| pair.residues);
        let near: Vec<[usize; 2]> = pairs
            .filter(|pair| (0..2).all(|side| matched[side].contains(&pair[side])))
            .collect();
        Self {
            whole: sides.map(|side| side.superposition(|_| true)),
            interface: std::array::from_fn(|side| {
                let near: HashSet<usize> = near.iter().map(|pair| pair[side]).collect();
                sides[side].superposition(|native| near.contains(&native))
            }),
            ligand_is_smaller: ligand_is_smaller(sides[0].native, sides[1].native),
        }
    }

    /// Numbers of backbone atoms matched: receptor, ligand.
    pub fn atoms(&self) -> [usize; 2] {
        self.whole.each_ref().map(|side| side.count as usize)
    }

    /// Numbers of backbone atoms that the interface RMSD is of: receptor, ligand.
    pub fn interface_atoms(&self) -> [usize; 2] {
        self.interface.each_ref().map(|side| side.count as usize)
    }

    /// RMSD of the docked receptor and ligand, each superposed on the native's, in Å: no rigid docking can correct it.
    pub fn of_the_parts(&self) -> [f64; 2] {
        self.whole.each_ref().map(|side| side.rmsd(&side.best))
    }

    /// The motion of the native that superposes its receptor on the docked one.
    pub fn to_receptor(&self) -> Pose {
        self.whole[0].best.inverse()
    }

    /// The RMSDs with the ligand at `pose`.
    pub fn at(&self, pose: &Pose) -> Rmsds {
        let [receptor, ligand] = &self.whole;
        let (_, interface) = self.interface[0].superpose_with(&self.interface[1], pose);
        let ligand = if self.ligand_is_smaller {
            ligand.rmsd(&receptor.best.after(pose))
        } else {
            // Superposing the placed ligand means: back from the pose, then the ligand's own best fit.
            receptor.rmsd(&ligand.best.after(&pose.inverse()))
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
