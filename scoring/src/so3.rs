//! Rotation sets: near-uniform, of any size, closed under the turns of a grid, the same on every machine.
//!
//! [`rotation_set`] starts from a super-Fibonacci spiral (Alexa, CVPR 2022) and relaxes it. [`covering_radius`]
//! measures the largest angle from a rotation to the nearest of a set. Rotations are unit quaternions, angles radians.

use crate::grid_turn::GridTurn;
use knotdock_structures::neighbours::Bins;
use nalgebra::{Quaternion, UnitQuaternion};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Rotations that share a transform of the ligand at the most.
const IMAGES: usize = GridTurn::ALL.len();

/// `count` rotations, closed under the eight turns of [`GridTurn`].
///
/// Rotation 8 i + f is turn f of [`GridTurn::ALL`] after rotation 8 i, so that one transform of the ligand serves eight
/// rotations, or four if the grid has no quarter turns.
///
/// Base rotations are those of a spiral within one domain of the turns, about the identity. Up to [`MAX_RELAXED`]
/// rotations, they and their images are relaxed like charges that repel each other, which evens out the domain's edges.
pub fn rotation_set(count: usize) -> Vec<UnitQuaternion<f64>> {
    if count > MAX_RELAXED {
        return spiral_set(count);
    }
    let mut base = domain(count.div_ceil(IMAGES));
    base.truncate(count.div_ceil(IMAGES));
    relax(&mut base);
    with_images(&base, count)
}

/// `count` rotations as of [`rotation_set`], but never relaxed: quickly made, less even at the edges of the domain.
pub fn spiral_set(count: usize) -> Vec<UnitQuaternion<f64>> {
    let (points, wanted) = (domain(count.div_ceil(IMAGES)), count.div_ceil(IMAGES));
    // Thinned evenly: without its last points a spiral has a hole.
    let kept: Vec<Point> = (0..wanted)
        .map(|index| points[index * points.len() / wanted])
        .collect();
    with_images(&kept, count)
}

/// Each rotation followed by its images, `count` in all.
fn with_images(base: &[Point], count: usize) -> Vec<UnitQuaternion<f64>> {
    base.iter()
        .flat_map(|&point| {
            let rotation = UnitQuaternion::from_quaternion(Quaternion::from(
                nalgebra::Vector4::new(point[1], point[2], point[3], point[0]),
            ));
            GridTurn::ALL.map(|turn| turn.after(&rotation))
        })
        .take(count)
        .collect()
}

/// Largest set that is relaxed. Beyond it the spiral is fine enough, and no measurement shows a gain.
pub const MAX_RELAXED: usize = 100_000;

/// Bytes of memory that relaxing takes per rotation (points and images, sorted by cell).
pub const BYTES_RELAXED: u64 = 250;

/// Name of the set of `count` rotations.
pub fn set_name(count: usize) -> &'static str {
    if count <= MAX_RELAXED {
        "super-Fibonacci (Alexa 2022), closed under the grid's turns, relaxed"
    } else {
        "super-Fibonacci (Alexa 2022), closed under the grid's turns"
    }
}

/// Parts of a unit quaternion, (w, x, y, z).
type Point = [f64; 4];

/// Root of x^4 = x + 4: the divisor of the second angle.
const TURN: f64 = 1.533_751_168_755_204_3;

/// Rotation `index` of a spiral of `count`.
fn rotation(index: usize, count: usize) -> UnitQuaternion<f64> {
    let s = index as f64 + 0.5;
    let t = s / count as f64;
    let (a, b) = (2.0 * PI * s / 2f64.sqrt(), 2.0 * PI * s / TURN);
    let (inner, outer) = (t.sqrt(), (1.0 - t).sqrt());
    UnitQuaternion::from_quaternion(Quaternion::new(
        outer * b.cos(),
        inner * a.sin(),
        inner * a.cos(),
        outer * b.sin(),
    ))
}

/// `count` rotations of a spiral that are nearer to none than their images under the grid's turns are, or a few more.
fn domain(count: usize) -> Vec<Point> {
    let images = GridTurn::ALL.len();
    let mut size = images * count;
    loop {
        let points: Vec<Point> = (0..size)
            .map(|index| rotation(index, size))
            .map(|q| [q.w, q.i, q.j, q.k])
            .filter(is_nearest)
            .collect();
        if points.len() >= count {
            return points;
        }
        size += count.max(16) / 16;
    }
}

/// Whether the rotation turns by a smaller angle than each of its images: |w| is the cosine of half the angle.
fn is_nearest(point: &Point) -> bool {
    let images = &GridTurn::ALL[1..];
    images
        .iter()
        .all(|turn| turn.after_parts(*point)[0].abs() < point[0].abs())
}

