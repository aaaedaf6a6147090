//! Residues of a model, and the tokens to which its confidence refers.
//!
//! A standard amino acid or nucleotide is one token, and every heavy atom of anything else: modified residues, ligands,
//! ions and glycans (Abramson et al., Nature 630 (2024) 493-500, supplementary section 2.6). Boltz, Chai and Protenix
//! share this rule. Tokens are in the order of the file.

use std::collections::BTreeSet;

use knotdock_structures::Error;
use knotdock_structures::molecule::{Atom, Molecule};

use super::confidence::{ChainPairIptm, Confidence};
use crate::interface::ResidueName;

/// Residue names that are one token each.
const STANDARD: [&str; 31] = [
    "ALA", "ARG", "ASN", "ASP", "CYS", "GLN", "GLU", "GLY", "HIS", "ILE", "LEU", "LYS", "MET",
    "PHE", "PRO", "SER", "THR", "TRP", "TYR", "VAL", "UNK", "A", "C", "G", "U", "N", "DA", "DC",
    "DG", "DT", "DN",
];

/// Largest mean difference between pLDDT of the confidence files and of the B column of one model.
const SAME_PLDDT: f64 = 2.0;

/// An amino acid or nucleotide of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Residue {
    /// The author's number and insertion code, as `52A`.
    pub number: String,
    /// Its token: of a modified residue, that of CA or C1'.
    pub token: usize,
    /// Position in Å of CB, of CA if there is none, or of C3' of a nucleotide.
    pub position: [f64; 3],
    /// pLDDT of that atom, 0 to 100, if it is known.
    pub plddt: Option<f64>,
}

/// A chain of at least two amino acids or nucleotides.
#[derive(Clone, Debug, PartialEq)]
pub struct PolymerChain {
    /// The author's name.
    pub name: String,
    /// Its place among all chains of the file, those of ligands and ions included.
    pub place: usize,
    /// Its residues, modified ones included.
    pub residues: Vec<Residue>,
    /// Their names, joined.
    pub sequence: String,
    /// Whether any is a nucleotide.
    pub is_nucleic: bool,
}

/// The chains of a model that can be a side of an interface.
#[derive(Clone, Debug, PartialEq)]
pub struct Polymers {
    /// The chains in the order of the file.
    pub chains: Vec<PolymerChain>,
    /// Chains of the file, those of ligands and ions included.
    pub chains_in_file: usize,
}

