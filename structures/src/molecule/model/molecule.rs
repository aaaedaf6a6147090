//! A structure as docked.

use crate::molecule::model::atom::Atom;
use crate::molecule::model::format::Format;
use crate::molecule::model::report::ReadReport;
use crate::molecule::{InputSpec, ReadOptions, read};

/// A structure as docked: its kept atoms in file order.
#[derive(Clone, Debug, PartialEq)]
pub struct Molecule {
    /// Kept atoms, in file order.
    pub atoms: Vec<Atom>,
    /// The format that the file had.
    pub format: Format,
    /// Report on reading the file: what was kept, dropped and altered, and the warnings. Empty for a molecule made in
    /// memory.
    pub report: ReadReport,
    /// Lines at which the file itself ends a chain, rising: of TER, MODEL, ENDMDL and END records, and in mmCIF the
    /// first line of another `label_asym_id` under the same author's name. Atoms on both sides of such a line are of
    /// two chains even where their chain names are equal.
    pub chain_breaks: Vec<usize>,
}

impl Molecule {
    /// Reads `FILE` (PDB or mmCIF, also gzip-compressed) or `FILE:H,L`, which picks chains, with the default options:
    /// see [`crate::molecule::read`].
    ///
    /// ```
    /// use knotdock_structures::molecule::Molecule;
    ///
    /// # let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    /// let molecule = Molecule::read(&format!("{folder}/1ppe_ligand_unbound.pdb"))?;
    /// assert_eq!(molecule.atoms.len(), 221);
    /// # Ok::<(), knotdock_structures::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error`](crate::Error) for a file that cannot be read.
    pub fn read(file: &str) -> Result<Self, crate::Error> {
        Self::read_with(file, &ReadOptions::default())
    }

    /// As [`Self::read`], with options.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_with(file: &str, options: &ReadOptions) -> Result<Self, crate::Error> {
        Ok(read(&InputSpec::parse(file)?, options)?)
    }

    /// A molecule made in memory, with an empty report.
    pub fn new(atoms: Vec<Atom>, format: Format) -> Self {
        Self {
            atoms,
            format,
            report: ReadReport::default(),
            chain_breaks: Vec::new(),
        }
    }

    /// The molecule with every position x (Å) moved to `map(x)`, e.g. a ligand placed by a pose.
    #[must_use]
    pub fn map_positions(&self, map: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let mut moved = self.clone();
        for atom in &mut moved.atoms {
            atom.position = map(atom.position);
        }
        moved
    }

    /// The atoms as knots of unit weight and united-atom radius, in the file's frame (Å).
    ///
    /// # Errors
    /// [`crate::knots::KnotsError`] when there is no atom or a number is not usable.
    pub fn knots(&self) -> Result<crate::Knots, crate::knots::KnotsError> {
        crate::Knots::new(
            self.atoms.iter().map(|atom| atom.position).collect(),
            self.atoms.iter().map(|atom| atom.radius).collect(),
        )
    }
}
