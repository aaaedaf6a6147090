//! The exact score: the pair sum over all knots in f64, with its gradient over the six degrees of freedom.
//!
//! O(ligand knots x receptor knots within reach), by a cell list. Kernels come from tables that follow the ranking kernel to
//! about 1e-9 of its largest value; `unfiltered` evaluates B&I's own kernel directly.

use crate::kernel::RankingKernel;
use crate::kernel::table::Table;
use crate::se3::Pose;
use knotdock_structures::Knots;
use knotdock_structures::knots::KnotsError;
use nalgebra::Vector3;

/// The exact score of one pose and its parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExactScore {
    /// G of the ranking kernel.
    pub score: f64,
    /// Its unweighted slices at rho = 0, r0, 2 r0.
    pub slices: [f64; 3],
    /// G of B&I's own kernel, without low-pass.
    pub unfiltered: f64,
}

/// Gradient of a score: per Å of translation, and per radian of rotation about the ligand's centre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseGradient {
    /// dG / dt.
    pub force: Vector3<f64>,
    /// dG / d omega, for R -> `exp([omega]x)` R about the ligand's centre.
    pub torque: Vector3<f64>,
}

/// A pair of knot sets prepared for exact scoring.
pub struct ExactScorer {
    kernel: RankingKernel,
    /// Tables of the distinct radius sums.
    tables: Vec<Table<4>>,
    /// [ligand class][receptor class].
    pairs: Vec<Vec<RadiusPair>>,
    receptor: Cells,
    receptor_center: Vector3<f64>,
    ligand: Vec<LigandKnot>,
    ligand_center: Vector3<f64>,
}

/// Receptor knots collected per turn of the inner loop.
const NEAR: usize = 256;

/// Squared distances and indices of receptor knots within reach. Whether a knot is within reach is a coin toss that no branch
/// predictor wins, so candidates are stored always and counted only when near.
struct Near {
    pairs: [(f64, u32); NEAR],
    count: usize,
}

impl Default for Near {
    fn default() -> Self {
        Self {
            pairs: [(0.0, 0); NEAR],
            count: 0,
        }
    }
}

/// What two radii share: their sum in Å and the table that serves it.
#[derive(Clone, Copy)]
struct RadiusPair {
    radius_sum: f64,
    table: usize,
}

#[derive(Clone, Copy)]
struct LigandKnot {
    /// Relative to the ligand's centre, in Å.
    position: Vector3<f64>,
    weight: f64,
    class: usize,
}

/// Receptor knots sorted into cubic cells, x fastest, so that a row of cells is one run of knots.
struct Cells {
    low: Vector3<f64>,
    edge: f64,
    count: [usize; 3],
    starts: Vec<u32>,
    positions: Vec<[f64; 3]>,
    weights: Vec<f64>,
    classes: Vec<u32>,
}

