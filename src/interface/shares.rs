//! Consensus interface: where on either molecule the best clusters gather.

use super::{Contact, ContactFinder, ResidueName};
use serde::Serialize;

/// Clusters that are counted, the best ones.
pub const CONSENSUS: usize = 50;

/// A residue, and how many of the best clusters touch it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResidueShare {
    /// The residue.
    pub residue: ResidueName,
    /// Clusters whose best pose has it in contact.
    pub clusters: usize,
    /// The same as a share of all that were counted.
    pub share: f64,
}

/// The share of some clusters that touch each residue of either side. `clusters` are the contacts of the best pose of
/// each. Residues stand in the order of their files; those that no cluster touches are among them.
pub fn residue_shares(finder: &ContactFinder, clusters: &[&[Contact]]) -> [Vec<ResidueShare>; 2] {
    let sides = finder.residues();
    let mut counts = sides.map(|residues| vec![0_usize; residues.len()]);
    for contacts in clusters {
        for (side, counts) in counts.iter_mut().enumerate() {
            let mut touched: Vec<usize> = contacts
                .iter()
                .map(|contact| contact.residues[side])
                .collect();
            touched.sort_unstable();
            touched.dedup();
            for residue in touched {
                counts[residue] += 1;
            }
        }
    }
    std::array::from_fn(|side| {
        let residues = sides[side].iter().zip(&counts[side]);
        let share = |(residue, &clusters_of): (&ResidueName, &usize)| ResidueShare {
            residue: residue.clone(),
            clusters: clusters_of,
            share: match clusters.len() {
                0 => 0.0,
                all => clusters_of as f64 / all as f64,
            },
        };
        residues.map(share).collect()
    })
}
