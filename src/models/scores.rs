//! Scores of a pair of chains that a program's confidence gives.
//!
//! Definitions are those of the authors' papers, in the form of Dunbrack's program `ipsae.py`
//! (<https://github.com/DunbrackLab/IPSAE>, version 3), with which the values agree. Only amino acids and nucleotides
//! count, each by one token.
//!
//! # Conventions
//!
//! - PAE_ij is the error of residue j with residue i aligned, in Å. Scores of two values have one per direction.
//! - A contact is a pair of residues with CB within 8 Å (CA of glycine, C3' of a nucleotide).

use serde::Serialize;

use super::confidence::Pae;
use super::tokens::{PolymerChain, Residue};

/// Largest distance between CB atoms of residues in contact, in Å.
pub const BETA_CONTACT: f64 = 8.0;
/// PAE in Å up to which pairs of residues count for LIS.
pub const LIS_CUTOFF: f32 = 12.0;
/// Default PAE in Å below which pairs of residues count for ipSAE.
pub const IPSAE_CUTOFF: f64 = 10.0;

/// Scores of a pair of chains by confidence, from 0 to 1 but for PAE and pLDDT.
///
/// Those of two values have one for each direction: chain 1 aligned, then chain 2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PairScores {
    /// ipSAE (Dunbrack, bioRxiv 2025.02.10.637595); needs PAE.
    ///
    /// For each residue i of the aligned chain, the mean of 1 / (1 + (PAE_ij / d0)²) over residues j of the other with a
    /// PAE below the cut-off; the largest of these means. d0 is that of the TM-score for the number of those residues j,
    /// at least 27.
    pub ipsae: Option<[f64; 2]>,
    /// pDockQ (Bryant et al., Nat. Commun. 13 (2022) 1265); needs pLDDT.
    ///
    /// 0.724 / (1 + exp(-0.052 (x - 152.611))) + 0.018 with x = mean pLDDT of residues in contact times log10 of the
    /// contacts; 0 without contacts.
    pub pdockq: Option<f64>,
    /// pDockQ2 (Zhu et al., Bioinformatics 39 (2023) btad424); needs PAE and pLDDT.
    ///
    /// 1.31 / (1 + exp(-0.075 (x - 84.733))) + 0.005 with x = mean pLDDT of residues in contact times the mean of
    /// 1 / (1 + (PAE / 10)²) over contacts; 0 without contacts.
    pub pdockq2: Option<[f64; 2]>,
    /// LIS (Kim et al., bioRxiv 2024.02.19.580970); needs PAE.
    ///
    /// Mean of (12 - PAE) / 12 over pairs of residues with a PAE of at most 12 Å.
    pub lis: Option<[f64; 2]>,
    /// Mean PAE of residues in contact in both directions, in Å; `None` without contacts.
    pub interface_pae: Option<f64>,
    /// Mean pLDDT of residues in contact, 0 to 100; `None` without contacts.
    pub interface_plddt: Option<f64>,
}

impl PairScores {
    /// The scores of two chains. `cutoff` is the PAE in Å below which pairs count for ipSAE.
    ///
    /// Time is proportional to the product of the numbers of residues.
    pub fn of(chains: [&PolymerChain; 2], pae: Option<&Pae>, cutoff: f64) -> Self {
        let sides = chains.map(|chain| chain.residues.as_slice());
        let contacts = beta_contacts(sides);
        let plddt = interface_plddt(sides, &contacts);
        let is_nucleic = chains.iter().any(|chain| chain.is_nucleic);
        let directions = [sides, [sides[1], sides[0]]];
        let errors = pae.map(|pae| {
            let tokens = contacts
                .iter()
                .map(|&[i, j]| [sides[0][i].token, sides[1][j].token]);
            let forth: Vec<f64> = tokens.clone().map(|[i, j]| error(pae, i, j)).collect();
            let back: Vec<f64> = tokens.map(|[i, j]| error(pae, j, i)).collect();
            [forth, back]
        });
        let known = plddt.zip(errors.as_ref());
        Self {
            ipsae: pae.map(|pae| directions.map(|sides| ipsae(pae, sides, cutoff, is_nucleic))),
            pdockq: plddt.map(|plddt| pdockq(plddt, contacts.len())),
            pdockq2: known.map(|(plddt, both)| both.each_ref().map(|one| pdockq2(plddt, one))),
            lis: pae.map(|pae| directions.map(|sides| lis(pae, sides))),
            interface_pae: errors.and_then(|both| mean(both.iter().flatten().copied())),
            interface_plddt: plddt.filter(|_| !contacts.is_empty()),
        }
    }
}

