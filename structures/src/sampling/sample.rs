//! A solid sampled by any method: the sets of balls, and the time of each step.

use std::time::Instant;

use serde::Serialize;

use crate::ball::Ball;
use crate::knots::{Knots, KnotsError};
use crate::mesh::{Frame, Solid};
use crate::sampling::cover::Covering;
use crate::sampling::decomposition::{Decomposition, DecompositionOptions, decompose_in_order};
use crate::sampling::grid::{DepthField, Grid};
use crate::sampling::skeletal_density::{Priority, priorities};
use crate::sampling::{medial, octree, packing};

/// Why a solid could not be sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SampleError {
    /// No node of the grid is inside; for Algorithm 1, nor any point under the surface.
    #[error(
        "no ball fits inside the mesh: none of the grid's nodes is inside it, or it bounds no solid"
    )]
    NothingInside,
}

/// Method by which balls are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Behandish and Ilieş, Algorithm 1: see [`super::decomposition`].
    BehandishIlies(DecompositionOptions),
    /// Weller and Zachmann, distance-greedy packing: see [`super::packing`].
    WellerZachmann,
    /// Balls about octree cells: see [`super::octree`].
    Octree,
    /// Balls about points of the medial axis: see [`super::medial`].
    MedialAxis,
    /// Uniform sampling, B&I's own baseline: about every inside node the ball of radius eps that holds the cube of one
    /// spacing.
    Voxels,
}

/// Name of a set of balls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SetName {
    /// Inside the solid.
    A1,
    /// Covering the solid: A1 grown by eps.
    A2,
    /// Between the two, and the fewest.
    A3,
    /// The one set of Weller and Zachmann's packing.
    Wz,
    /// The one set of the octree.
    Octree,
    /// The one set of the medial axis.
    Medial,
    /// The one set of the voxels.
    Voxels,
}

/// A set of balls.
#[derive(Clone, Debug)]
pub struct BallSet {
    /// Name of the set.
    pub name: SetName,
    /// The balls, in the solid's unit.
    pub balls: Vec<Ball>,
    /// Wall time from the solid to this set, in seconds.
    pub seconds: f64,
}

/// A step of sampling.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Step {
    /// Name of the step.
    pub name: &'static str,
    /// Wall time, in seconds.
    pub seconds: f64,
}

impl Step {
    /// A step that began at `start` and ends now.
    pub fn since(name: &'static str, start: Instant) -> Self {
        let seconds = start.elapsed().as_secs_f64();
        Self { name, seconds }
    }
}

/// A sampled solid.
#[derive(Clone, Debug)]
pub struct Sampling {
    /// Depths on the grid.
    pub field: DepthField,
    /// Number of nodes strictly inside, |X|.
    pub inside_nodes: usize,
    /// The sets of balls: A1, A2 and A3, or the one of another method.
    pub sets: Vec<BallSet>,
    /// Balls that Algorithm 1 added to cover the surface; none for other methods.
    pub covering: Option<Covering>,
    /// Times of the steps.
    pub steps: Vec<Step>,
}

/// Samples a solid on a grid of `per_axis` nodes an axis.
///
/// # Errors
/// [`SampleError::NothingInside`] when no ball can be placed.
pub fn sample(solid: &Solid, per_axis: usize, method: Method) -> Result<Sampling, SampleError> {
    let start = Instant::now();
    let mut steps: Vec<Step> = Vec::new();
    let mut step = |name| {
        let gone: f64 = steps.iter().map(|step| step.seconds).sum();
        let seconds = start.elapsed().as_secs_f64() - gone;
        steps.push(Step { name, seconds });
        gone + seconds
    };
    let field = DepthField::new(solid, Grid::new(solid, per_axis));
    let nodes = field.inside();
    step("distance and sign at the nodes");
    let set = |name, balls, seconds| BallSet {
        name,
        balls,
        seconds,
    };
    let mut covering = None;
    let sets: Vec<BallSet> = match method {
        Method::BehandishIlies(options) => {
            let priorities = priorities(solid, &field, &nodes, options.priority);
            step(match options.priority {
                Priority::SkeletalDensity => "skeletal density",
                Priority::Radius => "order by radius",
            });
            let found = decompose_in_order(solid, &field, &nodes, &priorities, options.mu)?;
            let seconds = step("decomposition");
            covering = Some(found.covering);
            let Decomposition { a1, a2, a3, .. } = found;
            let sets = [(SetName::A1, a1), (SetName::A2, a2), (SetName::A3, a3)];
            sets.map(|(name, balls)| set(name, balls, seconds)).into()
        }
        Method::WellerZachmann => {
            let balls = packing::pack(&field);
            vec![set(SetName::Wz, balls, step("packing"))]
        }
        Method::Octree => {
            let balls = octree::octree(solid, &field);
            vec![set(SetName::Octree, balls, step("octree"))]
        }
        Method::MedialAxis => {
            let balls = medial::medial_balls(solid, &field);
            vec![set(SetName::Medial, balls, step("medial axis"))]
        }
        Method::Voxels => {
            let radius = field.grid.epsilon();
            let ball = |&node: &usize| Ball::new(field.grid.node(node), radius);
            let balls = nodes.iter().map(ball).collect();
            vec![set(SetName::Voxels, balls, step("voxels"))]
        }
    };
    if sets.iter().any(|set| set.balls.is_empty()) {
        return Err(SampleError::NothingInside);
    }
    Ok(Sampling {
        inside_nodes: nodes.len(),
        field,
        sets,
        covering,
        steps,
    })
}

/// Balls as knots in the file's unit, of weight one or of the weights given.
///
/// # Errors
/// [`KnotsError`] when there is no ball, the weights are fewer or more than the balls, or a radius underflows.
pub fn knots(frame: Frame, balls: &[Ball], weights: Option<&[f64]>) -> Result<Knots, KnotsError> {
    let placed = |ball: &Ball| (frame.outward(ball.center), ball.radius * frame.unit);
    let (centers, radii) = balls.iter().map(placed).unzip();
    match weights {
        None => Knots::new(centers, radii),
        Some(weights) => Knots::with_weights(centers, radii, weights.to_vec()),
    }
}
