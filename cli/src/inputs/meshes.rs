//! Meshes named on the command line of `knotdock dock` or in a run.json: read, recorded, described.

use std::path::Path;

use knotdock::mesh::SampledPart;
use knotdock::output::records::input_record::InputRecord;
use knotdock::output::records::manifest::InputEntry;
use knotdock_structures::mesh::{self, Mesh, MeshReport, Solid};
use knotdock_structures::molecule::InputSpec;

use knotdock_structures::Error;

/// Endings of mesh files.
const ENDINGS: [&str; 4] = ["stl", "obj", "ply", "off"];

/// Whether a file is a mesh, by its name.
pub fn is_mesh(path: &Path) -> bool {
    path.extension().is_some_and(|ending| {
        let ending = ending.to_string_lossy().to_ascii_lowercase();
        ENDINGS.contains(&ending.as_str())
    })
}

/// A mesh as read.
pub struct MeshInput {
    /// File and checksum.
    pub record: InputRecord,
    /// The surface.
    pub mesh: Mesh,
    /// What the file held.
    pub report: MeshReport,
    /// What it bounds.
    pub solid: Solid,
}

impl MeshInput {
    /// Reads a mesh; chains cannot be picked of one.
    pub fn read(spec: &InputSpec) -> Result<Self, Error> {
        if spec.chains.is_some() {
            return Err(Error::input("a mesh has no chains to pick")
                .at(&spec.path)
                .help("leave out the colon and what follows it"));
        }
        let bytes = mesh::file_bytes(&spec.path)?;
        let (mesh, report) = mesh::read_bytes(&spec.path, &bytes)?;
        let solid = Solid::new(&mesh).map_err(|error| error.at(&spec.path))?;
        Ok(Self {
            record: InputRecord::new(spec, &bytes),
            mesh,
            report,
            solid,
        })
    }

    /// The mesh for run.json, with how it was sampled.
    pub fn entry(&self, sampling: Option<&SampledPart>) -> Result<InputEntry, Error> {
        Ok(InputEntry {
            record: self.record.clone(),
            atoms: None,
            sampling: sampling.cloned(),
            report: serde_json::to_value(&self.report).map_err(Error::machine)?,
        })
    }
}
