//! The gap between two meshes, searched where no length fixes it.
//!
//! The default gap may be twice the true clearance, and a gap is found from 0.65 to 1.55 of itself. So two are searched:
//! the default one and [`CLOSER`] of it. The closer one is kept if more of the surfaces face each other at its best pose.
//!
//! Scores of two gaps do not compare. Times the square of the offset they are about areas, but an edge counts as a strip
//! as wide as the offset, which favours the wider gap. The *facing area* has no such strip: it is the area of one surface
//! whose nearest point of the other is straight ahead, within 1.55 of the wider gap. Of the areas of both surfaces
//! the smaller one counts, for a part that is wrapped loosely around another faces it with more than it is faced.

use crate::dock::outcome::{DockOutcome, StageTime};
use crate::dock::pair::PreparedPair;
use crate::dock::run::Searched;
use crate::options::DockOptions;
use crate::progress::Progress;
use crate::threads;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use knotdock_structures::mesh::{Solid, SurfaceSample};
use nalgebra::Vector3;
use rayon::prelude::*;
use serde::Serialize;

/// The second gap as a share of the default one.
pub const CLOSER: f64 = 0.65;
/// Poses of each gap that are refined before one is chosen.
const PROBED: usize = 100;
/// Farthest that surfaces face each other, in wider gaps: up to there flat faces have half of the best score.
const REACH: f64 = 1.55;
/// Least cosine between a normal and the way to the nearest point that is straight ahead.
const AHEAD: f64 = 0.8;
/// Ratio of facing areas from which on the closer gap is better. If both gaps find one pose, areas differ by the places
/// of the samples alone, and the wider gap has fewer balls to rank by.
const MARGIN: f64 = 1.01;
/// Largest distance between a point of a surface and its nearest sample, in wider gaps.
const SAMPLE_SPACING: f64 = 0.5;

/// A gap that was searched.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SearchedGap {
    /// The gap: the offset r0, in the files' unit.
    pub offset: f64,
    /// Facing area of its best pose, in the square of the files' unit: an estimate by samples of the surfaces.
    pub facing_area: f64,
}

/// A docking at the gap with the larger facing area.
pub struct DockedAtGap {
    /// Its outcome. The stage `other gap` is the search at the other.
    pub outcome: DockOutcome,
    /// Number of the gap.
    pub gap: usize,
    /// The wider gap and the closer one.
    pub gaps: [SearchedGap; 2],
}

/// Options at the closer gap: every length shrinks with it, but for a radius of clusters that was given.
pub fn closer(options: &DockOptions, cluster_radius_given: bool) -> DockOptions {
    options.changed(|options| {
        let kernel = &mut options.kernel;
        kernel.offset *= CLOSER;
        kernel.resolution *= CLOSER;
        for length in [&mut kernel.pass_length, &mut kernel.spacing] {
            *length = length.map(|length| CLOSER * length);
        }
        if !cluster_radius_given {
            options.ranking.cluster_radius *= CLOSER;
        }
    })
}

/// Searches two solids at two gaps, the wider one first, and ranks the poses of the one with the larger facing area.
///
/// # Errors
/// As [`dock`](crate::dock::run::dock).
pub fn dock_at_gaps(
    pairs: [&PreparedPair; 2],
    solids: [&Solid; 2],
    progress: &dyn Progress,
) -> Result<DockedAtGap, Error> {
    let threads = pairs.map(|pair| pair.plan.in_flight());
    threads::on(threads[0].min(threads[1]), || {
        dock_on_threads(pairs, solids, progress)
    })?
}

/// The search on the threads of the current pool.
fn dock_on_threads(
    pairs: [&PreparedPair; 2],
    solids: [&Solid; 2],
    progress: &dyn Progress,
) -> Result<DockedAtGap, Error> {
    let (first, second) = (search(pairs[0], progress)?, search(pairs[1], progress)?);
    let offsets = pairs.map(|pair| pair.plan.options.kernel.offset);
    let gaps = [(offsets[0], &first), (offsets[1], &second)].map(|(offset, searched)| {
        let area = |pose: &Pose| facing_area(solids, pose, offsets[0]);
        SearchedGap {
            offset,
            facing_area: searched.best().map_or(0.0, area),
        }
    });
    let gap = usize::from(gaps[1].facing_area > MARGIN * gaps[0].facing_area);
    let (mut best, other) = match gap {
        0 => (first, second),
        _ => (second, first),
    };
    let stages = other.into_stages();
    best.resume();
    best.refine(usize::MAX, progress)?;
    let mut outcome = best.ranked(None, progress)?;
    outcome.timing.push(StageTime {
        name: "other gap",
        wall_seconds: stages.iter().map(|stage| stage.wall_seconds).sum(),
        cpu_seconds: stages.iter().map(|stage| stage.cpu_seconds).sum(),
    });
    Ok(DockedAtGap { outcome, gap, gaps })
}

