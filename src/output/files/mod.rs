//! Files written whole: staged directories, complexes, balls and pictures.

pub mod added;
pub mod appended;
pub mod assemblies;
pub mod checksum;
pub mod complexes;
mod disk;
mod fault;
pub mod file_error;
pub mod folder;
pub mod lock;
pub mod model_file;
pub mod own_files;
pub mod seal;
pub mod staging;
pub mod viewers;
pub mod whole_file;