/// The polymers of a molecule, with the pLDDT of their residues.
///
/// Of a molecule without confidence, pLDDT is that of the B column if its file is known as a prediction.
///
/// # Errors
/// [`Error`] if the confidence is that of other residues: the number of tokens, pLDDT values or chains differs, a token
/// is of another chain or residue, or the B column has another pLDDT.
pub fn polymers(molecule: &Molecule, confidence: Option<&Confidence>) -> Result<Polymers, Error> {
    let atoms = &molecule.atoms;
    let mut names: Vec<&str> = Vec::new();
    for atom in atoms {
        // Most atoms are of the chain of the last one.
        if names.last() != Some(&atom.chain.as_str()) && !names.contains(&atom.chain.as_str()) {
            names.push(&atom.chain);
        }
    }
    let mut chains: Vec<PolymerChain> = Vec::new();
    // Token of each atom, first atom of each token, and place of each polymer residue.
    let (mut token_of_atom, mut first_atoms) = (vec![0; atoms.len()], Vec::new());
    let mut centers = Vec::new();
    for residue in molecule.atoms_by_residue(&vec![true; atoms.len()]) {
        let heavy: Vec<usize> = residue
            .into_iter()
            .filter(|&at| !atoms[at].is_hydrogen())
            .collect();
        let Some(&first) = heavy.first() else {
            continue;
        };
        let is_standard = STANDARD.contains(&atoms[first].residue_name.as_str());
        for (number, &at) in heavy.iter().enumerate() {
            if number == 0 || !is_standard {
                first_atoms.push(at);
            }
            token_of_atom[at] = first_atoms.len() - 1;
        }
        let Some((center, is_nucleic)) = center(atoms, &heavy, is_standard) else {
            continue;
        };
        let name = &atoms[first].chain;
        let place = names.iter().position(|one| one == name).unwrap_or(0);
        let chain = match chains.iter_mut().position(|chain| chain.place == place) {
            Some(at) => &mut chains[at],
            None => {
                chains.push(PolymerChain {
                    name: name.clone(),
                    place,
                    residues: Vec::new(),
                    sequence: String::new(),
                    is_nucleic: false,
                });
                let last = chains.len() - 1;
                &mut chains[last]
            }
        };
        let named = |wanted: &str| heavy.iter().copied().find(|&at| atoms[at].name == wanted);
        let beta = named(if is_nucleic { "C3'" } else { "CB" }).unwrap_or(center);
        chain.is_nucleic |= is_nucleic;
        chain.sequence += &atoms[first].residue_name;
        chain.residues.push(Residue {
            number: ResidueName::of(&atoms[first]).number,
            token: token_of_atom[center],
            position: atoms[beta].position,
            plddt: None,
        });
        centers.push((chain.place, chain.residues.len() - 1, beta));
    }
    let tokens = Tokens {
        first_atoms,
        token_of_atom,
    };
    if let Some(confidence) = confidence {
        tokens.check(atoms, &names, confidence)?;
    }
    let plddt = tokens.plddt(molecule, &centers, confidence)?;
    if let Some(plddt) = plddt {
        for (&(place, residue, _), value) in centers.iter().zip(plddt) {
            let mut chain = chains.iter_mut().filter(|chain| chain.place == place);
            if let Some(residue) = chain
                .next()
                .and_then(|chain| chain.residues.get_mut(residue))
            {
                residue.plddt = Some(value);
            }
        }
    }
    // One amino acid or nucleotide is a ligand.
    chains.retain(|chain| chain.residues.len() > 1);
    chains.sort_by_key(|chain| chain.place);
    Ok(Polymers {
        chains,
        chains_in_file: names.len(),
    })
}

/// The CA of an amino acid or the C1' of a nucleotide, and whether it is the latter; `None` for all else.
fn center(atoms: &[Atom], heavy: &[usize], is_standard: bool) -> Option<(usize, bool)> {
    let named = |name: &str| heavy.iter().copied().find(|&at| atoms[at].name == name);
    let has = |name: &str| named(name).is_some();
    if let Some(center) = named("CA").filter(|&at| atoms[at].element == "C") {
        return (is_standard || has("N") && has("C")).then_some((center, false));
    }
    let center = named("C1'")?;
    (is_standard || has("P") && has("C3'")).then_some((center, true))
}

struct Tokens {
    first_atoms: Vec<usize>,
    token_of_atom: Vec<usize>,
}

