//! Writing molecules and complexes, as PDB or mmCIF.
//!
//! Atoms keep their order, names, residue numbers, insertion codes, elements, occupancies and temperature factors. A
//! complex gets unique chain names: a chain keeps its name unless a chain before it (receptor first) has it, PDB's single
//! column cannot hold it, or it has other characters than letters and digits. The map stands in the file's remarks and is returned.

pub(crate) mod chains;
pub(crate) mod error;
pub(crate) mod mmcif;
pub(crate) mod models;
pub(crate) mod pdb;
pub(crate) mod row;

use std::collections::HashMap;
use std::io::Write;

pub use crate::molecule::write::chains::{ChainMap, ChainName, Partner};
pub use crate::molecule::write::models::ModelWriter;

use crate::molecule::model::atom::Atom;
use crate::molecule::model::format::Format;
use crate::molecule::model::groups::{GroupKind, residues};
use crate::molecule::model::molecule::Molecule;
use crate::molecule::model::wording::show_chain;
use crate::molecule::write::error::WriteError;
use crate::molecule::write::row::{Row, name};

/// The format that a complex is written in: PDB when all partners came as PDB and it fits the columns (at most 99,999
/// atoms and 62 chains, coordinates from -999.999 to 9999.999 Å), mmCIF otherwise.
pub fn complex_format(molecules: &[&Molecule]) -> Format {
    if molecules.iter().any(|one| one.format != Format::Pdb) {
        return Format::Mmcif;
    }
    let fits = ChainMap::of_complex(Format::Pdb, molecules)
        .and_then(|map| pdb::check(&complex_rows(molecules, &map)));
    match fits {
        Ok(()) => Format::Pdb,
        Err(_) => Format::Mmcif,
    }
}

/// Writes receptor and already placed ligand, and of a ring its further copies, as one structure.
///
/// `remarks` are free lines; the chain map is added to them. Use [`complex_format`] to choose the format.
///
/// # Errors
/// [`WriteError`] when the writer fails, a number is not finite, or the format cannot hold the complex.
pub fn write_complex<W: Write>(
    writer: &mut W,
    format: Format,
    molecules: &[&Molecule],
    remarks: &[String],
) -> Result<ChainMap, WriteError> {
    let map = ChainMap::of_complex(format, molecules)?;
    let mut remarks = remarks.to_vec();
    remarks.extend(map.remarks());
    let rows = complex_rows(molecules, &map);
    write_rows(writer, format, &rows, &remarks)?;
    Ok(map)
}

/// Writes one molecule under its own chain names.
///
/// # Errors
/// As [`write_complex`].
pub fn write_molecule<W: Write>(
    writer: &mut W,
    format: Format,
    molecule: &Molecule,
    remarks: &[String],
) -> Result<(), WriteError> {
    let rows = rows(&molecule.atoms, |atom| &atom.chain);
    write_rows(writer, format, &rows, remarks)
}

/// Writes one molecule; of chains whose names the format cannot hold, such as `A-2` in PDB, the remarks say what they
/// are called instead.
///
/// # Errors
/// As [`write_complex`].
pub fn write_renamed<W: Write>(
    writer: &mut W,
    format: Format,
    molecule: &Molecule,
    remarks: &[String],
) -> Result<(), WriteError> {
    let map = ChainMap::of_molecule(format, molecule)?;
    let renamed = map
        .chains
        .iter()
        .filter(|chain| chain.written != chain.original);
    let notes = renamed.map(|chain| {
        format!(
            "chain {} was {}",
            chain.written,
            show_chain(&chain.original)
        )
    });
    let remarks: Vec<String> = remarks.iter().cloned().chain(notes).collect();
    write_rows(writer, format, &complex_rows(&[molecule], &map), &remarks)
}

/// Whether a format holds a molecule as [`write_renamed`] writes it.
///
/// # Errors
/// [`WriteError::DoesNotFit`] with what does not.
pub fn fits(format: Format, molecule: &Molecule) -> Result<(), WriteError> {
    let map = ChainMap::of_molecule(format, molecule)?;
    match format {
        Format::Pdb => pdb::check(&complex_rows(&[molecule], &map)),
        Format::Mmcif => Ok(()),
    }
}

fn complex_rows<'a>(molecules: &[&'a Molecule], map: &'a ChainMap) -> Vec<Row<'a>> {
    let of_molecule = |(place, molecule): (usize, &&'a Molecule)| {
        let partner = Partner::at(place);
        let chains = map.chains.iter().filter(|chain| chain.partner == partner);
        let names: HashMap<&str, &str> = chains
            .map(|chain| (chain.original.as_str(), chain.written.as_str()))
            .collect();
        rows(&molecule.atoms, move |atom| {
            let own = atom.chain.as_str();
            names.get(own).copied().unwrap_or(own)
        })
    };
    molecules.iter().enumerate().flat_map(of_molecule).collect()
}

fn rows<'a>(atoms: &'a [Atom], chain: impl Fn(&'a Atom) -> &'a str) -> Vec<Row<'a>> {
    let mut rows: Vec<Row<'a>> = atoms
        .iter()
        .map(|atom| Row {
            atom,
            chain: chain(atom),
            ends_chain: false,
        })
        .collect();
    for end in polymer_ends(atoms) {
        if let Some(row) = rows.get_mut(end) {
            row.ends_chain = true;
        }
    }
    rows
}

/// Indices of the last atoms of the chains' polymers: the last residue of ATOM records in each chain, and the modified
/// residues that follow it directly. What comes after (cofactors, metals, free amino acids) is not part of the polymer.
fn polymer_ends(atoms: &[Atom]) -> Vec<usize> {
    struct End {
        residue: usize,
        atom: usize,
    }
    let mut ends: Vec<End> = Vec::new();
    let mut places: HashMap<&str, usize> = HashMap::new();
    for (index, residue) in residues(atoms).iter().enumerate() {
        let is_polymer = matches!(
            residue.kind,
            GroupKind::AminoAcid | GroupKind::ModifiedResidue | GroupKind::Nucleotide
        );
        let (Some(&last), true) = (residue.atoms.iter().max(), is_polymer) else {
            continue;
        };
        let is_hetero = atoms.get(last).is_some_and(|atom| atom.hetero);
        let place = places.get(residue.key.0);
        match place.and_then(|&place| ends.get_mut(place)) {
            Some(end) if !is_hetero || end.residue + 1 == index => {
                end.residue = index;
                end.atom = last;
            }
            Some(_) => {}
            None => {
                places.insert(residue.key.0, ends.len());
                ends.push(End {
                    residue: index,
                    atom: last,
                });
            }
        }
    }
    ends.iter().map(|end| end.atom).collect()
}

fn write_rows<W: Write>(
    writer: &mut W,
    format: Format,
    rows: &[Row<'_>],
    remarks: &[String],
) -> Result<(), WriteError> {
    check(format, rows)?;
    match format {
        Format::Pdb => pdb::write(writer, rows, remarks),
        Format::Mmcif => mmcif::write(writer, rows, remarks),
    }
}

/// Whether a format can hold rows.
fn check(format: Format, rows: &[Row<'_>]) -> Result<(), WriteError> {
    for row in rows {
        let atom = row.atom;
        let numbers = [atom.occupancy, atom.b_factor];
        if !atom.position.iter().chain(&numbers).all(|n| n.is_finite()) {
            return Err(WriteError::NotFinite { atom: name(row) });
        }
    }
    match format {
        Format::Pdb => pdb::check(rows),
        Format::Mmcif => Ok(()),
    }
}
