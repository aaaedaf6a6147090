//! Tables of restraints: CSV, one row per pair of residues or atoms.
//!
//! ```text
//! receptor,ligand,lower,target,upper,group
//! A:57,B:12.CA,0,,8,
//! # Either of two residues, which are one restraint:
//! A:60,B:12,0,,6,loop
//! A:60,B:15,0,,6,loop
//! ```
//!
//! Columns go by their names, in any order. `receptor` and `ligand` are needed, and `upper` unless a preset gives it.
//! `lower` is 0 by default. Rows of one group are alternatives of one restraint, and all their bounds are
//! equal. Lines that begin with `#` and blank ones are skipped. Columns may be separated as spreadsheets save them, by
//! commas, semicolons or tabs.

use std::collections::{HashMap, HashSet};

use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;

use crate::restraints::crosslink::{self, Crosslink};
use crate::restraints::restraint::{Bounds, NamedRestraint, SelectedAtoms, distance};
use crate::restraints::side_atoms::SideAtoms;
use crate::table_text::named_columns::{Columns, read_rows, shortened};

/// The columns of a table.
const COLUMNS: Columns<6> = Columns {
    names: ["receptor", "ligand", "lower", "target", "upper", "group"],
    needed: &["receptor", "ligand"],
    remedy: "the first row names the columns: receptor, ligand, lower, target, upper, group; receptor and ligand are \
        needed, and so is upper without --crosslink. Statements (assign) belong in a file whose name ends in .tbl",
};

/// The restraints of a table. Lines end with LF.
pub(super) fn parse(
    bytes: Vec<u8>,
    molecules: [&Molecule; 2],
    crosslink: Option<Crosslink>,
) -> Result<Vec<NamedRestraint>, Error> {
    let mut rows = Rows::new(molecules, crosslink);
    read_rows(bytes, &COLUMNS, |line, row| rows.add(line, row))?;
    Ok(rows.restraints)
}

/// Restraints of the rows so far.
struct Rows<'a> {
    restraints: Vec<NamedRestraint>,
    /// The restraint of each group, with the alternatives that it has.
    groups: HashMap<String, Group>,
    sides: [SideAtoms<'a>; 2],
    crosslink: Option<Crosslink>,
    selected: SelectedAtoms,
}

struct Group {
    restraint: usize,
    bounds: Bounds,
    /// Alternatives: one that is written twice counts once.
    pairs: HashSet<[Vec<usize>; 2]>,
}

impl<'a> Rows<'a> {
    fn new(molecules: [&'a Molecule; 2], crosslink: Option<Crosslink>) -> Self {
        let [receptor, ligand] = molecules;
        let atom = crosslink.map(|crosslink| crosslink.atom);
        Self {
            restraints: Vec::new(),
            groups: HashMap::new(),
            sides: [
                SideAtoms::new(receptor, "receptor", atom),
                SideAtoms::new(ligand, "ligand", atom),
            ],
            crosslink,
            selected: SelectedAtoms::default(),
        }
    }

    fn add(&mut self, line: u64, row: &[&str; 6]) -> Result<(), Error> {
        let [receptor, ligand, lower, target, upper, group] = *row;
        for (field, column) in [(receptor, "receptor"), (ligand, "ligand")] {
            if field.is_empty() {
                return Err(Error::input(format!("the row has no {column}"))
                    .help("give residues or atoms, as in A:57 or A:57.CA"));
            }
        }
        let bounds = self.bounds(lower, target, upper)?;
        let [of_receptor, of_ligand] = &mut self.sides;
        let pair = [of_receptor.read(receptor)?, of_ligand.read(ligand)?];
        if let Some(known) = self.groups.get_mut(group) {
            let restraint = &mut self.restraints[known.restraint];
            if known.bounds != bounds {
                let (group, line) = (shortened(group), restraint.line);
                let message =
                    format!("the bounds differ from those of group `{group}` on line {line}");
                return Err(Error::input(message).help(
                    "give all rows of a group the same lower, target and upper, since they are one restraint",
                ));
            }
            if known.pairs.insert(pair.clone()) {
                self.selected.add(&pair)?;
                restraint.pairs.push(pair);
            }
            return Ok(());
        }
        self.selected.add(&pair)?;
        let name = if group.is_empty() {
            format!("{receptor} - {ligand}")
        } else {
            let known = Group {
                restraint: self.restraints.len(),
                bounds,
                pairs: HashSet::from([pair.clone()]),
            };
            self.groups.insert(group.to_owned(), known);
            group.to_owned()
        };
        self.restraints.push(NamedRestraint {
            name,
            line,
            pairs: vec![pair],
            lower: bounds.lower,
            target: bounds.target,
            upper: bounds.upper,
            written_upper: bounds.upper,
        });
        Ok(())
    }

    fn bounds(&self, lower: &str, target: &str, upper: &str) -> Result<Bounds, Error> {
        let optional = |column: &str, text: &str| -> Result<Option<f64>, Error> {
            (!text.is_empty())
                .then(|| distance(column, text))
                .transpose()
        };
        let preset = self.crosslink.map(|crosslink| crosslink.upper);
        let upper = optional("upper", upper)?.or(preset);
        let (lower, target) = (optional("lower", lower)?, optional("target", target)?);
        let upper = upper.ok_or_else(|| {
            Error::input("the row has no upper").help(format!(
                "give the largest distance in Å, or the reagent of cross-links with --crosslink: {}",
                crosslink::names()
            ))
        })?;
        Bounds::new(lower.unwrap_or(0.0), target, upper)
    }
}

#[cfg(test)]
mod tests;
