//! The exact score of the product kernel: the sum over all pairs in f64, the reference that grid and lifted engines are
//! held to.
//!
//! O(receptor knots x ligand knots within reach). Radial kernels come from tables that follow [`ProductKernel::value`] to
//! about 1e-9 of its peak (sharp balls: the lens volumes themselves). The low-passed kernel rings far beyond the parts,
//! so nearly all pairs are within its reach. Knots are therefore taken class by class of their radii: the table of a
//! pair of classes stays in the cache, while those of all pairs take tens of megabytes. The kernel without low-pass ends
//! where the grown balls part; of the receptor's blocks only those within its reach are visited.

use super::product::ProductKernel;
use super::table::Table;
use crate::blocks::{Blocks, NearPoints, vectors, vectors_mut};
use crate::rigid_move::{PoseGradient, center};
use crate::se3::Pose;
use crate::vectorized::with_simd;
use knotdock_structures::Knots;
use knotdock_structures::knots::KnotsError;
use nalgebra::{Rotation3, Vector3};
use pulp::Simd;

/// A pair of knot sets prepared for exact scoring with the product kernel.
pub struct ProductScorer {
    kernel: ProductKernel,
    tables: PairTables,
    /// The same without the low-pass, where there is one.
    unfiltered: Option<PairTables>,
    /// By class of radius.
    receptor: Vec<ReceptorClass>,
    receptor_center: Vector3<f64>,
    /// By class of radius.
    ligand: Vec<Vec<LigandKnot>>,
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

/// The receptor's knots of one radius, relative to its centre.
struct ReceptorClass {
    blocks: Blocks,
    /// In the order of the blocks, by lane of the tables: as it is, as it is, grown, grown.
    weights: Vec<[f64; 4]>,
}

/// A knot of the ligand.
struct LigandKnot {
    /// Relative to the ligand's centre, in Å.
    position: Vector3<f64>,
    /// By lane of the tables: as it is, grown, as it is, grown.
    weights: [f64; 4],
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

    /// Overlaps of a pair of sharp balls: as they are, the ligand's grown, the receptor's grown, both grown.
    fn sharp(&self, ligand: usize, receptor: usize, distance: f64) -> [f64; 4] {
        let [radii, other] = &self.radii;
        self.kernel
            .layer_overlaps(distance, radii[ligand], other[receptor])
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
        let weights = |knots: &Knots, i: usize| {
            let skin = knots.skin_weights.get(i).copied();
            [knots.weights[i], skin.unwrap_or(knots.weights[i])]
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
            receptor: by_class(&receptor_radii, &receptor_class, |members| {
                let position = |&i: &usize| Vector3::from(receptor.centers[i]) - receptor_center;
                let positions: Vec<Vector3<f64>> = members.iter().map(position).collect();
                let blocks = Blocks::new(&positions);
                let weights = blocks.arranged(|place| {
                    let [solid, grown] = weights(receptor, members[place]);
                    [solid, solid, grown, grown]
                });
                ReceptorClass { blocks, weights }
            }),
            ligand: by_class(&ligand_radii, &ligand_class, |members| {
                let knot = |&i: &usize| {
                    let [solid, grown] = weights(ligand, i);
                    LigandKnot {
                        position: Vector3::from(ligand.centers[i]) - ligand_center,
                        weights: [solid, grown, solid, grown],
                    }
                };
                members.iter().map(knot).collect()
            }),
            receptor_center,
            ligand_center,
            kernel: kernel.clone(),
        })
    }

    /// Score and slices of one pose.
    pub fn score(&self, pose: &Pose) -> ProductScore {
        let slices = self.slices(&self.tables, pose);
        ProductScore {
            score: self.weighted(slices),
            slices,
            unfiltered: self.unfiltered(pose),
        }
    }