impl Cells {
    fn new(points: &[Vector3<f64>], weights: &[f64], classes: &[usize], edge: f64) -> Self {
        let mut low = Vector3::repeat(f64::INFINITY);
        let mut high = Vector3::repeat(f64::NEG_INFINITY);
        for point in points {
            low = low.inf(point);
            high = high.sup(point);
        }
        // A sparse set far wider than the reach must not ask for more cells than it has use for.
        let volume: f64 = (high - low)
            .iter()
            .map(|length| length / edge + 1.0)
            .product();
        let edge = edge * (volume / (1e6 + points.len() as f64)).max(1.0).cbrt();
        let count = [0, 1, 2].map(|axis| ((high[axis] - low[axis]) / edge) as usize + 1);
        let cell_of = |point: &Vector3<f64>| {
            let [x, y, z] = [0, 1, 2]
                .map(|axis| (((point[axis] - low[axis]) / edge) as usize).min(count[axis] - 1));
            (z * count[1] + y) * count[0] + x
        };
        let mut order: Vec<(usize, usize)> = points
            .iter()
            .enumerate()
            .map(|(index, point)| (cell_of(point), index))
            .collect();
        order.sort_unstable();
        let mut starts = vec![0u32; count.iter().product::<usize>() + 1];
        for (cell, _) in &order {
            starts[cell + 1] += 1;
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        Self {
            low,
            edge,
            count,
            starts,
            positions: order.iter().map(|&(_, i)| points[i].into()).collect(),
            weights: order.iter().map(|&(_, i)| weights[i]).collect(),
            classes: order.iter().map(|&(_, i)| classes[i] as u32).collect(),
        }
    }

    /// Visits runs of knots that may lie within `reach` of `point`.
    #[inline(always)]
    fn runs(
        &self,
        point: &Vector3<f64>,
        reach: f64,
        mut visit: impl FnMut(std::ops::Range<usize>),
    ) {
        let mut first = [0usize; 3];
        let mut last = [0usize; 3];
        for axis in 0..3 {
            let low = (point[axis] - reach - self.low[axis]) / self.edge;
            let high = (point[axis] + reach - self.low[axis]) / self.edge;
            if high < 0.0 || low >= self.count[axis] as f64 {
                return;
            }
            first[axis] = low.max(0.0) as usize;
            last[axis] = (high as usize).min(self.count[axis] - 1);
        }
        for z in first[2]..=last[2] {
            let dz = self.gap(point[2], 2, z);
            for y in first[1]..=last[1] {
                let dy = self.gap(point[1], 1, y);
                let rest = reach * reach - dy * dy - dz * dz;
                if rest <= 0.0 {
                    continue;
                }
                let half = rest.sqrt();
                let low = ((point[0] - half - self.low[0]) / self.edge).max(0.0) as usize;
                let high = (((point[0] + half - self.low[0]) / self.edge).max(0.0) as usize)
                    .min(self.count[0] - 1);
                if low > high {
                    continue;
                }
                let row = (z * self.count[1] + y) * self.count[0];
                visit(self.starts[row + low] as usize..self.starts[row + high + 1] as usize);
            }
        }
    }

    /// Distance along one axis from a coordinate to a layer of cells; 0 inside it.
    #[inline(always)]
    fn gap(&self, coordinate: f64, axis: usize, layer: usize) -> f64 {
        let low = self.low[axis] + self.edge * layer as f64;
        (low - coordinate)
            .max(coordinate - low - self.edge)
            .max(0.0)
    }
}

impl ExactScorer {
    /// Prepares two sets of knots; only the real parts of weights count (shape has no other).
    ///
    /// # Errors
    /// [`KnotsError`] when a set is not usable.
    pub fn new(
        kernel: &RankingKernel,
        receptor: &Knots,
        ligand: &Knots,
    ) -> Result<Self, KnotsError> {
        receptor.check()?;
        ligand.check()?;
        let receptor_center = center(receptor);
        let ligand_center = center(ligand);
        let (receptor_radii, receptor_class) = receptor.radius_classes();
        let (ligand_radii, ligand_class) = ligand.radius_classes();
        let mut sums: Vec<f64> = receptor_radii
            .iter()
            .flat_map(|r| ligand_radii.iter().map(move |s| r + s))
            .collect();
        sums.sort_by(f64::total_cmp);
        sums.dedup();
        let pairs = ligand_radii
            .iter()
            .map(|s| {
                receptor_radii
                    .iter()
                    .map(|r| RadiusPair {
                        radius_sum: r + s,
                        table: sums.partition_point(|&sum| sum < r + s),
                    })
                    .collect()
            })
            .collect();
        let points: Vec<Vector3<f64>> = receptor
            .centers
            .iter()
            .map(|&x| Vector3::from(x) - receptor_center)
            .collect();
        let weights: Vec<f64> = receptor.weights.iter().map(|c| c.re).collect();
        Ok(Self {
            tables: sums.iter().map(|&sum| kernel.distance_table(sum)).collect(),
            pairs,
            receptor: Cells::new(&points, &weights, &receptor_class, kernel.reach() / 4.0),
            receptor_center,
            ligand: (0..ligand.len())
                .map(|j| LigandKnot {
                    position: Vector3::from(ligand.centers[j]) - ligand_center,
                    weight: ligand.weights[j].re,
                    class: ligand_class[j],
                })
                .collect(),
            ligand_center,
            kernel: kernel.clone(),
        })
    }