/// A pair's search, with the best poses refined.
fn search<'a>(pair: &'a PreparedPair, progress: &dyn Progress) -> Result<Searched<'a>, Error> {
    let mut searched = Searched::new(&pair.plan, &pair.points, None, progress)?;
    searched.refine(PROBED, progress)?;
    Ok(searched)
}

/// The smaller of the areas with which two solids face each other at a pose, within `REACH` times `gap`.
fn facing_area([receptor, ligand]: [&Solid; 2], pose: &Pose, gap: f64) -> f64 {
    let inverse = pose.inverse();
    area_before(receptor, ligand, pose, gap).min(area_before(ligand, receptor, &inverse, gap))
}

/// Area of the surface of `moved` at a pose that faces `fixed`.
fn area_before(fixed: &Solid, moved: &Solid, pose: &Pose, gap: f64) -> f64 {
    let unit = moved.frame().unit;
    let (reach, spacing) = (REACH * gap, SAMPLE_SPACING * gap / unit);
    let area = |triangle: usize| {
        let mut area = 0.0;
        let visit = |sample: SurfaceSample| {
            let point = pose.apply(moved.frame().outward(sample.point));
            let nearest = fixed.nearest(fixed.frame().inward(point));
            let way = Vector3::from(fixed.frame().outward(nearest)) - Vector3::from(point);
            let normal = pose.rotation * Vector3::from(sample.normal);
            if way.norm() <= reach && way.dot(&normal) >= AHEAD * way.norm() {
                area += sample.area;
            }
        };
        moved.samples_of(triangle, spacing, |_, _| false, visit);
        area
    };
    let triangles = 0..moved.sampled_triangles();
    let areas: Vec<f64> = triangles.into_par_iter().map(area).collect();
    areas.iter().sum::<f64>() * unit * unit
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_structures::mesh::from_triangles;

    /// A box about the origin, its corners moved by `shift`.
    fn cuboid(half: [f64; 3], shift: f64) -> Solid {
        let corner = |index: usize| {
            [0, 1, 2].map(|axis| match index >> axis & 1 {
                1 => shift + half[axis],
                _ => shift - half[axis],
            })
        };
        let corners: Vec<[f64; 3]> = (0..8).map(corner).collect();
        let faces = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let halves = faces
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let triangles: Vec<[u32; 3]> = halves.collect();
        let (mesh, _) = from_triangles(&corners, &triangles).unwrap();
        Solid::new(&mesh).unwrap()
    }

    /// A block on a larger one faces it with its base alone, at any gap within reach, whatever the origins of the files; a
    /// strip about the base of the larger one is not ahead of the block.
    #[test]
    fn blocks_face_each_other_by_the_smaller_base() {
        let solids = [cuboid([3.0, 2.5, 1.0], 0.0), cuboid([1.5, 0.7, 2.0], 40.0)];
        let solids = [&solids[0], &solids[1]];
        let at = |gap: f64| {
            let quarter = std::f64::consts::FRAC_1_SQRT_2;
            // A quarter turn about z: (x, y) becomes (-y, x).
            Pose::from_parts([quarter, 0.0, 0.0, quarter], [40.0, -40.0, gap - 37.0])
        };
        for gap in [0.02, 0.1, 0.15] {
            let area = facing_area(solids, &at(gap), 0.1);
            assert!((area - 4.2).abs() < 0.15, "{gap}: {area}");
        }
        assert_eq!(facing_area(solids, &at(0.16), 0.1), 0.0);
        // Within each other nothing is ahead.
        assert_eq!(facing_area(solids, &at(-0.1), 0.1), 0.0);
    }

    /// Lengths that were not given shrink with the gap.
    #[test]
    fn lengths_shrink_with_the_gap() {
        let wide = DockOptions::default().changed(|options| options.kernel.spacing = Some(2.0));
        let near = closer(&wide, false);
        let share = |of: fn(&DockOptions) -> f64| of(&near) / of(&wide);
        for share in [
            share(|options| options.kernel.offset),
            share(|options| options.kernel.resolution),
            share(|options| options.kernel.spacing.unwrap()),
            share(|options| options.ranking.cluster_radius),
        ] {
            assert!((share - CLOSER).abs() < 1e-12);
        }
        let given = closer(&wide, true).ranking.cluster_radius;
        assert_eq!(given, wide.ranking.cluster_radius);
    }
}
