//! Fairness of the product kernel: faces count by their area, whatever balls a solid is made of.

use super::landscape::double_skin_scores;
use knotdock::dock::pair::{GivenDefaults, PreparedPair, Sampling, sampled_defaults};
use knotdock::mesh::MeshOptions;
use knotdock::mesh::samplers::Sampler;
use knotdock::options::{DockOptions, SampleWeights};
use knotdock_scoring::se3::Pose;
use knotdock_structures::mesh::{Solid, from_triangles};
use nalgebra::Vector3;
use std::sync::Arc;

/// A box between two corners.
fn cuboid(low: [f64; 3], high: [f64; 3]) -> Solid {
    let corner = |index: usize| {
        [0, 1, 2].map(|axis| {
            if index >> axis & 1 == 1 {
                high[axis]
            } else {
                low[axis]
            }
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
    let triangles: Vec<[u32; 3]> = faces
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    let (mesh, report) = from_triangles(&corners, &triangles).unwrap();
    assert!(report.is_sound(), "{report:?}");
    Solid::new(&mesh).unwrap()
}

const OFFSET: f64 = 0.08;

/// Two blocks face to face score most at a gap of about an offset, by the area of the faces. The profiles of their double
/// skins give the score of endless faces. Edges and the error of the fit leave 0.3 to 1 times that.
#[test]
fn faces_score_by_their_area() {
    let (side, height) = (1.0, 0.5);
    let half = 0.5 * side;
    let below = cuboid([-half, -half, -height], [half, half, 0.0]);
    let above = cuboid([-half, -half, 0.0], [half, half, height]);
    let options = MeshOptions {
        per_axis: 44,
        sampler: Sampler::Bi,
        offset: Some(OFFSET),
        weights: SampleWeights::Fitted,
        alpha: Sampler::Bi.alpha(),
        lambda: 9.0,
        resolution: None,
        pass_length: None,
        memory: None,
    };
    let profiles = double_skin_scores();
    let area = (side / OFFSET).powi(2);
    let best = profiles.iter().fold(0.0f64, |best, &score| best.max(score));
    let solids = [&below, &above].map(Into::into);
    let sampling = Sampling::of(solids, &options).unwrap();
    let mut docking = DockOptions::default();
    docking.sampling.sampler = Some(Sampler::Bi);
    sampled_defaults(&sampling.pair, &mut docking, GivenDefaults::default());
    for part in &sampling.pair.parts {
        let fit = part.double_skin.as_ref().unwrap();
        println!("{} balls, {fit:?}", part.balls);
        assert!(fit.rms < 0.05 * fit.rms_of_target, "{fit:?}");
    }
    let prepared = PreparedPair::meshes(Arc::new(sampling), &docking).unwrap();
    let scorer = prepared.plan.exact_scorer().unwrap();
    let mut largest = (0.0, 0.0f64);
    for (place, profile) in profiles.iter().enumerate().skip(4).step_by(2) {
        let gap = 0.05 * place as f64;
        let pose = Pose {
            translation: Vector3::new(0.0, 0.0, gap * OFFSET),
            ..Pose::identity()
        };
        let score = scorer.score(&pose).score / (area * best);
        let expected = profile / best;
        println!("gap {gap:.1} r0: {score:.3} of the best, by the profiles {expected:.3}");
        if score > largest.1 {
            largest = (gap, score);
        }
        assert!(gap > 0.45 || score < 0.0, "{gap}: {score}");
    }
    assert!((0.9..1.35).contains(&largest.0), "{largest:?}");
    assert!((0.3..1.0).contains(&largest.1), "{largest:?}");
}