    /// The ranking kernel in use.
    pub fn kernel(&self) -> &RankingKernel {
        &self.kernel
    }

    /// Centre of the ligand in its own file frame, about which torques are taken, in Å.
    pub fn ligand_center(&self) -> Vector3<f64> {
        self.ligand_center
    }

    /// Ligand knots at a pose, relative to the receptor's centre: differences of large file coordinates are taken first, so an
    /// offset of 1e6 Å costs no digits here.
    fn placed(&self, pose: &Pose) -> (nalgebra::Rotation3<f64>, Vector3<f64>) {
        let rotation = pose.rotation.to_rotation_matrix();
        let center = rotation * self.ligand_center + pose.translation - self.receptor_center;
        (rotation, center)
    }

    /// Score, slices and unfiltered score of one pose.
    pub fn score(&self, pose: &Pose) -> ExactScore {
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || self.score_inline(pose),
        )
    }

    #[inline(always)]
    fn score_inline(&self, pose: &Pose) -> ExactScore {
        let (rotation, center) = self.placed(pose);
        let reach = self.kernel.reach();
        let square_reach = reach * reach;
        let mut sums = [0.0; 4];
        let mut plain = [0.0; 3];
        let cone = self.kernel.cone();
        let offsets = self.kernel.options().slice_offsets();
        for knot in &self.ligand {
            let x = rotation * knot.position + center;
            let mut own = [0.0; 4];
            let mut own_plain = [0.0; 3];
            let tables = &self.pairs[knot.class];
            let mut near = Near::default();
            let mut flush = |near: &mut Near| {
                for &(square, index) in &near.pairs[..near.count] {
                    let index = index as usize;
                    let distance = square.sqrt();
                    let weight = self.receptor.weights[index];
                    let pair = &tables[self.receptor.classes[index] as usize];
                    let values = self.tables[pair.table].value(distance);
                    for lane in 0..4 {
                        own[lane] += weight * values[lane];
                    }
                    if distance < pair.radius_sum + offsets[2] {
                        for (slice, offset) in offsets.into_iter().enumerate() {
                            let sigma = pair.radius_sum + offset;
                            if distance < sigma {
                                own_plain[slice] += weight * cone.value(distance, sigma);
                            }
                        }
                    }
                }
                near.count = 0;
            };
            self.receptor.runs(&x, reach, |run| {
                for start in run.clone().step_by(NEAR / 2) {
                    let end = run.end.min(start + NEAR / 2);
                    for (p, index) in self.receptor.positions[start..end].iter().zip(start..) {
                        let (dx, dy, dz) = (x[0] - p[0], x[1] - p[1], x[2] - p[2]);
                        let square = dx * dx + dy * dy + dz * dz;
                        near.pairs[near.count] = (square, index as u32);
                        near.count += usize::from(square < square_reach);
                    }
                    if near.count >= NEAR / 2 {
                        flush(&mut near);
                    }
                }
            });
            flush(&mut near);
            for lane in 0..4 {
                sums[lane] += knot.weight * own[lane];
            }
            for slice in 0..3 {
                plain[slice] += knot.weight * own_plain[slice];
            }
        }
        let weights = self.kernel.options().slice_weights();
        let weighted = |slices: [f64; 3]| (0..3).map(|i| weights[i] * slices[i]).sum();
        let slices = [sums[0], sums[1], sums[2]];
        ExactScore {
            // From the slices, not the fourth lane: what the table shows then adds up to the last digit.
            score: weighted(slices),
            slices,
            unfiltered: weighted(plain),
        }
    }

