//! Two bodies made ready to be docked, once or again and again with other options.

use std::sync::Arc;

use knotdock_structures::molecule::Molecule;

use crate::dock::outcome::StageTime;
use crate::dock::plan::{DockPlan, plan, plan_scene};
use crate::dock::run::molecule_points;
use crate::dock::scene::Scene;
use crate::dock::stopwatch::timed;
use crate::mesh::samplers::RESOLUTION;
use crate::mesh::{CLUSTER_RADIUS, MeshOptions, MeshPair, MeshSceneError, Shape, sample_gaps};
use crate::options::DockOptions;
use knotdock_structures::Error;

/// Two bodies, the receptor first.
#[derive(Clone, Copy)]
pub enum Pair<'a> {
    /// Molecules, in Å.
    Molecules([&'a Molecule; 2]),
    /// Meshes or files of balls, in one unit of length.
    Meshes([Shape<'a>; 2]),
}

/// Meshes as balls, and the cost of making them.
#[derive(Clone, Debug)]
pub struct Sampling {
    /// The balls of both.
    pub pair: MeshPair,
    /// Time.
    pub time: StageTime,
}

impl Sampling {
    /// Samples two meshes.
    ///
    /// # Errors
    /// [`MeshSceneError`].
    pub fn of(shapes: [Shape; 2], options: &MeshOptions) -> Result<Self, MeshSceneError> {
        Ok(Self::of_gaps(shapes, options, None)?.0)
    }

    /// Samples two meshes, and for a closer gap too, as [`sample_gaps`] does. All time is the first one's.
    ///
    /// # Errors
    /// [`MeshSceneError`].
    pub fn of_gaps(
        shapes: [Shape; 2],
        options: &MeshOptions,
        share: Option<f64>,
    ) -> Result<(Self, Option<Self>), MeshSceneError> {
        let (pairs, time) = timed("sample", || sample_gaps(shapes, options, share));
        let (pair, closer) = pairs?;
        let none = StageTime {
            wall_seconds: 0.0,
            cpu_seconds: time.cpu_seconds.map(|_| 0.0),
            ..time
        };
        let closer = closer.map(|pair| Self { pair, time: none });
        Ok((Self { pair, time }, closer))
    }
}

/// A docking made ready to run.
pub struct PreparedPair {
    /// Its plan.
    pub plan: DockPlan,
    /// Points of the ligand whose RMSD makes clusters.
    pub points: Vec<[f64; 3]>,
    /// Report on the sampling of the meshes.
    pub sampling: Option<Arc<Sampling>>,
    /// Sampling for a closer gap, if the gap is searched.
    pub closer: Option<Arc<Sampling>>,
    /// What sampling (of meshes) and planning took.
    pub timing: Vec<StageTime>,
}

impl PreparedPair {
    /// Plans a docking of molecules.
    ///
    /// # Errors
    /// [`Error`].
    pub fn molecules(
        [receptor, ligand]: [&Molecule; 2],
        options: &DockOptions,
    ) -> Result<Self, Error> {
        let (planned, time) = timed("plan", || plan(receptor, ligand, options));
        Ok(Self {
            plan: planned?,
            points: molecule_points(ligand),
            sampling: None,
            closer: None,
            timing: vec![time],
        })
    }

    /// Plans a docking of sampled meshes; `options` have all lengths.
    ///
    /// # Errors
    /// [`Error`].
    pub fn meshes(sampling: Arc<Sampling>, options: &DockOptions) -> Result<Self, Error> {
        let (planned, time) = timed("plan", || {
            let scene = Scene::of_meshes(&sampling.pair, options)?;
            plan_scene(scene, options)
        });
        Ok(Self {
            plan: planned?,
            points: sampling.pair.parts[1].knots.centers.clone(),
            timing: vec![sampling.time, time],
            sampling: Some(sampling),
            closer: None,
        })
    }
}

/// Makes dockings of a pair ready, with the samplings of its meshes that were needed so far.
pub struct Preparer<'a> {
    pair: Pair<'a>,
    sampled: Vec<(MeshOptions, Arc<Sampling>)>,
}

/// The sampling that options ask for, which have all lengths.
fn mesh_options(options: &DockOptions) -> MeshOptions {
    let (sampling, kernel) = (&options.sampling, &options.kernel);
    MeshOptions {
        per_axis: sampling.sample_grid.unwrap_or_default().per_axis,
        sampler: sampling.sampler.unwrap_or_default(),
        offset: Some(kernel.offset),
        weights: sampling.sample_weights.unwrap_or_default(),
        alpha: kernel.alpha,
        lambda: kernel.lambda,
        resolution: Some(kernel.resolution),
        pass_length: kernel.pass_length,
        memory: options.machine.memory,
    }
}

impl<'a> Preparer<'a> {
    /// Knows what `first`, prepared with `options`, needed.
    pub fn new(pair: Pair<'a>, options: &DockOptions, first: &PreparedPair) -> Self {
        let sampled = first.sampling.iter();
        Self {
            pair,
            sampled: sampled
                .map(|sampling| (mesh_options(options).of_balls(), Arc::clone(sampling)))
                .collect(),
        }
    }

    /// Samples what has to be and plans. Of meshes, `options` have all lengths; a sampling that is at hand is used
    /// again, with the time that it took.
    ///
    /// # Errors
    /// [`Error`].
    pub fn prepare(&mut self, options: &DockOptions) -> Result<PreparedPair, Error> {
        match self.pair {
            Pair::Molecules(molecules) => Ok(PreparedPair::molecules(molecules, options)?),
            Pair::Meshes(solids) => {
                let sampling = self.sampling(solids, options)?;
                Ok(PreparedPair::meshes(sampling, options)?)
            }
        }
    }

    fn sampling(
        &mut self,
        solids: [Shape; 2],
        options: &DockOptions,
    ) -> Result<Arc<Sampling>, Error> {
        let wanted = mesh_options(options);
        let key = wanted.of_balls();
        if let Some((_, known)) = self.sampled.iter().find(|(known, _)| *known == key) {
            return Ok(Arc::clone(known));
        }
        let sampling = Arc::new(Sampling::of(solids, &wanted)?);
        self.sampled.push((key, Arc::clone(&sampling)));
        Ok(sampling)
    }
}

/// Which options with defaults of their own for meshes were given, beside the offset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GivenDefaults {
    /// The resolution.
    pub resolution: bool,
    /// The radius of clusters.
    pub cluster_radius: bool,
    /// The exponent of the bump function.
    pub alpha: bool,
    /// Any of the rotations, the finer ones and their share.
    pub rotations: bool,
}

/// Finer rotations of meshes, about 7 degrees apart, and the share of them that is searched: joints are deeper than
/// molecules' (docs/method/mesh_docking.md has what they find).
const FINE_ROTATIONS: (usize, f64) = (30_000, 0.2);

/// The defaults for meshes of options that were not given.
pub fn sampled_defaults(meshes: &MeshPair, options: &mut DockOptions, given: GivenDefaults) {
    options.kernel.offset = meshes.offset;
    if !given.alpha {
        options.kernel.alpha = meshes.sampler.alpha();
    }
    if !given.resolution {
        options.kernel.resolution = RESOLUTION * meshes.offset;
    }
    if !given.cluster_radius {
        options.ranking.cluster_radius = CLUSTER_RADIUS * meshes.offset;
    }
    if !given.rotations {
        let (finer, share) = FINE_ROTATIONS;
        options.search.fine_rotations = Some(finer);
        options.search.fine_share = share;
    }
}
