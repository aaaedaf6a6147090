//! Fitted weights against solutions known by hand.

#![cfg(feature = "mesh")]

use std::f64::consts::PI;

use crate::solids::{cuboid, sphere};
use knotdock_structures::numeric::Bump;
use knotdock_structures::sampling::decomposition::DecompositionOptions;
use knotdock_structures::sampling::grid::{DepthField, Grid};
use knotdock_structures::sampling::weights::fit;
use knotdock_structures::sampling::{Ball, Method, sample};

fn bump(alpha: f64) -> Bump {
    Bump::new(alpha).unwrap()
}

#[test]
fn the_bump_is_that_of_the_paper() {
    let values = [0.0, 1.0, 2.0].map(|x| bump(2.0).value(x));
    assert_eq!(values, [1.0, 0.0, 0.0]);
    assert!((bump(2.0).value(0.5f64.sqrt()) - (-1f64).exp()).abs() < 1e-15);
    // The indicator of the ball as alpha grows.
    let volume = |alpha| bump(alpha).volume();
    assert!((volume(1e5) - 4.0 / 3.0 * PI).abs() < 1e-3);
    assert!(volume(1.0) < volume(2.0) && volume(2.0) < volume(8.0));
}

#[test]
fn one_ball_and_its_copies() {
    let solid = sphere([0.0; 3], 1.0, 20).solid();
    let field = DepthField::new(&solid, Grid::new(&solid, 15));
    let ball = Ball {
        center: [0.0; 3],
        radius: 0.5,
    };
    // The least squares weight of a single column, from its own sums.
    let values: Vec<f64> = field
        .inside()
        .into_iter()
        .map(|node| {
            field
                .grid
                .node(node)
                .iter()
                .map(|v| v * v)
                .sum::<f64>()
                .sqrt()
                / 0.5
        })
        .map(|x| bump(2.0).value(x))
        .collect();
    let expected = values.iter().sum::<f64>() / values.iter().map(|v| v * v).sum::<f64>();
    let one = fit(&field, &[ball], bump(2.0), 0.5);
    assert!(
        (one.weights[0] / expected - 1.0).abs() < 1e-6,
        "{} {expected}",
        one.weights[0]
    );
    assert!(one.rms_fitted < one.rms_unit);
    // A ball split in copies keeps its sum.
    let three = fit(&field, &[ball; 3], bump(2.0), 0.5);
    assert!((three.weights.iter().sum::<f64>() / expected - 1.0).abs() < 1e-3);
    assert!((three.rms_fitted - one.rms_fitted).abs() < 1e-6);
    assert!((three.volume_unit / one.volume_unit - 3.0).abs() < 1e-12);
    // With an indicator for a bump a ball that covers all has weight one and leaves nothing over.
    let cube = cuboid([-0.5; 3], [0.5; 3]).solid();
    let field = DepthField::new(&cube, Grid::new(&cube, 9));
    let all = Ball {
        center: [0.0; 3],
        radius: 2.0,
    };
    let exact = fit(&field, &[all, all], bump(1e9), 1.0);
    assert!((exact.weights.iter().sum::<f64>() - 1.0).abs() < 1e-6 && exact.rms_fitted < 1e-6);
}

/// At the minimum over c >= 0 the gradient is zero where a weight is above zero, and not below zero where it is zero.
#[test]
fn weights_meet_the_conditions_of_the_minimum() {
    let solid = cuboid([-1.0, -0.6, -0.4], [1.0, 0.6, 0.4]).solid();
    let sampling = sample(
        &solid,
        18,
        Method::BehandishIlies(DecompositionOptions::default()),
    )
    .unwrap();
    let field = &sampling.field;
    let balls = &sampling.sets[2].balls;
    let volume = 2.0 * 1.2 * 0.8 / solid.frame().unit.powi(3);
    let fitted = fit(field, balls, bump(2.0), volume);
    let value = |ball: &Ball, node: usize| {
        let place = field.grid.node(node);
        let spacing = (0..3)
            .map(|axis| (place[axis] - ball.center[axis]).powi(2))
            .sum::<f64>()
            .sqrt();
        bump(2.0).value(spacing / ball.radius)
    };
    let nodes: Vec<usize> = (0..field.grid.nodes())
        .filter(|&node| field.depth[node] != 0.0)
        .collect();
    let target = |node: usize| if field.depth[node] > 0.0 { 1.0 } else { 0.0 };
    let left: Vec<f64> = nodes
        .iter()
        .map(|&node| {
            target(node)
                - balls
                    .iter()
                    .zip(&fitted.weights)
                    .map(|(ball, w)| w * value(ball, node))
                    .sum::<f64>()
        })
        .collect();
    for (ball, &weight) in balls.iter().zip(&fitted.weights) {
        assert!(weight >= 0.0);
        let column: Vec<f64> = nodes.iter().map(|&node| value(ball, node)).collect();
        let square: f64 = column.iter().map(|v| v * v).sum();
        if square < 0.1 {
            assert_eq!(weight, 1.0, "the nodes hardly see this ball");
            continue;
        }
        let pull = column.iter().zip(&left).map(|(v, l)| v * l).sum::<f64>() / square;
        assert!(
            pull < 2e-3 && (weight == 0.0 || pull > -2e-3),
            "weight {weight}, pull {pull}"
        );
    }
    let inside = nodes
        .iter()
        .zip(&left)
        .filter(|(node, _)| target(**node) == 1.0);
    let squares: Vec<f64> = inside.map(|(_, left)| left * left).collect();
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!((rms - fitted.rms_fitted).abs() < 1e-4);
    assert!(fitted.rms_fitted < 0.5 * fitted.rms_unit, "{fitted:?}");
    assert!(
        (fitted.volume_fitted - 1.0).abs() < (fitted.volume_unit - 1.0).abs(),
        "{fitted:?}"
    );
}
