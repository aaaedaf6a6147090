//! File formats of structures.

use serde::Serialize;

/// File format of a structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// The fixed-column wwPDB format, version 3.3.
    Pdb,
    /// PDBx/mmCIF.
    Mmcif,
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