/// Moves points away from each other on the sphere of quaternions, their images and antipodes included.
///
/// Takes 40 steps, which shrink to nothing. Independent of the number of threads.
fn relax(base: &mut [Point]) {
    const STEPS: usize = 40;
    // Each of the 16 images of each point, antipodes included, has this much of the sphere's length scale.
    let spacing = (2.0 * PI * PI / (16.0 * base.len() as f64)).cbrt();
    let cutoff = (2.2 * spacing).min(2.0);
    // Cells no smaller than the cut-off, and few enough for memory.
    let cells = ((2.0 / cutoff) as usize).clamp(1, 40);
    let cell = |x: f64| (((x + 1.0) * 0.5 * cells as f64) as usize).min(cells - 1);
    let place =
        |p: &Point| ((cell(p[0]) * cells + cell(p[1])) * cells + cell(p[2])) * cells + cell(p[3]);
    for step in 0..STEPS {
        let all: Vec<(usize, Point)> = base
            .iter()
            .flat_map(|&point| GridTurn::ALL.map(|turn| turn.after_parts(point)))
            .flat_map(|point| [point, point.map(|part| -part)])
            .map(|point| (place(&point), point))
            .collect();
        // Points of a cell keep their order: the sums below must not depend on threads.
        let all = Bins::new(cells.pow(4), all, |&(place, _)| place);
        let length = 0.1 * spacing * (1.0 - step as f64 / STEPS as f64);
        let moved: Vec<Point> = base
            .par_iter()
            .map(|point| {
                let force = push(point, &all, cells, cell, spacing, cutoff);
                let along: f64 = (0..4).map(|i| force[i] * point[i]).sum();
                let force: Point = std::array::from_fn(|i| force[i] - along * point[i]);
                let size = force.iter().map(|x| x * x).sum::<f64>().sqrt().max(1.0);
                let next: Point = std::array::from_fn(|i| point[i] + length / size * force[i]);
                let norm = next.iter().map(|x| x * x).sum::<f64>().sqrt();
                next.map(|part| part / norm)
            })
            .collect();
        base.copy_from_slice(&moved);
    }
}

/// Sum over the neighbours of (spacing / distance)^6, pointing away from them, faded out at the cut-off.
fn push(
    point: &Point,
    all: &Bins<(usize, Point)>,
    cells: usize,
    cell: impl Fn(f64) -> usize,
    spacing: f64,
    cutoff: f64,
) -> Point {
    let range = |x: f64| cell(x - cutoff)..=cell(x + cutoff);
    let mut force = [0.0; 4];
    for a in range(point[0]) {
        for b in range(point[1]) {
            for c in range(point[2]) {
                let row = ((a * cells + b) * cells + c) * cells;
                let ends = range(point[3]);
                for (_, other) in all.run(row + ends.start(), row + ends.end()) {
                    let away: Point = std::array::from_fn(|i| point[i] - other[i]);
                    let square: f64 = away.iter().map(|x| x * x).sum();
                    if square >= cutoff * cutoff || square == 0.0 {
                        continue;
                    }
                    let fade = 1.0 - square / (cutoff * cutoff);
                    let weight = (spacing * spacing / square).powi(3) * fade * fade / square.sqrt();
                    for i in 0..4 {
                        force[i] += weight * away[i];
                    }
                }
            }
        }
    }
    force
}

/// Rotations that are compared at a time.
const LANES: usize = 8;

