//! The example pair, as benches take it.

use knotdock_structures::Knots;
use knotdock_structures::molecule::{InputSpec, ReadOptions, read};
use std::error::Error;
use std::path::Path;

/// Knots of the receptor and the ligand.
pub fn knots() -> Result<[Knots; 2], Box<dyn Error>> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("structures/examples");
    Ok([
        load(folder.join("1ppe_receptor_unbound.pdb"))?,
        load(folder.join("1ppe_ligand_unbound.pdb"))?,
    ])
}

/// Knots of a file.
pub fn load(path: impl AsRef<Path>) -> Result<Knots, Box<dyn Error>> {
    let spec = InputSpec::whole(path.as_ref().to_owned());
    Ok(read(&spec, &ReadOptions::default())?.knots()?)
}
