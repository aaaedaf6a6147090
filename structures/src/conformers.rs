//! Conformers of unresolved segments: equally weighted CA traces.

use crate::vector::{dot, subtract};

/// Conformers of one segment of a chain, in a frame that moves with the body. All are equally likely.
#[derive(Clone, Debug, PartialEq)]
pub struct Conformers {
    /// Beginning of the segment, in the file's frame, Å.
    pub origin: [f64; 3],
    /// Unit vectors of the segment's own frame, in the file's frame.
    pub axes: [[f64; 3]; 3],
    /// CA atoms of each conformer, in the segment's own frame, Å: one trace per conformer, one point per residue.
    pub traces: Vec<Vec<[f64; 3]>>,
}

impl Conformers {
    /// Converts a point of the file's frame to the segment's own, Å.
    pub fn local(&self, point: [f64; 3]) -> [f64; 3] {
        let from = subtract(point, self.origin);
        self.axes.map(|unit| dot(unit, from))
    }

    /// Converts a point of the segment's own frame to the file's, Å.
    pub fn in_file(&self, point: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let along = self.axes.iter().zip(&point).map(|(unit, x)| unit[axis] * x);
            self.origin[axis] + along.sum::<f64>()
        })
    }
}
