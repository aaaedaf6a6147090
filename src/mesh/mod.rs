//! Two meshes as knots that dock: their sampling, and the lengths that follow from it.
//!
//! # Conventions
//!
//! Lengths are in the unit of the mesh files, which must be one. The spacing of a part's grid is h. The value eps =
//! sqrt(3) h / 2 is the bound within which the sampler knows its surface ([`knotdock_structures::sampling::grid`]). A
//! is the receptor, B the ligand.
//!
//! # Two samplers
//!
//! [`samplers`] has a file for each. `lattice` makes balls of one radius and correlates them by B&I's cone; `bi` makes
//! those of Algorithm 1 and correlates them by the product kernel. Both score two flat faces most at a gap of one
//! offset: **the offset r0 is the gap of the search**, such as the clearance of a peg in its hole.
//! docs/method/mesh_docking.md compares them.

pub mod samplers;

use knotdock_structures::knots::KnotsError;
use knotdock_structures::mesh::Solid;
use knotdock_structures::sampling::feature_size::feature_size;
use knotdock_structures::sampling::grid::{DepthField, Grid};
use knotdock_structures::sampling::weights::FittedWeights;
use knotdock_structures::sampling::{Ball, SampleError};
use knotdock_structures::{Error, Knots};
use serde::{Deserialize, Serialize};
use std::fmt;

use crate::geometry::bracket::{bounds, shifted};
use crate::mesh::samplers::double_skin::DoubleSkinFit;
use crate::mesh::samplers::{
    BallsToWeigh, PartToSample, RESOLUTION, Sampler, SamplerError, bi, lattice, union,
};
use knotdock_scoring::kernel::{KernelOptions, Trim};

/// Default pass length of the low-pass, in resolutions.
pub const PASS_RATIO: f64 = 2.0;
/// Default radius of clusters in offsets: that of molecules.
pub const CLUSTER_RADIUS: f64 = 5.0 / 2.2;
/// Length in place of one Ångström, in offsets.
const ANGSTROM: f64 = 1.0 / 2.2;
/// The remedy for parts of very different size.
const CUT_DOWN: &str =
    "where one part is much larger than the other, cut it down to what is near the joint";
/// Longest edges of a bounding box that single precision carries through the search.
const SIZES: std::ops::RangeInclusive<f64> = 1e-7..=1e9;

/// Weights of a mesh's balls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SampleWeights {
    /// Such that the summed bumps come closest to one inside and to zero outside.
    #[default]
    Fitted,
    /// One each.
    Unit,
}

/// Options on sampling two meshes. Lengths in the files' unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshOptions {
    /// Nodes along each edge of each part's grid, n = m^(1/3).
    pub per_axis: usize,
    /// The sampler.
    pub sampler: Sampler,
    /// Skin offset r0, the gap of the search; `None`: 2 (`eps_A` + `eps_B`), at most twice the smaller feature size.
    pub offset: Option<f64>,
    /// Weights of the balls.
    pub weights: SampleWeights,
    /// Exponent alpha of the bump function.
    pub alpha: f64,
    /// Penalty lambda of overlap.
    pub lambda: f64,
    /// Resolution; `None`: [`RESOLUTION`] offsets.
    pub resolution: Option<f64>,
    /// Pass length of the low-pass; `None`: [`PASS_RATIO`] resolutions.
    pub pass_length: Option<f64>,
    /// Bytes that the fit of a part's weights may take; `None`: any number.
    pub memory: Option<u64>,
}

impl MeshOptions {
    /// These options, with the defaults of all that do not change the balls.
    pub(crate) fn of_balls(self) -> Self {
        match self.sampler {
            Sampler::Bi => self,
            Sampler::Lattice => Self {
                lambda: 0.0,
                resolution: None,
                pass_length: None,
                ..self
            },
        }
    }

    /// The kernel at an offset, its lengths in `unit`.
    fn kernel(&self, offset: f64, unit: f64) -> KernelOptions {
        let resolution = self.resolution.unwrap_or(RESOLUTION * offset);
        KernelOptions {
            lambda: self.lambda,
            offset: offset / unit,
            alpha: self.alpha,
            resolution: resolution / unit,
            pass_length: self.pass_length.unwrap_or(PASS_RATIO * resolution) / unit,
            trim: Trim::FlatTop,
        }
    }
}

