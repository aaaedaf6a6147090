//! Writing molecules and complexes, as PDB or mmCIF.
//!
//! Atoms keep their order, names, residue numbers, insertion codes, elements, occupancies and temperature factors. A
//! complex gets unique chain names: a chain keeps its name unless a chain before it (receptor first) has it, PDB's single
//! column cannot hold it, or it has other characters than letters and digits. The map is written in the file's remarks
//! and returned.
//!
//! Errors of the writer itself are returned as they are. What a format cannot hold is an [`Error`] within
//! [`io::Error::other`].

pub(crate) mod chains;
mod mmcif;
mod pdb;

use std::collections::HashMap;
use std::io::{self, Write};

pub use crate::molecule::write::chains::{ChainMap, ChainName, Partner};

use crate::Error;
use crate::molecule::model::{Atom, Format, GroupKind, Molecule, residues, show_chain};

/// An atom under the name that its chain has in the file.
struct Row<'a> {
    atom: &'a Atom,
    chain: &'a str,
    /// The chain's polymer ends with this atom.
    ends_chain: bool,
}

impl Row<'_> {
    /// The atom as named in messages.
    fn name(&self) -> String {
        let Atom {
            name,
            residue_name,
            residue_number,
            ..
        } = self.atom;
        format!("{name} of {residue_name} {}{residue_number}", self.chain)
    }
}

/// A number rounded to a multiple of 1 / `per_unit`, without the sign that a rounded-off zero would keep.
fn rounded(value: f64, per_unit: f64) -> f64 {
    let value = (value * per_unit).round() / per_unit;
    if value == 0.0 { 0.0 } else { value }
}

/// Free text in printable ASCII, on one line: both formats allow no more.
fn plain(text: &str) -> String {
    let letter = |c: char| match c {
        c if c.is_ascii_graphic() => c,
        c if c.is_whitespace() => ' ',
        _ => '?',
    };
    text.chars().map(letter).collect()
}

/// The format that a complex is written in: PDB when all partners came as PDB and it fits the columns (at most 99,999
/// atoms and 62 chains, coordinates from -999.999 to 9999.999 Å), mmCIF otherwise.
pub fn complex_format(molecules: &[&Molecule]) -> Format {
    let fits_pdb = || {
        let map = ChainMap::of_complex(Format::Pdb, molecules);
        map.and_then(|map| pdb::check(&complex_rows(molecules, &map)))
            .is_ok()
    };
    if molecules.iter().all(|one| one.format == Format::Pdb) && fits_pdb() {
        Format::Pdb
    } else {
        Format::Mmcif
    }
}

/// Writes receptor and already placed ligand, and of a ring its further copies, as one structure.
///
/// `remarks` are free lines; the chain map is added to them. Use [`complex_format`] to choose the format.
///
/// # Errors
/// The writer fails, a number is not finite, or the format cannot hold the complex.
pub fn write_complex<W: Write>(
    writer: &mut W,
    format: Format,
    molecules: &[&Molecule],
    remarks: &[String],
) -> io::Result<ChainMap> {
    let map = ChainMap::of_complex(format, molecules).map_err(io::Error::other)?;
    let remarks = [remarks, &map.remarks()].concat();
    write_rows(writer, format, &complex_rows(molecules, &map), &remarks)?;
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
) -> io::Result<()> {
    let rows = rows(&molecule.atoms, |atom| &atom.chain);
    write_rows(writer, format, &rows, remarks)
}

/// Writes one molecule. Chains whose names the format cannot hold, such as `A-2` in PDB, get others, which the remarks
/// list.
///
/// # Errors
/// As [`write_complex`].
pub fn write_renamed<W: Write>(
    writer: &mut W,
    format: Format,
    molecule: &Molecule,
    remarks: &[String],
) -> io::Result<()> {
    let map = ChainMap::of_molecule(format, molecule).map_err(io::Error::other)?;
    let renamed = map
        .chains
        .iter()
        .filter(|chain| chain.written != chain.original);
    let note = |chain: &ChainName| {
        format!(
            "chain {} was {}",
            chain.written,
            show_chain(&chain.original)
        )
    };
    let remarks = [remarks, &renamed.map(note).collect::<Vec<_>>()].concat();
    write_rows(writer, format, &complex_rows(&[molecule], &map), &remarks)
}

