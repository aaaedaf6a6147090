//! The states that a side chain may take, as chi angles.

use knotdock_structures::molecule::{SideChain, rotamers};

/// How far from a rotamer, and from the present angles, the first two angles are tried, in radians: 10 degrees.
const STEP: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// The chi angles of each state in radians: the present ones, their neighbours, and the rotamers of the backbone with
/// theirs.
///
/// A neighbour differs by 10 degrees in the first or the second angle.
pub(super) fn candidates(side_chain: &SideChain, present: &[f64]) -> Vec<Vec<f64>> {
    let mut states = neighbourhood(present, 2, STEP);
    let [phi, psi] = side_chain.backbone;
    for rotamer in rotamers(side_chain.residue, phi, psi) {
        let mean = rotamer.chi.get(..present.len()).unwrap_or_default();
        states.extend(neighbourhood(mean, 2, STEP));
    }
    states
}

/// The present angles, those found, and those that differ from them by `step` (radians) in one angle.
pub(super) fn around(present: &[f64], found: &[f64], step: f64) -> Vec<Vec<f64>> {
    let mut states = vec![present.to_vec()];
    states.extend(neighbourhood(found, found.len(), step));
    states
}

/// Angles, and those one step away in one of the first `count`.
fn neighbourhood(chi: &[f64], count: usize, step: f64) -> Vec<Vec<f64>> {
    let mut all = vec![chi.to_vec()];
    for k in 0..chi.len().min(count) {
        for step in [step, -step] {
            let mut near = chi.to_vec();
            near[k] += step;
            all.push(near);
        }
    }
    all
}