/// Covering radius of a set: the largest angle in radians from any rotation to the nearest of the set.
///
/// Maximised from a fixed sample of starts, so a lower bound, within a few per cent.
pub fn covering_radius(set: &[UnitQuaternion<f64>]) -> f64 {
    // |q.p| is the cosine of half the angle. Eight points at a time, component by component, fill vector registers; the
    // last point fills what is left.
    let points: Vec<[[f32; LANES]; 4]> = set
        .chunks(LANES)
        .map(|chunk| {
            let quaternion = |lane: usize| {
                let q = chunk[lane.min(chunk.len() - 1)];
                [q.w as f32, q.i as f32, q.j as f32, q.k as f32]
            };
            std::array::from_fn(|part| std::array::from_fn(|lane| quaternion(lane)[part]))
        })
        .collect();
    let nearest = |q: &[f32; 4]| -> f32 {
        let mut largest = [0.0f32; LANES];
        for [w, x, y, z] in &points {
            let mut cosines = [0.0f32; LANES];
            for lane in 0..LANES {
                cosines[lane] = w[lane] * q[0] + x[lane] * q[1] + y[lane] * q[2] + z[lane] * q[3];
            }
            for (largest, cosine) in largest.iter_mut().zip(cosines) {
                let cosine = cosine.abs();
                // A comparison: `f32::max` handles NaN and takes three instructions.
                *largest = if cosine > *largest { cosine } else { *largest };
            }
        }
        largest.into_iter().fold(0.0, f32::max)
    };
    // About 4e8 comparisons at most: measuring a set of a million takes no longer than making it.
    let starts = (1_500_000 / set.len().max(1)).clamp(8, 384);
    let farthest = |start: usize| {
        // A spiral of another size samples SO(3) independently of the set.
        let q = rotation(start, starts);
        let mut best = [q.w as f32, q.i as f32, q.j as f32, q.k as f32];
        let mut cosine = nearest(&best);
        let mut step = 1.5 / (set.len() as f32).cbrt();
        while step > 0.05 / (set.len() as f32).cbrt() {
            let mut moved = false;
            for axis in 0..4 {
                for sign in [-1.0, 1.0] {
                    let mut trial = best;
                    trial[axis] += sign * step;
                    let norm = trial.iter().map(|x| x * x).sum::<f32>().sqrt();
                    trial = trial.map(|x| x / norm);
                    let value = nearest(&trial);
                    if value < cosine {
                        (best, cosine, moved) = (trial, value, true);
                    }
                }
            }
            if !moved {
                step *= 0.5;
            }
        }
        cosine
    };
    let worst = (0..starts).into_par_iter().map(farthest);
    let worst = worst.reduce(|| 1.0, f32::min);
    2.0 * f64::from(worst.min(1.0)).acos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn covers_as_evenly_as_the_field_expects() {
        for count in [60, 500, 3600] {
            let set = rotation_set(count);
            let radius = covering_radius(&set);
            // A ball of angle a is the share (a - sin a) / pi of SO(3). No covering radius is below that of share 1 /
            // n.
            let mut least = 0.0f64;
            while (least - least.sin()) / PI < 1.0 / count as f64 {
                least += 1e-4;
            }
            assert!(
                radius > least && radius < 2.2 * least,
                "{count}: {radius} {least}"
            );
        }
    }

    #[test]
    fn turns_map_the_set_onto_itself_and_it_has_the_requested_size() {
        for count in [1, 2, 3, 5, 60, 1201] {
            let set = rotation_set(count);
            assert_eq!(set.len(), count);
            for (index, q) in set.iter().enumerate() {
                assert_eq!(*q, GridTurn::ALL[index % 8].after(&set[index - index % 8]));
                assert!((q.norm() - 1.0).abs() < 1e-12);
            }
        }
    }

    /// A spiral with too many points is thinned evenly, so that no removed point leaves a hole.
    #[test]
    fn spirals_have_no_hole() {
        let mut with_too_many = 0;
        for wanted in (4000..4040).chain([25_003, 25_100]) {
            let points = domain(wanted);
            with_too_many += usize::from(points.len() > wanted);
            let kept: Vec<Point> = spiral_set(8 * wanted)
                .iter()
                .step_by(8)
                .map(|q| [q.w, q.i, q.j, q.k])
                .collect();
            let spacing = (2.0 * PI * PI / (16.0 * wanted as f64)).cbrt();
            let last = points.iter().rev().take(points.len() - wanted);
            for point in last {
                let nearest = kept.iter().map(|other| {
                    let square = |i: usize| (point[i] - other[i]).powi(2);
                    (0..4).map(square).sum::<f64>()
                });
                assert!(
                    nearest.fold(9.0, f64::min).sqrt() < 2.0 * spacing,
                    "{wanted}"
                );
            }
        }
        assert!(with_too_many > 3);
    }

    /// The purpose of the relaxation: a random rotation's nearest neighbour is no farther than in the plain spiral, on
    /// average and at worst.
    #[test]
    fn relaxed_set_covers_no_worse_than_the_spiral() {
        let relaxed = rotation_set(1200);
        let spiral: Vec<_> = (0..1200).map(|i| rotation(i, 1200)).collect();
        let probes: Vec<_> = (0..5000).map(|i| rotation(i, 5000)).collect();
        let angles = |set: &[UnitQuaternion<f64>]| -> (f64, f64) {
            let nearest = probes.iter().map(|probe| {
                let angle = set.iter().map(|q| q.angle_to(probe));
                angle.fold(f64::INFINITY, f64::min)
            });
            nearest.fold((0.0, 0.0), |(sum, worst), angle| {
                (sum + angle / 5000.0, f64::max(worst, angle))
            })
        };
        let ((mean, worst), (spiral_mean, spiral_worst)) = (angles(&relaxed), angles(&spiral));
        assert!(mean < spiral_mean, "{mean} {spiral_mean}");
        assert!(worst < 1.02 * spiral_worst, "{worst} {spiral_worst}");
    }

    /// Uniform over SO(3): the mean of the rotation matrices vanishes.
    #[test]
    fn mean_rotation_vanishes() {
        let set = rotation_set(3600);
        let sum = set.iter().fold(nalgebra::Matrix3::zeros(), |sum, q| {
            sum + q.to_rotation_matrix().matrix()
        });
        assert!((sum / 3600.0).norm() < 0.02);
    }
}
