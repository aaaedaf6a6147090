//! A molecule as it was read, written as a structure file of its own.

use knotdock_structures::Error;
use std::path::Path;

use knotdock_structures::molecule::{Format, Molecule, write_renamed};

use crate::output::files::whole_file::write_whole;
use crate::output::records::program::VERSION;

/// The format of a file's name: `.pdb` or `.ent`, `.cif` or `.mmcif`; `None` for other endings.
pub fn format_of_name(path: &Path) -> Option<Format> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    match ending.as_str() {
        "pdb" | "ent" => Some(Format::Pdb),
        "cif" | "mmcif" => Some(Format::Mmcif),
        _ => None,
    }
}

/// Writes the atoms that were kept, whole or not at all. Chains keep their names if the format can hold them.
pub fn write(path: &Path, format: Format, molecule: &Molecule) -> Result<(), Error> {
    let remark = format!(
        "knotdock {VERSION}, what was read of {}",
        molecule.report.file
    );
    write_whole(path, |mut file| {
        write_renamed(&mut file, format, molecule, &[remark])
    })
}
