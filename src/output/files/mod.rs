//! Files written whole: staged directories, complexes, balls and pictures.

pub mod appended;
pub mod assemblies;
pub mod balls;
pub mod checksum;
mod commit;
pub mod complexes;
mod disk;
pub mod exported;
mod fault;
pub mod folder_lock;
pub mod model_file;
pub mod molecule_file;
mod own_files;
mod places;
pub mod product;
pub mod sample_picture;
pub mod seal;
pub mod staging;
mod staging_error;
mod staging_folder;
pub mod surfaces;
pub mod viewers;
pub mod volume_grids;
pub mod whole_file;
pub mod workplace;
