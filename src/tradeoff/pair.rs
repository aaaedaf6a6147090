//! Two bodies that are docked again and again with other options.

use std::time::Instant;

use cpu_time::ProcessTime;
use knotdock_structures::mesh::Solid;
use knotdock_structures::molecule::Molecule;

use crate::search::meshes::{
    MeshOptions, MeshPair, MeshSceneError, PER_AXIS, SampleWeights, sample_pair,
};
use crate::search::{
    DockOptions, DockPlan, Scene, SearchError, StageTime, molecule_points, plan, plan_scene,
};

/// Two bodies, the receptor first.
#[derive(Clone, Copy)]
pub enum Pair<'a> {
    /// Molecules, in Å.
    Molecules([&'a Molecule; 2]),
    /// Meshes, in one unit of length.
    Meshes([&'a Solid; 2]),
}

/// Why a setting cannot be run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PairError {
    /// The search refuses it.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// The meshes cannot be sampled so.
    #[error(transparent)]
    Mesh(#[from] MeshSceneError),
}

impl PairError {
    /// What the user may do about it.
    pub fn remedy(&self) -> String {
        match self {
            Self::Search(error) => error.remedy(),
            Self::Mesh(error) => error.remedy().to_owned(),
        }
    }
}

/// A setting made ready to run.
pub struct Prepared {
    /// Its plan.
    pub plan: DockPlan,
    /// Points of the ligand whose RMSD makes clusters.
    pub points: Vec<[f64; 3]>,
    /// What sampling (of meshes) and planning took.
    pub timing: Vec<StageTime>,
}

/// A pair with the samplings of its meshes that settings have needed so far.
pub struct Preparer<'a> {
    pair: Pair<'a>,
    sampled: Vec<(usize, SampleWeights, MeshPair, StageTime)>,
}

impl<'a> Preparer<'a> {
    /// Nothing sampled yet.
    pub fn new(pair: Pair<'a>) -> Self {
        Self {
            pair,
            sampled: Vec::new(),
        }
    }

    /// Samples what has to be and plans. Of meshes, `options` have all lengths; a sampling that is at hand is used again, with the time
    /// that it took.
    ///
    /// # Errors
    /// [`PairError`].
    pub fn prepare(&mut self, options: &DockOptions) -> Result<Prepared, PairError> {
        match self.pair {
            Pair::Molecules([receptor, ligand]) => {
                let (planned, time) = timed("plan", || plan(receptor, ligand, options));
                Ok(Prepared {
                    plan: planned?,
                    points: molecule_points(ligand),
                    timing: vec![time],
                })
            }
            Pair::Meshes(solids) => {
                let (sampled, sampling) = self.sampled(solids, options)?;
                let (planned, time) = timed("plan", || {
                    Scene::of_meshes(sampled, options).and_then(|scene| plan_scene(scene, options))
                });
                Ok(Prepared {
                    plan: planned?,
                    points: sampled.parts[1].knots.centers.clone(),
                    timing: vec![sampling, time],
                })
            }
        }
    }

    fn sampled(
        &mut self,
        [receptor, ligand]: [&Solid; 2],
        options: &DockOptions,
    ) -> Result<(&MeshPair, StageTime), PairError> {
        let per_axis = options.sample_grid.unwrap_or(PER_AXIS);
        let weights = options.sample_weights.unwrap_or_default();
        let known = |(nodes, kind, ..): &(usize, SampleWeights, MeshPair, StageTime)| {
            (*nodes, *kind) == (per_axis, weights)
        };
        let place = match self.sampled.iter().position(known) {
            Some(place) => place,
            None => {
                let sampling = MeshOptions {
                    per_axis,
                    offset: Some(options.offset),
                    weights,
                    alpha: options.alpha,
                };
                let (pair, time) = timed("sample", || sample_pair(receptor, ligand, &sampling));
                self.sampled.push((per_axis, weights, pair?, time));
                self.sampled.len() - 1
            }
        };
        let (_, _, pair, time) = &self.sampled[place];
        Ok((pair, *time))
    }
}

/// The result of a call with its wall and CPU time.
fn timed<T>(name: &'static str, call: impl FnOnce() -> T) -> (T, StageTime) {
    let (wall, cpu) = (Instant::now(), ProcessTime::try_now().ok());
    let result = call();
    let time = StageTime {
        name,
        wall_seconds: wall.elapsed().as_secs_f64(),
        cpu_seconds: cpu
            .and_then(|cpu| cpu.try_elapsed().ok())
            .map(|cpu| cpu.as_secs_f64()),
    };
    (result, time)
}
