//! The files that `knotdock sample` writes.

use std::path::{Path, PathBuf};

use knotdock::output::balls::{write_mesh, write_pseudo_atoms, write_table};
use knotdock::output::sample_picture::write_picture;
use knotdock_structures::Knots;
use knotdock_structures::mesh::Solid;
use knotdock_structures::sampler::Ball;

use super::Sample;
use crate::cli::failure::Failure;

/// Form in which balls are exported.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Export {
    Mesh,
    PseudoAtoms,
}

impl Export {
    /// Writes balls in this form.
    pub fn write(self, knots: &Knots, path: &Path) -> Result<(), Failure> {
        match self {
            Self::Mesh => write_mesh(knots, path)?,
            Self::PseudoAtoms => write_pseudo_atoms(knots, path)?,
        }
        Ok(())
    }
}

impl Sample {
    /// Checks, before any work, that the files to write are not there and can be made.
    pub(super) fn check_files(&self) -> Result<Option<Export>, Failure> {
        let files: Vec<&PathBuf> = [
            Some(&self.output),
            self.picture.as_ref(),
            self.export.as_ref(),
        ]
        .into_iter()
        .flatten()
        .collect();
        for (index, file) in files.iter().enumerate() {
            if files[..index].contains(file) || **file == self.mesh {
                return Err(Failure::input("the same file is named twice")
                    .at(file)
                    .remedy("give each file to write a name of its own"));
            }
            // A device or a pipe is there and is meant to be written to.
            if !self.force && file.is_file() {
                return Err(Failure::input("the file is already there")
                    .at(file)
                    .remedy("choose another name, or pass --force to replace it"));
            }
            let folder = file
                .parent()
                .filter(|folder| !folder.as_os_str().is_empty());
            if file.is_dir() || !folder.unwrap_or(Path::new(".")).is_dir() {
                return Err(Failure::input(
                    "cannot write there: the folder does not exist or the name is a folder's",
                )
                .at(file)
                .remedy("name a file in a folder that exists"));
            }
        }
        let Some(path) = &self.export else {
            return Ok(None);
        };
        let ending = path
            .extension()
            .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("obj") => Ok(Some(Export::Mesh)),
            Some("pdb") => Ok(Some(Export::PseudoAtoms)),
            _ => Err(Failure::input("--export writes .obj and .pdb files")
                .at(path)
                .remedy(
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
    ) -> Result<Vec<String>, Failure> {
        write_table(knots, &self.output)?;
        let mut files = vec![&self.output];
        if let (Some(path), Some(export)) = (&self.export, export) {
            export.write(knots, path)?;
            files.push(path);
        }
        if let Some(path) = &self.picture {
            write_picture(solid, balls, path)?;
            files.push(path);
        }
        let names = files.iter().map(|file| file.display().to_string());
        Ok(names.collect())
    }
}
