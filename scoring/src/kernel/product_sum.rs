//! The exact score of the product kernel: the plain sum over all pairs in f64, the reference that grid and lifted
//! engines are held to.
//!
//! O(receptor knots x ligand knots), radial kernels from tables that follow [`ProductKernel::value`] to about 1e-9 of
//! its peak (sharp balls: the lens volumes themselves). No cell list: a reference is better plain than fast.

use super::product::ProductKernel;
use super::table::Table;
use crate::rigid_move::{PoseGradient, center};
use crate::se3::Pose;
use crate::vectorized::vectorize;
use knotdock_structures::Knots;
use knotdock_structures::knots::KnotsError;
use nalgebra::{Rotation3, Vector3};

/// A pair of knot sets prepared for exact scoring with the product kernel.
pub struct ProductScorer {
    kernel: ProductKernel,
    tables: PairTables,
    /// The same without the low-pass, where there is one.
    unfiltered: Option<PairTables>,
    receptor: Vec<PlacedKnot>,
    receptor_center: Vector3<f64>,
    ligand: Vec<PlacedKnot>,
    ligand_center: Vector3<f64>,
}

/// Kernels of all pairs of radii.
struct PairTables {
    /// [ligand class][receptor class], both balls as they are, the receptor's grown, the ligand's grown, both grown.
    /// `None`: sharp balls, whose kernel is cheap as it is.
    tables: Option<Vec<Vec<Table<4>>>>,
    kernel: ProductKernel,
    /// Distance from which a pair's kernel is 0, [ligand class][receptor class].
    reaches: Vec<Vec<f64>>,
    /// Distinct radii of ligand and receptor.
    radii: [Vec<f64>; 2],
}

/// A knot relative to its body's centre, in Å.
struct PlacedKnot {
    position: Vector3<f64>,
    /// As it is, and grown.
    weights: [f64; 2],
    class: usize,
}

/// Score and unweighted slices of one pose, in the kernel's unit of volume.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProductScore {
    /// -lambda^2 g_0 + 2 lambda g_1 - g_2.
    pub score: f64,
    /// g_0, g_1, g_2.
    pub slices: [f64; 3],
    /// The score without the low-pass.
    pub unfiltered: f64,
}

impl PairTables {
    fn new(kernel: &ProductKernel, ligand: &[f64], receptor: &[f64]) -> Self {
        Self {
            tables: kernel
                .is_smooth()
                .then(|| kernel.layer_tables(ligand, receptor)),
            kernel: kernel.clone(),
            reaches: ligand
                .iter()
                .map(|&s| receptor.iter().map(|&r| kernel.reach(r, s)).collect())
                .collect(),
            radii: [ligand.to_vec(), receptor.to_vec()],
        }
    }

