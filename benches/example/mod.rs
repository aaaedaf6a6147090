//! The example pair, as benches take it.

use knotdock_structures::Knots;
use knotdock_structures::molecule::{InputSpec, ReadOptions, read};
use std::error::Error;
use std::path::Path;

/// Knots of the receptor and the ligand.
pub fn knots() -> Result<[Knots; 2], Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("structures/examples");
    let load = |name: &str| -> Result<_, Box<dyn Error>> {
        let spec = InputSpec::whole(folder.join(name));
        Ok(read(&spec, &ReadOptions::default())?.knots()?)
    };
    Ok([
        load("1ppe_receptor_unbound.pdb")?,
        load("1ppe_ligand_unbound.pdb")?,
    ])
}
