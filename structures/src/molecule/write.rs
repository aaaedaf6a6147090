//! Writing molecules and complexes, as PDB or mmCIF.
//!
//! Atoms keep their order, names, residue numbers, insertion codes, elements, occupancies and temperature factors. A complex
//! gets unique chain names: a chain keeps its name unless a chain before it (receptor first) has it, or PDB's single column
//! cannot hold it. The map stands in the file's remarks and is returned.

mod chains;
mod mmcif;
mod pdb;

use std::io::{self, Write};

pub use chains::{ChainMap, ChainName, Partner};

use super::groups::{GroupKind, residues};
use super::report::show_chain;
use super::{Atom, Format, Molecule};

/// Why a molecule could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The file system refused.
    #[error("the structure cannot be written: {0}")]
    Io(#[from] io::Error),
    /// PDB was asked for, and its columns cannot hold this. mmCIF can.
    #[error("this does not fit the PDB format: {what}; write mmCIF instead")]
    DoesNotFit {
        /// What does not fit.
        what: String,
    },
    /// A coordinate, occupancy or temperature factor is NaN or infinite.
    #[error("atom {atom} has a number that is not finite")]
    NotFinite {
        /// Name, residue and chain of the atom.
        atom: String,
    },
    /// A name cannot stand in an mmCIF file: it has both kinds of quotes, a line end, or characters beyond ASCII.
    #[error("'{text}' cannot be written as an mmCIF value")]
    Unwritable {
        /// The name.
        text: String,
    },
}

impl Format {
    /// The usual file name extension, without a dot.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Pdb => "pdb",
            Self::Mmcif => "cif",
        }
    }
}

/// An atom under the name that its chain has in the file.
struct Row<'a> {
    atom: &'a Atom,
    chain: &'a str,
    /// The chain's polymer ends with this atom.
    ends_chain: bool,
}

/// The format that a complex is written in: PDB when all partners came as PDB and it fits the columns (at most 99,999
/// atoms and 62 chains, coordinates from -999.999 to 9999.999 Å), mmCIF otherwise.
pub fn complex_format(molecules: &[&Molecule]) -> Format {
    if molecules.iter().any(|one| one.format != Format::Pdb) {
        return Format::Mmcif;
    }
    let fits = ChainMap::assign(Format::Pdb, molecules)
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
    let map = ChainMap::assign(format, molecules)?;
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

/// Writes one molecule; of chains whose names the format cannot hold, such as `A-2` in PDB, the remarks say what they are called instead.
///
/// # Errors
/// As [`write_complex`].
pub fn write_renamed<W: Write>(
    writer: &mut W,
    format: Format,
    molecule: &Molecule,
    remarks: &[String],
) -> Result<(), WriteError> {
    let map = ChainMap::assign(format, &[molecule])?;
    let renamed = map
        .chains
        .iter()
        .filter(|chain| chain.written != chain.original);
    let told = renamed.map(|chain| {
        format!(
            "chain {} was {}",
            chain.written,
            show_chain(&chain.original)
        )
    });
    let remarks: Vec<String> = remarks.iter().cloned().chain(told).collect();
    write_rows(writer, format, &complex_rows(&[molecule], &map), &remarks)
}

/// Whether a format holds a molecule as [`write_renamed`] writes it.
///
/// # Errors
/// [`WriteError::DoesNotFit`] with what does not.
pub fn fits(format: Format, molecule: &Molecule) -> Result<(), WriteError> {
    let map = ChainMap::assign(format, &[molecule])?;
    match format {
        Format::Pdb => pdb::check(&complex_rows(&[molecule], &map)),
        Format::Mmcif => Ok(()),
    }
}

fn complex_rows<'a>(molecules: &[&'a Molecule], map: &'a ChainMap) -> Vec<Row<'a>> {
    let of_molecule = |(place, molecule): (usize, &&'a Molecule)| {
        rows(&molecule.atoms, move |atom| {
            map.written(Partner::at(place), &atom.chain)
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
    for end in chain_ends(atoms) {
        if let Some(row) = rows.get_mut(end) {
            row.ends_chain = true;
        }
    }
    rows
}

/// Indices of the last atoms of the chains' polymers: the last residue of ATOM records in each chain, and the modified
/// residues that follow it directly. What comes after (cofactors, metals, free amino acids) is not part of the polymer.
fn chain_ends(atoms: &[Atom]) -> Vec<usize> {
    struct End<'a> {
        chain: &'a str,
        residue: usize,
        atom: usize,
    }
    let mut ends: Vec<End<'_>> = Vec::new();
    for (index, residue) in residues(atoms).iter().enumerate() {
        let is_polymer = matches!(
            residue.kind,
            GroupKind::AminoAcid | GroupKind::ModifiedResidue | GroupKind::Nucleotide
        );
        let (Some(&last), true) = (residue.atoms.iter().max(), is_polymer) else {
            continue;
        };
        let is_hetero = atoms.get(last).is_some_and(|atom| atom.hetero);
        match ends.iter_mut().find(|end| end.chain == residue.key.0) {
            Some(end) if !is_hetero || end.residue + 1 == index => {
                end.residue = index;
                end.atom = last;
            }
            Some(_) => {}
            None => ends.push(End {
                chain: residue.key.0,
                residue: index,
                atom: last,
            }),
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
    for row in rows {
        let atom = row.atom;
        let numbers = [atom.occupancy, atom.b_factor];
        if !atom.position.iter().chain(&numbers).all(|n| n.is_finite()) {
            return Err(WriteError::NotFinite { atom: name(row) });
        }
    }
    match format {
        Format::Pdb => {
            pdb::check(rows)?;
            pdb::write(writer, rows, remarks)
        }
        Format::Mmcif => mmcif::write(writer, rows, remarks),
    }
}

/// An atom as named in messages.
fn name(row: &Row<'_>) -> String {
    let atom = row.atom;
    format!(
        "{} of {} {}{}",
        atom.name, atom.residue_name, row.chain, atom.residue_number
    )
}

/// A number rounded to so many thousandths or hundredths, without the sign that a rounded-off zero would keep.
fn rounded(value: f64, per_unit: f64) -> f64 {
    let value = (value * per_unit).round() / per_unit;
    if value == 0.0 { 0.0 } else { value }
}

/// Free text in printable ASCII, on one line: both formats allow no more.
fn plain(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            c if c.is_ascii_graphic() => c,
            c if c.is_whitespace() => ' ',
            _ => '?',
        })
        .collect()
}
