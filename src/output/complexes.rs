//! Complexes: the receptor as it was and the ligand in its place, one file a rank.

use std::io;
use std::path::Path;

use knotdock_structures::molecule::{
    ChainMap, Format, Molecule, WriteError, complex_format, write_complex,
};

use super::poses::PoseRow;
use super::program::VERSION;
use super::whole_file::{FileError, write_whole};

/// Complexes as written.
#[derive(Clone, Debug)]
pub struct Written {
    /// Names of the files, in the order of the rows.
    pub names: Vec<String>,
    /// Which chain of which input has which name in them; it is the same in all.
    pub chains: ChainMap,
}

/// Writes the complexes of `rows` into `folder` as `rank_0001.pdb` ...; as `.cif` when one of the inputs was mmCIF or a
/// complex does not fit the PDB format.
///
/// # Errors
/// [`FileError`] when the folder cannot be made or a file cannot be written.
pub fn write_complexes(
    receptor: &Molecule,
    ligand: &Molecule,
    rows: &[PoseRow],
    folder: &Path,
) -> Result<Written, FileError> {
    if !rows.is_empty() {
        std::fs::create_dir_all(folder).map_err(|source| FileError::unwritable(folder, source))?;
    }
    // Placed ligands are made twice, once to see whether they fit and once to be written: many at once may not fit
    // into the memory.
    let placed = |row: &PoseRow| ligand.map_positions(|position| row.pose.apply(position));
    let fits = rows
        .iter()
        .all(|row| complex_format(receptor, &placed(row)) == Format::Pdb);
    let format = match rows {
        [] => complex_format(receptor, ligand),
        _ if fits => Format::Pdb,
        _ => Format::Mmcif,
    };
    let mut chains = None;
    let mut names = Vec::new();
    for row in rows {
        let name = format!("rank_{:04}.{}", row.rank, format.extension());
        let ligand = placed(row);
        write_whole(&folder.join(&name), |mut file| {
            let map = write_complex(&mut file, format, receptor, &ligand, &remarks(row));
            chains = Some(map.map_err(io_error)?);
            Ok(())
        })?;
        names.push(name);
    }
    let chains = match chains {
        Some(chains) => chains,
        // No complex was asked for: the names are what they would have been.
        None => write_complex(&mut io::sink(), format, receptor, ligand, &[])
            .map_err(|error| FileError::writing(folder, io_error(error)))?,
    };
    Ok(Written { names, chains })
}

/// What a complex says of itself: where it comes from and how its ligand was moved.
fn remarks(row: &PoseRow) -> Vec<String> {
    let [w, x, y, z] = row.pose.quaternion();
    let t = row.pose.translation;
    vec![
        format!("knotdock {VERSION}, rank {}", row.rank),
        format!("ligand turned by (w x y z) {w:.6} {x:.6} {y:.6} {z:.6}"),
        format!("then moved by {:.3} {:.3} {:.3} A", t.x, t.y, t.z),
    ]
}

fn io_error(error: WriteError) -> io::Error {
    match error {
        WriteError::Io(error) => error,
        other => io::Error::other(other),
    }
}
