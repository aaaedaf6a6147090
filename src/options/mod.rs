//! What a docking run may be asked.

pub mod effect_choice;
pub use effect_choice::EffectChoice;

use crate::error::SearchError;
use crate::mesh::SampleWeights;
use crate::priors::restraints::AntibodySurface;
use knotdock_scoring::effect::contact::Potential;
use knotdock_scoring::engine::EngineOptions;
use knotdock_scoring::kernel::{KernelOptions, Trim};
use knotdock_scoring::rescoring::{AtomPairPotential, DistanceBinnedPotential};
use knotdock_scoring::symmetry::Symmetry;
use knotdock_structures::molecule::ResidueSelection;
use serde::{Deserialize, Serialize};

/// Options of a docking run. Lengths in Å, or in the files' unit where meshes are docked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DockOptions {
    /// Number of rotations sampled, of rings that of axes.
    pub rotations: usize,
    /// Size of the finer set of rotations that is searched about the best; `None`: no finer search.
    pub fine_rotations: Option<usize>,
    /// Share of the finer set that is searched.
    pub fine_share: f64,
    /// Where a run within a time stopped, which one that repeats it does, too; `None`: nowhere.
    pub stopped: Option<Stopped>,
    /// Resolution: the ranking kernel's low-pass stops at 1 / resolution.
    pub resolution: f64,
    /// Length whose inverse is the pass frequency; `None`: `PASS_RATIO` times the resolution.
    pub pass_length: Option<f64>,
    /// Grid spacing; `None`: resolution / 2, or finer where the tolerance needs it.
    pub spacing: Option<f64>,
    /// Weight lambda of overlap against contact.
    pub lambda: f64,
    /// Skin offset r0.
    pub offset: f64,
    /// Exponent alpha of the bump function; infinity is the sharp ball.
    #[serde(with = "knotdock_scoring::kernel::exponent")]
    pub alpha: f64,
    /// Weight in shape of atoms that no water reaches, against 1 for the others.
    pub core_weight: f64,
    /// Error of the fast path aimed at, relative to the best score.
    pub tolerance: f64,
    /// Floating-point type of the fast path.
    pub precision: Precision,
    /// What correlates.
    pub engine: EngineChoice,
    /// Nodes along each edge of the grids that meshes are sampled on; `None` for molecules.
    pub sample_grid: Option<usize>,
    /// Weights of a mesh's balls; `None` for molecules.
    pub sample_weights: Option<SampleWeights>,
    /// Symmetry of the rings that copies of one molecule are to form, or two rings with each other; `None`: a receptor and a ligand are docked.
    pub symmetry: Option<Symmetry>,
    /// Terms of the score.
    pub effects: EffectChoice,
    /// Weight of the electrostatic energy: score per kcal/mol.
    pub electrostatics_weight: f64,
    /// Weight of the contact potential: score per RT.
    pub contact_weight: f64,
    /// The contact potential; `None`: the one that the program carries.
    pub contact_potential: Option<Potential>,
    /// Weight of the fine contact potential, by which poses are rescored where the contact effect is on: score per RT; 0: without it.
    pub fine_contact_weight: f64,
    /// The fine contact potential; `None`: the one that the program carries.
    pub fine_contact_potential: Option<DistanceBinnedPotential>,
    /// Weight of the atom pair potential, by which poses are rescored likewise: score per RT; 0: without it.
    pub atom_pair_weight: f64,
    /// Weight of what a pose is worth once relaxed, by which poses are rescored likewise: score per RT; 0: without it.
    pub relaxed_weight: f64,
    /// The atom pair potential; `None`: the one that the program carries.
    pub atom_pair_potential: Option<AtomPairPotential>,
    /// What a contact costs that a blocked atom makes: score.
    pub restraint_weight: f64,
    /// What a pose earns in which all attracted residues touch: score.
    pub active_weight: f64,
    /// What a pose earns in which all catalytic residues of a peptidase touch: score; 0: peptidases are docked as any protein.
    pub peptidase_weight: f64,
    /// What an atom costs that lies where residues missing from the other side's file are, times how likely they are there: score; 0: nothing is known of these.
    pub unresolved_weight: f64,
    /// What an atom near an end of its chain costs that touches the other side: score; 0: ends are as good as any.
    pub termini_weight: f64,
    /// What part of an antibody may touch.
    pub antibody: AntibodySurface,
    /// Residues of the receptor that are to stay free of contact.
    pub block_receptor: Option<ResidueSelection>,
    /// Residues of the ligand that are to stay free of contact.
    pub block_ligand: Option<ResidueSelection>,
    /// Residues of the receptor that are to be in contact.
    pub active_receptor: Option<ResidueSelection>,
    /// Residues of the ligand that are to be in contact.
    pub active_ligand: Option<ResidueSelection>,
    /// pH at which charges are assigned.
    pub ph: f64,
    /// Peaks kept of each rotation.
    pub per_rotation: usize,
    /// Poses kept over all rotations.
    pub poses: usize,
    /// Best poses that are refined off the grid; `None`: [`REFINED_BY_SHAPE`] where shape is the only effect, else none.
    pub refine: Option<usize>,
    /// Radius of clusters: RMSD of the ligand's CA atoms, or of a mesh's sample points.
    pub cluster_radius: f64,
    /// Whether every pose is a row, rather than one a cluster.
    pub every_pose: bool,
    /// Threads; 0 takes all cores.
    pub threads: usize,
    /// Bytes that the run may take; `None`: no limit.
    pub memory: Option<u64>,
}

