//! Alignments of every chain of the docked molecule with every chain of the native.
//!
//! Sequences alone do not say which of several copies a chain is; that is for
//! [`placements`](crate::evaluate::matching::placements).

use std::collections::HashMap;

use knotdock_scoring::se3::Pose;
use nalgebra::Point3;

use crate::evaluate::matching::alignment::{Alignment, align, settle};
use crate::evaluate::residues::residue::Number;
use crate::evaluate::residues::segments::{Step, step};
use crate::evaluate::residues::{Residues, Segment};

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

    /// Moves gaps that the sequences leave open to where residues lie nearest each other after `motion`; whether any moved.
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

    fn of(
        (user, ours): (usize, &[usize]),
        (native, theirs): (usize, &[usize]),
        found: &Alignment,
    ) -> Self {
        let pairs = found.pairs.iter().map(|&(i, j)| (ours[i], theirs[j]));
        Self {
            user,
            native,
            pairs: pairs.collect(),
            aligned: found.aligned,
            lengths: (ours.len(), theirs.len()),
        }
    }
}

/// Aligns some residues of one docked segment with some of the native's, each given with the segment's index.
pub(in crate::evaluate) fn align_members(
    user: &Residues,
    native: &Residues,
    ours: (usize, &[usize]),
    theirs: (usize, &[usize]),
) -> ChainPair {
    let found = align(&user.at(ours.1), &native.at(theirs.1));
    ChainPair::of(ours, theirs, &found)
}

/// Every docked segment aligned with every one of the native's, rows by the docked one.
///
/// Copies are aligned once: chains of the same residues and numbers have the same alignment.
pub(in crate::evaluate) fn align_all(user: &Residues, native: &Residues) -> Vec<ChainPair> {
    let (our_kinds, their_kinds) = (kinds(user), kinds(native));
    let mut known: HashMap<(&Kind, &Kind), Alignment> = HashMap::new();
    let mut all = Vec::with_capacity(our_kinds.len() * their_kinds.len());
    for (u, our_kind) in our_kinds.iter().enumerate() {
        for (n, their_kind) in their_kinds.iter().enumerate() {
            let (ours, theirs) = (&user.segments[u].members, &native.segments[n].members);
            let found = known
                .entry((our_kind, their_kind))
                .or_insert_with(|| align(&user.at(ours), &native.at(theirs)));
            all.push(ChainPair::of((u, ours), (n, theirs), found));
        }
    }
    all
}

/// Key of a chain's alignment: each residue's name and number, and the link to the next one.
type Kind<'a> = Vec<(&'a str, Number, Option<Step>)>;

fn kinds(residues: &Residues) -> Vec<Kind<'_>> {
    let of_segment = |segment: &Segment| {
        let members = residues.at(&segment.members).into_iter();
        let following = members.clone().skip(1).map(Some).chain([None]);
        let kinds = members.zip(following).map(|(residue, next)| {
            let step = next.map(|next| step(residue, next));
            (residue.kind.as_str(), residue.number, step)
        });
        kinds.collect()
    };
    residues.segments.iter().map(of_segment).collect()
}
