//! Files written whole: staged directories, complexes, balls and pictures.

pub mod assemblies;
pub mod balls;
pub mod complexes;
pub mod exclusive;
pub mod molecule_file;
pub mod sample_picture;
pub mod staging;
pub mod whole_file;