/// Where a run within a time stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stopped {
    /// Rotations that were searched, evenly spread over the set.
    pub rotations: usize,
    /// Poses that were kept of the search, the best ones.
    pub poses: usize,
}

/// Floating-point type of the fast path: spectra, grids and the search. What is reported is in double precision whatever it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// 32 bits: tolerances down to 1e-4.
    #[default]
    Single,
    /// 64 bits: tolerances down to 1e-6.
    Double,
}

impl Precision {
    /// Both, the coarser first.
    pub const ALL: [Self; 2] = [Self::Single, Self::Double];

    /// Name as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Double => "double",
        }
    }

    /// Finest tolerance that it can be asked.
    pub fn finest_tolerance(self) -> f64 {
        match self {
            Self::Single => 1e-4,
            Self::Double => 1e-6,
        }
    }
}

impl std::str::FromStr for Precision {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|known| known.name() == text);
        known.ok_or_else(|| format!("{} is needed", Self::ALL.map(Self::name).join(" or ")))
    }
}

/// What the correlations are computed on. All else, exact sums and refinement among it, is computed on the CPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EngineChoice {
    /// The CPU's cores.
    #[default]
    Cpu,
    /// A graphics processor, in single precision.
    Gpu,
}

impl EngineChoice {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Cpu, Self::Gpu];

    /// Name as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
        }
    }
}

impl std::str::FromStr for EngineChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|known| known.name() == text);
        known.ok_or_else(|| format!("{} is needed", Self::ALL.map(Self::name).join(" or ")))
    }
}

/// Poses refined by default when shape is all there is: as many as it takes for ranks to depend little on how the ligand was turned
/// (docs/defaults.md). Beside other effects refining cost ranks.
pub const REFINED_BY_SHAPE: usize = 600;

/// Axes of rings by default: 4 degrees to the nearest at most, and up to twice that for the copies about it.
pub const AXES: usize = 900;

/// Axes of two rings by default: of D2 a degree apart, of Dn 2 / n of one.
pub const AXES_ACROSS: usize = 90;

/// Default pass length as a multiple of the resolution.
pub const PASS_RATIO: f64 = 2.0;

