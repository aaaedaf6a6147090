//! From polygons to a solid's surface: vertices welded, seams joined, triangles turned outward, repeats left out.

pub(in crate::mesh) mod bounded_surface;
pub(in crate::mesh) mod cells;
pub(in crate::mesh) mod clusters;
pub(in crate::mesh) mod corner_tree;
pub(in crate::mesh) mod distinct;
pub(in crate::mesh) mod edges;
pub(in crate::mesh) mod faces;
pub(in crate::mesh) mod facing;
pub(in crate::mesh) mod labels;
pub(in crate::mesh) mod nesting;
pub(in crate::mesh) mod polygon;
pub(in crate::mesh) mod repeats;
pub(in crate::mesh) mod ring;
pub(in crate::mesh) mod rounding;
pub(in crate::mesh) mod seams;
pub(in crate::mesh) mod shells;
pub(in crate::mesh) mod topology;
pub(in crate::mesh) mod weld;