    /// Score of one pose and its gradient over translation (Å) and rotation (radians) about the ligand's centre.
    pub fn gradient(&self, pose: &Pose) -> (f64, PoseGradient) {
        let (rotation, center) = self.placed(pose);
        let reach = self.kernel.reach();
        let mut score = 0.0;
        let mut gradient = PoseGradient::default();
        for knot in &self.ligand {
            let arm = rotation * knot.position;
            let x = arm + center;
            let mut force = Vector3::zeros();
            self.receptor.runs(&x, reach, |run| {
                for i in run {
                    let between = x - Vector3::from(self.receptor.positions[i]);
                    let square = between.norm_squared();
                    if square >= reach * reach {
                        continue;
                    }
                    let distance = square.sqrt();
                    let class = self.receptor.classes[i] as usize;
                    let weight = self.receptor.weights[i] * knot.weight;
                    let table = &self.tables[self.pairs[knot.class][class].table];
                    let (value, slope) = table.value_and_derivative(distance);
                    score += weight * value[3];
                    // Coincident knots: the kernel is even and smooth there, so its force is zero.
                    if distance > 0.0 {
                        force += between * (weight * slope[3] / distance);
                    }
                }
            });
            gradient.force += force;
            gradient.torque += arm.cross(&force);
        }
        (score, gradient)
    }
}

