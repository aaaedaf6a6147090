//! The files that `knotdock sample` writes.

use std::path::{Path, PathBuf};

use crate::solid_files::balls::{write_mesh, write_pseudo_atoms, write_table};
use crate::solid_files::sample_picture::write_picture;
use knotdock::output::files::whole_file::{StagedFile, is_stream};
use knotdock_structures::Knots;
use knotdock_structures::mesh::Solid;
use knotdock_structures::sampling::Ball;

use super::Sample;
use crate::arguments::output_file::{check_output, is_same};
use crate::messages::console::Console;
use knotdock_structures::Error;

/// Form in which balls are exported.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Export {
    Mesh,
    PseudoAtoms,
}

impl Export {
    /// Writes balls in this form.
    pub fn write(self, knots: &Knots, path: &Path) -> Result<StagedFile, Error> {
        Ok(match self {
            Self::Mesh => write_mesh(knots, path)?,
            Self::PseudoAtoms => write_pseudo_atoms(knots, path)?,
        })
    }
}

/// What a file's name ends with, in small letters.
fn ending(path: &Path) -> Option<String> {
    path.extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase())
}

impl Sample {
    /// Checks, before any work, that the files to write are not there and can be made.
    pub(super) fn check_files(&self, console: Console) -> Result<Option<Export>, Error> {
        let files: Vec<&PathBuf> = [
            Some(&self.output),
            self.picture.as_ref(),
            self.export.as_ref(),
        ]
        .into_iter()
        .flatten()
        .collect();
        for (index, file) in files.iter().enumerate() {
            if files[..index].iter().any(|other| is_same(other, file)) {
                return Err(Error::input("the same file is named twice")
                    .at(file)
                    .help("give each output file its own name"));
            }
            check_output(file, [self.mesh.as_path()], self.force, console)?;
        }
        if let Some(path) = &self.picture
            && ending(path).as_deref() != Some("svg")
            && !is_stream(path)
        {
            return Err(Error::input("--picture writes .svg files")
                .at(path)
                .help("end the name with .svg"));
        }
        let Some(path) = &self.export else {
            return Ok(None);
        };
        match ending(path).as_deref() {
            Some("obj") => Ok(Some(Export::Mesh)),
            Some("pdb") => Ok(Some(Export::PseudoAtoms)),
            _ => Err(Error::input("--export writes .obj and .pdb files")
                .at(path)
                .help(
                    "end the name with .obj for a mesh of spheres or with .pdb for pseudo-atoms",
                )),
        }
    }

    /// Writes all of them and returns their names.
    pub(super) fn write(
        &self,
        solid: &Solid,
        knots: &Knots,
        balls: &[Ball],
        export: Option<Export>,
    ) -> Result<Vec<String>, Error> {
        // None takes its place before all of them are on the device.
        let mut staged = vec![write_table(knots, &self.output)?];
        let mut files = vec![&self.output];
        if let (Some(path), Some(export)) = (&self.export, export) {
            staged.push(export.write(knots, path)?);
            files.push(path);
        }
        if let Some(path) = &self.picture {
            staged.push(write_picture(solid, balls, path)?);
            files.push(path);
        }
        for file in staged {
            file.place()?;
        }
        let names = files.iter().map(|file| file.display().to_string());
        Ok(names.collect())
    }
}
