//! The solid of a mesh as balls, by Algorithm 1.

use std::sync::Arc;

use super::{BallHierarchy, BallSolid, density, mean_center};
use crate::Error;
use crate::ball::Ball;
use crate::mesh::{ExactSolid, Indefinite, Solid};
use crate::numeric::Bump;
use crate::sampling::decomposition::{DecompositionOptions, reduce};
use crate::sampling::hausdorff::HausdorffMeter;
use crate::sampling::{Method, SampleError, SetName, sample, weights};

/// Exponent of the bumps that weights are fitted for.
const ALPHA: f64 = 2.0;

/// How a mesh was sampled. Lengths in the file's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshSampling {
    /// Nodes along each edge of the grid.
    pub per_axis: usize,
    /// eps of the grid.
    pub grid_epsilon: f64,
    /// No point of the solid is farther from the inner balls; of meshes that are not closed, as measured.
    pub inward: f64,
    /// Share of the solid's volume that the inner balls miss; `None` if the grid sees no volume.
    pub missed: Option<f64>,
    /// Why the triangles do not decide contact, if they do not.
    pub indefinite: Option<Indefinite>,
}

impl BallSolid {
    /// The solid of a mesh: A1 of Algorithm 1 on a grid of `per_axis` nodes an axis (B&I, appendix A).
    ///
    /// The balls of [`Self::density`] are the originals of A3, on fine grids of an A3 of larger eps, so that they are
    /// at most 200. Their weights are fitted for bumps of exponent 2.
    ///
    /// # Errors
    /// [`SampleError::NothingInside`] when no ball can be placed.
    pub fn from_mesh(solid: &Solid, per_axis: usize) -> Result<(Self, MeshSampling), SampleError> {
        let method = Method::BehandishIlies(DecompositionOptions::default());
        let mut sampling = sample(solid, per_axis, method)?;
        let field = &sampling.field;
        let meter = HausdorffMeter::new(solid, field);
        let position = sampling.sets.iter().position(|set| set.name == SetName::A1);
        let a1 = sampling
            .sets
            .swap_remove(position.ok_or(SampleError::NothingInside)?);
        let balls = a1.balls;
        let fit = meter.measure(&balls);
        let grid_epsilon = field.grid.epsilon();
        // The inner balls grown by this hold a closed mesh for certain; for others it is measured.
        let inward = fit.inward_bound.unwrap_or(fit.hausdorff_inward);
        let epsilon = grid_epsilon.max(inward);
        let few = few_of(&balls, grid_epsilon);
        let volume = meter.volume();
        let weights = match (Bump::new(ALPHA), sampling.inside_nodes) {
            (Ok(bump), 1..) => weights::fit(field, &few, bump, volume).weights,
            _ => vec![1.0; few.len()],
        };
        let (unit, origin) = (solid.frame().unit, solid.frame().origin);
        let scaled = |balls: &[Ball]| -> Vec<Ball> {
            let scaled = balls
                .iter()
                .map(|ball| Ball::new(ball.center.map(|x| x * unit), ball.radius * unit));
            scaled.collect()
        };
        let few = scaled(&few);
        let centroid = if solid.mesh().is_closed() {
            solid.mesh().centroid().map(|x| x * unit)
        } else {
            mean_center(&few, &weights)
        };
        let density = density(&few, &weights).map_err(|_| SampleError::NothingInside)?;
        let exact = ExactSolid::new(solid);
        let indefinite = exact.as_ref().err().copied();
        let solid = Self {
            exact: exact.ok().map(Arc::new),
            origin,
            hierarchy: BallHierarchy::new(&scaled(&balls)),
            epsilon: epsilon * unit,
            centroid,
            density,
        };
        let sampled = MeshSampling {
            per_axis,
            grid_epsilon: grid_epsilon * unit,
            inward: inward * unit,
            missed: (volume > 0.0).then(|| fit.volume_missed / volume),
            indefinite,
        };
        Ok((solid, sampled))
    }
}

impl Solid {
    /// The solid as balls between which its surface lies, by Algorithm 1 on a cubic grid of about `nodes` nodes:
    /// [`BallSolid::from_mesh`].
    ///
    /// # Errors
    /// [`Error`] if no ball can be placed.
    pub fn decompose(&self, nodes: usize) -> Result<BallSolid, Error> {
        let per_axis = (nodes as f64).cbrt().round().max(2.0) as usize;
        let (solid, _) = BallSolid::from_mesh(self, per_axis).map_err(|error| {
            Error::input(error)
                .help("check that the mesh is closed and one solid, or sample it on a finer grid")
        })?;
        Ok(solid)
    }
}

/// Most balls of a density: their pairs are summed in about a millisecond.
const MAX_BALLS: usize = 200;

/// The originals of A3, at an eps that leaves few enough of them.
fn few_of(balls: &[Ball], epsilon: f64) -> Vec<Ball> {
    let mut reach = epsilon;
    loop {
        let kept = reduce(balls, reach);
        if kept.len() <= MAX_BALLS {
            return kept.into_iter().map(|index| balls[index]).collect();
        }
        reach *= 1.25;
    }
}
