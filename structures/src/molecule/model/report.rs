//! Report on reading a file: what was kept, dropped and altered, and the warnings.

use std::collections::{BTreeMap, HashMap};
use std::fmt;
use std::path::{Path, PathBuf};

use crate::molecule::model::{Atom, CutEnd, Format, GroupKind, Residue, count, show_chain};
use serde::Serialize;

/// A structure file and the chains and residues requested of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputSpec {
    /// The file.
    pub path: PathBuf,
    /// Chains to keep by their author names, case-sensitive, `_` for the blank name, and residues of chains, as parts
    /// of a [`ResidueSelection`](crate::molecule::ResidueSelection): `H`, `H:1-120`; all chains when `None`.
    pub chains: Option<Vec<String>>,
    /// Model to read, 1 for the first in the file; where `None`, [`ReadOptions`](crate::molecule::ReadOptions) choose it.
    pub model: Option<usize>,
}

impl InputSpec {
    /// All chains of a file.
    pub fn whole(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            chains: None,
            model: None,
        }
    }
}

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
    /// Standard amino acids under other names, and the names that they were read as.
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
    /// Why the B column is taken for no pLDDT although a least one is given.
    #[serde(skip)]
    pub no_confidence: Option<String>,
    /// Facts to know before trusting the result.
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

impl DropKind {
    /// The name under which the report counts an atom dropped for this reason; nothing for kinds that are counted as one.
    pub(crate) fn counted_by(self, atom: &Atom) -> &str {
        match self {
            Self::Chain | Self::OtherResidue | Self::Assembly => show_chain(&atom.chain),
            Self::Hydrogen | Self::Model => "",
            _ => &atom.residue_name,
        }
    }
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

/// Counts of changes on reading.
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
    /// Counts atoms as dropped, under the name of their residue or chain.
    pub(crate) fn drop_atoms(&mut self, kind: DropKind, name: &str, atoms: usize) {
        let at = self.dropped.iter().position(|entry| entry.kind == kind);
        let at = at.unwrap_or(self.dropped.len());
        if at == self.dropped.len() {
            let names = BTreeMap::new();
            self.dropped.push(Dropped {
                kind,
                atoms: 0,
                names,
            });
        }
        let entry = &mut self.dropped[at];
        entry.atoms += atoms;
        match entry.names.get_mut(name) {
            Some(count) => *count += atoms,
            None if name.is_empty() => {}
            None => drop(entry.names.insert(name.to_owned(), atoms)),
        }
    }

