//! Two meshes as knots that dock: how they are sampled, and which lengths follow from that.
//!
//! # Conventions
//!
//! Lengths are in the unit of the mesh files, which must be one. The spacing of a part's grid is h. The value eps =
//! sqrt(3) h / 2 is the bound within which the sampler knows its surface ([`knotdock_structures::sampling::grid`]). A
//! is the receptor, B the ligand.
//!
//! # Why balls of one radius
//!
//! A sum over pairs of balls counts pairs. Over balls of very different size that is no volume. A large ball that
//! overlaps another by its whole volume counts as much as two tiny ones that touch. The many balls of an edge
//! outweigh the one that fills the middle.
//!
//! So parts that dock are sampled by balls of one radius on a lattice ([`lattice()`]). Weights are fitted so that
//! their bumps add up to one inside and zero outside. The sum over pairs is then an integral over both volumes,
//! however the lattices lie. The kernel is that of molecules, B&I's cone, whose balls are all of about one size.
//!
//! For balls of mixed radii touching means too little at large radii. A skin of fixed width would fix that but not
//! the counting. docs/mesh_docking.md has the figures.
//!
//! # Which lengths
//!
//! Two flat faces with a gap g between them score, per area, E(g) = pi times the integral from g on of K(d) d (d -
//! g)^2. K is the ranking kernel. The radii are [`RADIUS`], the resolution is [`RESOLUTION`] (both in units of r0)
//! and lambda is 9. Then E is greatest at g = r0, above half of that from 0.65 to 1.55 r0, and below zero under 0.3
//! r0. So **the offset r0 is the gap that is looked for**: of a peg in its hole, the clearance.

use knotdock_structures::Knots;
use knotdock_structures::knots::KnotsError;
use knotdock_structures::mesh::Solid;
use knotdock_structures::numeric::Bump;
use knotdock_structures::numeric::bump::AlphaError;
use knotdock_structures::sampling::feature_size::feature_size;
use knotdock_structures::sampling::grid::{DepthField, Grid};
use knotdock_structures::sampling::hausdorff::HausdorffMeter;
use knotdock_structures::sampling::lattice::lattice;
use knotdock_structures::sampling::weights::{self, FittedWeights};
use knotdock_structures::sampling::{SampleError, knots};
use serde::Serialize;

use crate::options::{DockOptions, SampleWeights};

/// Radius of the balls in offsets: 2.5 Å where the offset is 2.2 Å.
pub const RADIUS: f64 = 2.5 / 2.2;
/// Default resolution in offsets: that of molecules.
pub const RESOLUTION: f64 = 4.5 / 2.2;
/// Default radius of clusters in offsets: that of molecules.
pub const CLUSTER_RADIUS: f64 = 5.0 / 2.2;
/// Widest cell of the lattice in offsets: half the default resolution.
const CELL: f64 = 0.5 * RESOLUTION;
/// Length that stands for one Ångström, in offsets.
const ANGSTROM: f64 = 1.0 / 2.2;
/// Longest edges of a bounding box that single precision carries through the search.
const SIZES: std::ops::RangeInclusive<f64> = 1e-7..=1e9;

/// Options on sampling two meshes. Lengths in the files' unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshOptions {
    /// Nodes along each edge of each part's grid, n = m^(1/3).
    pub per_axis: usize,
    /// Skin offset r0, the gap looked for; `None`: [`default_offset`].
    pub offset: Option<f64>,
    /// Weights of the balls.
    pub weights: SampleWeights,
    /// Exponent alpha of the bump function.
    pub alpha: f64,
}

