//! What a run leaves behind: `poses.csv`, `top/rank_0001.pdb` (of meshes `.obj`) ..., `run.json`, and the words on the terminal; and what
//! `knotdock sample` does: `knots.csv`, and balls as a mesh, as pseudo-atoms or in a picture; and what `knotdock tradeoff` does:
//! `tradeoff.csv`, `tradeoff.json` and a picture; and the tables that `knotdock batch` reads and writes.
//!
//! # Conventions
//!
//! - Every file is written whole under a `.partial` name and then renamed, so that a run that fails or is killed never
//!   leaves part of a file where a whole one is looked for. See [`whole_file`] and [`staging`].
//! - Coordinates are in Å, of meshes in the unit of their files. A pose carries the ligand from its own file's frame to the receptor's.
//! - Numbers are printed in the shortest digits that read back to the same f64; a value that does not exist is an empty
//!   field in CSV and `null` in JSON, never NaN.
//! - Two runs of the same input and options differ in no byte but for the objects `timing` and `machine` of `run.json`.

pub mod assemblies;
pub mod atom_table;
pub mod balls;
pub mod batch_results;
pub mod complexes;
pub mod cost_model_file;
mod csv_lines;
pub mod exclusive;
pub mod fields;
pub mod input_record;
pub mod manifest;
pub mod molecule_file;
pub mod pair_table;
mod pose_columns;
pub mod poses;
pub mod poses_reader;
pub mod program;
pub mod quality;
pub mod recorded_run;
pub mod report;
pub mod sample_picture;
pub mod staging;
pub mod tradeoff;
pub mod whole_file;
