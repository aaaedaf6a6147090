//! The parts of a run's report, and the data of its scripts, as JSON.
//!
//! | entry | what |
//! |---|---|
//! | `sides` | names of the two bodies |
//! | `columns`, `rows` | the table: how each column is shown, and its fields |
//! | `terms` | columns that add up to the pose score |
//! | `refined` | the first rows as their complexes are written: placement, and atoms that moved per side: place in the file, x, y, z |
//! | `placed` | the motion of each placed body, per row: qw, qx, qy, qz, tx, ty, tz |
//! | `bodies` | receptor and ligand: text of a structure, or vertices and triangles |
//! | `contacts` | one text per row, five numbers per pair of residues: places in `residues`, distance in 0.01 Å, hydrogen bonds, salt bridge |
//! | `shares` | clusters that touch each residue, per side; `counted` of them were examined |
//! | `chains` | names of chains in complexes |
//! | `overlay` | known complexes over the receptor: `traces`, lines of both sides; `of_row`, the place of each row's own |
//! | `clusters` | size; best, mean and standard deviation of scores; mean and largest RMSD |

use std::collections::HashMap;
use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::report::columns::{ShownColumn, is_term, shown};
use crate::report::html::{Page, section};
use crate::report::shown::{placement, rounded, significant, solid};
use crate::report::viewer::{Viewer, on_request};
use crate::report::{MAX_ROWS, run_cost, run_words};
use knotdock::evaluate::{Evaluator, Trace};
use knotdock::interface::{Contact, ResidueName, heavy_residues};
use knotdock::options::DockOptions;
use knotdock::output::run_contacts::RunContacts;
use knotdock::output::run_folder::Bodies;
use knotdock::output::tables::poses::{PoseRow, PoseTable};
use knotdock::pose_space::arrangement::Arrangement;
use knotdock::refine::Refined;
use knotdock_scoring::se3::Pose;
use knotdock_structures::molecule::{Format, Molecule, ResidueSelection, fits, write_renamed};

/// A finished run, as it is shown.
pub struct RunReport<'a> {
    pub record: &'a Value,
    pub options: &'a DockOptions,
    pub table: &'a PoseTable,
    pub bodies: Bodies<'a>,
    /// The first rows as they were refined, which are shown in their place.
    pub refined: &'a [Refined],
    /// Contacts of molecules in the poses of the table.
    pub contacts: Option<&'a RunContacts<'a>>,
    /// The known complex, if one was named, or why it does not measure the poses.
    pub known: Option<Result<&'a Evaluator, &'a str>>,
    /// Figures of the clusters; `null` if they are lost.
    pub clusters: Value,
    /// Its directory as commands would name it.
    pub directory: &'a str,
}

/// The data, with the first `count` rows.
pub(super) fn data(report: &RunReport, count: usize) -> Value {
    let table = report.table;
    let columns: Vec<ShownColumn> = table.header.iter().map(shown).collect();
    let rows: Vec<Vec<Value>> = (0..count)
        .map(|row| {
            columns
                .iter()
                .map(|column| cell(report, row, column))
                .collect()
        })
        .collect();
    let arrangement = Arrangement::from(report.options.search.symmetry);
    let placed = table.rows().iter().take(count).map(|row| {
        let images = arrangement.images(&row.pose).unwrap_or_default();
        images.iter().map(placement).collect::<Vec<_>>()
    });
    let is_shown_term = |column: &&ShownColumn| is_term(&column.name);
    let terms = columns.iter().filter(is_shown_term);
    let mut data = json!({
        "kind": "run",
        "sides": match arrangement.is_ring() {
            true => ["molecule", "next copy"],
            false => ["receptor", "ligand"],
        },
        "terms": terms.map(|column| column.name.as_str()).collect::<Vec<_>>(),
        "columns": columns,
        "rows": rows,
        "placed": placed.collect::<Vec<_>>(),
        "refined": report.refined.iter().map(refined).collect::<Vec<_>>(),
        "chains": report.record["chains"],
    });
    match (report.bodies, report.contacts) {
        (Bodies::Molecules(molecules), Some(contacts)) => {
            let sides = contacts.finder.residues();
            data["bodies"] = (0..2)
                .map(|side| molecule(report, side, molecules[side], sides[side]))
                .collect();
            let rows = contacts.rows.iter().take(count).map(|row| flat(row));
            data["contacts"] = rows.collect();
            let shares = contacts.shares();
            data["shares"] = shares
                .iter()
                .map(|side| side.iter().map(|share| share.clusters).collect::<Value>())
                .collect();
            data["counted"] = json!(contacts.firsts.len());
        }
        (Bodies::Molecules(_), None) => {}
        (Bodies::Solids(surfaces), _) => data["bodies"] = surfaces.iter().map(solid).collect(),
    }
    if let Some(Ok(evaluator)) = report.known {
        data["overlay"] = overlay(evaluator, &table.rows()[..count]);
    }
    if !report.clusters.is_null() {
        data["clusters"] = report.clusters.clone();
    }
    data
}

