//! Errors of writing structures.

use std::io;

/// Why a molecule could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The file system refused.
    #[error("the structure cannot be written: {0}")]
    Io(#[from] io::Error),
    /// PDB was requested, and its columns cannot hold this. mmCIF can.
    #[error("this does not fit the PDB format: {what}; write mmCIF instead")]
    DoesNotFit {
        /// The value that does not fit.
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
