//! Many complexes in one file, `ensemble.pdb` or `ensemble.cif`: one model per rank, for viewers that play them.

use crate::output::files::file_error;
use knotdock_structures::Error;
use std::path::Path;

use knotdock_structures::molecule::{Format, ModelWriter};

use crate::output::files::complexes::{PosedPair, format_of};
use crate::output::files::disk;
use crate::output::files::whole_file::write_new;
use crate::output::records::program::VERSION;

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
    let format = format_of(pairs, folder)?;
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
            match pair.placed(folder) {
                Ok(placed) => {
                    models.write(&placed.iter().collect::<Vec<_>>())?;
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