/// PAE of a token with another one aligned, in Å.
fn error(pae: &Pae, aligned: usize, scored: usize) -> f64 {
    let value = pae.row(aligned).get(scored);
    value.map_or(f64::INFINITY, |&value| f64::from(value))
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

/// Pairs of residues with CB within [`BETA_CONTACT`], by their places in both chains.
fn beta_contacts([first, second]: [&[Residue]; 2]) -> Vec<[usize; 2]> {
    let mut contacts = Vec::new();
    for (i, one) in first.iter().enumerate() {
        for (j, other) in second.iter().enumerate() {
            let along = one.position.iter().zip(&other.position);
            let square: f64 = along.map(|(a, b)| (a - b) * (a - b)).sum();
            if square <= BETA_CONTACT * BETA_CONTACT {
                contacts.push([i, j]);
            }
        }
    }
    contacts
}

/// Mean pLDDT of residues in contact, 0 without any; `None` if it is not known.
fn interface_plddt(sides: [&[Residue]; 2], contacts: &[[usize; 2]]) -> Option<f64> {
    let is_known = sides
        .iter()
        .all(|side| side.iter().all(|one| one.plddt.is_some()));
    let touching = [0, 1].into_iter().flat_map(|side| {
        let mut places: Vec<usize> = contacts.iter().map(|pair| pair[side]).collect();
        places.sort_unstable();
        places.dedup();
        places
            .into_iter()
            .filter_map(move |at| sides[side][at].plddt)
    });
    let mean = mean(touching).unwrap_or(0.0);
    is_known.then_some(mean)
}

/// d0 of the TM-score in Å, for a number of residues (Yang & Skolnick, Proteins 57 (2004) 702-710).
fn d0(residues: usize, is_nucleic: bool) -> f64 {
    let least = if is_nucleic { 2.0 } else { 1.0 };
    (1.24 * (residues.max(27) as f64 - 15.0).cbrt() - 1.8).max(least)
}

/// The share 1 / (1 + (error / d0)²).
fn closeness(error: f64, d0: f64) -> f64 {
    1.0 / (1.0 + (error / d0).powi(2))
}

fn ipsae(pae: &Pae, [aligned, scored]: [&[Residue]; 2], cutoff: f64, is_nucleic: bool) -> f64 {
    let of_residue = |one: &Residue| {
        let errors = || {
            let all = scored
                .iter()
                .map(|other| error(pae, one.token, other.token));
            all.filter(|&error| error < cutoff)
        };
        let d0 = d0(errors().count(), is_nucleic);
        mean(errors().map(|error| closeness(error, d0))).unwrap_or(0.0)
    };
    aligned.iter().map(of_residue).fold(0.0, f64::max)
}

fn lis(pae: &Pae, [aligned, scored]: [&[Residue]; 2]) -> f64 {
    let errors = aligned.iter().flat_map(|one| {
        let all = scored
            .iter()
            .map(|other| error(pae, one.token, other.token));
        all.filter(|&error| error <= f64::from(LIS_CUTOFF))
    });
    let cutoff = f64::from(LIS_CUTOFF);
    mean(errors.map(|error| (cutoff - error) / cutoff)).unwrap_or(0.0)
}

fn pdockq(plddt: f64, contacts: usize) -> f64 {
    match contacts {
        0 => 0.0,
        contacts => {
            let x = plddt * (contacts as f64).log10();
            0.724 / (1.0 + (-0.052 * (x - 152.611)).exp()) + 0.018
        }
    }
}

fn pdockq2(plddt: f64, errors: &[f64]) -> f64 {
    match mean(errors.iter().map(|&error| closeness(error, 10.0))) {
        None => 0.0,
        Some(mean) => 1.31 / (1.0 + (-0.075 * (plddt * mean - 84.733)).exp()) + 0.005,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight chain along x at a height, with a residue every 4 Å.
    fn chain(
        name: &str,
        first_token: usize,
        residues: usize,
        height: f64,
        plddt: f64,
    ) -> PolymerChain {
        let residue = |at: usize| Residue {
            number: at.to_string(),
            token: first_token + at,
            position: [4.0 * at as f64, height, 0.0],
            plddt: Some(plddt),
        };
        PolymerChain {
            name: name.to_owned(),
            place: 0,
            residues: (0..residues).map(residue).collect(),
            sequence: String::new(),
            is_nucleic: false,
        }
    }

    /// A PAE that is constant in each of the four blocks of two chains.
    fn blocks(sizes: [usize; 2], errors: [[f32; 2]; 2]) -> Pae {
        let tokens = sizes[0] + sizes[1];
        let side = |token: usize| usize::from(token >= sizes[0]);
        let places = (0..tokens).flat_map(|i| (0..tokens).map(move |j| (i, j)));
        Pae {
            tokens,
            values: places.map(|(i, j)| errors[side(i)][side(j)]).collect(),
        }
    }

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }

    /// With a constant error all are closed forms, in each direction with its own error and number of residues.
    #[test]
    fn constant_errors_give_closed_forms() {
        let (a, b) = (chain("A", 0, 60, 0.0, 80.0), chain("B", 60, 30, 7.0, 60.0));
        let pae = blocks([60, 30], [[1.0, 4.0], [6.0, 1.0]]);
        let found = PairScores::of([&a, &b], Some(&pae), 10.0);
        let d0 = |count: f64| 1.24 * (count - 15.0).cbrt() - 1.8;
        let closeness = |error: f64, d0: f64| 1.0 / (1.0 + (error / d0) * (error / d0));
        let [forth, back] = found.ipsae.unwrap();
        near(forth, closeness(4.0, d0(30.0)));
        near(back, closeness(6.0, d0(60.0)));
        near(found.lis.unwrap()[0], 8.0 / 12.0);
        near(found.lis.unwrap()[1], 0.5);
        // Residues touch the one opposite alone, at 7 Å: its neighbours are at sqrt(49 + 16) = 8.06 Å.
        near(found.interface_plddt.unwrap(), 70.0);
        near(found.interface_pae.unwrap(), 5.0);
        let x = 70.0 * 30.0_f64.log10();
        near(
            found.pdockq.unwrap(),
            0.724 / (1.0 + (-0.052 * (x - 152.611)).exp()) + 0.018,
        );
        for (found, error) in found.pdockq2.unwrap().into_iter().zip([4.0, 6.0]) {
            let x = 70.0 * closeness(error, 10.0);
            near(found, 1.31 / (1.0 + (-0.075 * (x - 84.733)).exp()) + 0.005);
        }
    }

    /// Errors at the cut-off do not count for ipSAE, at 12 Å they count as 0 for LIS, and short chains have d0 = 1.04.
    #[test]
    fn cutoffs_are_those_of_the_authors() {
        let (a, b) = (chain("A", 0, 5, 0.0, 80.0), chain("B", 5, 5, 30.0, 80.0));
        let at_cutoff = blocks([5, 5], [[0.0, 10.0], [9.99, 0.0]]);
        let [forth, back] = PairScores::of([&a, &b], Some(&at_cutoff), 10.0)
            .ipsae
            .unwrap();
        assert_eq!(forth, 0.0);
        let d0 = 1.24 * 12.0_f64.cbrt() - 1.8;
        near(back, 1.0 / (1.0 + (f64::from(9.99_f32) / d0).powi(2)));
        let wide = blocks([5, 5], [[0.0, 12.0], [12.01, 0.0]]);
        let found = PairScores::of([&a, &b], Some(&wide), 10.0);
        assert_eq!(found.lis, Some([0.0, 0.0]));
        // Out of contact.
        assert_eq!((found.pdockq, found.pdockq2), (Some(0.0), Some([0.0, 0.0])));
        assert_eq!((found.interface_pae, found.interface_plddt), (None, None));
        let nucleic = PolymerChain {
            is_nucleic: true,
            ..b
        };
        let [_, back] = PairScores::of([&a, &nucleic], Some(&at_cutoff), 10.0)
            .ipsae
            .unwrap();
        near(back, 1.0 / (1.0 + (f64::from(9.99_f32) / 2.0).powi(2)));
    }

    /// Without PAE only pDockQ is known, without pLDDT nothing that needs it.
    #[test]
    fn scores_need_their_confidence() {
        let (mut a, b) = (chain("A", 0, 5, 0.0, 80.0), chain("B", 5, 5, 6.0, 80.0));
        let found = PairScores::of([&a, &b], None, 10.0);
        assert!(found.pdockq.is_some() && found.interface_plddt.is_some());
        assert!(found.ipsae.is_none() && found.lis.is_none() && found.pdockq2.is_none());
        a.residues[4].plddt = None;
        let pae = blocks([5, 5], [[1.0; 2]; 2]);
        let found = PairScores::of([&a, &b], Some(&pae), 10.0);
        assert!(found.pdockq.is_none() && found.pdockq2.is_none());
        assert!(found.ipsae.is_some() && found.interface_pae.is_some());
    }
}