/// The known complexes with decimals that are seen, and which of them each row is measured by.
fn overlay(evaluator: &Evaluator, rows: &[PoseRow]) -> Value {
    let poses: Vec<Pose> = rows.iter().map(|row| row.pose).collect();
    let (known, of_row) = evaluator.known(&poses);
    let line = |line: &Vec<[f64; 3]>| -> Value {
        let parts = line.as_flattened().iter();
        parts.map(|part| rounded(*part, 1)).collect()
    };
    let side = |trace: &Trace| trace.iter().map(line).collect::<Value>();
    let traces: Vec<_> = known
        .iter()
        .map(|sides| sides.each_ref().map(side))
        .collect();
    json!({ "traces": traces, "of_row": of_row })
}

/// A field of the table, with the digits that are shown and four more.
fn cell(report: &RunReport, row: usize, column: &ShownColumn) -> Value {
    let field = report.table.field(row, &column.name).unwrap_or_default();
    match (field, column.digits) {
        ("", _) => Value::Null,
        (text, None) => json!(text),
        (text, Some(digits)) => match text.parse::<f64>() {
            Ok(value) if value.is_finite() => json!(rounded(value, digits as i32 + 4)),
            _ => json!(text),
        },
    }
}

/// A refined pose, with the atoms that moved, flat.
fn refined(refined: &Refined) -> Value {
    let moved = refined.moved.each_ref().map(|moved| {
        let atoms = moved.iter().flat_map(|&(place, position)| {
            let position = position.map(|part| json!(rounded(part, 3)));
            std::iter::once(json!(place)).chain(position)
        });
        atoms.collect::<Vec<_>>()
    });
    json!({ "placed": placement(&refined.pose), "moved": moved })
}

/// Contacts as text: as values of JSON they would take ten times the memory.
fn flat(contacts: &[Contact]) -> String {
    let mut text = String::new();
    for contact in contacts {
        let [first, second] = contact.residues;
        let distance = (100.0 * contact.distance).round();
        let (bonds, bridge) = (contact.hydrogen_bonds, u8::from(contact.salt_bridge));
        let space = if text.is_empty() { "" } else { " " };
        // Writing to memory does not fail.
        let _ = write!(text, "{space}{first} {second} {distance} {bonds} {bridge}");
    }
    text
}

fn molecule(
    report: &RunReport,
    side: usize,
    molecule: &Molecule,
    residues: &[ResidueName],
) -> Value {
    let format = match fits(Format::Pdb, molecule) {
        Ok(()) => Format::Pdb,
        Err(_) => Format::Mmcif,
    };
    let mut text = Vec::new();
    // Writing to memory does not fail, and the format fits.
    let written = write_renamed(&mut text, format, molecule, &[]);
    assert!(written.is_ok(), "{written:?}");
    let names: Vec<_> = residues
        .iter()
        .map(|residue| [&residue.chain, &residue.number, &residue.name])
        .collect();
    json!({
        "format": format.extension(),
        "text": String::from_utf8_lossy(&text),
        "residues": names,
        "residue_of_atom": residue_of_atom(molecule),
        "active": chosen(molecule, &active(report, side)),
        "blocked": chosen(molecule, &blocked(report, side)),
    })
}

