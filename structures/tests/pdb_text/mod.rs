//! Atom records as text, for tests of the PDB reader.

use knotdock_structures::Error;
use knotdock_structures::molecule::{InputSpec, Molecule, ReadOptions, read};

/// An atom record: record name, atom name (4 columns), alternate location, residue, chain, number, insertion, x,
/// occupancy, element (2 columns).
#[derive(Clone)]
pub struct Line {
    pub record: &'static str,
    pub name: &'static str,
    pub alternate: char,
    pub residue: &'static str,
    pub chain: char,
    pub number: i64,
    pub insertion: char,
    pub x: f64,
    pub occupancy: f64,
    pub element: &'static str,
}

/// The alpha carbon of a glycine.
pub const ATOM: Line = Line {
    record: "ATOM",
    name: " CA ",
    alternate: ' ',
    residue: "GLY",
    chain: 'A',
    number: 1,
    insertion: ' ',
    x: 0.0,
    occupancy: 1.0,
    element: " C",
};

impl Line {
    /// An atom of one of the usual groups: record name, atom name in its four columns, residue and its number, element.
    pub fn of(
        record: &'static str,
        name: &'static str,
        residue: &'static str,
        number: i64,
        element: &'static str,
    ) -> Line {
        Line {
            record,
            name,
            residue,
            number,
            element,
            ..ATOM
        }
    }

    /// An atom at an alternate location: residue number, atom name, location, occupancy.
    pub fn at(number: i64, name: &'static str, alternate: char, occupancy: f64) -> Line {
        Line {
            number,
            name,
            alternate,
            occupancy,
            ..ATOM
        }
    }

    /// The same atom in another chain.
    pub fn in_chain(self, chain: char) -> Line {
        Line { chain, ..self }
    }

    /// The record with its line end.
    pub fn text(&self) -> String {
        format!(
            "{:<6}{:>5} {}{}{:>3} {}{:>4}{}   {:>8.3}{:>8.3}{:>8.3}{:>6.2}{:>6.2}          {:>2}  \n",
            self.record,
            1,
            self.name,
            self.alternate,
            self.residue,
            self.chain,
            self.number,
            self.insertion,
            self.x,
            1.0,
            2.0,
            self.occupancy,
            20.0,
            self.element
        )
    }
}

/// Records one after the other.
pub fn text(lines: &[Line]) -> String {
    lines.iter().map(Line::text).collect()
}

/// Reads bytes as a file of the given name; `chains` follows the name, as in `:H,L`.
pub fn read_bytes(name: &str, bytes: &[u8], chains: &str) -> Result<Molecule, Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let spec = InputSpec::parse(&format!("{}{chains}", path.display()))?;
    read(&spec, &ReadOptions::default())
}

/// Reads text as a PDB file.
pub fn read_text(text: &str) -> Result<Molecule, Error> {
    read_bytes("x.pdb", text.as_bytes(), "")
}

/// Atom names in order.
pub fn names(molecule: &Molecule) -> Vec<&str> {
    molecule
        .atoms
        .iter()
        .map(|atom| atom.name.as_str())
        .collect()
}
