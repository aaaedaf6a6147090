//! Tables of restraints: CSV, a row a pair of residues or atoms.
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
//! `lower` is 0 where there is none. Rows of one group are alternatives of one restraint, and all their bounds are
//! equal. Lines that begin with `#` and blank ones are skipped. Columns may be separated as spreadsheets save them, by
//! commas, semicolons or tabs.

use std::collections::{HashMap, HashSet};

use csv::StringRecord;
use knotdock_structures::molecule::Molecule;

use crate::output::tables::cells::unquoted;
use crate::output::tables::csv_lines::line_of;
use crate::output::tables::spreadsheet::{column_name, plain};
use crate::restraints::bounds::{Bounds, distance};
use crate::restraints::crosslink::Crosslink;
use crate::restraints::error::{Located, RestraintFault, listed, shortened};
use crate::restraints::restraint::{NamedRestraint, SelectedAtoms};
use crate::restraints::side_atoms::SideAtoms;

/// The columns that a table may have.
pub const COLUMNS: [&str; 6] = ["receptor", "ligand", "lower", "target", "upper", "group"];

const COMMENT: Option<u8> = Some(b'#');

/// The restraints of a table. Lines end with LF.
pub(super) fn parse(
    bytes: Vec<u8>,
    molecules: [&Molecule; 2],
    crosslink: Option<Crosslink>,
) -> Result<Vec<NamedRestraint>, Located> {
    let (text, delimiter) =
        plain(bytes).map_err(|message| Located::in_file(RestraintFault::Unreadable(message)))?;
    let line = |position: &csv::Position| {
        usize::try_from(line_of(text.as_bytes(), position, COMMENT)).unwrap_or(usize::MAX)
    };
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(COMMENT)
        .delimiter(delimiter)
        .from_reader(text.as_bytes());
    let mut header: Option<Header> = None;
    let mut rows = Rows::new(molecules, crosslink);
    for record in reader.records() {
        let record = record.map_err(|error| Located {
            line: error.position().map(line),
            ..Located::in_file(RestraintFault::Unreadable(error.to_string()))
        })?;
        // A comment may have blanks before it, and spreadsheets end tables with rows of empty fields.
        let is_comment = record.get(0).is_some_and(|field| field.starts_with('#'));
        if is_comment || record.iter().all(str::is_empty) {
            continue;
        }
        let line = record.position().map_or(1, line);
        let at_line = |fault| Located::on_line(line, fault);
        match &header {
            None => header = Some(Header::read(&record).map_err(at_line)?),
            Some(header) => {
                let row = header.row(&record).map_err(at_line)?;
                rows.add(line, &row).map_err(at_line)?;
            }
        }
    }
    match header {
        Some(_) => Ok(rows.restraints),
        None => Err(Located::in_file(RestraintFault::NoRestraint)),
    }
}

/// Which column of [`COLUMNS`] each column of the file is.
struct Header(Vec<usize>);

/// The fields of a row in the order of [`COLUMNS`], empty where there is none.
type Row<'a> = [&'a str; COLUMNS.len()];

impl Header {
    fn read(record: &StringRecord) -> Result<Self, RestraintFault> {
        let names: Vec<String> = record.iter().map(column_name).collect();
        let mut seen = HashSet::new();
        let mut places = Vec::new();
        for name in &names {
            let place = COLUMNS.iter().position(|column| column == name);
            let place = place.ok_or_else(|| RestraintFault::UnknownColumn(shortened(name)))?;
            if !seen.insert(place) {
                return Err(RestraintFault::RepeatedColumn(name.clone()));
            }
            places.push(place);
        }
        for (place, column) in COLUMNS.into_iter().enumerate().take(2) {
            if !seen.contains(&place) {
                return Err(RestraintFault::MissingColumn {
                    column,
                    present: listed(names.iter().map(String::as_str)),
                });
            }
        }
        Ok(Self(places))
    }

    fn row<'a>(&self, record: &'a StringRecord) -> Result<Row<'a>, RestraintFault> {
        if record.len() != self.0.len() {
            return Err(RestraintFault::FieldCount {
                fields: record.len(),
                columns: self.0.len(),
            });
        }
        let mut row = [""; COLUMNS.len()];
        for (&place, field) in self.0.iter().zip(record) {
            row[place] = unquoted(field);
        }
        Ok(row)
    }
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

    fn add(&mut self, line: usize, row: &Row<'_>) -> Result<(), RestraintFault> {
        let [receptor, ligand, lower, target, upper, group] = *row;
        for (field, column) in [(receptor, "receptor"), (ligand, "ligand")] {
            if field.is_empty() {
                return Err(RestraintFault::MissingField(column));
            }
        }
        let bounds = self.bounds(lower, target, upper)?;
        let [of_receptor, of_ligand] = &mut self.sides;
        let pair = [of_receptor.read(receptor)?, of_ligand.read(ligand)?];
        if let Some(known) = self.groups.get_mut(group) {
            let restraint = &mut self.restraints[known.restraint];
            if known.bounds != bounds {
                return Err(RestraintFault::GroupBounds {
                    group: shortened(group),
                    first: restraint.line,
                });
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
        });
        Ok(())
    }

    fn bounds(&self, lower: &str, target: &str, upper: &str) -> Result<Bounds, RestraintFault> {
        let optional = |what, text: &str| -> Result<Option<f64>, RestraintFault> {
            (!text.is_empty()).then(|| distance(what, text)).transpose()
        };
        let preset = self.crosslink.map(|crosslink| crosslink.upper);
        let upper = optional("upper", upper)?.or(preset);
        Bounds::new(
            optional("lower", lower)?.unwrap_or(0.0),
            optional("target", target)?,
            upper.ok_or(RestraintFault::MissingField("upper"))?,
        )
    }
}

#[cfg(test)]
mod tests;
