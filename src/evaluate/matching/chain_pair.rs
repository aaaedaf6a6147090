//! Alignments of every chain of the docked molecule with every chain of the native.
//!
//! Sequences alone do not say which of several copies a chain is; that is for
//! [`placements`](crate::evaluate::matching::placements).

use knotdock_scoring::se3::Pose;
use nalgebra::Point3;

use crate::evaluate::matching::alignment::{align, settle};
use crate::evaluate::residues::Residues;

/// Residues of a docked chain matched with those of a chain of the native.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::evaluate) struct ChainPair {
    /// Index of the docked segment.
    pub user: usize,
    /// Index of the native's segment.
    pub native: usize,
    /// Equal residues: (index of the docked residue, index of the native's).
    pub pairs: Vec<(usize, usize)>,
    /// Aligned places, equal or not.
    pub aligned: usize,
    /// Number of residues to align, of the docked chain and of the native's.
    pub lengths: (usize, usize),
}

/// Chains are one another's when at least this share of the shorter is equal.
const MIN_IDENTITY: f64 = 0.5;
/// Chains are copies of one another when this share of the shorter is equal: room for a few mutations and unlike ends.
const IDENTICAL: f64 = 0.9;

impl ChainPair {
    /// Whether the sequences allow that the two are the same chain.
    pub fn is_alike(&self) -> bool {
        self.shares(MIN_IDENTITY)
    }

    /// Whether the two are copies of one chain.
    pub fn is_identical(&self) -> bool {
        self.shares(IDENTICAL)
    }

    fn shares(&self, least: f64) -> bool {
        let (ours, theirs) = self.lengths;
        !self.pairs.is_empty() && self.pairs.len() as f64 >= least * ours.min(theirs) as f64
    }

    /// Names of the docked chain and of the native's.
    pub fn names<'a>(&self, user: &'a Residues, native: &'a Residues) -> (&'a str, &'a str) {
        let (user, native) = (&user.segments[self.user], &native.segments[self.native]);
        (&user.name, &native.name)
    }

    /// Moves gaps that the sequences leave open to where residues are nearest each other after `motion`; whether any moved.
    pub fn settle(&mut self, user: &Residues, native: &Residues, motion: &Pose) -> bool {
        let (ours, theirs) = (
            &user.segments[self.user].members,
            &native.segments[self.native].members,
        );
        let [Some(&first), Some(&other)] = [ours.first(), theirs.first()] else {
            return false;
        };
        // Members of a segment are consecutive.
        let mut pairs: Vec<(usize, usize)> = self
            .pairs
            .iter()
            .map(|&(i, j)| (i - first, j - other))
            .collect();
        let rises = pairs.windows(2).all(|pair| pair[0].1 < pair[1].1);
        let moved = |point: Point3<f64>| Point3::from(motion.apply(point.into()));
        let any = rises && settle(&user.at(ours), &native.at(theirs), &mut pairs, moved);
        if any {
            self.pairs = pairs
                .into_iter()
                .map(|(i, j)| (i + first, j + other))
                .collect();
        }
        any
    }
}

/// Aligns some residues of one docked segment with some of the native's, each given with the segment's index.
pub(in crate::evaluate) fn align_members(
    docked: &Residues,
    complex: &Residues,
    (user, ours): (usize, &[usize]),
    (native, theirs): (usize, &[usize]),
) -> ChainPair {
    let found = align(&docked.at(ours), &complex.at(theirs));
    let pairs = found.pairs.iter().map(|&(i, j)| (ours[i], theirs[j]));
    ChainPair {
        user,
        native,
        pairs: pairs.collect(),
        aligned: found.aligned,
        lengths: (ours.len(), theirs.len()),
    }
}
