//! Conformers of unresolved segments: equally weighted CA traces.

/// Conformers of one segment of a chain, in a frame of its own that moves with the body. All are equally likely.
#[derive(Clone, Debug, PartialEq)]
pub struct Conformers {
    /// Where the segment begins, in the file's frame, Å.
    pub origin: [f64; 3],
    /// Unit vectors of the segment's own frame, in the file's frame.
    pub axes: [[f64; 3]; 3],
    /// CA atoms of each conformer, in the segment's own frame, Å: [conformer][residue].
    pub traces: Vec<Vec<[f64; 3]>>,
}

impl Conformers {
    /// Converts a point of the file's frame to the segment's own, Å.
    pub fn local(&self, point: [f64; 3]) -> [f64; 3] {
        let from: [f64; 3] = std::array::from_fn(|axis| point[axis] - self.origin[axis]);
        self.axes
            .map(|unit| unit.iter().zip(&from).map(|(a, b)| a * b).sum())
    }

    /// Converts a point of the segment's own frame to the file's, Å.
    pub fn in_file(&self, point: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let along = self.axes.iter().zip(&point).map(|(unit, x)| unit[axis] * x);
            self.origin[axis] + along.sum::<f64>()
        })
    }
}