    /// Overlaps of a pair of classes: as they are, the ligand's grown, the receptor's grown, both grown.
    #[inline(always)]
    fn value(&self, ligand: usize, receptor: usize, distance: f64) -> [f64; 4] {
        match &self.tables {
            Some(tables) => tables[ligand][receptor].value(distance),
            None => {
                let [radii, other] = &self.radii;
                self.kernel
                    .layer_overlaps(distance, radii[ligand], other[receptor])
            }
        }
    }
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
        let place = |knots: &Knots, class: &[usize], center: Vector3<f64>| {
            let skin = |i: usize| knots.skin_weights.get(i).copied();
            (0..knots.len())
                .map(|i| PlacedKnot {
                    position: Vector3::from(knots.centers[i]) - center,
                    weights: [knots.weights[i], skin(i).unwrap_or(knots.weights[i])],
                    class: class[i],
                })
                .collect()
        };
        let (receptor_center, ligand_center) = (center(receptor), center(ligand));
        let tables =
            |kernel: &ProductKernel| PairTables::new(kernel, &ligand_radii, &receptor_radii);
        Ok(Self {
            tables: tables(kernel),
            unfiltered: kernel
                .without_low_pass(&[&receptor_radii, &ligand_radii].map(Vec::as_slice))
                .as_ref()
                .map(tables),
            receptor: place(receptor, &receptor_class, receptor_center),
            ligand: place(ligand, &ligand_class, ligand_center),
            receptor_center,
            ligand_center,
            kernel: kernel.clone(),
        })
    }

    /// Score and slices of one pose.
    pub fn score(&self, pose: &Pose) -> ProductScore {
        let slices = self.slices(&self.tables, pose);
        let score = self.weighted(slices);
        ProductScore {
            score,
            slices,
            unfiltered: match &self.unfiltered {
                Some(tables) => self.weighted(self.slices(tables, pose)),
                None => score,
            },
        }
    }

    /// The score of one pose and nothing else.
    pub fn score_only(&self, pose: &Pose) -> f64 {
        self.weighted(self.slices(&self.tables, pose))
    }

    /// Score of one pose and its gradient over translation (Å) and rotation (radians) about the ligand's centre.
    /// Sharp balls, whose kernel has corners, have none: it is zero.
    pub fn gradient(&self, pose: &Pose) -> (f64, PoseGradient) {
        let (rotation, shift) = self.placed(pose);
        let [plain, single, both] = self.kernel.options().slice_weights();
        let lanes = [plain, 0.5 * single, 0.5 * single, both];
        let mut score = 0.0;
        let mut gradient = PoseGradient::default();
        let Some(tables) = &self.tables.tables else {
            return (self.score_only(pose), gradient);
        };
        for knot in &self.ligand {
            let arm = rotation * knot.position;
            let at = arm + shift;
            let mut force = Vector3::zeros();
            for other in &self.receptor {
                let way = at - other.position;
                let distance = way.norm();
                let (values, slopes) = tables[knot.class][other.class].value_and_slope(distance);
                let weights = layer_weights(knot, other);
                let sum = |of: [f64; 4]| -> f64 {
                    (0..4)
                        .map(|lane| lanes[lane] * weights[lane] * of[lane])
                        .sum()
                };
                score += sum(values);
                // The kernel is even and smooth: coincident balls do not pull.
                if distance > 0.0 {
                    force += way * (sum(slopes) / distance);
                }
            }
            gradient.force += force;
            gradient.torque += arm.cross(&force);
        }
        (score, gradient)
    }

    /// Rotation of a pose, and the ligand's centre there relative to the receptor's.
    fn placed(&self, pose: &Pose) -> (Rotation3<f64>, Vector3<f64>) {
        let rotation = pose.rotation.to_rotation_matrix();
        let shift = rotation * self.ligand_center + pose.translation - self.receptor_center;
        (rotation, shift)
    }

    fn weighted(&self, slices: [f64; 3]) -> f64 {
        let weights = self.kernel.options().slice_weights();
        (0..3).map(|i| weights[i] * slices[i]).sum()
    }

    /// g_0, g_1, g_2.
    fn slices(&self, tables: &PairTables, pose: &Pose) -> [f64; 3] {
        vectorize!(self.slices_inline(tables, pose))
    }

    #[inline(always)]
    fn slices_inline(&self, tables: &PairTables, pose: &Pose) -> [f64; 3] {
        let (rotation, shift) = self.placed(pose);
        let mut sums = [0.0; 4];
        for knot in &self.ligand {
            let at = rotation * knot.position + shift;
            let mut of_knot = [0.0; 4];
            let reaches = &tables.reaches[knot.class];
            for other in &self.receptor {
                let distance = (at - other.position).norm();
                if distance >= reaches[other.class] {
                    continue;
                }
                let values = tables.value(knot.class, other.class, distance);
                let weights = layer_weights(knot, other);
                for lane in 0..4 {
                    of_knot[lane] += weights[lane] * values[lane];
                }
            }
            for (sum, value) in sums.iter_mut().zip(of_knot) {
                *sum += value;
            }
        }
        [sums[0], 0.5 * (sums[1] + sums[2]), sums[3]]
    }
}

/// Products of two knots' weights, in the order of the tables' lanes.
#[inline(always)]
fn layer_weights(knot: &PlacedKnot, other: &PlacedKnot) -> [f64; 4] {
    let ([solid, grown], [other, other_grown]) = (knot.weights, other.weights);
    [
        solid * other,
        grown * other,
        solid * other_grown,
        grown * other_grown,
    ]
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
