//! The report of reading a file, in words.

use std::fmt;
use std::path::Path;

use crate::molecule::model::report::{Altered, ConfidenceSource, DropKind, Dropped, ReadReport};
use crate::molecule::model::wording::{count, show_chain};

/// Joins the first few of a list and counts the rest.
fn list(items: impl Iterator<Item = String>) -> String {
    first(8, items)
}

/// Joins the first so many of a list and counts the rest.
fn first(shown: usize, items: impl Iterator<Item = String>) -> String {
    let items: Vec<String> = items.collect();
    let rest = items.len().saturating_sub(shown);
    let mut text = items
        .iter()
        .take(shown)
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
        self.write_contents(f)?;
        self.write_changes(f)?;
        self.write_copies(f)?;
        self.write_confidence(f)?;
        for warning in &self.warnings {
            write!(f, "\n  warning: {warning}")?;
        }
        Ok(())
    }
}

impl ReadReport {
    /// The report in a line, without warnings: the file's name, what is kept, and what is dropped or in doubt.
    pub fn brief(&self) -> String {
        const SHOWN: usize = 3;
        let file = Path::new(&self.file);
        let name = file.file_name().unwrap_or(file.as_os_str());
        let residues: usize = self.chains.iter().map(|chain| chain.residues).sum();
        let chains = self.chains.iter();
        let mut parts = vec![format!(
            "{}: {} in {} {}",
            name.to_string_lossy(),
            count(residues, "residue"),
            if self.chains.len() == 1 {
                "chain"
            } else {
                "chains"
            },
            list(chains.map(|chain| show_chain(&chain.name).to_owned()))
        )];
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

    /// Writes the atoms, residues and chains that are kept.
    fn write_contents(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
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
        Ok(())
    }

    /// Writes what was renamed, dropped and altered.
    fn write_changes(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.other_names.is_empty() {
            let residues = self.other_names.iter().map(|other| other.residues).sum();
            let names =
                list(self.other_names.iter().map(|other| {
                    format!("{} {} as {}", other.residues, other.name, other.read_as)
                }));
            write!(
                f,
                "\n  {} under other names read: {names}",
                count(residues, "residue")
            )?;
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
        Ok(())
    }

    /// Writes the assembly that was built and the models that were joined.
    fn write_copies(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
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
        Ok(())
    }

    /// Writes the confidence of a predicted model.
    fn write_confidence(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
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
        DropKind::OtherResidue => format!("{atoms} of other residues of {}", names()),
        DropKind::Assembly => format!("{atoms} of chains outside the assembly ({})", names()),
        DropKind::Hydrogen => count(dropped.atoms, "hydrogen"),
        DropKind::Water => count(dropped.atoms, "water atom"),
        DropKind::Residue => format!("{atoms} of residues not wanted ({})", names()),
        DropKind::PseudoAtom => {
            let each = dropped.names.iter();
            let each = each.map(|(name, count)| format!("{count} {name}"));
            format!("{} ({})", count(dropped.atoms, "pseudo-atom"), list(each))
        }
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
        say(
            self.chains_from_segids,
            "chains named by the segid, columns 73-76".to_owned(),
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
