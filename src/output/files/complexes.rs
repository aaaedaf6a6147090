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
use crate::refine::Refined;
use rayon::prelude::*;

/// A complex of a run.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Complex {
    /// Its format: PDB, or mmCIF for inputs in it and for complexes that do not fit into PDB.
    pub format: Format,
    /// Its file as text.
    pub text: String,
}

/// A complex as text; of a ring all copies.
///
/// # Errors
/// [`Error`] for a row whose pose is not one of such a ring.
pub fn complex(pair: &PosedPair) -> Result<Complex, Error> {
    let folder = Path::new("");
    let format = format_of(std::slice::from_ref(pair), folder)?;
    let (text, _) = pair.text(format, folder)?;
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

/// A pose with its molecules, as it was searched or refined.
#[derive(Clone, Copy)]
pub struct PosedPair<'a> {
    /// Receptor and ligand.
    pub molecules: [&'a Molecule; 2],
    /// Their arrangement.
    pub arrangement: Arrangement,
    /// The pose as it was searched.
    pub row: PoseRow,
    /// The refined pose that is written in its place; of a pair, not of a ring.
    pub refined: Option<&'a Refined>,
}

impl<'a> PosedPair<'a> {
    /// The poses of rows, with what they were refined to, if they were.
    pub fn of(
        (molecules, arrangement): ([&'a Molecule; 2], Arrangement),
        (rows, refined): (&[PoseRow], &'a [Refined]),
    ) -> Vec<Self> {
        let pair = |(index, row): (usize, &PoseRow)| Self {
            molecules,
            arrangement,
            row: *row,
            refined: refined.get(index),
        };
        rows.iter().enumerate().map(pair).collect()
    }

    /// The receptor, and what is placed about it.
    ///
    /// # Errors
    /// [`Error`] if the pose is not one of such a ring.
    pub(crate) fn placed(&self, folder: &Path) -> Result<Vec<Molecule>, Error> {
        let [receptor, ligand] = [0, 1].map(|side| match self.refined {
            Some(refined) => refined.molecule(side, self.molecules[side]),
            None => self.molecules[side].clone(),
        });
        let mut placed = placed_copies(&ligand, self.arrangement, &self.written_row(), folder)?;
        placed.insert(0, receptor);
        Ok(placed)
    }

    /// The complex as it is written to a file, and the names of its chains.
    fn text(&self, format: Format, path: &Path) -> Result<(Vec<u8>, ChainMap), Error> {
        let placed = self.placed(path)?;
        let placed: Vec<&Molecule> = placed.iter().collect();
        let mut text = Vec::new();
        let chains = write_complex(&mut text, format, &placed, &self.remarks());
        let chains = chains.map_err(|source| file_error::writing(path, source))?;
        Ok((text, chains))
    }

    /// The row with the pose that is written.
    fn written_row(&self) -> PoseRow {
        PoseRow {
            pose: self.refined.map_or(self.row.pose, |refined| refined.pose),
            ..self.row
        }
    }

    fn remarks(&self) -> Vec<String> {
        let refined = self.refined.map_or("", |_| ", refined");
        let mut remarks = remarks(&self.written_row(), self.arrangement, refined);
        if self.refined.is_some_and(Refined::has_moved_atoms) {
            remarks.push("side chains packed and atoms at the interface moved apart".to_owned());
        }
        remarks
    }
}

/// Writes complexes into a staging folder as `rank_0001.pdb` ... They are `.cif` when one of the inputs was mmCIF or a
/// complex does not fit the PDB format, or of the format that is `wanted`. For a ring all copies are written. Without
/// complexes the names of chains are those that they would have of `molecules`.
///
/// # Errors
/// [`Error`] when the folder cannot be made, a file is there or cannot be written, or a row's pose is not one of
/// such a ring.
pub fn write_complexes(
    (molecules, arrangement): ([&Molecule; 2], Arrangement),
    pairs: &[PosedPair],
    (folder, wanted): (&Path, Option<Format>),
) -> Result<WrittenBodies, Error> {
    if !pairs.is_empty() {
        disk::create_dir_all(folder).map_err(|source| file_error::unwritable(folder, source))?;
    }
    let [receptor, ligand] = molecules;
    // Without complexes the names of chains are those that they would have.
    let unplaced = vec![ligand; arrangement.placed()];
    let unplaced: Vec<&Molecule> = std::iter::once(receptor).chain(unplaced).collect();
    let format = match wanted {
        Some(format) => format,
        None if pairs.is_empty() => complex_format(&unplaced),
        None => format_of(pairs, folder)?,
    };
    let mut chains = None;
    let name = |pair: &PosedPair| file_name(pair.row.rank, format.extension());
    let names = pairs.iter().map(name).collect();
    // As many texts at once as there are threads that make them.
    for pairs in pairs.chunks(rayon::current_num_threads()) {
        let texts = pairs.par_iter().map(|pair| {
            let path = folder.join(name(pair));
            pair.text(format, &path)
                .map(|(text, chains)| (path, text, chains))
        });
        let texts: Vec<Result<_, Error>> = texts.collect();
        for made in texts {
            let (path, text, map) = made?;
            let written = write_new(&path, |file| file.write_all(&text));
            written.map_err(|source| file_error::writing(&path, source))?;
            chains = Some(map);
        }
    }
    if chains.is_none() {
        let map = write_complex(&mut io::sink(), format, &unplaced, &[]);
        chains = Some(map.map_err(|error| file_error::writing(folder, error))?);
    }
    Ok(WrittenBodies { names, chains })
}

/// The format that holds all of some complexes. Placed molecules are made for it and again for the files: all at once may
/// not fit into the memory.
pub(crate) fn format_of(pairs: &[PosedPair], folder: &Path) -> Result<Format, Error> {
    let formats = pairs.par_iter().map(|pair| {
        let placed = pair.placed(folder)?;
        Ok(complex_format(&placed.iter().collect::<Vec<_>>()))
    });
    for format in formats.collect::<Vec<Result<Format, Error>>>() {
        if format? != Format::Pdb {
            return Ok(Format::Mmcif);
        }
    }
    Ok(Format::Pdb)
}

/// The molecules that a pose places about the receptor: the ligand, or all copies of a ring but the receptor.
///
/// # Errors
/// [`Error`] if the pose is not one of such a ring.
fn placed_copies(
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
