//! Where residues may be that a file does not show: many conformers that their chain may take, none more likely than another.

/// Conformers of a segment of chain, in a frame of its own that goes with the body.
#[derive(Clone, Debug, PartialEq)]
pub struct Conformers {
    /// Where the segment begins, in the file's frame (Å).
    pub origin: [f64; 3],
    /// Unit vectors of the segment's own frame, in the file's.
    pub axes: [[f64; 3]; 3],
    /// CA atoms of each conformer, in the segment's own frame (Å).
    pub traces: Vec<Vec<[f64; 3]>>,
}

impl Conformers {
    /// A point of the file's frame in the segment's own.
    pub fn local(&self, point: [f64; 3]) -> [f64; 3] {
        let from: [f64; 3] = std::array::from_fn(|axis| point[axis] - self.origin[axis]);
        self.axes
            .map(|unit| unit.iter().zip(&from).map(|(a, b)| a * b).sum())
    }

    /// A point of the segment's own frame in the file's.
    pub fn in_file(&self, point: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let along = self.axes.iter().zip(&point).map(|(unit, x)| unit[axis] * x);
            self.origin[axis] + along.sum::<f64>()
        })
    }
}
