//! TEMPORARY STAND-IN of this branch only: the interface of the search with poses made up, to be dropped for the real
//! one on merging.

pub mod outcome;

use knotdock_scoring::se3::Pose;
use knotdock_structures::molecule::Molecule;
use outcome::{MeasuredError, RankedPose};
use serde::{Deserialize, Serialize};

/// Effects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Effect {
    /// Shape.
    Shape,
}

/// Options.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct DockOptions {
    pub rotations: usize,
    pub resolution: Option<f64>,
    pub pass: Option<f64>,
    pub spacing: Option<f64>,
    pub lambda: f64,
    pub offset: f64,
    pub alpha: f64,
    pub tolerance: f64,
    pub effects: Vec<Effect>,
    pub per_rotation: usize,
    pub poses: usize,
    pub refine: usize,
    pub cluster_radius: Option<f64>,
    pub threads: usize,
    pub memory: Option<u64>,
}

impl Default for DockOptions {
    fn default() -> Self {
        Self {
            rotations: 3600,
            resolution: None,
            pass: None,
            spacing: None,
            lambda: 10.0,
            offset: 2.0,
            alpha: 2.0,
            tolerance: 1e-3,
            effects: vec![Effect::Shape],
            per_rotation: 3,
            poses: 2000,
            refine: 300,
            cluster_radius: Some(5.0),
            threads: 0,
            memory: None,
        }
    }
}

/// Plan.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs)]
pub struct DockPlan {
    pub rotations: usize,
    pub covering_radius: f64,
    pub memory: u64,
    #[serde(skip)]
    options: DockOptions,
}

impl std::fmt::Display for DockPlan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} rotations, {} bytes", self.rotations, self.memory)
    }
}

/// Fault.
#[derive(Debug, thiserror::Error)]
pub enum SearchError {
    /// Fault of the knots.
    #[error(transparent)]
    Knots(#[from] knotdock_structures::knots::KnotsError),
}

impl SearchError {
    /// Remedy.
    pub fn remedy(&self) -> String {
        "correct it".to_owned()
    }
}

/// Progress.
pub trait Progress: Sync {
    /// A stage begins.
    fn stage(&self, name: &str, total: u64);
    /// Steps done.
    fn advance(&self, by: u64);
}

/// Cost.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs)]
pub struct EffectCost {
    pub effect: Effect,
    pub rank: usize,
}

/// Time.
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs)]
pub struct StageTime {
    pub name: String,
    pub wall_seconds: f64,
    pub cpu_seconds: f64,
}

/// Outcome.
#[allow(missing_docs)]
pub struct DockOutcome {
    pub poses: Vec<RankedPose>,
    pub error: MeasuredError,
    pub effects: Vec<EffectCost>,
    pub timing: Vec<StageTime>,
}

/// Plans.
///
/// # Errors
/// Of the knots.
pub fn plan(
    receptor: &Molecule,
    ligand: &Molecule,
    options: &DockOptions,
) -> Result<DockPlan, SearchError> {
    receptor.knots()?;
    ligand.knots()?;
    Ok(DockPlan {
        rotations: options.rotations,
        covering_radius: 0.2,
        memory: 1_000_000,
        options: options.clone(),
    })
}

/// Docks.
///
/// # Errors
/// None.
pub fn dock(
    plan: &DockPlan,
    receptor: &Molecule,
    _ligand: &Molecule,
    progress: &dyn Progress,
) -> Result<DockOutcome, SearchError> {
    progress.stage("search", plan.rotations as u64);
    let (low, high) = receptor.knots()?.bounds();
    let mut poses = Vec::new();
    for index in 0..plan.rotations.min(plan.options.poses) {
        let angle = index as f64 * 0.7;
        let score = 1000.0 / (1.0 + index as f64);
        poses.push(RankedPose {
            pose: Pose::from_parts(
                [angle.cos(), 0.1, angle.sin(), 0.3],
                [high[0] + angle, low[1], high[2]],
            ),
            score,
            cluster: Some(index / 3 + 1),
            cluster_size: Some(3),
            refined: index < plan.options.refine,
            rotation: index,
            score_grid: score * 0.999,
            score_unfiltered: score * 1.1,
            shape: score,
            slices: [0.0, score / 20.0, 0.0],
        });
        progress.advance(1);
    }
    Ok(DockOutcome {
        poses,
        error: MeasuredError {
            poses: 10,
            rms: 1e-3,
            worst: 2e-3,
            low_pass_share: 0.1,
        },
        effects: vec![EffectCost {
            effect: Effect::Shape,
            rank: 3,
        }],
        timing: vec![StageTime {
            name: "search".to_owned(),
            wall_seconds: 0.0,
            cpu_seconds: 0.0,
        }],
    })
}