/// Why two meshes cannot be docked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshSceneError {
    /// A part cannot be sampled.
    #[error("{source}")]
    Sample {
        /// Which part: 0 the receptor, 1 the ligand.
        part: usize,
        /// Why.
        source: SampleError,
    },
    /// The bump function has no such exponent.
    #[error(transparent)]
    Alpha(#[from] AlphaError),
    /// The balls are not usable.
    #[error(transparent)]
    Knots(#[from] KnotsError),
    /// A part is so large or small that its numbers leave single precision.
    #[error(
        "the part is {extent:e} across; meshes that dock must be between {:e} and {:e}",
        SIZES.start(),
        SIZES.end()
    )]
    Size {
        /// Which part.
        part: usize,
        /// Longest edge of its bounding box.
        extent: f64,
    },
    /// A part is thinner than the two grids resolve together.
    #[error(
        "the part's features are about {feature:.3e} in radius, too thin beside the {resolved:.3e} (eps of both \
         parts) to which the two are sampled"
    )]
    Thin {
        /// Which part.
        part: usize,
        /// Its feature size.
        feature: f64,
        /// eps of the receptor and of the ligand together.
        resolved: f64,
    },
    /// The offset is finer than the sampling, or larger than a part.
    #[error(
        "an offset of {offset:.3e} is {}: it must lie between {low:.3e}, eps of both parts, and {high:.3e}, a quarter of the smaller part",
        if .offset < .low { "finer than the parts are sampled" } else { "too coarse for the parts" }
    )]
    Offset {
        /// The offset requested, or the default.
        offset: f64,
        /// Least.
        low: f64,
        /// Most.
        high: f64,
    },
}

impl MeshSceneError {
    /// The part at fault, where one is: 0 the receptor, 1 the ligand.
    pub fn part(&self) -> Option<usize> {
        match self {
            Self::Sample { part, .. } | Self::Size { part, .. } | Self::Thin { part, .. } => {
                Some(*part)
            }
            Self::Alpha(_) | Self::Knots(_) | Self::Offset { .. } => None,
        }
    }

    /// Remedy for the user.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Sample { .. } => {
                "check that the mesh is closed and one solid, or sample it on a finer --sample-grid"
            }
            Self::Alpha(_) => "give --alpha a number above zero",
            Self::Knots(_) => "check the mesh, or sample it on a finer --sample-grid",
            Self::Size { .. } => {
                "scale both meshes alike, into a unit in which they are about 1 to 1000 across"
            }
            Self::Thin { .. } => {
                "sample finer with --sample-grid (2^21, say); where one part is much larger than the other, cut \
                 it down to what is near the joint"
            }
            Self::Offset { .. } => {
                "choose --offset in this range, or a finer --sample-grid, which brings its lower end down; \
                 where one part is much larger than the \
                 other, cut it down to what is near the joint"
            }
        }
    }
}

/// A part as it is docked. Lengths in the file's unit.
#[derive(Clone, Debug, Serialize)]
pub struct SampledPart {
    /// The balls.
    #[serde(skip)]
    pub knots: Knots,
    /// Number of balls.
    pub balls: usize,
    /// Their radius.
    pub radius: f64,
    /// Nodes along each edge of the grid.
    pub per_axis: usize,
    /// Spacing h of the grid.
    pub spacing: f64,
    /// eps = sqrt(3) h / 2.
    pub epsilon: f64,
    /// Nodes along each edge of a cell of the lattice.
    pub per_cell: usize,
    /// Nodes strictly inside.
    pub inside_nodes: usize,
    /// Median local feature size, as a radius.
    pub feature_size: f64,
    /// How the weights were fitted; `null` where they are one.
    pub weights: Option<FittedWeights>,
}

/// Two parts that are to be docked.
#[derive(Clone, Debug)]
pub struct MeshPair {
    /// Receptor and ligand.
    pub parts: [SampledPart; 2],
    /// Skin offset r0 in use.
    pub offset: f64,
}

/// The default offset: 2 (`eps_A` + `eps_B`), but no more than twice the smaller feature size.
///
/// The former is the least clearance that the sampling resolves. The latter keeps the skin from filling the features.
pub fn default_offset(epsilons: [f64; 2], features: [f64; 2]) -> f64 {
    let sampled = 2.0 * (epsilons[0] + epsilons[1]);
    sampled.min(2.0 * features[0].min(features[1]))
}

