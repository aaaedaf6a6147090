//! The exact score of the product kernel: the plain sum over all pairs in f64, the reference that grid and lifted
//! engines are held to.
//!
//! O(receptor knots x ligand knots), radial kernels from tables that follow [`ProductKernel::value`] to about 1e-9 of
//! its peak (sharp balls: the lens volumes themselves). No cell list: a reference is better plain than fast.

use super::product::ProductKernel;
use super::table::Table;
use crate::exact::center;
use crate::se3::Pose;
use knotdock_structures::Knots;
use knotdock_structures::knots::KnotsError;
use nalgebra::Vector3;

/// A pair of knot sets prepared for exact scoring with the product kernel. Real parts of weights count.
pub struct ProductScorer {
    kernel: ProductKernel,
    /// [ligand class][receptor class].
    pairs: Vec<Vec<Pair>>,
    receptor: Vec<PlacedKnot>,
    receptor_center: Vector3<f64>,
    ligand: Vec<PlacedKnot>,
    ligand_center: Vector3<f64>,
}

struct Pair {
    radii: [f64; 2],
    reach: f64,
    /// `None`: the kernel itself, by its closed form.
    table: Option<Table<4>>,
}

/// A knot relative to its body's centre, in Å.
struct PlacedKnot {
    position: Vector3<f64>,
    weight: f64,
    class: usize,
}

/// Score and unweighted slices of one pose, in Å^3.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProductScore {
    /// -lambda^2 g_0 + 2 lambda g_1 - g_2.
    pub score: f64,
    /// g_0, g_1, g_2.
    pub slices: [f64; 3],
}

impl ProductScorer {
    /// Prepares the tables of all pairs of distinct radii.
    ///
    /// # Errors
    /// [`KnotsError`] on knots that cannot be scored.
    pub fn new(
        kernel: &ProductKernel,
        receptor: &Knots,
        ligand: &Knots,
    ) -> Result<Self, KnotsError> {
        receptor.check()?;
        ligand.check()?;
        let (receptor_radii, receptor_class) = receptor.radius_classes();
        let (ligand_radii, ligand_class) = ligand.radius_classes();
        let pair = |r: f64, s: f64| Pair {
            radii: [r, s],
            reach: kernel.reach(r, s),
            table: kernel.is_smooth().then(|| kernel.pair_table(r, s)),
        };
        let place = |knots: &Knots, class: &[usize], center: Vector3<f64>| {
            (0..knots.len())
                .map(|i| PlacedKnot {
                    position: Vector3::from(knots.centers[i]) - center,
                    weight: knots.weights[i],
                    class: class[i],
                })
                .collect()
        };
        let (receptor_center, ligand_center) = (center(receptor), center(ligand));
        Ok(Self {
            pairs: ligand_radii
                .iter()
                .map(|&s| receptor_radii.iter().map(|&r| pair(r, s)).collect())
                .collect(),
            receptor: place(receptor, &receptor_class, receptor_center),
            ligand: place(ligand, &ligand_class, ligand_center),
            receptor_center,
            ligand_center,
            kernel: kernel.clone(),
        })
    }

    /// Score and slices of one pose.
    pub fn score(&self, pose: &Pose) -> ProductScore {
        let rotation = pose.rotation.to_rotation_matrix();
        let shift = rotation * self.ligand_center + pose.translation - self.receptor_center;
        let mut slices = [0.0; 3];
        for knot in &self.ligand {
            let at = rotation * knot.position + shift;
            let pairs = &self.pairs[knot.class];
            for other in &self.receptor {
                let pair = &pairs[other.class];
                let distance = (at - other.position).norm();
                if distance >= pair.reach {
                    continue;
                }
                let values = match &pair.table {
                    Some(table) => table.value(distance),
                    None => self.kernel.value(distance, pair.radii[0], pair.radii[1]),
                };
                let weight = knot.weight * other.weight;
                for (slice, value) in slices.iter_mut().zip(values) {
                    *slice += weight * value;
                }
            }
        }
        let weights = self.kernel.options().slice_weights();
        ProductScore {
            score: (0..3).map(|i| weights[i] * slices[i]).sum(),
            slices,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::product::lens_volume;
    use crate::kernel::{Band, KernelOptions, Trim};

    /// Two sharp balls: each slice is a lens volume, and the score their weighted sum.
    #[test]
    fn sharp_balls_score_their_lens_volumes() {
        let options = KernelOptions {
            lambda: 10.0,
            offset: 2.0,
            alpha: f64::INFINITY,
            resolution: 4.0,
            pass_length: 8.0,
            trim: Trim::FlatTop,
        };
        let kernel = ProductKernel::new(options, Band::Whole, 1.9, 1.0).unwrap();
        let a = Knots::new(vec![[3.0, 0.0, 1.0]], vec![1.5]).unwrap();
        let b = Knots::new(vec![[-2.0, 5.0, 0.0]], vec![1.9]).unwrap();
        let scorer = ProductScorer::new(&kernel, &a, &b).unwrap();
        for d in [0.0, 0.3, 1.0, 3.0, 3.5, 5.0, 7.0, 8.0] {
            let pose = Pose::about(
                Pose::identity().rotation,
                Vector3::new(-2.0, 5.0, 0.0),
                Vector3::new(3.0, d, 1.0),
            );
            let [x, y, z] = [
                lens_volume(1.5, 1.9, d),
                0.5 * (lens_volume(3.5, 1.9, d) + lens_volume(1.5, 3.9, d)),
                lens_volume(3.5, 3.9, d),
            ];
            let score = scorer.score(&pose);
            assert!((score.score - (-100.0 * x + 20.0 * y - z)).abs() < 1e-9);
        }
    }
}
