//! Relaxation of rotations, which evens out how they cover SO(3).

use super::spiral::Point;
use crate::grid_turn::GridTurn;
use knotdock_structures::neighbours::Bins;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Moves points away from each other on the sphere of quaternions, their images and antipodes included.
///
/// Takes 40 steps, which shrink to nothing. Independent of the number of threads.
pub(super) fn relax(base: &mut [Point]) {
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