    pub(crate) fn count(&mut self, residues: &[Residue<'_>]) {
        let mut places: HashMap<&str, usize> = HashMap::new();
        let mut groups: BTreeMap<(GroupKind, &str), [usize; 2]> = BTreeMap::new();
        let mut other_names: BTreeMap<(&str, &str), usize> = BTreeMap::new();
        for residue in residues {
            let (key, atoms) = (residue.key, residue.atoms.len());
            let place = *places.entry(key.chain).or_insert(self.chains.len());
            if place == self.chains.len() {
                let name = key.chain.to_owned();
                self.chains.push(ChainCount {
                    name,
                    residues: 0,
                    atoms: 0,
                });
            }
            self.chains[place].residues += 1;
            self.chains[place].atoms += atoms;
            if residue.kind != GroupKind::AminoAcid {
                let [residues, all] = groups.entry((residue.kind, key.name)).or_default();
                *residues += 1;
                *all += atoms;
            }
            if residue.known_as != key.name {
                *other_names.entry((key.name, residue.known_as)).or_default() += 1;
            }
        }
        let groups = groups
            .into_iter()
            .map(|((kind, name), [residues, atoms])| GroupCount {
                name: name.to_owned(),
                kind,
                residues,
                atoms,
            });
        self.groups = groups.collect();
        let other_names = other_names
            .into_iter()
            .map(|((name, read_as), residues)| OtherName {
                name: name.to_owned(),
                read_as: read_as.to_owned(),
                residues,
            });
        self.other_names = other_names.collect();
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
    /// Copies of atoms left out because they coincide with another copy of the same: they are on an axis of symmetry.
    pub on_axes: usize,
}

/// Models that were read as one molecule.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct JoinedModels {
    /// Models that have atoms.
    pub models: usize,
    /// Copies of atoms left out because they coincide with the same atom of an earlier model: they are on an axis of
    /// symmetry.
    pub on_axes: usize,
}

/// Source by which a prediction was detected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ConfidenceSource {
    /// The file says so: `_ma_qa_metric` of ModelCIF.
    Header,
    /// The values of the B column look like a prediction's: one per residue, or high ones with a tail of low ones.
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

/// Joins the first few of a list and counts the rest.
fn list(items: impl Iterator<Item = String>) -> String {
    first(8, items)
}

/// Joins the first `shown` of a list and counts the rest.
fn first(shown: usize, items: impl Iterator<Item = String>) -> String {
    let items: Vec<String> = items.collect();
    let rest = items.len().saturating_sub(shown);
    let more = if rest > 0 {
        format!(" and {rest} more")
    } else {
        String::new()
    };
    items[..items.len() - rest].join(", ") + &more
}

impl fmt::Display for ReadReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let atoms: usize = self.chains.iter().map(|chain| chain.atoms).sum();
        let chains = self.chains.iter().map(|chain| {
            format!(
                "{} ({})",
                show_chain(&chain.name),
                count(chain.residues, "residue")
            )
        });
        write!(
            f,
            "{}: {}, {}, {}: {}",
            self.file,
            count(atoms, "atom"),
            count(self.residues(), "residue"),
            count(self.chains.len(), "chain"),
            list(chains)
        )?;
        let groups = self.groups.iter().map(|group| {
            let words = group.kind.words(group.residues != 1);
            format!("{} {} ({words})", group.residues, group.name)
        });
        line(f, "kept", list(groups))?;
        let residues = self.other_names.iter().map(|other| other.residues).sum();
        let names = self
            .other_names
            .iter()
            .map(|other| format!("{} {} as {}", other.residues, other.name, other.read_as));
        let read = format!("{} under other names read", count(residues, "residue"));
        line(f, &read, list(names))?;
        line(f, "dropped", list(self.dropped.iter().map(show_dropped)))?;
        line(f, "altered", self.altered.show())?;
        if let Some(BuiltAssembly {
            id,
            chains,
            chains_in_file,
            on_axes,
        }) = &self.assembly
        {
            let chains = count(*chains, "chain");
            write!(
                f,
                "\n  biological assembly {id}: {chains}, of {chains_in_file} in the file"
            )?;
            if *on_axes > 0 {
                write!(f, "; {} on its axes kept once", count(*on_axes, "atom"))?;
            }
        }
        if let Some(joined) = &self.joined_models {
            write!(
                f,
                "\n  {} read as one molecule",
                count(joined.models, "model")
            )?;
            if joined.on_axes > 0 {
                let atoms = count(joined.on_axes, "atom");
                write!(f, "; {atoms} in one place in several kept once")?;
            }
        }
        if let Some(confidence) = &self.confidence {
            let source = match confidence.source {
                ConfidenceSource::Header => "as the file says",
                ConfidenceSource::Values => "detected from its B column",
                ConfidenceSource::User => "as --min-plddt says",
            };
            write!(
                f,
                "\n  a predicted model, {source}: mean pLDDT {:.1}, {} of {} below 50",
                confidence.mean,
                confidence.below_50,
                count(confidence.residues, "residue")
            )?;
        }
        self.warnings
            .iter()
            .try_for_each(|warning| write!(f, "\n  warning: {warning}"))
    }
}

/// Writes a line of the report, unless it is empty.
fn line(f: &mut fmt::Formatter<'_>, head: &str, text: String) -> fmt::Result {
    match text.as_str() {
        "" => Ok(()),
        text => write!(f, "\n  {head}: {text}"),
    }
}

