//! Agreement of the models of one system: clusters by their contacts, and the residues that most of them touch.
//!
//! Two interfaces agree by the share 2 |A and B| / (|A| + |B|) of their contacts (pairs of residues with heavy atoms within
//! 5 Å) that they have in common, from 0 to 1. Of two equal chains, either may be the first. Clusters are made as those of
//! contacts in HADDOCK (Rodrigues et al., Proteins 80 (2012) 1810-1817): the model with most neighbours and these are
//! the first, and so on with the rest. Neighbours have at least [`SAME_INTERFACE`] in common.

use std::collections::{BTreeMap, BTreeSet};

use super::{ChainPair, PredictedModel};
use crate::interface::ResidueName;

/// Least agreement of neighbours.
pub const SAME_INTERFACE: f64 = 0.5;
/// Least share of the models that touch a residue of the consensus.
pub const CONSENSUS_SHARE: f64 = 0.5;

/// A pair of chains in all models that have it.
#[derive(Clone, Debug)]
pub struct System {
    /// The models: places in the list of models and of the pair in its model.
    pub members: Vec<[usize; 2]>,
    /// Of each member, its mean agreement with the others, 0 to 1; `None` if it is the only one.
    pub agreement: Vec<Option<f64>>,
    /// Of each member, the number of its cluster, from 1 for the largest.
    pub clusters: Vec<usize>,
    /// Residues that at least [`CONSENSUS_SHARE`] of the models touch, with the share, under the names of the first
    /// member: those of chain 1, then those of chain 2.
    pub consensus: Vec<(ResidueName, f64)>,
}

/// A residue by its number and name.
type Site<'a> = (&'a str, &'a str);

/// The pairs of residues in contact.
type Contacts<'a> = BTreeSet<[Site<'a>; 2]>;

fn contacts(pair: &ChainPair) -> Contacts<'_> {
    let pairs = pair.interface.pairs.iter();
    pairs
        .map(|contact| contact.residues.each_ref().map(site))
        .collect()
}

fn site(residue: &ResidueName) -> Site<'_> {
    (&residue.number, &residue.name)
}

/// The share of contacts in common; none for two interfaces without contacts.
fn shared(one: &Contacts, other: &Contacts) -> f64 {
    let both = one.intersection(other).count();
    match one.len() + other.len() {
        0 => 0.0,
        all => 2.0 * both as f64 / all as f64,
    }
}

/// The systems of some models: pairs of chains with the same sequences at the same places in their files.
pub fn systems(models: &[PredictedModel]) -> Vec<System> {
    let mut places: BTreeMap<(usize, &[String; 2]), Vec<[usize; 2]>> = BTreeMap::new();
    for (at, model) in models.iter().enumerate() {
        for (number, pair) in model.pairs.iter().enumerate() {
            places
                .entry((number, &pair.sequences))
                .or_default()
                .push([at, number]);
        }
    }
    let pair = |[model, pair]: [usize; 2]| &models[model].pairs[pair];
    let of =
        |members: Vec<[usize; 2]>| system(members.iter().map(|&at| pair(at)).collect(), members);
    places.into_values().map(of).collect()
}

fn system(pairs: Vec<&ChainPair>, members: Vec<[usize; 2]>) -> System {
    let is_symmetric = pairs
        .iter()
        .any(|pair| pair.sequences[0] == pair.sequences[1]);
    let all: Vec<Contacts> = pairs.iter().map(|pair| contacts(pair)).collect();
    let swapped = |contacts: &Contacts<'_>| -> Vec<[String; 4]> {
        let turned = contacts
            .iter()
            .map(|[(a, b), (c, d)]| [c, d, a, b].map(|&text| text.to_owned()));
        turned.collect()
    };
    let count = members.len();
    let mut agreements = vec![vec![1.0; count]; count];
    for i in 0..count {
        let swapped = if is_symmetric {
            swapped(&all[i])
        } else {
            Vec::new()
        };
        let turned: Contacts = swapped
            .iter()
            .map(|[a, b, c, d]| [(a.as_str(), b.as_str()), (c.as_str(), d.as_str())])
            .collect();
        for j in 0..i {
            let value = shared(&all[i], &all[j]);
            let value = if is_symmetric {
                value.max(shared(&turned, &all[j]))
            } else {
                value
            };
            (agreements[i][j], agreements[j][i]) = (value, value);
        }
    }
    let others = |row: &Vec<f64>| {
        let sum: f64 = row.iter().sum();
        (count > 1).then(|| (sum - 1.0) / (count - 1) as f64)
    };
    System {
        agreement: agreements.iter().map(others).collect(),
        clusters: clusters(&agreements),
        consensus: consensus(&pairs, is_symmetric),
        members,
    }
}

/// The cluster of each, from 1, by the agreements of all with all.
fn clusters(agreements: &[Vec<f64>]) -> Vec<usize> {
    let mut clusters = vec![0; agreements.len()];
    let mut number = 0;
    while clusters.contains(&0) {
        number += 1;
        let neighbours = |center: usize| -> Vec<usize> {
            let free = (0..clusters.len()).filter(|&at| clusters[at] == 0);
            free.filter(|&at| at == center || agreements[center][at] >= SAME_INTERFACE)
                .collect()
        };
        let free = (0..clusters.len()).filter(|&at| clusters[at] == 0);
        // The first of those with most neighbours.
        let largest = free
            .map(neighbours)
            .reduce(|best, next| if next.len() > best.len() { next } else { best });
        for at in largest.unwrap_or_default() {
            clusters[at] = number;
        }
    }
    clusters
}

