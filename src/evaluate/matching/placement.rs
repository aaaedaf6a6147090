//! A placement: one way in which a docked side lies on the native.

use knotdock_scoring::se3::Pose;

use crate::evaluate::matching::chain_pair::ChainPair;

/// One way in which a side lies on the native.
#[derive(Clone, Debug)]
pub(in crate::evaluate) struct Placement {
    /// Which residues are which, chain by chain. No residue stands in two.
    pub chains: Vec<ChainPair>,
    /// Takes the side from its own frame to the native's.
    pub motion: Pose,
    /// Backbone RMSD in Å of all matched residues after `motion`.
    pub rmsd: f64,
}

impl Placement {
    /// All equal residues: (index of the user's, index of the native's).
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.chains
            .iter()
            .flat_map(|chain| chain.pairs.iter().copied())
    }

    /// Number of equal residues.
    pub fn matched(&self) -> usize {
        self.chains.iter().map(|chain| chain.pairs.len()).sum()
    }

    /// Equal residues as a share, 0 to 1, of all aligned ones.
    pub fn identity(&self) -> f64 {
        let aligned: usize = self.chains.iter().map(|chain| chain.aligned).sum();
        self.matched() as f64 / aligned.max(1) as f64
    }

    /// Indices of the native's segments that have part in it, rising.
    pub fn native_segments(&self) -> Vec<usize> {
        let mut segments: Vec<usize> = self.chains.iter().map(|chain| chain.native).collect();
        segments.sort_unstable();
        segments.dedup();
        segments
    }

    /// Indices of the native's matched residues, rising.
    pub fn natives(&self) -> Vec<usize> {
        let mut natives: Vec<usize> = self.pairs().map(|(_, native)| native).collect();
        natives.sort_unstable();
        natives
    }

    /// All equal residues, rising.
    pub fn sorted_pairs(&self) -> Vec<(usize, usize)> {
        let mut pairs: Vec<_> = self.pairs().collect();
        pairs.sort_unstable();
        pairs
    }
}
