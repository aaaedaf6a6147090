//! What reading a file did: kept, dropped, altered, warned of.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;

use super::Format;
use super::assembly::BuiltAssembly;
use super::confidence::{Confidence, ToldBy};
use super::groups::GroupKind;

/// What reading one file did.
///
/// Its `Display` prints a few compact lines for people; its `Serialize` is for run.json and `--json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ReadReport {
    /// The file as given.
    pub file: String,
    /// The format found, by content first.
    pub format: Option<Format>,
    /// Whether the file was gzip-compressed.
    pub compressed: bool,
    /// Chains kept, in file order.
    pub chains: Vec<ChainCount>,
    /// Groups kept that are not standard amino acids, by name.
    pub groups: Vec<GroupCount>,
    /// What was dropped, by kind; kinds with nothing dropped are left out.
    pub dropped: Vec<Dropped>,
    /// What was altered.
    pub altered: Altered,
    /// The biological assembly that was built; nothing where the coordinates were taken as they stand.
    pub assembly: Option<BuiltAssembly>,
    /// How sure the prediction is that the file holds; nothing where it holds none.
    pub confidence: Option<Confidence>,
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

/// Why atoms were dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DropKind {
    /// Chains that were not asked for.
    Chain,
    /// Chains that have no part in the biological assembly asked for.
    Assembly,
    /// Hydrogen and deuterium: united-atom radii stand for them.
    Hydrogen,
    /// Water.
    Water,
    /// Buffer and cryo additives.
    Additive,
    /// Other HETATM records, where these are not wanted.
    Hetatm,
    /// Alternate locations that were not chosen.
    AlternateLocation,
    /// Residues of a predicted model of which it is not sure enough.
    LowConfidence,
    /// Models that were not asked for: all but the first by default.
    Model,
}

/// Atoms dropped for one reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Dropped {
    /// The reason.
    pub kind: DropKind,
    /// Atoms dropped.
    pub atoms: usize,
    /// Residues (for chains and additives: chain or residue names) with the number of atoms dropped from each.
    pub names: BTreeMap<String, usize>,
}

/// What was altered on reading.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Altered {
    /// Atoms whose blank element column was filled from residue and atom name.
    pub elements_derived: usize,
    /// Atoms whose element column was impossible for their residue and name, and was replaced.
    pub elements_corrected: usize,
    /// Blank or unreadable occupancies and temperature factors, replaced by 1 and 0.
    pub defaults_filled: usize,
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
    /// Counts atoms as dropped; `name` says what they belong to.
    pub(super) fn drop_atoms(&mut self, kind: DropKind, name: &str, atoms: usize) {
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

/// `1 atom`, `2 atoms`.
pub(super) fn count(number: usize, what: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {what}{plural}")
}

/// A chain's name as shown: `_` for the blank one.
pub(super) fn show_chain(name: &str) -> &str {
    if name.is_empty() { "_" } else { name }
}

/// Joins the first few of a list and counts the rest.
fn list(items: impl Iterator<Item = String>) -> String {
    const SHOWN: usize = 8;
    let items: Vec<String> = items.collect();
    let rest = items.len().saturating_sub(SHOWN);
    let mut text = items
        .iter()
        .take(SHOWN)
        .cloned()
        .collect::<Vec<_>>()
        .join(", ");
    if rest > 0 {
        text.push_str(&format!(" and {rest} more"));
    }
    text
}

impl fmt::Display for ReadReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let atoms: usize = self.chains.iter().map(|chain| chain.atoms).sum();
        let residues: usize = self.chains.iter().map(|chain| chain.residues).sum();
        let chains = list(self.chains.iter().map(|chain| {
            format!(
                "{} ({})",
                show_chain(&chain.name),
                count(chain.residues, "residue")
            )
        }));
        write!(
            f,
            "{}: {}, {}, {}: {chains}",
            self.file,
            count(atoms, "atom"),
            count(residues, "residue"),
            count(self.chains.len(), "chain"),
        )?;
        if !self.groups.is_empty() {
            let groups = list(self.groups.iter().map(|group| {
                let words = group.kind.words(group.residues != 1);
                format!("{} {} ({words})", group.residues, group.name)
            }));
            write!(f, "\n  kept: {groups}")?;
        }
        if !self.dropped.is_empty() {
            write!(
                f,
                "\n  dropped: {}",
                list(self.dropped.iter().map(show_dropped))
            )?;
        }
        let altered = self.altered.show();
        if !altered.is_empty() {
            write!(f, "\n  altered: {}", altered.join(", "))?;
        }
        if let Some(built) = &self.assembly {
            let (id, chains) = (&built.id, count(built.chains, "chain"));
            write!(
                f,
                "\n  biological assembly {id}: {chains}, of {} in the file",
                built.chains_in_file
            )?;
            if built.on_axes > 0 {
                write!(
                    f,
                    "; {} on its axes kept once",
                    count(built.on_axes, "atom")
                )?;
            }
        }
        if let Some(confidence) = &self.confidence {
            let told_by = match confidence.told_by {
                ToldBy::Header => "as the file says",
                ToldBy::Values => "told by its B column",
            };
            write!(
                f,
                "\n  a predicted model, {told_by}: mean pLDDT {:.1}, {} of {} below 50",
                confidence.mean,
                confidence.below_50,
                count(confidence.residues, "residue")
            )?;
        }
        for warning in &self.warnings {
            write!(f, "\n  warning: {warning}")?;
        }
        Ok(())
    }
}

fn show_dropped(dropped: &Dropped) -> String {
    let names = || {
        list(
            dropped
                .names
                .keys()
                .map(|name| show_chain(name).to_string()),
        )
    };
    let atoms = count(dropped.atoms, "atom");
    match dropped.kind {
        DropKind::Chain => format!("{atoms} of other chains ({})", names()),
        DropKind::Assembly => format!("{atoms} of chains outside the assembly ({})", names()),
        DropKind::Hydrogen => count(dropped.atoms, "hydrogen"),
        DropKind::Water => count(dropped.atoms, "water atom"),
        DropKind::Additive => format!("{atoms} of additives ({})", names()),
        DropKind::Hetatm => format!("{atoms} of HETATM records ({})", names()),
        DropKind::AlternateLocation => format!("{atoms} of alternate locations"),
        DropKind::LowConfidence => format!(
            "{atoms} of {} of low pLDDT ({})",
            count(dropped.names.len(), "residue"),
            names()
        ),
        DropKind::Model => format!("{atoms} of other models"),
    }
}

impl Altered {
    fn show(&self) -> Vec<String> {
        let mut parts = Vec::new();
        let mut say = |number: usize, text: String| {
            if number > 0 {
                parts.push(text);
            }
        };
        let derived = self.elements_derived;
        say(derived, format!("{} derived", count(derived, "element")));
        let corrected = self.elements_corrected;
        say(
            corrected,
            format!("{} corrected", count(corrected, "element")),
        );
        let filled = self.defaults_filled;
        say(
            filled,
            format!("{} filled", count(filled, "occupancy or B value")),
        );
        let choices = self.alternate_locations.len();
        say(
            choices,
            format!(
                "alternate locations chosen in {}",
                count(choices, "residue")
            ),
        );
        let models = self.models_ignored;
        say(models, format!("{} ignored", count(models, "other model")));
        parts
    }
}