impl Tokens {
    /// Refuses the confidence of other residues.
    fn check(&self, atoms: &[Atom], names: &[&str], confidence: &Confidence) -> Result<(), Error> {
        let tokens = self.first_atoms.len();
        let other = |what: &str, count: usize| {
            other_model(format!(
                "the confidence has {count} {what}, and the structure has {tokens} tokens ({} atoms, {} chains)",
                atoms.len(),
                names.len()
            ))
        };
        let counts = [
            (
                "tokens with a PAE",
                confidence.pae.as_ref().map(|pae| pae.tokens),
            ),
            (
                "tokens with a chain",
                confidence.token_chains.as_ref().map(Vec::len),
            ),
            (
                "tokens with a residue",
                confidence.token_residues.as_ref().map(Vec::len),
            ),
        ];
        for (what, count) in counts {
            if let Some(count) = count.filter(|&count| count != tokens) {
                return Err(other(what, count));
            }
        }
        if let Some(ChainPairIptm::Matrix(rows)) = &confidence.chain_pair_iptm
            && rows.len() != names.len()
        {
            return Err(other("chains with an ipTM", rows.len()));
        }
        let chains = confidence.token_chains.iter().flatten();
        for (token, (&at, chain)) in self.first_atoms.iter().zip(chains).enumerate() {
            let number = confidence.token_residues.as_ref().map(|all| all[token]);
            let atom = &atoms[at];
            let is_numbered = STANDARD.contains(&atom.residue_name.as_str());
            let is_other = number.is_some_and(|number| number != atom.residue_number);
            if *chain != atom.chain || is_numbered && is_other {
                let name = ResidueName::of(atom);
                return Err(other_model(format!(
                    "token {} of the confidence is of {chain}:{}, and that of the structure of {}:{}",
                    token + 1,
                    number.map_or_else(|| "?".to_owned(), |number| number.to_string()),
                    name.chain,
                    name.number
                )));
            }
        }
        Ok(())
    }

    /// pLDDT of the residues whose places and representative atoms are given; `None` if it is not known.
    fn plddt(
        &self,
        molecule: &Molecule,
        residues: &[(usize, usize, usize)],
        confidence: Option<&Confidence>,
    ) -> Result<Option<Vec<f64>>, Error> {
        let atoms = &molecule.atoms;
        let of_column = b_column(molecule, confidence.is_some()).map(|scale| {
            let values = residues.iter();
            values
                .map(|&(.., atom)| scale * atoms[atom].b_factor)
                .collect::<Vec<f64>>()
        });
        let Some(values) = confidence.and_then(|confidence| confidence.plddt.as_ref()) else {
            return Ok(of_column);
        };
        let value = |at: usize| values.get(at).map_or(0.0, |&value| f64::from(value));
        let numbered = residues.iter().enumerate();
        let found: Vec<f64> = match values.len() {
            count if count == atoms.len() => residues.iter().map(|one| value(one.2)).collect(),
            count if count == self.first_atoms.len() => {
                let tokens = residues.iter().map(|one| self.token_of_atom[one.2]);
                tokens.map(value).collect()
            }
            count if count == residues.len() => numbered.map(|(at, _)| value(at)).collect(),
            count => {
                return Err(other_model(format!(
                    "the confidence has {count} values of pLDDT, and the structure has {} atoms, {} tokens and {} \
                     residues",
                    atoms.len(),
                    self.first_atoms.len(),
                    residues.len()
                )));
            }
        };
        if let Some(column) = of_column {
            let differences = found.iter().zip(&column).map(|(a, b)| (a - b).abs());
            let mean = differences.sum::<f64>() / column.len().max(1) as f64;
            if mean > SAME_PLDDT {
                return Err(other_model(format!(
                    "the pLDDT of the confidence differs from that of the B column by {mean:.1} on average"
                )));
            }
        }
        Ok(Some(found))
    }
}

/// Factor by which the B column becomes pLDDT; `None` if it is something else.
///
/// Without confidence files it counts only in a file that is known as a prediction.
fn b_column(molecule: &Molecule, has_confidence: bool) -> Option<f64> {
    if !has_confidence && molecule.report.confidence.is_none() {
        return None;
    }
    let values = || molecule.atoms.iter().map(|atom| atom.b_factor);
    let distinct: BTreeSet<u64> = values().map(f64::to_bits).take(1000).collect();
    let is_plddt = distinct.len() > 1 && values().all(|value| (0.0..=100.0).contains(&value));
    let scale = if values().all(|value| value <= 1.0) {
        100.0
    } else {
        1.0
    };
    is_plddt.then_some(scale)
}

/// Confidence that is not of this structure.
fn other_model(message: String) -> Error {
    Error::input(message).help(
        "give the confidence files of this very model by --confidence, and the structure as its program wrote it",
    )
}
