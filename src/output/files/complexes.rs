//! Complexes: the receptor as it was and the ligand in its place, one file per rank; for rings, all copies.

use crate::output::files::file_error;
use knotdock_structures::Error;
use std::io;
use std::path::Path;

use knotdock_scoring::se3::Pose;
use knotdock_structures::molecule::{
    ChainMap, Format, Molecule, complex_format, write_complex, write_renamed,
};

use crate::output::files::disk;
use crate::output::files::whole_file::{write_new, write_whole};
use crate::output::records::program::VERSION;
use crate::output::tables::poses::PoseRow;
use crate::pose_space::arrangement::Arrangement;

/// A complex of a run.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Complex {
    /// Its format: PDB, or mmCIF for inputs in it and for complexes that do not fit into PDB.
    pub format: Format,
    /// Its file as text.
    pub text: String,
}

/// The complex of a row; of a ring all copies.
///
/// # Errors
/// [`Error`] for a row whose pose is not one of such a ring.
pub fn complex(
    [receptor, ligand]: [&Molecule; 2],
    arrangement: Arrangement,
    row: &PoseRow,
) -> Result<Complex, Error> {
    let others = placed_copies(ligand, arrangement, row, Path::new(""))?;
    let molecules = with(receptor, &others);
    let format = complex_format(&molecules);
    let mut text = Vec::new();
    let remarks = remarks(row, arrangement, "");
    write_complex(&mut text, format, &molecules, &remarks).map_err(Error::machine)?;
    Ok(Complex {
        format,
        text: String::from_utf8(text).map_err(Error::machine)?,
    })
}

/// Bodies as written.
#[derive(Clone, Debug)]
pub struct WrittenBodies {
    /// Names of the files, in the order of the rows.
    pub names: Vec<String>,
    /// Which chain of which input has which name in the complexes, which is the same in all; `None` for solids.
    pub chains: Option<ChainMap>,
}

/// Name of the file that shows the complex, or of meshes the assembly, of a rank.
pub(crate) fn file_name(rank: usize, extension: &str) -> String {
    format!("rank_{rank:04}.{extension}")
}

/// All names that it may have: as PDB, as mmCIF, and of meshes.
pub fn file_names(rank: usize) -> [String; 3] {
    ["pdb", "cif", "obj"].map(|extension| file_name(rank, extension))
}

/// Writes the complexes of `rows` into a staging folder as `rank_0001.pdb` ... They are `.cif` when one of the inputs
/// was mmCIF or a complex does not fit the PDB format, or of the format that is `wanted`. For a ring all copies are
/// written. `note` follows the rank in the remarks.
///
/// # Errors
/// [`Error`] when the folder cannot be made, a file is there or cannot be written, or a row's pose is not one of
/// such a ring.
pub fn write_complexes(
    [receptor, ligand]: [&Molecule; 2],
    arrangement: Arrangement,
    rows: &[PoseRow],
    note: &str,
    (folder, wanted): (&Path, Option<Format>),
) -> Result<WrittenBodies, Error> {
    if !rows.is_empty() {
        disk::create_dir_all(folder).map_err(|source| file_error::unwritable(folder, source))?;
    }
    let placed = |row: &PoseRow| placed_copies(ligand, arrangement, row, folder);
    // Placed molecules are made twice, for their format and for the file: all at once may not fit into the memory.
    let mut fits = true;
    for row in rows {
        fits &= complex_format(&with(receptor, &placed(row)?)) == Format::Pdb;
    }
    // Without complexes the names of chains are those that they would have.
    let unplaced = || vec![ligand.clone(); arrangement.placed()];
    let format = match rows {
        [] => complex_format(&with(receptor, &unplaced())),
        _ if fits => Format::Pdb,
        _ => Format::Mmcif,
    };
    let format = wanted.unwrap_or(format);
    let mut chains = None;
    let mut names = Vec::new();
    for row in rows {
        let name = file_name(row.rank, format.extension());
        let others = placed(row)?;
        let remarks = remarks(row, arrangement, note);
        let path = folder.join(&name);
        let written = write_new(&path, |mut file| {
            let map = write_complex(&mut file, format, &with(receptor, &others), &remarks);
            chains = Some(map?);
            Ok(())
        });
        written.map_err(|source| file_error::writing(&path, source))?;
        names.push(name);
    }
    if chains.is_none() {
        let map = write_complex(&mut io::sink(), format, &with(receptor, &unplaced()), &[]);
        chains = Some(map.map_err(|error| file_error::writing(folder, error))?);
    }
    Ok(WrittenBodies { names, chains })
}

/// The molecules that a pose places about the receptor: the ligand, or all copies of a ring but the receptor.
///
/// # Errors
/// [`Error`] if the pose is not one of such a ring.
pub(crate) fn placed_copies(
    ligand: &Molecule,
    arrangement: Arrangement,
    row: &PoseRow,
    folder: &Path,
) -> Result<Vec<Molecule>, Error> {
    let poses = arrangement.images(&row.pose).ok_or_else(|| {
        let (rank, suffix) = (row.rank, arrangement.suffix());
        let error = io::Error::other(format!("the pose of rank {rank} forms no ring{suffix}"));
        file_error::writing(folder, error)
    })?;
    let moved = |pose: &Pose| ligand.map_positions(|position| pose.apply(position));
    Ok(poses.iter().map(moved).collect())
}

/// The molecules of a complex: the receptor, and those placed about it.
pub(crate) fn with<'a>(receptor: &'a Molecule, others: &'a [Molecule]) -> Vec<&'a Molecule> {
    std::iter::once(receptor).chain(others).collect()
}

/// Remarks of a complex: its origin, and how its ligand, or each copy of a ring from the one before it, was moved.
fn remarks(row: &PoseRow, arrangement: Arrangement, note: &str) -> Vec<String> {
    let [w, x, y, z] = row.pose.quaternion();
    let t = row.pose.translation;
    let rank = format!("rank {}{}{note}", row.rank, arrangement.suffix());
    let moved = match arrangement.moved() {
        "copy" => "each copy",
        other => other,
    };
    vec![
        format!("knotdock {VERSION}, {rank}"),
        format!("{moved} turned by (w x y z) {w:.6} {x:.6} {y:.6} {z:.6}"),
        format!("then moved by {:.3} {:.3} {:.3} A", t.x, t.y, t.z),
    ]
}

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
pub fn write_kept_atoms(path: &Path, format: Format, molecule: &Molecule) -> Result<(), Error> {
    let remark = format!(
        "knotdock {VERSION}, what was read of {}",
        molecule.report.file
    );
    write_whole(path, |mut file| {
        write_renamed(&mut file, format, molecule, &[remark])
    })
}