/// Middle of the bounding box, in Å: exact under scaling by powers of two, and within a rounding error under shifts.
pub fn center(knots: &Knots) -> Vector3<f64> {
    let (low, high) = knots.bounds();
    Vector3::from([0, 1, 2].map(|axis| low[axis] + 0.5 * (high[axis] - low[axis])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::affinity::DoubleSkin;
    use crate::kernel::{KernelOptions, Trim};
    use num_complex::Complex64;

    fn kernel() -> RankingKernel {
        let options = KernelOptions {
            lambda: 10.0,
            offset: 2.0,
            alpha: 2.0,
            resolution: 4.0,
            pass_length: 8.0,
            trim: Trim::FlatTop,
        };
        RankingKernel::new(options, 3.0, 3.8, 1.0).unwrap()
    }

    fn cloud(count: usize, spread: f64, seed: u64) -> Knots {
        let mut state = seed;
        let mut next = move || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let radii = [1.5, 1.65, 1.9];
        Knots::new(
            (0..count)
                .map(|_| std::array::from_fn(|_| spread * next()))
                .collect(),
            (0..count).map(|i| radii[i % 3]).collect(),
        )
        .unwrap()
    }

    fn some_pose() -> Pose {
        Pose::from_parts([0.3, -0.2, 0.8, 0.4], [4.0, -2.0, 7.0])
    }

    /// The cell list must change nothing against the plain double sum over the kernel's definition, and the one-array form with
    /// complex weights must give the same score as the three slices.
    #[test]
    fn equals_the_plain_double_sum_and_the_complex_one_array_form() {
        let (kernel, a, b, pose) = (
            kernel(),
            cloud(60, 15.0, 1),
            cloud(40, 10.0, 2),
            some_pose(),
        );
        let scorer = ExactScorer::new(&kernel, &a, &b).unwrap();
        let ours = scorer.score(&pose);
        let skin = DoubleSkin {
            lambda: 10.0,
            offset: 2.0,
        };
        let (fa, fb) = (skin.knots(&a), skin.knots(&b));
        let mut whole = Complex64::new(0.0, 0.0);
        let mut plain = Complex64::new(0.0, 0.0);
        for i in 0..fa.len() {
            for j in 0..fb.len() {
                let x = pose.apply(fb.centers[j]);
                let d = (0..3)
                    .map(|k| (x[k] - fa.centers[i][k]).powi(2))
                    .sum::<f64>()
                    .sqrt();
                let sigma = fa.radii[i] + fb.radii[j];
                let weight = fa.weights[i] * fb.weights[j];
                whole += weight
                    * if d < kernel.reach() {
                        kernel.value(d, sigma)
                    } else {
                        0.0
                    };
                plain += weight * kernel.cone().value(d, sigma);
            }
        }
        let scale = ours.score.abs().max(100.0);
        assert!(
            (whole.re - ours.score).abs() < 1e-7 * scale,
            "{whole} {ours:?}"
        );
        assert!(whole.im.abs() < 1e-7 * scale);
        assert!((plain.re - ours.unfiltered).abs() < 1e-9 * scale);
        assert!((scorer.gradient(&pose).0 - ours.score).abs() < 1e-9 * scale);
    }

    #[test]
    fn gradient_matches_central_differences() {
        let (kernel, a, b, pose) = (
            kernel(),
            cloud(60, 15.0, 3),
            cloud(40, 10.0, 4),
            some_pose(),
        );
        let scorer = ExactScorer::new(&kernel, &a, &b).unwrap();
        let (_, gradient) = scorer.gradient(&pose);
        let h = 1e-5;
        for axis in 0..3 {
            let mut step = Vector3::zeros();
            step[axis] = h;
            let moved = |sign: f64| {
                let pose = Pose {
                    translation: pose.translation + step * sign,
                    ..pose
                };
                scorer.score(&pose).score
            };
            let slope = (moved(1.0) - moved(-1.0)) / (2.0 * h);
            assert!((slope - gradient.force[axis]).abs() < 1e-5 * gradient.force.norm());
            let turned = |sign: f64| {
                let turn = nalgebra::UnitQuaternion::new(step * sign);
                let arm = pose.rotation * scorer.ligand_center();
                let pose = Pose {
                    rotation: turn * pose.rotation,
                    translation: pose.translation + arm - turn * arm,
                };
                scorer.score(&pose).score
            };
            let slope = (turned(1.0) - turned(-1.0)) / (2.0 * h);
            assert!((slope - gradient.torque[axis]).abs() < 1e-5 * gradient.torque.norm());
        }
    }

    /// The sign of the score: a touching pair of balls beats an overlapping and a distant one (B&I's text after eq. 53).
    #[test]
    fn touching_beats_overlapping_and_distant() {
        let kernel = kernel();
        let ball = Knots::new(vec![[0.0; 3]], vec![1.7]).unwrap();
        let scorer = ExactScorer::new(&kernel, &ball, &ball).unwrap();
        let at = |x: f64| {
            scorer.score(&Pose {
                translation: Vector3::new(x, 0.0, 0.0),
                ..Pose::identity()
            })
        };
        let (overlapping, touching, distant) = (at(0.5), at(4.0), at(30.0));
        assert!(touching.score > 1.0 && touching.unfiltered > 1.0);
        assert!(overlapping.score < -10.0 && overlapping.unfiltered < -10.0);
        assert_eq!(distant.score, 0.0);
        // Closed form, no low-pass: centres coincide, all three slices are psi(0) = 1, G = -(lambda - 1)^2.
        assert_eq!(at(0.0).unfiltered, -81.0);
        // At d = sigma / sqrt 2 slice 0 is exp(-1).
        let d = 3.4 / 2f64.sqrt();
        let cone = kernel.cone();
        assert!((cone.value(d, 3.4) - (-1f64).exp()).abs() < 1e-14);
    }

    /// Hard case: file coordinates at 1e6 Å. Moving or turning an input must leave the score at the carried pose.
    #[test]
    fn carried_poses_keep_their_score() {
        let (kernel, a, b, pose) = (
            kernel(),
            cloud(60, 15.0, 5),
            cloud(40, 10.0, 6),
            some_pose(),
        );
        let first = ExactScorer::new(&kernel, &a, &b)
            .unwrap()
            .score(&pose)
            .score;
        for offset in [10.0, 1e4, 1e6] {
            let motion =
                Pose::from_parts([0.5, 0.1, -0.7, 0.3], [offset, -0.3 * offset, 0.7 * offset]);
            let moved = |knots: &Knots| {
                let mut knots = knots.clone();
                for x in &mut knots.centers {
                    *x = motion.apply(*x);
                }
                knots
            };
            let carried = pose.after(&motion.inverse());
            let second = ExactScorer::new(&kernel, &a, &moved(&b))
                .unwrap()
                .score(&carried)
                .score;
            let third = ExactScorer::new(&kernel, &moved(&a), &b)
                .unwrap()
                .score(&motion.after(&pose))
                .score;
            // 1e6 Å at double precision leaves 1e-10 Å in a coordinate, times a slope of the score.
            let bound = first.abs().max(100.0) * f64::max(1e-9, 1e-14 * offset);
            assert!((second - first).abs() < bound, "{first} {second}");
            assert!((third - first).abs() < bound, "{first} {third}");
        }
    }
}