/// Content of a part that docks.
#[derive(Clone, Copy)]
pub enum Shape<'a> {
    /// The solid that a mesh bounds; it is sampled.
    Solid(&'a Solid),
    /// Balls of a file, docked as they are.
    Balls(&'a BallPart),
}

impl<'a> From<&'a Solid> for Shape<'a> {
    fn from(solid: &'a Solid) -> Self {
        Self::Solid(solid)
    }
}

/// Balls of a file, in its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct BallPart {
    /// The balls, one at least.
    pub balls: Vec<Ball>,
    /// One weight per ball; `None`: they are fitted.
    pub weights: Option<Vec<f64>>,
}

impl BallPart {
    /// Middle of the bounding box, and its longest edge.
    fn middle_and_edge(&self) -> ([f64; 3], f64) {
        let (low, high) = bounds(&self.balls);
        let edges = [0, 1, 2].map(|axis| high[axis] - low[axis]);
        let middle = [0, 1, 2].map(|axis| low[axis] + 0.5 * edges[axis]);
        (middle, edges.into_iter().fold(0.0, f64::max))
    }

    /// Median radius.
    fn feature_size(&self) -> f64 {
        let mut radii: Vec<f64> = self.balls.iter().map(|ball| ball.radius).collect();
        radii.sort_by(f64::total_cmp);
        radii.get(radii.len() / 2).copied().unwrap_or(0.0)
    }
}

/// An error of two meshes that are docked, with the part at fault.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshSceneError {
    /// The part at fault, if one is: 0 the receptor, 1 the ligand.
    pub part: Option<usize>,
    /// The error.
    pub error: Error,
}

impl From<KnotsError> for MeshSceneError {
    fn from(error: KnotsError) -> Self {
        let remedy = "check the mesh, or sample it on a finer --sample-grid";
        Self {
            part: None,
            error: Error::input(error).help(remedy),
        }
    }
}

impl From<MeshSceneError> for Error {
    fn from(error: MeshSceneError) -> Self {
        error.error
    }
}

/// The error of a part.
fn of_part(part: usize, message: impl fmt::Display, remedy: &str) -> MeshSceneError {
    MeshSceneError {
        part: Some(part),
        error: Error::input(message).help(remedy),
    }
}

/// A part that cannot be sampled.
fn unsampled(part: usize, error: &SamplerError) -> MeshSceneError {
    let remedy = match error {
        SamplerError::Sample(_) => {
            "check that the mesh is closed and one solid, or sample it on a finer --sample-grid"
        }
        SamplerError::Memory { .. } => {
            "allow more --memory, or give a larger --offset or --sample-weights unit"
        }
        _ => "give another --resolution, or --sample-weights unit",
    };
    of_part(part, error, remedy)
}

/// A part as it is docked. Lengths in the file's unit.
#[derive(Clone, Debug, Serialize)]
pub struct SampledPart {
    /// The balls.
    #[serde(skip)]
    pub knots: Knots,
    /// The sampler.
    pub sampler: Sampler,
    /// Number of balls.
    pub balls: usize,
    /// Their radius; the largest for balls of every size.
    pub radius: f64,
    /// The smallest radius.
    pub smallest_radius: f64,
    /// Nodes along each edge of the grid.
    pub per_axis: usize,
    /// Spacing h of the grid.
    pub spacing: f64,
    /// eps = sqrt(3) h / 2.
    pub epsilon: f64,
    /// Nodes along each edge of a cell of the lattice, no whole number; `null` without a lattice.
    pub per_cell: Option<f64>,
    /// Nodes strictly inside.
    pub inside_nodes: usize,
    /// Median local feature size, as a radius.
    pub feature_size: f64,
    /// The fit of the weights; `null` if they are one.
    pub weights: Option<FittedWeights>,
    /// The fit of the double skin; `null` without one.
    pub double_skin: Option<DoubleSkinFit>,
}

/// Two parts that are to be docked.
#[derive(Clone, Debug)]
pub struct MeshPair {
    /// Receptor and ligand.
    pub parts: [SampledPart; 2],
    /// Skin offset r0 in use.
    pub offset: f64,
    /// The sampler.
    pub sampler: Sampler,
}

