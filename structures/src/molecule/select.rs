//! From parsed records to the atoms that are docked: chains asked for, no hydrogens, no waters, no additives, one alternate
//! location a residue.

use std::path::Path;

use super::additives::is_additive;
use super::alternate::choose;
use super::elements::{self, Origin};
use super::error::ReadError;
use super::parse::Parsed;
use super::read::ReadOptions;
use super::report::{DropKind, ReadReport, show_chain};
use super::residues::{is_amino_acid, is_water};
use super::sieve::NameColumn;
use super::{Atom, report};

/// Applies all selections and notes in the report what they dropped.
///
/// Radii are left at zero: they need to know whole residues.
pub(super) fn select(
    file: &Path,
    parsed: Vec<Parsed>,
    chains: Option<&[String]>,
    options: &ReadOptions,
    report: &mut ReadReport,
) -> Result<Vec<Atom>, ReadError> {
    let wanted = wanted_chains(file, &parsed, chains)?;
    let aligned = keeps_alignment(&parsed);
    let mut atoms = Vec::with_capacity(parsed.len());
    for record in parsed {
        let carried = &record.carried;
        let name = carried.residue_name.as_str();
        if wanted
            .as_ref()
            .is_some_and(|wanted| !wanted.contains(&carried.chain))
        {
            report.drop_atoms(DropKind::Chain, show_chain(&carried.chain), 1);
            continue;
        }
        let is_kept_by_name = options.keep.iter().any(|keep| keep == name);
        if !is_kept_by_name && is_water(name) {
            report.drop_atoms(DropKind::Water, name, 1);
            continue;
        }
        if !is_kept_by_name && is_additive(name) {
            report.drop_atoms(DropKind::Additive, name, 1);
            continue;
        }
        let element = elements::resolve(
            name,
            &record.name,
            &carried.element,
            carried.name_column,
            aligned,
        )
        .ok_or_else(|| ReadError::UnknownElement {
            file: file.to_path_buf(),
            line: carried.line,
            atom: record.name.clone(),
            residue: format!(
                "{name} {}{}",
                show_chain(&carried.chain),
                carried.residue_number
            ),
        })?;
        if elements::is_hydrogen(element.symbol) {
            report.drop_atoms(DropKind::Hydrogen, "", 1);
            continue;
        }
        match element.origin {
            Origin::Column => {}
            Origin::Derived => report.altered.elements_derived += 1,
            Origin::Corrected => report.altered.elements_corrected += 1,
        }
        atoms.push(atom(record, element.symbol));
    }
    let atoms = choose(atoms, report);
    if atoms.is_empty() {
        return Err(ReadError::EmptySelection {
            file: file.to_path_buf(),
            dropped: report.atoms_dropped(),
        });
    }
    Ok(atoms)
}

fn atom(record: Parsed, element: &str) -> Atom {
    let carried = record.carried;
    Atom {
        name: record.name,
        residue_name: carried.residue_name,
        chain: carried.chain,
        residue_number: carried.residue_number,
        insertion_code: record.insertion_code,
        alternate_location: carried.alternate_location,
        element: element.to_string(),
        position: record.exact.position,
        occupancy: record.exact.occupancy,
        b_factor: record.exact.b_factor,
        hetero: record.hetero,
        radius: 0.0,
        line: carried.line,
    }
}

/// The chains to keep, or all of them.
fn wanted_chains(
    file: &Path,
    parsed: &[Parsed],
    chains: Option<&[String]>,
) -> Result<Option<Vec<String>>, ReadError> {
    let Some(chains) = chains else {
        return Ok(None);
    };
    let mut present: Vec<String> = Vec::new();
    for record in parsed {
        if present.last() != Some(&record.carried.chain) && !present.contains(&record.carried.chain)
        {
            present.push(record.carried.chain.clone());
        }
    }
    let mut wanted = Vec::with_capacity(chains.len());
    for chain in chains {
        if present.contains(chain) {
            wanted.push(chain.clone());
        } else if chain == report::show_chain("") && present.iter().any(String::is_empty) {
            wanted.push(String::new());
        } else {
            return Err(ReadError::UnknownChain {
                file: file.to_path_buf(),
                chain: chain.clone(),
                present,
            });
        }
    }
    Ok(Some(wanted))
}

/// Whether the file aligns atom names as the wwPDB does: alpha carbons of amino acids leave column 13 blank.
fn keeps_alignment(parsed: &[Parsed]) -> bool {
    parsed
        .iter()
        .filter(|record| record.name == "CA" && is_amino_acid(&record.carried.residue_name))
        .all(|record| record.carried.name_column == NameColumn::Blank)
}