/// Whether a format holds a molecule as [`write_renamed`] writes it.
///
/// # Errors
/// What does not fit.
pub fn fits(format: Format, molecule: &Molecule) -> Result<(), Error> {
    let map = ChainMap::of_molecule(format, molecule)?;
    match format {
        Format::Pdb => pdb::check(&complex_rows(&[molecule], &map)),
        Format::Mmcif => Ok(()),
    }
}

/// The error of a value that the columns of PDB cannot hold; mmCIF can.
fn does_not_fit(what: &str) -> Error {
    Error::input(format!(
        "this does not fit the PDB format: {what}; write mmCIF instead"
    ))
    .help("write mmCIF instead")
}

fn complex_rows<'a>(molecules: &[&'a Molecule], map: &'a ChainMap) -> Vec<Row<'a>> {
    let of_molecule = |(place, molecule): (usize, &&'a Molecule)| {
        let partner = Partner::at(place);
        let chains = map.chains.iter().filter(|chain| chain.partner == partner);
        let names = chains.map(|chain| (chain.original.as_str(), chain.written.as_str()));
        let names: HashMap<&str, &str> = names.collect();
        rows(&molecule.atoms, move |atom| {
            let own = atom.chain.as_str();
            names.get(own).copied().unwrap_or(own)
        })
    };
    molecules.iter().enumerate().flat_map(of_molecule).collect()
}

/// The atoms of a molecule as rows.
///
/// A chain's polymer ends with its last residue of ATOM records and the modified residues that follow that directly. What
/// comes after (cofactors, metals, free amino acids) is not part of it.
fn rows<'a>(atoms: &'a [Atom], chain: impl Fn(&'a Atom) -> &'a str) -> Vec<Row<'a>> {
    let row = |atom| Row {
        atom,
        chain: chain(atom),
        ends_chain: false,
    };
    let mut rows: Vec<Row<'a>> = atoms.iter().map(row).collect();
    // By chain: the last residue of its polymer, and the last atom of that.
    let mut ends: HashMap<&str, [usize; 2]> = HashMap::new();
    for (index, residue) in residues(atoms).iter().enumerate() {
        let is_polymer = residue.is_peptide() || residue.kind == GroupKind::Nucleotide;
        let Some(&last) = residue.atoms.iter().max().filter(|_| is_polymer) else {
            continue;
        };
        let chain = residue.key.chain;
        let follows = |end: &[usize; 2]| !atoms[last].hetero || end[0] + 1 == index;
        if ends.get(chain).is_none_or(follows) {
            ends.insert(chain, [index, last]);
        }
    }
    for [_, atom] in ends.into_values() {
        rows[atom].ends_chain = true;
    }
    rows
}