impl Default for DockOptions {
    /// Resolution, offset, lambda, the weights of effects and that nothing is refined were chosen on training pairs; the rest is the
    /// literature's or this project's first measured setting.
    fn default() -> Self {
        Self {
            rotations: 3600,
            fine_rotations: None,
            fine_share: 0.05,
            stopped: None,
            resolution: 4.5,
            pass_length: None,
            spacing: None,
            lambda: 9.0,
            offset: 2.2,
            alpha: 2.0,
            core_weight: 1.0,
            tolerance: 1e-2,
            precision: Precision::Single,
            engine: EngineChoice::Cpu,
            sample_grid: None,
            sample_weights: None,
            symmetry: None,
            effects: EffectChoice::Auto,
            electrostatics_weight: 24.0,
            contact_weight: 2.0,
            contact_potential: None,
            fine_contact_weight: 2.0,
            fine_contact_potential: None,
            atom_pair_weight: 1.0,
            relaxed_weight: 3.0,
            atom_pair_potential: None,
            // About what contacts earn: 1.1 to 1.6 in all terms together among good poses of training pairs.
            restraint_weight: 1.0,
            active_weight: 2000.0,
            // Two units of log-odds, of which one is worth 212 to 240 on training pairs.
            peptidase_weight: 500.0,
            unresolved_weight: 3.0,
            termini_weight: 2.0,
            antibody: AntibodySurface::default(),
            block_receptor: None,
            block_ligand: None,
            active_receptor: None,
            active_ligand: None,
            ph: 7.0,
            per_rotation: 3,
            poses: 2000,
            refine: None,
            cluster_radius: 5.0,
            every_pose: false,
            threads: 0,
            memory: None,
        }
    }
}

impl DockOptions {
    /// What the first version would have made of no options at all: the defaults, less all that came later and moves the ranking.
    pub fn of_first_version() -> Self {
        Self {
            unresolved_weight: 0.0,
            termini_weight: 0.0,
            fine_contact_weight: 0.0,
            atom_pair_weight: 0.0,
            relaxed_weight: 0.0,
            peptidase_weight: 0.0,
            antibody: AntibodySurface::Whole,
            ..Self::default()
        }
    }

    /// The engine's part of the options.
    pub fn engine(&self) -> EngineOptions {
        EngineOptions {
            kernel: KernelOptions {
                lambda: self.lambda,
                offset: self.offset,
                alpha: self.alpha,
                resolution: self.resolution,
                pass_length: self.pass_length.unwrap_or(PASS_RATIO * self.resolution),
                trim: Trim::FlatTop,
            },
            spacing: self.spacing,
            tolerance: self.tolerance,
        }
    }

    /// Whether residues are named that are to stay free of contact, or to be in contact.
    pub(crate) fn names_residues(&self) -> bool {
        let named = [
            &self.block_receptor,
            &self.block_ligand,
            &self.active_receptor,
            &self.active_ligand,
        ];
        named.into_iter().any(Option::is_some)
    }

    /// Refuses weights and a pH that mean nothing.
    pub(crate) fn check_effects(&self) -> Result<(), SearchError> {
        let numbers = [
            ("core-weight", self.core_weight, 1e3),
            ("electrostatics-weight", self.electrostatics_weight, 1e6),
            ("contact-weight", self.contact_weight, 1e6),
            ("fine-contact-weight", self.fine_contact_weight, 1e6),
            ("atom-pair-weight", self.atom_pair_weight, 1e6),
            ("relaxed-weight", self.relaxed_weight, 1e6),
            ("restraint-weight", self.restraint_weight, 1e6),
            ("active-weight", self.active_weight, 1e6),
            ("peptidase-weight", self.peptidase_weight, 1e6),
            ("unresolved-weight", self.unresolved_weight, 1e6),
            ("termini-weight", self.termini_weight, 1e6),
            ("ph", self.ph, 14.0),
        ];
        for (name, value, most) in numbers {
            if !(0.0..=most).contains(&value) {
                return Err(SearchError::Option {
                    name,
                    value: value.to_string(),
                    bound: format!("between 0 and {most}"),
                });
            }
        }
        Ok(())
    }

