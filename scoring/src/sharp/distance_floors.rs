//! Distance from any place to the nearest atom of a body, at least.

use nalgebra::Vector3;

/// Least edge of a cell, Å.
const EDGE: f64 = 2.5;
/// Most cells: where a body is spread out they grow.
const MAX_CELLS: f64 = 4e6;
/// Distance from which cells are only known to be far, Å.
const FAR: f64 = 16.0;

/// Lower bounds of the distance to a body's atoms, by cells of space.
///
/// Most atoms of a ligand are far from the receptor, and a look at one cell shows it.
pub(super) struct DistanceFloors {
    low: Vector3<f64>,
    edge: f64,
    counts: [usize; 3],
    /// Bound of each cell, Å.
    bounds: Vec<f32>,
}

impl DistanceFloors {
    /// Bounds about some points (Å).
    pub fn new(points: impl Iterator<Item = Vector3<f64>> + Clone) -> Self {
        let ends = points.clone().fold(None, |ends, point| {
            let (low, high): (Vector3<f64>, Vector3<f64>) = ends.unwrap_or((point, point));
            Some((low.inf(&point), high.sup(&point)))
        });
        let (low, high) = ends.unwrap_or_default();
        let low = low.add_scalar(-FAR);
        let extent = (high - low).add_scalar(FAR);
        let mut edge = EDGE;
        while extent.iter().map(|x| x / edge + 1.0).product::<f64>() > MAX_CELLS {
            edge *= 1.5;
        }
        let counts: [usize; 3] = std::array::from_fn(|axis| (extent[axis] / edge) as usize + 1);
        let mut bounds = vec![FAR as f32; counts.iter().product()];
        let half_diagonal = 0.5 * 3f64.sqrt() * edge;
        let span = (FAR / edge) as usize + 1;
        for point in points {
            let at = (point - low) / edge;
            let [from, to]: [[usize; 3]; 2] = [
                std::array::from_fn(|axis| (at[axis] as usize).saturating_sub(span)),
                std::array::from_fn(|axis| (at[axis] as usize + span).min(counts[axis] - 1)),
            ];
            for x in from[0]..=to[0] {
                for y in from[1]..=to[1] {
                    let row = (x * counts[1] + y) * counts[2];
                    let flat = (x as f64 + 0.5 - at.x).powi(2) + (y as f64 + 0.5 - at.y).powi(2);
                    for (z, bound) in bounds[row + from[2]..=row + to[2]].iter_mut().enumerate() {
                        let square = flat + ((from[2] + z) as f64 + 0.5 - at.z).powi(2);
                        let distance = (square.sqrt() * edge - half_diagonal) as f32;
                        *bound = bound.min(distance);
                    }
                }
            }
        }
        Self {
            low,
            edge,
            counts,
            bounds,
        }
    }

    /// Whether no atom can be within `reach` (Å, at most 16) of a place.
    #[inline]
    pub fn excludes(&self, place: &Vector3<f64>, reach: f64) -> bool {
        let at = (place - self.low) / self.edge;
        let inside = (0..3).all(|axis| at[axis] >= 0.0 && at[axis] < self.counts[axis] as f64);
        if !inside {
            return reach < FAR;
        }
        let cell =
            (at.x as usize * self.counts[1] + at.y as usize) * self.counts[2] + at.z as usize;
        f64::from(self.bounds[cell]) > reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::Numbers;

    /// Excluded places are farther than the reach, and most far places are excluded. Parts of a body may be far from each
    /// other.
    #[test]
    fn only_what_is_far_is_excluded() {
        for spread in [1.0, 1e5] {
            let mut numbers = Numbers(3);
            let mut point = |size: f64| Vector3::from_fn(|_, _| size * (numbers.next() - 0.5));
            let mut atoms: Vec<Vector3<f64>> = (0..200).map(|_| point(30.0)).collect();
            atoms.push(Vector3::new(spread, 0.0, 0.0));
            let near = DistanceFloors::new(atoms.iter().copied());
            assert!(near.bounds.len() as f64 <= MAX_CELLS);
            let (mut far, mut excluded) = (0, 0);
            for _ in 0..2000 {
                let place = point(90.0);
                let distances = atoms.iter().map(|atom| (atom - place).norm());
                let distance = distances.fold(f64::INFINITY, f64::min);
                let is_excluded = near.excludes(&place, 8.0);
                assert!(!is_excluded || distance > 8.0);
                far += usize::from(distance > 14.0);
                excluded += usize::from(is_excluded);
            }
            assert!(far > 100 && (spread > 1.0 || excluded >= far));
        }
    }
}