    /// The score of one pose without the low-pass.
    pub fn unfiltered(&self, pose: &Pose) -> f64 {
        let tables = self.unfiltered.as_ref().unwrap_or(&self.tables);
        self.weighted(self.slices(tables, pose))
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
        let mut near = NearPoints::default();
        for (class, knots) in self.ligand.iter().enumerate() {
            for (other, receptor) in self.receptor.iter().enumerate() {
                let (table, reach) = (&tables[class][other], self.tables.reaches[class][other]);
                for knot in knots {
                    let arm = rotation * knot.position;
                    let at = arm + shift;
                    let mut force = Vector3::zeros();
                    receptor
                        .blocks
                        .list_near(&at.into(), reach, &mut near, |near| {
                            for (square, place) in near.pairs() {
                                let distance = square.sqrt();
                                let (values, slopes) = table.value_and_slope(distance);
                                let weights = &receptor.weights[place as usize];
                                let sum = |of: [f64; 4]| -> f64 {
                                    (0..4)
                                        .map(|i| lanes[i] * knot.weights[i] * weights[i] * of[i])
                                        .sum()
                                };
                                score += sum(values);
                                // The kernel is even and smooth: coincident balls do not pull.
                                if distance > 0.0 {
                                    let way = at - Vector3::from(receptor.blocks.position(place));
                                    force += way * (sum(slopes) / distance);
                                }
                            }
                        });
                    gradient.force += force;
                    gradient.torque += arm.cross(&force);
                }
            }
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
        let scorer = self;
        let sums = with_simd!(
            <'a>(scorer: &'a ProductScorer, tables: &'a PairTables, pose: &'a Pose) -> [f64; 4],
            |simd| scorer.sums(simd, tables, pose)
        );
        [sums[0], 0.5 * (sums[1] + sums[2]), sums[3]]
    }

    /// Sums over all pairs, by lane of the tables.
    #[inline(always)]
    fn sums<S: Simd>(&self, simd: S, tables: &PairTables, pose: &Pose) -> [f64; 4] {
        let (rotation, shift) = self.placed(pose);
        let mut totals = [0.0; 4];
        let mut near = NearPoints::default();
        for (class, knots) in self.ligand.iter().enumerate() {
            for (other, receptor) in self.receptor.iter().enumerate() {
                let reach = tables.reaches[class][other];
                let table = tables.tables.as_ref().map(|all| &all[class][other]);
                for knot in knots {
                    let x = (rotation * knot.position + shift).into();
                    receptor.blocks.near(
                        simd,
                        &x,
                        reach,
                        &mut near,
                        #[inline(always)]
                        |near| {
                            let sums = match table {
                                Some(table) => receptor.tabulated(simd, near, table),
                                None => receptor
                                    .summed(near, |distance| tables.sharp(class, other, distance)),
                            };
                            for lane in 0..4 {
                                totals[lane] += knot.weights[lane] * sums[lane];
                            }
                        },
                    );
                }
            }
        }
        totals
    }
}

impl ReceptorClass {
    /// Weighted sums of a kernel over some of the knots.
    fn summed(&self, near: &NearPoints, kernel: impl Fn(f64) -> [f64; 4]) -> [f64; 4] {
        let mut sums = [0.0; 4];
        for (square, place) in near.pairs() {
            let values = kernel(square.sqrt());
            for lane in 0..4 {
                sums[lane] += self.weights[place as usize][lane] * values[lane];
            }
        }
        sums
    }

    /// [`Self::summed`] of a table, all lanes at once.
    #[inline(always)]
    fn tabulated<S: Simd>(&self, simd: S, near: &NearPoints, table: &Table<4>) -> [f64; 4] {
        let mut sums = [simd.splat_f64s(0.0); 4];
        let count = 4 / S::F64_LANES;
        for (square, place) in near.pairs() {
            let Some((panel, u)) = table.panel(square.sqrt()) else {
                continue;
            };
            let Some(weights) = self.weights.get(place as usize) else {
                debug_assert!(false, "a knot that is not there is near");
                continue;
            };
            let (u, [lower @ .., last]) = (simd.splat_f64s(u), panel);
            for (index, sum) in sums.iter_mut().enumerate().take(count) {
                let mut value = vectors::<S>(last)[index];
                for terms in lower.iter().rev() {
                    value = simd.mul_add_e_f64s(value, u, vectors::<S>(terms)[index]);
                }
                *sum = simd.mul_add_e_f64s(value, vectors::<S>(weights)[index], *sum);
            }
        }
        let mut four = [0.0; 4];
        for (of, sum) in vectors_mut::<S>(&mut four).iter_mut().zip(sums) {
            *of = sum;
        }
        four
    }
}

