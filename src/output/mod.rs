//! The files that commands write, and the tables and records that they read.
//!
//! | command | files |
//! |---|---|
//! | `dock` | `poses.csv`, `top/rank_0001.pdb` (of meshes `.obj`) ..., `run.json` |
//! | `sample` | `knots.csv`, balls as a mesh, as pseudo-atoms or in a picture |
//! | `obstacle`, `morph` | balls, a surface, a volume grid, a picture |
//! | `se3` | a list of poses |
//! | `refine` | `refined.csv`, and complexes as `dock` writes them |
//! | `tradeoff` | `tradeoff.csv`, `tradeoff.json` and a picture |
//! | `batch` | `results.csv`, `poses.csv.gz`, shards of both, and the tables of pairs that it reads |
//! | `merge` | `results.csv` and `poses.csv.gz` of all shards |
//!
//! # Conventions
//!
//! - Every file is written whole in a staging folder, to the device, and then takes its place at one stroke. A run that
//!   fails or is killed leaves no partial file in place of a whole one. See [`files::whole_file`] and [`files::staging`].
//! - Coordinates are in Å, of meshes in the unit of their files. A pose carries the ligand from its own file's frame to
//!   the receptor's.
//! - Numbers are printed in the shortest digits that read back to the same f64; a value that does not exist is an empty
//!   field in CSV and `null` in JSON, never NaN.
//! - Two runs of the same input and options differ in no byte but for the objects `timing` and `machine` of `run.json`.
//!   The exception is `--budget`, under which the clock decides how much is searched; a run repeated from its record is
//!   none.

pub mod files;
pub mod prediction_inputs;
pub mod records;
pub mod run_contacts;
pub mod run_folder;
pub mod tables;
pub mod top_complexes;
