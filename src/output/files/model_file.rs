//! Many complexes in one file, `ensemble.pdb` or `ensemble.cif`: one model per rank, for viewers that play them.

use crate::output::files::file_error;
use knotdock_structures::Error;
use std::path::Path;

use knotdock_structures::molecule::{Format, ModelWriter, Molecule, complex_format};

use crate::output::files::complexes::{placed_copies, with};
use crate::output::files::disk;
use crate::output::files::whole_file::write_new;
use crate::output::records::program::VERSION;
use crate::output::tables::poses::PoseRow;
use crate::pose_space::arrangement::Arrangement;

/// A pose with its molecules.
#[derive(Clone, Copy)]
pub struct PosedPair<'a> {
    /// Receptor and ligand.
    pub molecules: [&'a Molecule; 2],
    /// Their arrangement.
    pub arrangement: Arrangement,
    /// The pose.
    pub row: PoseRow,
}

/// Name of the file in a format.
pub fn model_file_name(format: Format) -> String {
    format!("ensemble.{}", format.extension())
}

/// Writes complexes into a staging folder as the models of one file, in the order given; as mmCIF if one of the
/// inputs was mmCIF or a complex does not fit the PDB format. Returns the file's name.
///
/// # Errors
/// [`Error`] when the file cannot be written, or a row's pose is not one of such a ring.
pub fn write_model_file(pairs: &[PosedPair], folder: &Path) -> Result<String, Error> {
    let complex =
        |pair: &PosedPair| placed_copies(pair.molecules[1], pair.arrangement, &pair.row, folder);
    // Placed molecules are made twice: all at once may not fit into the memory.
    let mut format = Format::Pdb;
    for pair in pairs {
        if complex_format(&with(pair.molecules[0], &complex(pair)?)) != Format::Pdb {
            format = Format::Mmcif;
            break;
        }
    }
    let name = model_file_name(format);
    let path = folder.join(&name);
    disk::create_dir_all(folder).map_err(|source| file_error::unwritable(folder, source))?;
    let mut remarks = vec![format!("knotdock {VERSION}")];
    let numbered = pairs.iter().zip(1..);
    remarks.extend(numbered.map(|(pair, at)| format!("model {at} is rank {}", pair.row.rank)));
    let mut failed = None;
    let written = write_new(&path, |mut file| {
        let mut models = ModelWriter::new(&mut file, format, remarks);
        for pair in pairs {
            match complex(pair) {
                Ok(others) => {
                    models.write(&with(pair.molecules[0], &others))?;
                }
                Err(error) => {
                    failed = Some(error);
                    break;
                }
            }
        }
        models.finish()
    });
    written.map_err(|source| file_error::writing(&path, source))?;
    failed.map_or(Ok(name), Err)
}