/// The residue of each atom; for a hydrogen, that of the heavy atoms of its name, if there are any.
fn residue_of_atom(molecule: &Molecule) -> Vec<Option<usize>> {
    let mut residues = vec![None; molecule.atoms.len()];
    let mut of_name = HashMap::new();
    for (residue, atoms) in heavy_residues(molecule).into_iter().enumerate() {
        for at in atoms {
            residues[at] = Some(residue);
            of_name.insert(ResidueName::of(&molecule.atoms[at]), residue);
        }
    }
    for (atom, residue) in molecule.atoms.iter().zip(&mut residues) {
        *residue = residue.or_else(|| of_name.get(&ResidueName::of(atom)).copied());
    }
    residues
}

/// Residues of a side that poses are rewarded for touching: the user's, or the active site of a peptidase.
pub(super) fn active(report: &RunReport, side: usize) -> Vec<ResidueSelection> {
    let restraints = &report.options.restraints;
    let named = match side {
        0 => [&restraints.active_receptor, &restraints.site_receptor],
        _ => [&restraints.active_ligand, &restraints.site_ligand],
    };
    let site = &report.record["active_site"];
    let sites = match site["partner"].as_str() == Some(["receptor", "ligand"][side]) {
        true => site["sites"].as_array(),
        false => None,
    };
    let residues = sites.into_iter().flatten().flat_map(|site| {
        let residues = site["residues"].as_array().into_iter().flatten();
        residues.filter_map(|residue| residue.as_str()?.parse().ok())
    });
    named
        .into_iter()
        .flatten()
        .cloned()
        .chain(residues)
        .collect()
}

/// Residues of a side that are kept free of contact.
fn blocked(report: &RunReport, side: usize) -> Vec<ResidueSelection> {
    let restraints = &report.options.restraints;
    let named = [&restraints.block_receptor, &restraints.block_ligand][side];
    named.iter().cloned().collect()
}

fn chosen(molecule: &Molecule, selections: &[ResidueSelection]) -> Vec<usize> {
    let masks = selections
        .iter()
        .filter_map(|selection| molecule.selected(selection).ok());
    let masks: Vec<Vec<bool>> = masks.collect();
    let residues = heavy_residues(molecule).into_iter().enumerate();
    let is_chosen = |atoms: &[usize]| masks.iter().any(|mask| atoms.iter().any(|&at| mask[at]));
    residues
        .filter(|(_, atoms)| is_chosen(atoms))
        .map(|(residue, _)| residue)
        .collect()
}

impl RunReport<'_> {
    /// The whole page, with fewer rows of large molecules to stay below 6 MB.
    pub fn text(&self, viewer: Option<&Viewer>) -> String {
        let mut rows = self.table.rows().len().min(MAX_ROWS);
        loop {
            let text = self.page(rows, viewer);
            if text.len() <= MAX_BYTES || rows <= MIN_ROWS {
                return text;
            }
            rows = (rows / 2).max(MIN_ROWS);
        }
    }

    fn page(&self, rows: usize, viewer: Option<&Viewer>) -> String {
        let data = data(self, rows);
        let radius = significant(self.options.ranking.cluster_radius, 3);
        let unit = match self.bodies {
            Bodies::Molecules(_) => "\u{a0}Å",
            Bodies::Solids(_) => "",
        };
        let explorer = include_str!("page/explorer.html")
            .replace("{{lacking}}", &on_request(viewer))
            .replace("{{radius}}", &format!("{radius}{unit}"));
        let mut sections = vec![
            section("summary", "Summary", &run_words::summary(self, rows)),
            section("poses", "Poses", &explorer),
        ];
        if self.contacts.is_some() {
            let consensus = include_str!("page/consensus.html");
            sections.push(section(
                "consensus",
                "Where the best clusters gather",
                consensus,
            ));
        }
        sections.push(section(
            "cost",
            "Numerical error and cost",
            &run_cost::cost(self),
        ));
        sections.push(section(
            "options",
            "Options, and how to repeat the run",
            &run_cost::options(self),
        ));
        Page {
            title: run_words::title(self),
            sections,
            data: &data,
            viewer,
        }
        .text()
    }
}

/// Most bytes of a page, while rows can be left out.
const MAX_BYTES: usize = 5_500_000;
/// Rows that are shown of molecules of any size.
const MIN_ROWS: usize = 100;
