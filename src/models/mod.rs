//! Predicted models of complexes: which of them to trust, by the confidence of their program and by their coordinates.
//!
//! [`Prediction::read`] reads a structure with the confidence files beside it. [`Prediction::rated`] describes every pair of
//! its chains: ipTM as the program reports it, the [`scores`] that PAE and pLDDT give, and its
//! [`Interface`]. Sides are chains of proteins and nucleic acids; ligands and ions are none. [`systems`] compares the
//! models of one system, and [`trust`] gives each pair of chains a word.
//!
//! # Conventions
//!
//! Lengths and errors are in Å, pLDDT is from 0 to 100, other scores are from 0 to 1. Chains have the author's names.

mod agreement;
pub mod confidence;
mod confidence_files;
pub mod numpy;
pub mod scores;
pub mod tokens;
pub mod trust;

use std::path::{Path, PathBuf};

use knotdock_structures::Error;
use knotdock_structures::molecule::{Hetatm, InputSpec, Molecule, ReadOptions, read};
use rayon::prelude::*;

use crate::interface::Interface;
pub use agreement::{CONSENSUS_SHARE, SAME_INTERFACE, System, systems};
use confidence::{ChainPairIptm, Confidence};
pub use confidence_files::{Program, confidence_files, model_files};
use scores::PairScores;
use tokens::{PolymerChain, Polymers, polymers};

/// A predicted model of a complex.
#[derive(Clone, Debug)]
pub struct PredictedModel {
    /// The structure.
    pub path: PathBuf,
    /// The program whose names its confidence files have.
    pub program: Option<Program>,
    /// The confidence files that were read.
    pub confidence_files: Vec<PathBuf>,
    /// ipTM of the whole, 0 to 1.
    pub iptm: Option<f64>,
    /// pTM of the whole, 0 to 1.
    pub ptm: Option<f64>,
    /// Score by which the program ranks its models.
    pub ranking_score: Option<f64>,
    /// Mean pLDDT of amino acids and nucleotides, 0 to 100.
    pub plddt: Option<f64>,
    /// Every pair of chains of proteins and nucleic acids, in the order of the file.
    pub pairs: Vec<ChainPair>,
}

/// A pair of chains of a predicted model.
#[derive(Clone, Debug)]
pub struct ChainPair {
    /// The author's names of both chains.
    pub chains: [String; 2],
    /// Residue names of both chains, joined.
    pub sequences: [String; 2],
    /// ipTM of the pair as the program reports it, 0 to 1.
    ///
    /// The larger one of both directions. If there is none, a model of two chains has that of the whole.
    pub iptm: Option<f64>,
    /// Scores by confidence.
    pub scores: PairScores,
    /// Contacts, bonds, clashes and surface, by the coordinates.
    pub interface: Interface,
}

/// A structure with its confidence, as read.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// The structure's file.
    pub path: PathBuf,
    /// The program whose names its confidence files have.
    pub program: Option<Program>,
    /// The confidence files that were read.
    pub confidence_files: Vec<PathBuf>,
    /// What they hold.
    pub confidence: Option<Confidence>,
    /// Its chains of proteins and nucleic acids, at least two.
    pub polymers: Polymers,
    /// These chains as molecules, each with the ligands and ions under its name.
    pub molecules: Vec<Molecule>,
}

impl Prediction {
    /// Reads a structure, with given confidence files or, for `None`, those beside it.
    ///
    /// # Errors
    /// [`Error`] if a file cannot be read, the confidence is not that of the structure, or there is no pair of chains.
    pub fn read(path: &Path, confidence: Option<&[PathBuf]>) -> Result<Self, Error> {
        let (program, files) = confidence_files(path);
        let files = confidence.map_or(files, <[PathBuf]>::to_vec);
        let options = ReadOptions {
            hetatm: Hetatm::Keep,
            ..ReadOptions::default()
        };
        let molecule = read(&InputSpec::whole(path), &options)?;
        let confidence = match files.is_empty() {
            true => None,
            false => Some(Confidence::read(files.iter().map(PathBuf::as_path))?),
        };
        let polymers = polymers(&molecule, confidence.as_ref()).map_err(|error| error.at(path))?;
        let chains = &polymers.chains;
        if chains.len() < 2 {
            return Err(Error::input(format!(
                "there is no pair of chains: the file has {} of proteins or nucleic acids",
                chains.len()
            ))
            .at(path)
            .help("give models of complexes; ligands, ions and single residues are no sides"));
        }
        Ok(Self {
            path: path.to_owned(),
            program: program.filter(|_| confidence.is_some()),
            confidence_files: files,
            confidence,
            molecules: chains.iter().map(|one| chain_of(&molecule, one)).collect(),
            polymers,
        })
    }

