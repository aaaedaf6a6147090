//! Biological assemblies as a file describes them: which chains, moved how.

/// A motion of the file's coordinates, x -> R x + t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Operator {
    /// R, row by row.
    pub(crate) rotation: [[f64; 3]; 3],
    /// t, in Å.
    pub(crate) shift: [f64; 3],
}

impl Operator {
    /// Leaves everything in place.
    pub(crate) const IDENTITY: Self = Self {
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        shift: [0.0; 3],
    };

    pub(crate) fn turned(&self, x: [f64; 3]) -> [f64; 3] {
        self.rotation
            .map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2])
    }

    pub(crate) fn moved(&self, x: [f64; 3]) -> [f64; 3] {
        let turned = self.turned(x);
        [0, 1, 2].map(|axis| turned[axis] + self.shift[axis])
    }

    /// `first`, then this.
    pub(crate) fn after(&self, first: &Self) -> Self {
        let columns = [0, 1, 2].map(|column| self.turned(first.rotation.map(|row| row[column])));
        Self {
            rotation: [0, 1, 2].map(|row| columns.map(|column| column[row])),
            shift: self.moved(first.shift),
        }
    }
}

/// Chains of an assembly that are moved alike.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    /// Names of the chains, in mmCIF the archive's (`label_asym_id`).
    pub(crate) chains: Vec<String>,
    /// A copy of all of them for each.
    pub(crate) operators: Vec<Operator>,
}

/// One biological assembly.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Assembly {
    /// Its name, mostly a number from 1 on.
    pub(crate) id: String,
    pub(crate) parts: Vec<Part>,
}

/// Assemblies that a file describes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Assemblies {
    pub(crate) list: Vec<Assembly>,
    /// 1-based line and what is wrong there, where some cannot be understood.
    pub(crate) broken: Option<(Option<usize>, String)>,
}
