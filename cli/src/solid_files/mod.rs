//! Files of solids: balls, pictures, surfaces and volume grids.

pub mod balls;
pub mod sample_picture;
pub mod surfaces;
pub mod volume_grids;