fn write_rows<W: Write>(
    writer: &mut W,
    format: Format,
    rows: &[Row<'_>],
    remarks: &[String],
) -> io::Result<()> {
    check(format, rows).map_err(io::Error::other)?;
    match format {
        Format::Pdb => {
            pdb::write_head(writer, remarks)?;
            pdb::write_atoms(writer, rows)?;
            pdb::write_end(writer)
        }
        Format::Mmcif => {
            mmcif::write_head(writer, remarks)?;
            mmcif::write_model(writer, rows, 1, 0)?;
            mmcif::write_end(writer)
        }
    }
}

fn check(format: Format, rows: &[Row<'_>]) -> Result<(), Error> {
    for row in rows {
        let atom = row.atom;
        let numbers = [atom.occupancy, atom.b_factor];
        if !atom.position.iter().chain(&numbers).all(|n| n.is_finite()) {
            let message = format!("atom {} has a number that is not finite", row.name());
            return Err(Error::input(message));
        }
    }
    match format {
        Format::Pdb => pdb::check(rows),
        Format::Mmcif => Ok(()),
    }
}

/// A file of many complexes, one model after another.
///
/// The chains of each model are named as those of a complex by itself ([`write_complex`]).
pub struct ModelWriter<'a, W: Write> {
    writer: &'a mut W,
    format: Format,
    /// Remarks of the head, until it is written with the first model.
    remarks: Option<Vec<String>>,
    models: usize,
    atoms: usize,
}

impl<'a, W: Write> ModelWriter<'a, W> {
    /// Begins a file with free remarks; those on the chains of the first model follow.
    pub fn new(writer: &'a mut W, format: Format, remarks: Vec<String>) -> Self {
        Self {
            writer,
            format,
            remarks: Some(remarks),
            models: 0,
            atoms: 0,
        }
    }

    fn write_head(&mut self, chains: &[String]) -> io::Result<()> {
        let Some(remarks) = self.remarks.take() else {
            return Ok(());
        };
        let remarks = [&remarks, chains].concat();
        match self.format {
            Format::Pdb => pdb::write_head(self.writer, &remarks),
            Format::Mmcif => mmcif::write_head(self.writer, &remarks),
        }
    }

    /// Writes receptor and placed molecules as the next model; models are counted from 1.
    ///
    /// # Errors
    /// The writer fails, a number is not finite, or the format cannot hold the complex.
    pub fn write(&mut self, molecules: &[&Molecule]) -> io::Result<ChainMap> {
        let map = ChainMap::of_complex(self.format, molecules).map_err(io::Error::other)?;
        let rows = complex_rows(molecules, &map);
        check(self.format, &rows).map_err(io::Error::other)?;
        self.write_head(&map.remarks())?;
        self.models += 1;
        match self.format {
            Format::Pdb => pdb::write_model(self.writer, &rows, self.models)?,
            Format::Mmcif => mmcif::write_model(self.writer, &rows, self.models, self.atoms)?,
        }
        self.atoms += rows.len();
        Ok(map)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// The writer fails.
    pub fn finish(mut self) -> io::Result<()> {
        self.write_head(&[])?;
        match self.format {
            Format::Pdb => pdb::write_end(self.writer),
            Format::Mmcif => mmcif::write_end(self.writer),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::read::{ModelChoice, ReadOptions};
    use crate::molecule::{InputSpec, model_count, read_bytes};

    /// Each model reads back as the complex that was written, in either format.
    #[test]
    fn models_read_back() {
        let text =
            "ATOM      1  CA  ALA A   1       1.000   2.000   3.000  1.00 10.00           C\n";
        let spec = InputSpec::whole("x.pdb");
        let one = read_bytes(&spec, text.into(), &ReadOptions::default()).unwrap();
        let moved = |x: f64| one.map_positions(|[a, b, c]| [a + x, b, c]);
        for (format, name) in [(Format::Pdb, "x.pdb"), (Format::Mmcif, "x.cif")] {
            let mut bytes = Vec::new();
            let remarks = vec!["a remark".to_owned()];
            let mut models = ModelWriter::new(&mut bytes, format, remarks);
            for x in [10.0, 20.0, 30.0] {
                let map = models.write(&[&one, &moved(x)]).unwrap();
                assert_eq!(map.chains.len(), 2);
            }
            models.finish().unwrap();
            let text = String::from_utf8_lossy(&bytes);
            assert_eq!(text.matches("chain B is ligand chain A").count(), 1);
            assert_eq!(model_count(name.as_ref(), bytes.clone()).unwrap(), 3);
            for (number, x) in [(1, 11.0), (2, 21.0), (3, 31.0)] {
                let options = ReadOptions {
                    model: ModelChoice::Number(number),
                    ..ReadOptions::default()
                };
                let read = read_bytes(&InputSpec::whole(name), bytes.clone(), &options).unwrap();
                let found: Vec<f64> = read.atoms.iter().map(|atom| atom.position[0]).collect();
                assert_eq!(found, [1.0, x], "{name}");
            }
        }
    }
}
