//! A structure as docked.

use crate::molecule::model::atom::Atom;
use crate::molecule::model::format::Format;
use crate::molecule::model::report::ReadReport;

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
