//! Fairness of the product kernel: overlap counts by volume, whatever balls a solid is made of.

use knotdock::mesh::samplers::Sampler;
use knotdock::mesh::{MeshOptions, SampledPart, sample_pair};
use knotdock::options::SampleWeights;
use knotdock_scoring::engine::{EngineOptions, Plan};
use knotdock_scoring::exact_sum::ExactSum;
use knotdock_scoring::kernel::{Band, KernelOptions, Trim};
use knotdock_scoring::se3::Pose;
use knotdock_structures::Knots;
use knotdock_structures::mesh::{Solid, from_triangles};
use nalgebra::Vector3;

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

const OFFSET: f64 = 0.14;

fn sampled(solids: [&Solid; 2], per_axis: usize) -> [SampledPart; 2] {
    let options = MeshOptions {
        per_axis,
        sampler: Sampler::Bi,
        offset: Some(OFFSET),
        weights: SampleWeights::Fitted,
        alpha: 16.0,
    };
    sample_pair(solids.map(Into::into), &options).unwrap().parts
}

/// Both bodies' balls as one.
fn together(a: &Knots, b: &Knots) -> Knots {
    let both = |a: &[f64], b: &[f64]| [a, b].concat();
    Knots::with_weights(
        [&a.centers[..], &b.centers].concat(),
        both(&a.radii, &b.radii),
        both(&a.weights, &b.weights),
    )
    .unwrap()
}

/// A block, and the same block as two halves that touch. The overlap with a probe is the same volume, to the error of
/// the fit, though the halves have other balls and more of them.
#[test]
fn a_solid_in_two_halves_overlaps_as_the_whole() {
    let whole = cuboid([-0.5, -0.4, -0.3], [0.5, 0.4, 0.3]);
    let halves = [
        cuboid([-0.5, -0.4, -0.3], [0.0, 0.4, 0.3]),
        cuboid([0.0, -0.4, -0.3], [0.5, 0.4, 0.3]),
    ];
    let probe = cuboid([-0.25, -0.3, -0.35], [0.25, 0.3, 0.35]);
    let [whole, probe] = sampled([&whole, &probe], 28);
    let [left, right] = sampled([&halves[0], &halves[1]], 28);
    let halves = together(&left.knots, &right.knots);
    let engine = EngineOptions {
        kernel: KernelOptions {
            lambda: 9.0,
            offset: 0.5 * OFFSET,
            alpha: 16.0,
            resolution: 2.0 * OFFSET,
            pass_length: 4.0 * OFFSET,
            trim: Trim::FlatTop,
        },
        spacing: None,
        tolerance: 1e-2,
    };
    let overlap = |receptor: &Knots, shift: f64| {
        let mut probe = probe.knots.clone();
        probe.skin_weights.clear();
        let plan = Plan::product_in(receptor, &probe, engine, Band::LowPass, 1.0).unwrap();
        let exact = ExactSum::of(&plan, receptor, &probe).unwrap();
        let pose = Pose {
            translation: Vector3::new(shift, 0.0, 0.0),
            ..Pose::identity()
        };
        exact.score(&pose).slices[0]
    };
    let mut plain = whole.knots.clone();
    plain.skin_weights.clear();
    for shift in [0.0, 0.2, 0.4] {
        // Along x the probe reaches 0.25 to either side, across the block it is clipped to 0.6 x 0.6.
        let length = (0.5f64.min(shift + 0.25) - (shift - 0.25)) * 0.6 * 0.6;
        let [one, two] = [overlap(&plain, shift), overlap(&halves, shift)];
        println!("{shift}: volume {length:.4}, whole {one:.4}, halves {two:.4}");
        assert!((one - two).abs() < 0.12 * one, "{one} {two}");
        // Bodies are grown by a sixth of an offset, and bumps leave gaps: to a third.
        assert!((one / length - 1.0).abs() < 0.35, "{one} {length}");
    }
}