/// The residues that many models touch. Of two equal chains, a residue counts on either.
fn consensus(pairs: &[&ChainPair], is_symmetric: bool) -> Vec<(ResidueName, f64)> {
    let Some(first) = pairs.first() else {
        return Vec::new();
    };
    let mut touched: BTreeMap<(usize, i64, Site), usize> = BTreeMap::new();
    for pair in pairs {
        let contacts = pair.interface.pairs.iter().flat_map(|contact| {
            let sides = contact.residues.iter().enumerate();
            sides.map(|(side, residue)| (if is_symmetric { 0 } else { side }, residue))
        });
        let digits = |residue: &ResidueName| {
            let number = residue
                .number
                .trim_end_matches(|c: char| !c.is_ascii_digit());
            number.parse().unwrap_or(i64::MAX)
        };
        let residues: BTreeSet<(usize, i64, Site)> = contacts
            .map(|(side, residue)| (side, digits(residue), site(residue)))
            .collect();
        for residue in residues {
            *touched.entry(residue).or_default() += 1;
        }
    }
    let residues = touched
        .into_iter()
        .map(|((side, _, (number, name)), count)| {
            let residue = ResidueName {
                chain: first.chains[side].clone(),
                number: number.to_owned(),
                name: name.to_owned(),
            };
            (residue, count as f64 / pairs.len() as f64)
        });
    residues
        .filter(|(_, share)| *share >= CONSENSUS_SHARE)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::{Contact, Interface};
    use crate::models::scores::PairScores;

    /// A model whose chains touch by some residues.
    fn model(contacts: &[[i32; 2]], sequences: [&str; 2]) -> PredictedModel {
        let name = |chain: &str, number: i32| ResidueName {
            chain: chain.to_owned(),
            number: number.to_string(),
            name: "ALA".to_owned(),
        };
        let contact = |&[a, b]: &[i32; 2]| Contact {
            residues: [name("A", a), name("B", b)],
            distance: 4.0,
            hydrogen_bonds: 0,
            hydrogen_bond_distance: None,
            salt_bridge: false,
        };
        let interface = Interface {
            pairs: contacts.iter().map(contact).collect(),
            residues: [0, 0],
            hydrogen_bonds: 0,
            salt_bridges: 0,
            clashes: 0,
            buried: [0.0; 2],
            shape_complementarity: None,
        };
        PredictedModel {
            path: "x.pdb".into(),
            program: None,
            confidence_files: Vec::new(),
            iptm: None,
            ptm: None,
            ranking_score: None,
            plddt: None,
            pairs: vec![ChainPair {
                chains: ["A".to_owned(), "B".to_owned()],
                sequences: sequences.map(str::to_owned),
                iptm: None,
                scores: PairScores::default(),
                interface,
            }],
        }
    }

    /// Three models share half of their contacts or more, one has others, one none.
    #[test]
    fn models_with_common_contacts_are_a_cluster() {
        let chains = ["ALAGLY", "SER"];
        let models = [
            model(&[[8, 1], [9, 2]], chains),
            model(&[[1, 1], [2, 2], [3, 3], [4, 4]], chains),
            model(&[[1, 1], [2, 2], [3, 3], [10, 4]], chains),
            model(&[[1, 1], [2, 2], [5, 5], [6, 6]], chains),
            model(&[], chains),
            model(&[[1, 1]], ["SER", "SER"]),
        ];
        let found = systems(&models);
        assert_eq!(found.len(), 2);
        let [system, single] = found.as_slice() else {
            panic!()
        };
        assert_eq!(system.members, [[0, 0], [1, 0], [2, 0], [3, 0], [4, 0]]);
        assert_eq!(system.clusters, [2, 1, 1, 1, 3]);
        let agreement = |value: f64| Some(value / 4.0);
        assert_eq!(system.agreement[0], agreement(0.0));
        assert_eq!(system.agreement[1], agreement(0.75 + 0.5));
        let names = system
            .consensus
            .iter()
            .map(|(residue, share)| format!("{}{} {share}", residue.chain, residue.number));
        let expected = ["A1 0.6", "A2 0.6", "B1 0.8", "B2 0.8"];
        assert_eq!(names.collect::<Vec<_>>(), expected);
        assert_eq!((single.agreement[0], single.clusters[0]), (None, 1));
    }

    /// A dimer of equal chains has no first chain.
    #[test]
    fn equal_chains_may_be_exchanged() {
        let models = [
            model(&[[1, 10], [2, 20]], ["ALA", "ALA"]),
            model(&[[10, 1], [20, 2]], ["ALA", "ALA"]),
        ];
        let found = systems(&models);
        assert_eq!(found[0].agreement, [Some(1.0); 2]);
        assert_eq!(found[0].consensus.len(), 4);
        let numbers: Vec<&str> = found[0]
            .consensus
            .iter()
            .map(|(one, _)| one.number.as_str())
            .collect();
        assert_eq!(numbers, ["1", "2", "10", "20"]);
    }
}