/// The default offset: 2 (`eps_A` + `eps_B`), but no more than twice the smaller feature size.
///
/// The former is the least clearance that the sampling resolves. The latter keeps the skin from filling the features.
fn default_offset(epsilons: [f64; 2], features: [f64; 2]) -> f64 {
    let sampled = 2.0 * (epsilons[0] + epsilons[1]);
    sampled.min(2.0 * features[0].min(features[1]))
}

/// Samples two parts for docking.
pub fn sample_pair(shapes: [Shape; 2], options: &MeshOptions) -> Result<MeshPair, MeshSceneError> {
    Ok(sample_gaps(shapes, options, None)?.0)
}

/// Samples two parts for docking, and for a gap that is a share of that one. `None` if no share is given, or if the
/// closer gap is finer than the parts are sampled.
pub fn sample_gaps(
    shapes: [Shape; 2],
    options: &MeshOptions,
    share: Option<f64>,
) -> Result<(MeshPair, Option<MeshPair>), MeshSceneError> {
    let extents = shapes.map(|shape| match shape {
        Shape::Solid(solid) => {
            let longest = solid.half_sides().into_iter().fold(0.0, f64::max);
            2.0 * longest * solid.frame().unit
        }
        Shape::Balls(part) => part.middle_and_edge().1,
    });
    for (part, &extent) in extents.iter().enumerate() {
        if !SIZES.contains(&extent) {
            let message = format!(
                "the part is {extent:e} across; meshes that dock must be between {:e} and {:e}",
                SIZES.start(),
                SIZES.end()
            );
            let remedy =
                "scale both meshes alike, into a unit in which they are about 1 to 1000 across";
            return Err(of_part(part, message, remedy));
        }
    }
    let measured = shapes.map(|shape| Measured::of(shape, options.per_axis));
    let epsilons = measured.each_ref().map(|part| part.epsilon());
    let features = measured.each_ref().map(|part| part.feature_size);
    let resolved = epsilons[0] + epsilons[1];
    for (part, measured) in measured.iter().enumerate() {
        if measured.inside == 0 {
            return Err(unsampled(part, &SampleError::NothingInside.into()));
        }
        let feature = features[part];
        if feature < 0.5 * resolved {
            let message = format!(
                "the part's features are about {feature:.3e} in radius, too thin beside the {resolved:.3e} (eps of \
                 both parts) to which the two are sampled"
            );
            let remedy = format!("sample finer with --sample-grid (2^21, say); {CUT_DOWN}");
            return Err(of_part(part, message, &remedy));
        }
    }
    let offset = options
        .offset
        .unwrap_or_else(|| default_offset(epsilons, features));
    let (low, high) = (resolved, 0.25 * extents[0].min(extents[1]));
    // An offset of --rerun may differ from the bound by a rounding.
    if !(low * (1.0 - 1e-9)..=high).contains(&offset) {
        let fault = match offset < low {
            true => "finer than the parts are sampled",
            false => "too coarse for the parts",
        };
        let message = format!(
            "an offset of {offset:.3e} is {fault}: it must lie between {low:.3e}, eps of both parts, and {high:.3e}, a \
             quarter of the smaller part"
        );
        let remedy = format!(
            "choose --offset in this range, or a finer --sample-grid, which brings its lower end down; {CUT_DOWN}"
        );
        return Err(MeshSceneError {
            part: None,
            error: Error::input(message).help(remedy),
        });
    }
    let kernel = options.kernel(offset, 1.0);
    kernel.check().map_err(|error| MeshSceneError {
        part: None,
        error: Error::input(error).help("give a number in this range"),
    })?;
    let pair_at = |offset: f64| -> Result<MeshPair, MeshSceneError> {
        Ok(MeshPair {
            parts: [
                measured[0].sampled(0, offset, options)?,
                measured[1].sampled(1, offset, options)?,
            ],
            offset,
            sampler: options.sampler,
        })
    };
    let closer = share.map(|share| share * offset);
    let closer = closer.filter(|&closer| closer >= low);
    Ok((pair_at(offset)?, closer.map(pair_at).transpose()?))
}

/// A part on its grid.
struct Measured<'a> {
    shape: Shape<'a>,
    grid: Grid,
    /// Depths on it, of a solid.
    field: Option<DepthField>,
    /// Nodes strictly inside.
    inside: usize,
    /// Length of the grid's unit, in the file's.
    unit: f64,
    /// The grid's origin in a file of balls.
    middle: [f64; 3],
    feature_size: f64,
}

