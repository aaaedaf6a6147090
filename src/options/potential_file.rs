//! Files of potentials that options name.

use std::path::{Path, PathBuf};

use crate::bounded_read::{MAX_TABLE, read_bounded_text};
use knotdock_scoring::terms::effect::contact::Potential;
use knotdock_scoring::terms::pose::{AtomPairPotential, DistanceBinnedPotential};
use knotdock_structures::Error;

/// Why the potential that an option names cannot be used.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{message}")]
pub struct PotentialFileError {
    /// The file.
    pub path: PathBuf,
    /// 1-based line, where one is at fault.
    pub line: Option<u64>,
    /// The fault, in words.
    pub message: String,
    /// Remedy for the user.
    pub remedy: String,
}

/// The contact potential of a file.
pub(super) fn contact(path: &str) -> Result<Potential, PotentialFileError> {
    read(path, "contact_potential.py", Potential::parse)
}

/// The fine contact potential of a file.
pub(super) fn fine_contact(path: &str) -> Result<DistanceBinnedPotential, PotentialFileError> {
    read(
        path,
        "contact_potential.py --fine",
        DistanceBinnedPotential::parse,
    )
}

/// The atom pair potential of a file.
pub(super) fn atom_pair(path: &str) -> Result<AtomPairPotential, PotentialFileError> {
    read(path, "atom_pair_potential.py", AtomPairPotential::parse)
}

/// The table in a file; `script` writes such tables.
fn read<P>(
    path: &str,
    script: &str,
    parse: fn(&str) -> Result<P, Error>,
) -> Result<P, PotentialFileError> {
    let wrong = |line, message| PotentialFileError {
        path: Path::new(path).to_owned(),
        line,
        message,
        remedy: format!("give a table as scripts/{script} writes it, or leave the option out"),
    };
    let text = read_bounded_text(Path::new(path), MAX_TABLE).map_err(|error| {
        wrong(
            None,
            format!("the table of energies cannot be read: {error}"),
        )
    })?;
    parse(&text).map_err(|error| wrong(error.line(), error.to_string()))
}
