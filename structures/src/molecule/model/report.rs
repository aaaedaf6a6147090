//! Report on reading a file: what was kept, dropped and altered, and the warnings.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::molecule::InputSpec;
use crate::molecule::model::cut_ends::CutEnd;
use crate::molecule::model::format::Format;
use crate::molecule::model::groups::GroupKind;

/// Report on reading one file.
///
/// Its `Display` prints a few compact lines for people; its `Serialize` is for run.json and `--json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ReadReport {
    /// The file as given.
    pub file: String,
    /// What was read: file, chains and model; `None` for a molecule made in memory.
    #[serde(skip)]
    pub source: Option<InputSpec>,
    /// The format found, by content first.
    pub format: Option<Format>,
    /// Whether the file was gzip-compressed.
    pub compressed: bool,
    /// Chains kept, in file order.
    pub chains: Vec<ChainCount>,
    /// Groups kept that are not standard amino acids, by name.
    pub groups: Vec<GroupCount>,
    /// Standard amino acids under other names, and what they were read as.
    pub other_names: Vec<OtherName>,
    /// What was dropped, by kind; kinds with nothing dropped are left out.
    pub dropped: Vec<Dropped>,
    /// What was altered.
    pub altered: Altered,
    /// The biological assembly that was built; nothing where the coordinates were taken as they stand.
    pub assembly: Option<BuiltAssembly>,
    /// The models that were read as one molecule; nothing where one was read.
    pub joined_models: Option<JoinedModels>,
    /// How sure the prediction is that the file holds; nothing where it holds none.
    pub confidence: Option<Confidence>,
    /// Lowest and highest z (Å) of the planes of a flat membrane that the file marks, as those of OPM and PPM do.
    #[serde(skip)]
    pub membrane: Option<[f64; 2]>,
    /// Ends that a selection of residues cut out of chains: they stand for bonds.
    #[serde(skip)]
    pub(crate) cut_ends: Vec<CutEnd>,
    /// Why the B column is taken for no pLDDT where a least one is given.
    #[serde(skip)]
    pub no_confidence: Option<String>,
    /// What the user should know before trusting the result.
    pub warnings: Vec<String>,
}

/// A chain and how much of it was kept.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ChainCount {
    /// Author name; may be empty.
    pub name: String,
    /// Residues kept, cofactors and other groups included.
    pub residues: usize,
    /// Atoms kept.
    pub atoms: usize,
}

/// A kind of residue that was kept though it is no standard amino acid.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct GroupCount {
    /// Residue name.
    pub name: String,
    /// What it is.
    pub kind: GroupKind,
    /// How many of it.
    pub residues: usize,
    /// Their atoms.
    pub atoms: usize,
}

/// A standard amino acid under another name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct OtherName {
    /// Residue name in the file.
    pub name: String,
    /// What it was read as: a standard residue's name, or that of a state of one (`HIE`, `ASH`).
    pub read_as: String,
    /// How many of it.
    pub residues: usize,
}

/// Why atoms were dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DropKind {
    /// Chains that were not requested.
    Chain,
    /// Residues that were not requested, of chains of which others were.
    OtherResidue,
    /// Chains that have no part in the biological assembly requested.
    Assembly,
    /// Hydrogen and deuterium: united-atom radii stand for them.
    Hydrogen,
    /// Water.
    Water,
    /// Residues that are not wanted, by name.
    Residue,
    /// Records that are no atoms: marks of membranes and pockets, sites without mass.
    PseudoAtom,
    /// Buffer and cryo additives.
    Additive,
    /// Other HETATM records, where these are not wanted.
    Hetatm,
    /// Alternate locations that were not chosen.
    AlternateLocation,
    /// Residues of a predicted model of which it is not sure enough.
    LowConfidence,
    /// Models that were not requested: all but the first by default.
    Model,
}

/// Atoms dropped for one reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Dropped {
    /// The reason.
    pub kind: DropKind,
    /// Atoms dropped.
    pub atoms: usize,
    /// Residues (for chains: their names, for sites without mass: the atoms') with the number of atoms dropped from
    /// each.
    pub names: BTreeMap<String, usize>,
}

/// Counts of what was altered on reading.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Altered {
    /// Atoms whose blank element column was filled from residue and atom name.
    pub elements_derived: usize,
    /// Atoms whose element column was impossible for their residue and name, and was replaced.
    pub elements_corrected: usize,
    /// Blank or unreadable occupancies and temperature factors, replaced by 1 and 0.
    pub defaults_filled: usize,
    /// Atoms whose chain is their segid (columns 73-76 of PDB), since the file leaves the column of the chain blank.
    pub chains_from_segids: usize,
    /// Residues with alternate locations, and the one chosen.
    pub alternate_locations: Vec<AlternateChoice>,
    /// Models that were not read.
    pub models_ignored: usize,
    /// Whether all models lie beside one another, so that those that were not read are parts of what was.
    #[serde(skip)]
    pub models_are_parts: bool,
}

/// The alternate location chosen for a residue.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AlternateChoice {
    /// Author chain name.
    pub chain: String,
    /// Author residue number with insertion code, e.g. `100A`.
    pub residue: String,
    /// The location chosen.
    pub chosen: char,
    /// The locations that the file offers, in alphabetical order.
    pub offered: String,
}

impl ReadReport {
    /// Counts atoms as dropped; `name` says what they belong to.
    pub(crate) fn drop_atoms(&mut self, kind: DropKind, name: &str, atoms: usize) {
        if atoms == 0 {
            return;
        }
        let at = match self.dropped.iter().position(|entry| entry.kind == kind) {
            Some(at) => at,
            None => {
                self.dropped.push(Dropped {
                    kind,
                    atoms: 0,
                    names: BTreeMap::new(),
                });
                self.dropped.len() - 1
            }
        };
        if let Some(entry) = self.dropped.get_mut(at) {
            entry.atoms += atoms;
            match entry.names.get_mut(name) {
                Some(count) => *count += atoms,
                None if name.is_empty() => {}
                None => {
                    entry.names.insert(name.to_string(), atoms);
                }
            }
        }
    }

    /// Atoms dropped in all.
    pub fn atoms_dropped(&self) -> usize {
        self.dropped.iter().map(|entry| entry.atoms).sum()
    }
}

/// An assembly that was built.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct BuiltAssembly {
    /// Its name in the file.
    pub id: String,
    /// Protein and nucleic acid chains of it.
    pub chains: usize,
    /// Such chains in the file.
    pub chains_in_file: usize,
    /// Copies of atoms left out because they coincide with another copy of the same: they lie on an axis of symmetry.
    pub on_axes: usize,
}

/// Models that were read as one molecule.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct JoinedModels {
    /// Models that have atoms.
    pub models: usize,
    /// Copies of atoms left out because they coincide with the same atom of an earlier model: they lie on an axis of
    /// symmetry.
    pub on_axes: usize,
}

/// Source by which a prediction was detected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ConfidenceSource {
    /// The file says so: `_ma_qa_metric` of ModelCIF.
    Header,
    /// The values of the B column look like a prediction's: one a residue, or high ones with a tail of low ones.
    Values,
    /// The user gave a least pLDDT, and the B column can hold pLDDT.
    User,
}

/// Confidence of a prediction of a molecule.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Confidence {
    /// Source by which the B column was detected as pLDDT.
    pub source: ConfidenceSource,
    /// Mean pLDDT of the residues, 0 to 100, those that are left out among them.
    pub mean: f64,
    /// Residues.
    pub residues: usize,
    /// Those of them with a pLDDT below 50.
    pub below_50: usize,
}
