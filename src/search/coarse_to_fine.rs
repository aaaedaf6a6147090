//! Coarse to fine: rotations of a finer set about the best of the coarse one.
//!
//! Each rotation of the finer set belongs to the nearest rotation of the coarse one, in whose *cell* it lies. The
//! coarse rotations' cells are searched in the order of their best peaks, until a given share of the finer set has
//! been. In a searched cell the best peaks of all its rotations, coarse and fine, replace the coarse rotation's own.
//! They have the same number and spacing, so the list of poses keeps its length and its spread, with better poses in
//! its best regions. (Keeping every fine peak would fill the list with copies of the best few.)

use crate::progress::Progress;
use crate::search::plan::SearchPlan;
use crate::search::scan::scan;
use crate::search::scan_engine::ScanEngine;
use knotdock_scoring::peaks::{NEIGHBOURS, Peak};
use knotdock_structures::Error;
use nalgebra::{UnitQuaternion, Vector3};
use rayon::prelude::*;
use serde::Serialize;

/// Coverage of a finer search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct FineSearched {
    /// Rotations of the finer set that were searched.
    pub rotations: usize,
    /// Coarse rotations whose cells these are.
    pub cells: usize,
}

/// Searches the finer rotations about the best of `coarse`, all its peaks best first. Returned are the best peaks of
/// both, best first, and the coverage.
pub(crate) fn search_finer(
    plan: &SearchPlan,
    engine: &ScanEngine,
    mut coarse: Vec<Peak>,
    progress: &dyn Progress,
) -> Result<(Vec<Peak>, FineSearched), Error> {
    let (set, fine_set) = (&plan.rotations.coarse, &plan.rotations.fine);
    let cell_of = nearest(fine_set, set);
    let mut sizes = vec![0usize; set.len()];
    for &cell in &cell_of {
        sizes[cell as usize] += 1;
    }
    let wanted = (plan.fine_share * fine_set.len() as f64).ceil() as usize;
    let mut chosen = vec![false; set.len()];
    let (mut rotations, mut cells) = (0, 0);
    for peak in &coarse {
        if rotations >= wanted {
            break;
        }
        let cell = peak.rotation as usize;
        if !std::mem::replace(&mut chosen[cell], true) {
            rotations += sizes[cell];
            cells += 1;
        }
    }
    coarse.truncate(plan.kept);
    let is_chosen = |index: usize| chosen[cell_of[index] as usize];
    let groups = plan.rotations.fine_groups(is_chosen);
    progress.stage("fine", rotations as u64);
    let mut crowded = scan(plan, engine, &groups, usize::MAX, None, progress)?.peaks;

    let cell = |peak: &Peak| match (peak.rotation as usize).checked_sub(set.len()) {
        Some(index) => cell_of[index],
        None => peak.rotation,
    };
    let is_searched = |peak: &Peak| chosen[peak.rotation as usize];
    let (from_coarse, mut peaks): (Vec<_>, Vec<_>) = coarse.into_iter().partition(is_searched);
    crowded.reserve_exact(from_coarse.len());
    crowded.extend(from_coarse);
    crowded.sort_unstable_by(|a, b| cell(a).cmp(&cell(b)).then(a.order(b)));
    let position = |peak: &Peak| {
        let (_, half_turn) = plan.rotations.rotation(peak.rotation as usize);
        let voxel = peak.voxel as usize;
        engine.cpu.position_after(half_turn, voxel)
    };
    for group in crowded.chunk_by(|a, b| cell(a) == cell(b)) {
        let spacing = plan.engine.spacing();
        peaks.extend(spaced(group, plan.per_rotation, spacing, position));
    }
    peaks.sort_unstable_by(Peak::order);
    peaks.truncate(plan.kept);
    Ok((peaks, FineSearched { rotations, cells }))
}

/// The first `count` peaks, best first, that are farther from those before them than neighbours of one rotation's peaks
/// may be.
fn spaced(
    peaks: &[Peak],
    count: usize,
    spacing: f64,
    position: impl Fn(&Peak) -> Vector3<f64>,
) -> Vec<Peak> {
    // Half a voxel over: positions of different images are between one another's voxels, and the grid's axes may be
    // askew in the file.
    let least = (NEIGHBOURS as f64 + 0.5) * spacing;
    let mut kept: Vec<(Vector3<f64>, Peak)> = Vec::with_capacity(count.min(peaks.len()));
    for peak in peaks {
        if kept.len() == count {
            break;
        }
        let at = position(peak);
        if kept.iter().all(|(other, _)| (at - other).amax() > least) {
            kept.push((at, *peak));
        }
    }
    kept.into_iter().map(|(_, peak)| peak).collect()
}

/// The nearest rotation of `coarse` to each of `fine`; the first of several.
fn nearest(fine: &[UnitQuaternion<f64>], coarse: &[UnitQuaternion<f64>]) -> Vec<u32> {
    let parts = |q: &UnitQuaternion<f64>| [q.w as f32, q.i as f32, q.j as f32, q.k as f32];
    let coarse: Vec<[f32; 4]> = coarse.iter().map(parts).collect();
    fine.par_iter()
        .map(|rotation| {
            let [w, x, y, z] = parts(rotation);
            let mut best = (0, -1.0f32);
            for (index, p) in (0u32..).zip(&coarse) {
                // |q.p| is the cosine of half the angle between them.
                let cosine = (p[0] * w + p[1] * x + p[2] * y + p[3] * z).abs();
                if cosine > best.1 {
                    best = (index, cosine);
                }
            }
            best.0
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_scoring::so3::{rotation_set, spiral_set};

    #[test]
    fn cells_are_those_of_the_nearest_rotation() {
        let (coarse, fine) = (rotation_set(60), spiral_set(960));
        let cells = nearest(&fine, &coarse);
        let mut sizes = [0usize; 60];
        for (rotation, &cell) in fine.iter().zip(&cells) {
            sizes[cell as usize] += 1;
            let angle = |other: &UnitQuaternion<f64>| rotation.angle_to(other);
            let least = coarse.iter().map(angle).fold(f64::INFINITY, f64::min);
            assert!(angle(&coarse[cell as usize]) < least + 1e-3);
        }
        // Sixteen on average.
        assert!(
            sizes.iter().all(|size| (6..=32).contains(size)),
            "{sizes:?}"
        );
    }

    #[test]
    fn peaks_of_a_cell_keep_their_distance() {
        let peak = |voxel: u32| Peak {
            score: 100.0 - f64::from(voxel),
            rotation: 0,
            voxel,
        };
        let peaks: Vec<Peak> = (0..10).map(peak).collect();
        let on_a_line = |peak: &Peak| Vector3::new(f64::from(peak.voxel), 0.0, 0.0);
        let kept = spaced(&peaks, 3, 1.0, on_a_line);
        assert_eq!(kept, [peak(0), peak(3), peak(6)]);
        assert_eq!(spaced(&peaks, 9, 1.0, on_a_line).len(), 4);
        assert_eq!(spaced(&peaks[..0], 3, 1.0, on_a_line), []);
    }
}
