//! Files to solids to knots.
//!
//! # Example
//!
//! ```
//! # #[cfg(all(feature = "mesh", feature = "molecule"))]
//! # fn main() -> Result<(), knotdock_structures::Error> {
//! use knotdock_structures::mesh::Mesh;
//! use knotdock_structures::molecule::Molecule;
//!
//! # let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
//! let knots = Molecule::read(&format!("{folder}/1ppe_ligand_unbound.pdb"))?.knots()?;
//! assert_eq!(knots.len(), 221);
//!
//! let balls = Mesh::read(format!("{folder}/bunny.obj"))?.solid()?.decompose(1 << 12)?;
//! assert!(balls.inner().len() > 300 && balls.epsilon() > 0.0);
//! # Ok(())
//! # }
//! # #[cfg(not(all(feature = "mesh", feature = "molecule")))]
//! # fn main() {}
//! ```
//!
//! # Conventions
//!
//! - Lengths are in Å for molecules and in the file's own unit for meshes.
//! - A **knot** is a ball: a centre, a radius and a weight (Behandish & Ilieş, CAD 70, 2016, section 2.2).
//! - Chains carry the author's names (`auth_asym_id` in mmCIF), residues the author's numbers and insertion codes.
//!
//! This crate knows nothing of scores or transforms. With the feature `molecule` (default) it reads and writes PDB and
//! mmCIF files. With the feature `mesh` (default) it reads meshes and samples solids by balls. Without them [`Knots`],
//! the volumes of their balls, [`Conformers`], [`neighbours`] and [`numeric`] remain.

// No input may end in a panic; tests may.
#![cfg_attr(
    not(test),
    warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]

mod ball;
#[cfg(feature = "mesh")]
pub mod ball_file;
#[cfg(feature = "mesh")]
pub mod ball_solid;
pub mod ball_union;
mod conformers;
mod error;
pub mod knots;
#[cfg(feature = "mesh")]
pub mod mesh;
#[cfg(feature = "molecule")]
pub mod molecule;
#[cfg_attr(not(all(feature = "mesh", feature = "molecule")), allow(dead_code))]
mod motion;
pub mod neighbours;
pub mod numeric;
mod polar_atom;

#[cfg(feature = "mesh")]
pub mod sampling;
#[cfg(feature = "mesh")]
pub mod sphere_tree;
#[cfg(all(test, feature = "mesh"))]
mod test_support;
#[cfg_attr(not(feature = "mesh"), allow(dead_code))]
mod vector;

pub use ball::{Ball, LARGEST_LENGTH, SMALLEST_RADIUS};
pub use conformers::Conformers;
pub use error::Error;
pub use knots::Knots;
pub use polar_atom::PolarAtom;