impl ReadReport {
    /// The report in a line, without warnings: the file's name, and parts that are kept, dropped or in doubt.
    pub fn brief(&self) -> String {
        const SHOWN: usize = 3;
        let file = Path::new(&self.file);
        let name = file
            .file_name()
            .unwrap_or(file.as_os_str())
            .to_string_lossy();
        let residues = count(self.residues(), "residue");
        let chains = if self.chains.len() == 1 {
            "chain"
        } else {
            "chains"
        };
        let names = list(
            self.chains
                .iter()
                .map(|chain| show_chain(&chain.name).to_owned()),
        );
        let mut parts = vec![format!("{name}: {residues} in {chains} {names}")];
        if !self.groups.is_empty() {
            let groups = self.groups.iter();
            let groups = groups.map(|group| format!("{} {}", group.residues, group.name));
            parts.push(format!("kept {}", first(SHOWN, groups)));
        }
        if !self.dropped.is_empty() {
            let dropped = self.dropped.iter().map(show_dropped);
            parts.push(format!("dropped {}", first(SHOWN, dropped)));
        }
        if self.altered.models_ignored > 0 {
            let models = count(self.altered.models_ignored, "other model");
            parts.push(format!("{models} ignored"));
        }
        if let Some(built) = &self.assembly {
            parts.push(format!("biological assembly {}", built.id));
        }
        if let Some(joined) = &self.joined_models {
            parts.push(format!("{} as one molecule", count(joined.models, "model")));
        }
        if let Some(confidence) = &self.confidence {
            parts.push(format!("predicted, mean pLDDT {:.1}", confidence.mean));
        }
        parts.join("; ")
    }

    fn residues(&self) -> usize {
        self.chains.iter().map(|chain| chain.residues).sum()
    }
}

fn show_dropped(dropped: &Dropped) -> String {
    let names = list(dropped.names.keys().map(|name| show_chain(name).to_owned()));
    let atoms = |of: &str| format!("{} of {of}", count(dropped.atoms, "atom"));
    let named = |of: &str| format!("{} ({names})", atoms(of));
    match dropped.kind {
        DropKind::Chain => named("other chains"),
        DropKind::OtherResidue => atoms(&format!("other residues of {names}")),
        DropKind::Assembly => named("chains outside the assembly"),
        DropKind::Hydrogen => count(dropped.atoms, "hydrogen"),
        DropKind::Water => count(dropped.atoms, "water atom"),
        DropKind::Residue => named("residues not wanted"),
        DropKind::PseudoAtom => {
            let each = dropped
                .names
                .iter()
                .map(|(name, count)| format!("{count} {name}"));
            format!("{} ({})", count(dropped.atoms, "pseudo-atom"), list(each))
        }
        DropKind::Additive => named("additives"),
        DropKind::Hetatm => named("HETATM records"),
        DropKind::AlternateLocation => atoms("alternate locations"),
        DropKind::LowConfidence => named(&format!(
            "{} of low pLDDT",
            count(dropped.names.len(), "residue")
        )),
        DropKind::Model => atoms("other models"),
    }
}

impl Altered {
    fn show(&self) -> String {
        let counted = |number: usize, what: &str, verb: &str| {
            (number, format!("{} {verb}", count(number, what)))
        };
        let choices = self.alternate_locations.len();
        let chosen = format!(
            "alternate locations chosen in {}",
            count(choices, "residue")
        );
        let segids = "chains named by the segid, columns 73-76".to_owned();
        let parts = [
            counted(self.elements_derived, "element", "derived"),
            counted(self.elements_corrected, "element", "corrected"),
            counted(self.defaults_filled, "occupancy or B value", "filled"),
            (self.chains_from_segids, segids),
            (choices, chosen),
            counted(self.models_ignored, "other model", "ignored"),
        ];
        let parts = parts.into_iter().filter(|(number, _)| *number > 0);
        parts.map(|(_, text)| text).collect::<Vec<_>>().join(", ")
    }
}