/// Something of the members of each class.
fn by_class<T>(radii: &[f64], class: &[usize], of: impl Fn(&[usize]) -> T) -> Vec<T> {
    let mut members = vec![Vec::new(); radii.len()];
    for (index, &class) in class.iter().enumerate() {
        members[class].push(index);
    }
    members.iter().map(|members| of(members)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::product::lens_volume;
    use crate::kernel::{Band, KernelOptions, Trim};
    use crate::test_support::Numbers;

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

    /// Knots of a few radii about the origin, with weights of either sign.
    fn cloud(count: usize, spread: f64, seed: u64) -> Knots {
        let mut numbers = Numbers(seed);
        let radii = [1.2, 1.5, 1.9, 2.6];
        let mut three = || [0; 3].map(|_| spread * (2.0 * numbers.next() - 1.0));
        let centers: Vec<[f64; 3]> = (0..count).map(|_| three()).collect();
        let weights = |scale: f64| (0..count).map(|i| scale * (1.3 * i as f64).sin()).collect();
        let radii = (0..count).map(|i| radii[i % 4]).collect();
        let knots = Knots::with_weights(centers, radii, weights(1.0)).unwrap();
        knots.with_skin_weights(weights(0.4)).unwrap()
    }

    /// Taking knots by class and leaving out those beyond reach changes nothing against the plain sum over all pairs, with
    /// and without low-pass, and the gradient is that of the score.
    #[test]
    fn sums_are_those_over_all_pairs() {
        let options = KernelOptions {
            lambda: 9.0,
            offset: 1.4,
            alpha: 4.0,
            resolution: 3.0,
            pass_length: 6.0,
            trim: Trim::FlatTop,
        };
        let kernel = ProductKernel::new(options, Band::LowPass, 2.6, 1.0).unwrap();
        let (a, b) = (cloud(90, 9.0, 1), cloud(37, 6.0, 2));
        let scorer = ProductScorer::new(&kernel, &a, &b).unwrap();
        let (radii, class) = a.radius_classes();
        let (ligand_radii, ligand_class) = b.radius_classes();
        assert_eq!((radii.len(), ligand_radii.len()), (4, 4));
        // Sums of the slices and of the magnitudes of their terms.
        let plain = |tables: &PairTables, pose: &Pose| {
            let (mut sums, mut sizes, mut left_out) = ([0.0; 3], [0.0; 3], 0);
            for (i, &column) in class.iter().enumerate() {
                for (j, &row) in ligand_class.iter().enumerate() {
                    let place = Vector3::from(pose.apply(b.centers[j]));
                    let distance = (place - Vector3::from(a.centers[i])).norm();
                    if distance >= tables.reaches[row][column] {
                        left_out += 1;
                        continue;
                    }
                    let values = tables.tables.as_ref().unwrap()[row][column].value(distance);
                    let (solid, grown) = (b.weights[j], b.skin_weights[j]);
                    let (other, other_grown) = (a.weights[i], a.skin_weights[i]);
                    let middle = grown * other * values[1] + solid * other_grown * values[2];
                    let terms = [
                        solid * other * values[0],
                        0.5 * middle,
                        grown * other_grown * values[3],
                    ];
                    for slice in 0..3 {
                        sums[slice] += terms[slice];
                        sizes[slice] += terms[slice].abs();
                    }
                }
            }
            (sums, sizes, left_out)
        };
        let whole = scorer.unfiltered.as_ref().unwrap();
        for translation in [[0.0; 3], [7.0, -2.0, 1.0], [0.0, 14.0, 3.0]] {
            let pose = Pose::from_parts([0.3, -0.2, 0.8, 0.4], translation);
            let weights = options.slice_weights();
            for tables in [&scorer.tables, whole] {
                let (sums, sizes, left_out) = plain(tables, &pose);
                assert_eq!(left_out > 0, std::ptr::eq(tables, whole));
                let found = scorer.slices(tables, &pose);
                for slice in 0..3 {
                    let error = (found[slice] - sums[slice]).abs();
                    assert!(error < 1e-12 * sizes[slice], "{error:e} of {sizes:?}");
                }
            }
            let found = scorer.score(&pose);
            let weighted = |slices: [f64; 3]| (0..3).map(|i| weights[i] * slices[i]).sum::<f64>();
            let unfiltered = weighted(plain(whole, &pose).0);
            assert!((found.unfiltered - unfiltered).abs() < 1e-9 * unfiltered.abs());

            let (score, gradient) = scorer.gradient(&pose);
            assert!((score - found.score).abs() < 1e-9 * found.score.abs());
            for axis in 0..3 {
                let step = 1e-4;
                let moved = |by: f64| {
                    let mut pose = pose;
                    pose.translation[axis] += by;
                    scorer.score_only(&pose)
                };
                let slope = (moved(step) - moved(-step)) / (2.0 * step);
                let error = (gradient.force[axis] - slope).abs();
                assert!(error < 1e-4 * gradient.force.norm(), "{error:e}");
            }
        }
    }
}
