//! From polygons to a solid's surface: vertices welded, polygons cut, triangles turned outward, repeats left out.

pub(in crate::mesh) mod edges;
pub(in crate::mesh) mod facing;
pub(in crate::mesh) mod polygon;
pub(in crate::mesh) mod rounding;
pub(in crate::mesh) mod topology;
pub(in crate::mesh) mod weld;