    /// Refuses what no run can do.
    pub(crate) fn check(&self) -> Result<(), SearchError> {
        let counts = [
            ("rotations", self.rotations, 10_000_000),
            ("per-rotation", self.per_rotation, 10_000),
            ("poses", self.poses, 10_000_000),
        ];
        for (name, value, most) in counts {
            if value == 0 || value > most {
                return Err(SearchError::Option {
                    name,
                    value: value.to_string(),
                    bound: format!("between 1 and {most}"),
                });
            }
        }
        if let Some(Stopped { rotations, poses }) = self.stopped
            && !((1..=self.rotations).contains(&rotations) && (1..=self.poses).contains(&poses))
        {
            return Err(SearchError::Option {
                name: "stopped",
                value: format!("{rotations} rotations and {poses} poses"),
                bound: "at least one of each, and no more than rotations and poses".to_owned(),
            });
        }
        if let Some(finer) = self.fine_rotations
            && !(self.rotations..=10_000_000).contains(&finer)
        {
            return Err(SearchError::Option {
                name: "fine-rotations",
                value: finer.to_string(),
                bound: "no fewer than the rotations and at most 10000000".to_owned(),
            });
        }
        if !(self.fine_share > 0.0 && self.fine_share <= 1.0) {
            return Err(SearchError::Option {
                name: "fine-share",
                value: self.fine_share.to_string(),
                bound: "above 0 and at most 1".to_owned(),
            });
        }
        if !(self.cluster_radius.is_finite() && self.cluster_radius >= 0.0) {
            return Err(SearchError::Option {
                name: "cluster-radius",
                value: self.cluster_radius.to_string(),
                bound: "0 or more".to_owned(),
            });
        }
        if self.tolerance < self.precision.finest_tolerance() {
            return Err(SearchError::Option {
                name: "tolerance",
                value: self.tolerance.to_string(),
                bound: match self.precision {
                    Precision::Single => {
                        "1e-4 or more in single precision (1e-6 with --precision double)"
                    }
                    Precision::Double => "1e-6 or more",
                }
                .to_owned(),
            });
        }
        self.check_rings()?;
        self.check_engine()
    }

    /// Refuses what a search for rings has no part for.
    fn check_rings(&self) -> Result<(), SearchError> {
        let Some(symmetry) = self.symmetry else {
            return Ok(());
        };
        let without = |name, value: String, bound: &str| SearchError::Option {
            name,
            value,
            bound: format!("{bound} with --symmetry {symmetry}"),
        };
        if let Some(finer) = self.fine_rotations {
            return Err(without("fine-rotations", finer.to_string(), "left out"));
        }
        if let Some(refined) = self.refine {
            let bound = "left out, for every ring is refined,";
            return Err(without("refine", refined.to_string(), bound));
        }
        if self.engine != EngineChoice::Cpu {
            return Err(without("engine", self.engine.name().to_owned(), "cpu"));
        }
        // A ring's poses score as their inverses do.
        let sides = [
            ("block-ligand", &self.block_receptor, &self.block_ligand),
            ("active-ligand", &self.active_receptor, &self.active_ligand),
        ];
        for (name, receptor, ligand) in sides {
            if receptor != ligand {
                let value = match ligand {
                    Some(residues) => residues.clone().into(),
                    None => "left out".to_owned(),
                };
                return Err(without(name, value, "the receptor's"));
            }
        }
        Ok(())
    }

    fn check_engine(&self) -> Result<(), SearchError> {
        if self.engine == EngineChoice::Cpu {
            return Ok(());
        }
        if !cfg!(feature = "gpu") {
            return Err(SearchError::Option {
                name: "engine",
                value: self.engine.name().to_owned(),
                bound: "cpu in this build, which was made without the feature `gpu`".to_owned(),
            });
        }
        if self.precision == Precision::Double {
            return Err(SearchError::Option {
                name: "precision",
                value: self.precision.name().to_owned(),
                bound: "single with --engine gpu".to_owned(),
            });
        }
        Ok(())
    }
}
