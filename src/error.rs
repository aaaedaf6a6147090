//! Why a search was refused or failed, and what to do about it.

use crate::memory_size::{as_size, in_words};
use crate::predictions::PredictionError;
use crate::progress::Ended;
use crate::restraints::{Needed, RestraintFileError};
use crate::threads::ThreadsError;
use knotdock_scoring::engine::PlanError;
use knotdock_scoring::symmetry::Symmetry;
use knotdock_scoring::terms::effect::Effect;
use knotdock_structures::knots::KnotsError;

/// Why a docking run was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SearchError {
    /// A molecule gives no usable knots.
    #[error(transparent)]
    Knots(#[from] KnotsError),
    /// The engine cannot be planned.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// An option is out of its range.
    #[error("--{name} is {value}; it must be {bound}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: String,
        /// Its range.
        bound: String,
    },
    /// A requested effect for which the inputs lack data.
    #[error("the effect {effect} cannot be scored: {reason}")]
    Effect {
        /// The effect.
        effect: Effect,
        /// What the inputs lack.
        reason: String,
    },
    /// Two rings requested of a molecule that is not a ring.
    #[error("{symmetry} docks two rings, and this molecule is not such a ring: {reason}")]
    Ring {
        /// The symmetry.
        symmetry: Symmetry,
        /// What it lacks.
        reason: String,
    },
    /// Even with one rotation in flight the run does not fit into the memory allowed.
    #[error("the run needs {} of memory, and {} are allowed", in_words(*.needed), in_words(*.allowed))]
    Memory {
        /// Bytes that suffice.
        needed: u64,
        /// Bytes allowed.
        allowed: u64,
        /// Grid spacing that would fit, if any does.
        spacing: Option<f64>,
        /// Resolution for which that spacing is fine enough, where it is coarser than the requested one.
        resolution: Option<f64>,
        /// The pass length that goes with it, where one was requested.
        pass_length: Option<f64>,
        /// Whether that resolution is so much coarser than the requested one that it shows little.
        shows_little: bool,
    },
    /// The modes that a score is to be made of do not fit into the memory allowed.
    #[error("{modes} modes need {} of memory, and {} are allowed", in_words(*.needed), in_words(*.allowed))]
    Modes {
        /// Modes, conjugates counted once.
        modes: usize,
        /// Bytes needed.
        needed: u64,
        /// Bytes allowed.
        allowed: u64,
    },
    /// The file of restraints does not fit the molecules.
    #[error(transparent)]
    Restraints(#[from] RestraintFileError),
    /// Predictions of the interface do not fit the molecule.
    #[error("of the {side}: {error}")]
    Predictions {
        /// `receptor` or `ligand`.
        side: &'static str,
        /// The fault.
        error: PredictionError,
    },
    /// A file without the planes of a membrane.
    #[error("the file of the {side} marks no flat membrane across its z axis")]
    NoMembrane {
        /// `receptor` or `ligand`.
        side: &'static str,
    },
    /// No sampled pose stays out of the membrane.
    #[error("every pose that is searched lies in the membrane")]
    AllInMembrane,
    /// More restraints have to be satisfied than there are.
    #[error("{needed} restraints have to be satisfied, and there are {count}")]
    RestraintsNeed {
        /// How many have to be.
        needed: Needed,
        /// How many there are.
        count: usize,
    },
    /// No sampled pose can satisfy so many restraints.
    #[error("no pose that is searched can satisfy {needed} of the {count} restraints")]
    NoAllowedPose {
        /// How many have to be.
        needed: usize,
        /// How many there are.
        count: usize,
    },
    /// The threads could not be started.
    #[error(transparent)]
    Threads(#[from] ThreadsError),
    /// The graphics processor cannot be used.
    #[error("--engine gpu: {0}")]
    Graphics(String),
    /// The run was ended before its end.
    #[error(transparent)]
    Ended(#[from] Ended),
    /// No rotation has a finite score.
    #[error("no pose has a finite score")]
    NoPose,
    /// No pose scores anything, so that errors have no scale.
    #[error("no pose scores anything, so errors have no scale")]
    NothingScores,
}

impl SearchError {
    /// Remedy for the user.
    pub fn remedy(&self) -> String {
        match self {
            Self::Knots(_) => "check the structure's coordinates and radii".to_owned(),
            Self::Plan(PlanError::TooLarge(_)) | Self::Modes { .. } => {
                "use a coarser --resolution or --spacing, or check for atoms or parts far from the rest"
                    .to_owned()
            }
            Self::Option { bound, .. } if bound.starts_with("left out") => {
                "leave the option out".to_owned()
            }
            Self::Option { bound, .. } if bound.starts_with("residues") => {
                "name residues that the file has, by chain and number".to_owned()
            }
            Self::Plan(_) | Self::Option { .. } => {
                "give the option a value in its range".to_owned()
            }
            Self::Memory {
                needed,
                spacing: Some(spacing),
                resolution,
                pass_length,
                shows_little,
                ..
            } => {
                let with = |option: &str, value: &Option<f64>| {
                    value.map_or_else(String::new, |value| format!(" {option} {value}"))
                };
                let (resolution, pass_length) = (
                    with("--resolution", resolution),
                    with("--pass-length", pass_length),
                );
                let needed = as_size(*needed);
                let coarser = format!("--spacing {spacing}{resolution}{pass_length}");
                if *shows_little {
                    format!(
                        "allow more with --memory {needed}, or check for atoms or parts far from the rest; {coarser} would fit, but shows little"
                    )
                } else {
                    format!(
                        "use {coarser}, allow more with --memory {needed}, or check for atoms or parts far from the rest"
                    )
                }
            }
            Self::Memory { needed, .. } => {
                let needed = as_size(*needed);
                format!("allow more with --memory {needed}, or check for atoms or parts far from the rest")
            }
            Self::Graphics(_) => {
                "dock with --engine cpu, or see docs/method/engines.md for what a graphics processor needs"
                    .to_owned()
            }
            Self::Threads(error) => error.remedy().to_owned(),
            Self::Effect {
                effect: Effect::Restraint,
                ..
            } => {
                "leave out the options that name residues to block or attract, and restraint of --effects"
                    .to_owned()
            }
            Self::Effect { .. } => {
                "leave it out of --effects, or let auto choose what the inputs call for".to_owned()
            }
            Self::Ring { symmetry, .. } => {
                let folds = symmetry.folds().unwrap_or(1);
                format!(
                    "dock the single molecule with --symmetry C{folds} first and give a complex of that run, \
                     such as its top/rank_0001.pdb: copies one after \
                     another, each with all its chains"
                )
            }
            Self::NothingScores => "use a finer --spacing or --resolution".to_owned(),
            Self::Restraints(error) => error.remedy(),
            Self::Predictions { error, .. } => error.remedy(),
            Self::RestraintsNeed { count, .. } => {
                format!("give --restraints-need a number up to {count}, or a share")
            }
            Self::NoAllowedPose { .. } => {
                "accept fewer with --restraints-need, raise upper bounds, or check chains and numbers of residues"
                    .to_owned()
            }
            Self::NoMembrane { .. } => {
                "give a file of OPM or PPM, which has two planes of DUM records, or the lowest and highest z in Å as \
                 in --membrane=-15,15"
                    .to_owned()
            }
            Self::AllInMembrane => {
                "check that the molecule that has the membrane reaches out of it".to_owned()
            }
            Self::Ended(Ended::Interrupted) => "start it again".to_owned(),
            Self::Ended(Ended::TimeLimit(_)) => {
                "allow more with --time-limit, or search fewer --rotations".to_owned()
            }
            Self::NoPose => "check lambda and the offset".to_owned(),
        }
    }
}