/// Samples two solids for docking.
///
/// # Errors
/// [`MeshSceneError`].
pub fn sample_pair(
    receptor: &Solid,
    ligand: &Solid,
    options: &MeshOptions,
) -> Result<MeshPair, MeshSceneError> {
    let solids = [receptor, ligand];
    let extents = solids.map(|solid| {
        let longest = solid.half_sides().into_iter().fold(0.0, f64::max);
        2.0 * longest * solid.frame().unit
    });
    for (part, &extent) in extents.iter().enumerate() {
        if !SIZES.contains(&extent) {
            return Err(MeshSceneError::Size { part, extent });
        }
    }
    let fields = solids.map(|solid| DepthField::new(solid, Grid::new(solid, options.per_axis)));
    let measured = [0, 1].map(|part| {
        let unit = solids[part].frame().unit;
        let grid = fields[part].grid;
        (
            grid.epsilon() * unit,
            feature_size(solids[part], &fields[part]) * unit,
        )
    });
    let epsilons = measured.map(|(epsilon, _)| epsilon);
    let features = measured.map(|(_, feature)| feature);
    let resolved = epsilons[0] + epsilons[1];
    for (part, field) in fields.iter().enumerate() {
        if !field.depth.iter().any(|&depth| depth > 0.0) {
            let source = SampleError::NothingInside;
            return Err(MeshSceneError::Sample { part, source });
        }
        let feature = features[part];
        if feature < 0.5 * resolved {
            return Err(MeshSceneError::Thin {
                part,
                feature,
                resolved,
            });
        }
    }
    let offset = options
        .offset
        .unwrap_or_else(|| default_offset(epsilons, features));
    let (low, high) = (resolved, 0.25 * extents[0].min(extents[1]));
    // An offset that --rerun gives back may differ from the bound by a rounding.
    if !(low * (1.0 - 1e-9)..=high).contains(&offset) {
        return Err(MeshSceneError::Offset { offset, low, high });
    }
    Ok(MeshPair {
        parts: [
            sampled(solids[0], &fields[0], (features[0], offset), options)?,
            sampled(solids[1], &fields[1], (features[1], offset), options)?,
        ],
        offset,
    })
}

/// Samples one solid for a gap of `offset`, in its frame's unit as `feature_size`.
fn sampled(
    solid: &Solid,
    field: &DepthField,
    (feature_size, offset): (f64, f64),
    options: &MeshOptions,
) -> Result<SampledPart, MeshSceneError> {
    let frame = solid.frame();
    let spacing = field.grid.spacing() * frame.unit;
    let per_cell = ((CELL * offset / spacing).floor() as usize).max(1);
    let radius = RADIUS * offset;
    let balls = lattice(field, per_cell, radius / frame.unit);
    // Exact where the surface is closed; an open one has as much as its grid says.
    let volume = || match solid.mesh().is_closed() {
        true => solid.mesh().volume(),
        false => HausdorffMeter::new(solid, field).volume(),
    };
    let fitted = (options.weights == SampleWeights::Fitted)
        .then(|| Bump::new(options.alpha))
        .transpose()?
        .map(|bump| weights::fit(field, &balls, bump, volume()));
    // A ball without weight would only cost time.
    let (balls, weights): (Vec<_>, Vec<f64>) = balls
        .into_iter()
        .enumerate()
        .map(|(place, ball)| (ball, fitted.as_ref().map_or(1.0, |fit| fit.weights[place])))
        .filter(|(_, weight)| *weight > 0.0)
        .unzip();
    Ok(SampledPart {
        knots: knots(frame, &balls, Some(&weights))?,
        balls: balls.len(),
        radius,
        per_axis: field.grid.per_axis(),
        spacing,
        epsilon: field.grid.epsilon() * frame.unit,
        per_cell,
        inside_nodes: field.inside().len(),
        feature_size,
        weights: fitted,
    })
}

impl MeshPair {
    /// The length that plays the part of an Ångström.
    pub fn angstrom(&self) -> f64 {
        ANGSTROM * self.offset
    }

    /// The defaults of options that are lengths, for what was not given.
    pub fn defaults(&self, options: &mut DockOptions, given: GivenLengths) {
        options.kernel.offset = self.offset;
        if !given.resolution {
            options.kernel.resolution = RESOLUTION * self.offset;
        }
        if !given.cluster_radius {
            options.ranking.cluster_radius = CLUSTER_RADIUS * self.offset;
        }
    }
}

/// Which lengths were given, beside the offset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GivenLengths {
    /// The resolution.
    pub resolution: bool,
    /// The radius of clusters.
    pub cluster_radius: bool,
}
