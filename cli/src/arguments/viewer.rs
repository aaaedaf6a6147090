//! The library of the three-dimensional view of reports.

use std::path::PathBuf;

use crate::report::Viewer;
use clap::Args;
use knotdock_structures::Error;

/// Where the library is.
#[derive(Args, Clone, Debug)]
pub struct ViewerArguments {
    /// Folder of npm's package 3dmol, for the three-dimensional view of the report [default: what the program was built
    /// with].
    #[arg(long, value_name = "DIR")]
    viewer: Option<PathBuf>,
}

impl ViewerArguments {
    /// The library, if there is one.
    ///
    /// # Errors
    /// [`Error`] if the folder does not hold it.
    pub fn read(&self) -> Result<Option<Viewer>, Error> {
        match &self.viewer {
            Some(folder) => Viewer::read(folder).map(Some),
            None => Ok(Viewer::embedded().cloned()),
        }
    }
}