    /// Places of both chains of every pair, in the order of the file.
    pub fn pairs(&self) -> Vec<[usize; 2]> {
        let count = self.polymers.chains.len();
        let places = (0..count).flat_map(|i| (i + 1..count).map(move |j| [i, j]));
        places.collect()
    }

    /// The ratings of the model and of its [`Prediction::pairs`].
    ///
    /// `cutoff` is the PAE in Å below which pairs of residues count for ipSAE, `ph` the pH of charges.
    ///
    /// # Errors
    /// [`Error`] for a chain without atoms.
    pub fn rated(&self, cutoff: f64, ph: f64) -> Result<PredictedModel, Error> {
        let (confidence, chains) = (self.confidence.as_ref(), &self.polymers.chains);
        let pairs = self.pairs().into_par_iter().map(|pair| {
            let sides = pair.map(|at| &chains[at]);
            Ok(ChainPair {
                chains: sides.map(|chain| chain.name.clone()),
                sequences: sides.map(|chain| chain.sequence.clone()),
                iptm: confidence.and_then(|found| iptm(found, &self.polymers, sides)),
                scores: PairScores::of(
                    sides,
                    confidence.and_then(|found| found.pae.as_ref()),
                    cutoff,
                ),
                interface: Interface::of(pair.map(|at| &self.molecules[at]), ph)?,
            })
        });
        let pairs = pairs.collect::<Result<Vec<ChainPair>, Error>>();
        let residues = chains.iter().flat_map(|chain| &chain.residues);
        let plddt: Option<Vec<f64>> = residues.map(|residue| residue.plddt).collect();
        Ok(PredictedModel {
            path: self.path.clone(),
            program: self.program,
            iptm: confidence.and_then(|found| found.iptm),
            ptm: confidence.and_then(|found| found.ptm),
            ranking_score: confidence.and_then(|found| found.ranking_score),
            plddt: plddt.map(|values| values.iter().sum::<f64>() / values.len() as f64),
            pairs: pairs.map_err(|error| error.at(&self.path))?,
            confidence_files: self.confidence_files.clone(),
        })
    }
}

/// A chain by itself, with the ligands and ions under its name.
fn chain_of(molecule: &Molecule, chain: &PolymerChain) -> Molecule {
    let atoms = molecule
        .atoms
        .iter()
        .filter(|atom| atom.chain == chain.name);
    Molecule {
        chain_breaks: molecule.chain_breaks.clone(),
        ..Molecule::new(atoms.cloned().collect(), molecule.format)
    }
}

/// The ipTM of two chains as the program reports it.
fn iptm(confidence: &Confidence, polymers: &Polymers, sides: [&PolymerChain; 2]) -> Option<f64> {
    let [first, second] = sides;
    let both = match &confidence.chain_pair_iptm {
        Some(ChainPairIptm::Matrix(rows)) => {
            let value = |row: usize, column: usize| *rows.get(row)?.get(column)?;
            [
                value(first.place, second.place),
                value(second.place, first.place),
            ]
        }
        Some(ChainPairIptm::Named(pairs)) => {
            let value = |a: &PolymerChain, b: &PolymerChain| {
                pairs.get(&format!("{}-{}", a.name, b.name)).copied()
            };
            [value(first, second), value(second, first)]
        }
        None => [None; 2],
    };
    let whole = confidence.iptm.filter(|_| polymers.chains_in_file == 2);
    both.into_iter().flatten().reduce(f64::max).or(whole)
}
