//! Atoms in cells, so that those near a point are found without asking all.

use nalgebra::Vector3;

/// Edge of a cell in Å, where the atoms do not lie so far apart that there would be more than [`MAX_CELLS`].
const EDGE: f64 = 4.0;
const MAX_CELLS: f64 = 4e6;

/// An atom of a numbered type.
#[derive(Clone, Copy)]
pub(super) struct Atom {
    /// Relative to its body's centre, Å.
    pub position: Vector3<f64>,
    pub kind: usize,
}

/// Atoms by cell.
pub(super) struct Cells {
    atoms: Vec<Atom>,
    low: Vector3<f64>,
    edge: f64,
    counts: [usize; 3],
    /// Place in `atoms` of each cell's first atom, row-major, and their number.
    starts: Vec<u32>,
}

impl Cells {
    pub fn new(mut atoms: Vec<Atom>) -> Self {
        let ends = |pick: fn(f64, f64) -> f64, start: f64| {
            atoms.iter().fold(Vector3::repeat(start), |end, atom| {
                end.zip_map(&atom.position, pick)
            })
        };
        let low = ends(f64::min, 0.0);
        let extent = ends(f64::max, 0.0) - low;
        let count = |edge: f64| extent.map(|length| (length / edge).floor() + 1.0);
        let mut edge = EDGE;
        while count(edge).product() > MAX_CELLS {
            edge *= 1.5;
        }
        let counts: [usize; 3] = count(edge).map(|n| n as usize).into();
        let cell_of = |atom: &Atom| {
            let [x, y, z]: [f64; 3] = ((atom.position - low) / edge).into();
            (x as usize * counts[1] + y as usize) * counts[2] + z as usize
        };
        // Stable: atoms of a cell keep their order, so sums do too.
        atoms.sort_by_key(cell_of);
        let mut starts = vec![0u32; counts.iter().product::<usize>() + 1];
        for atom in &atoms {
            starts[cell_of(atom) + 1] += 1;
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        Self {
            atoms,
            low,
            edge,
            counts,
            starts,
        }
    }

    /// Visits the atoms within `reach` of a position, each with its squared distance, in one fixed order.
    #[inline]
    pub fn near(&self, position: Vector3<f64>, reach: f64, mut visit: impl FnMut(&Atom, f64)) {
        let from = (position - self.low).map(|x| ((x - reach) / self.edge).floor().max(0.0));
        let to = (position - self.low).map(|x| ((x + reach) / self.edge).floor());
        if (0..3).any(|axis| to[axis] < 0.0 || from[axis] >= self.counts[axis] as f64) {
            return;
        }
        let from = from.map(|x| x as usize);
        let last = |axis: usize| (to[axis] as usize).min(self.counts[axis] - 1);
        for x in from.x..=last(0) {
            for y in from.y..=last(1) {
                let row = (x * self.counts[1] + y) * self.counts[2];
                let first = self.starts[row + from.z] as usize;
                let end = self.starts[row + last(2) + 1] as usize;
                for atom in &self.atoms[first..end] {
                    let square = (atom.position - position).norm_squared();
                    if square < reach * reach {
                        visit(atom, square);
                    }
                }
            }
        }
    }
}