impl<'a> Measured<'a> {
    fn of(shape: Shape<'a>, per_axis: usize) -> Self {
        match shape {
            Shape::Solid(solid) => {
                let field = DepthField::new(solid, Grid::new(solid, per_axis));
                let unit = solid.frame().unit;
                Self {
                    shape,
                    grid: field.grid,
                    inside: field.inside().len(),
                    unit,
                    middle: [0.0; 3],
                    feature_size: feature_size(solid, &field) * unit,
                    field: Some(field),
                }
            }
            Shape::Balls(part) => {
                let (middle, edge) = part.middle_and_edge();
                let grid = Grid::of_edge(edge, per_axis);
                Self {
                    shape,
                    grid,
                    inside: union(grid, &about(middle, &part.balls), 0.0).inside().len(),
                    field: None,
                    unit: 1.0,
                    middle,
                    feature_size: part.feature_size(),
                }
            }
        }
    }

    fn epsilon(&self) -> f64 {
        self.grid.epsilon() * self.unit
    }

    /// Balls for a gap of `offset`.
    fn sampled(
        &self,
        index: usize,
        offset: f64,
        options: &MeshOptions,
    ) -> Result<SampledPart, MeshSceneError> {
        let kernel = options.kernel(offset, self.unit);
        let kernel = (options.weights == SampleWeights::Fitted).then_some(kernel);
        let found = match (self.shape, &self.field, options.sampler) {
            (Shape::Solid(solid), Some(field), sampler) => {
                let part = PartToSample {
                    solid,
                    field,
                    offset: offset / self.unit,
                    kernel,
                    room: options.memory,
                };
                let sample = match sampler {
                    Sampler::Lattice => lattice::sample,
                    Sampler::Bi => bi::sample,
                };
                sample(&part).map_err(|error| unsampled(index, &error))?
            }
            (Shape::Balls(part), _, Sampler::Bi) => bi::of_balls(&BallsToWeigh {
                balls: about(self.middle, &part.balls),
                weights: part.weights.as_deref(),
                grid: self.grid,
                offset,
                kernel,
                room: options.memory,
            })
            .map_err(|error| unsampled(index, &error))?,
            _ => {
                let message =
                    "the part is balls already, which this sampler cannot take as they are";
                return Err(of_part(
                    index,
                    message,
                    "dock files of balls with --sampler bi",
                ));
            }
        };
        let radii = found.balls.iter().map(|ball| ball.radius * self.unit);
        let smallest_radius = radii.clone().fold(f64::INFINITY, f64::min);
        let radius = radii.clone().fold(0.0, f64::max);
        let outward = |ball: &Ball| match self.shape {
            Shape::Solid(solid) => solid.frame().outward(ball.center),
            Shape::Balls(_) => [0, 1, 2].map(|axis| ball.center[axis] + self.middle[axis]),
        };
        let centers = found.balls.iter().map(outward).collect();
        let knots = Knots::with_weights(centers, radii.collect(), found.weights)?;
        Ok(SampledPart {
            knots: knots.with_skin_weights(found.skin_weights)?,
            sampler: options.sampler,
            balls: found.balls.len(),
            radius,
            smallest_radius,
            per_axis: self.grid.per_axis(),
            spacing: self.grid.spacing() * self.unit,
            epsilon: self.epsilon(),
            per_cell: found.per_cell,
            inside_nodes: self.inside,
            feature_size: self.feature_size,
            weights: found.fit,
            double_skin: found.double_skin,
        })
    }
}

/// Balls relative to a point.
fn about(middle: [f64; 3], balls: &[Ball]) -> Vec<Ball> {
    let by = middle.map(|part| -part);
    balls.iter().map(|ball| shifted(ball, by)).collect()
}

impl MeshPair {
    /// The length that plays the part of an Ångström.
    pub fn angstrom(&self) -> f64 {
        ANGSTROM * self.offset
    }

    /// Depth of the skin of the product kernel; `None` for the cone.
    pub fn skin(&self) -> Option<f64> {
        Some(self.sampler.skin()? * self.offset)
    }
}
