//! Options of the search, with their units and defaults.

use std::path::{Path, PathBuf};

use clap::Args;
use knotdock::mesh::{CLUSTER_RADIUS, GivenLengths, RESOLUTION, SampleWeights};
use knotdock::options::{AXES, AXES_ACROSS, EngineChoice, PASS_RATIO, Precision, REFINED_BY_SHAPE};
use knotdock::options::{DockOptions, EffectChoice};
use knotdock::priors::restraints::AntibodySurface;
use knotdock_scoring::effect::contact::{Potential, PotentialError};
use knotdock_scoring::kernel::exponent;
use knotdock_scoring::rescoring::{AtomPairPotential, DistanceBinnedPotential};
use knotdock_scoring::symmetry::Symmetry;

use knotdock_structures::molecule::ResidueSelection;

use crate::cli::arguments::idle::refuse_idle;
use crate::cli::arguments::values::{
    above_zero, at_least_one, grid, not_negative, rotations_of_angle,
};
use crate::cli::messages::failure::Failure;

/// Heading of the options that trade accuracy for time.
pub const TRADE_OFFS: &str = "Accuracy against time";
const SCORE: &str = "Score";
const MESHES: &str = "Meshes";

fn resolution_help() -> String {
    format!(
        "Finest detail that is ranked, in Å, of meshes in their unit as all lengths: the low-pass ends at 1/A cycles per Å [default: {}; of \
         meshes {RESOLUTION:.3} times the offset]",
        DockOptions::default().resolution
    )
}

fn offset_help() -> String {
    format!(
        "Depth r0 of the skin, in Å [default: {}]; of meshes the gap that is looked for between the parts [default: twice the eps of \
         both parts' sampling, at most twice the smaller feature size]",
        DockOptions::default().offset
    )
}

fn cluster_radius_help() -> String {
    format!(
        "RMSD within which poses form a cluster, in Å, over the ligand's CA atoms or a mesh's sample points [default: {}; of meshes \
         {CLUSTER_RADIUS:.3} times the offset]",
        DockOptions::default().cluster_radius
    )
}

fn rotations_help() -> String {
    format!(
        "Rotations of the ligand, near uniform over all [default: {}]; with `dock --symmetry` axes, over half a sphere [default: {AXES}] or across a ring's own [default: {AXES_ACROSS}]",
        DockOptions::default().rotations
    )
}

fn pass_length_help() -> String {
    format!(
        "Coarsest detail that the low-pass touches, in Å: it takes nothing below 1/A cycles per Å; at least a hundredth above the resolution [default: {PASS_RATIO} \
         times the resolution]"
    )
}

fn refine_help() -> String {
    format!(
        "Best poses to refine off the grid [default: {REFINED_BY_SHAPE} with shape alone, none beside other effects, where \
         tighter fits make no better a ranking]"
    )
}

/// Heading of the options that say what the table lists.
pub const RANKING: &str = "Ranking";

/// Options of the kernel and of the modes that stand for it.
#[derive(Args, Debug)]
pub struct KernelArguments {
    #[arg(long, value_name = "A", value_parser = above_zero, help = resolution_help(), help_heading = TRADE_OFFS)]
    resolution: Option<f64>,
    #[arg(long, value_name = "A", value_parser = above_zero, help = pass_length_help(), help_heading = TRADE_OFFS)]
    pass_length: Option<f64>,
    /// Spacing of the translation grid, in Å [default: half the resolution, or finer where the tolerance needs it].
    #[arg(long, value_name = "A", value_parser = above_zero, help_heading = TRADE_OFFS)]
    spacing: Option<f64>,
    /// Penalty of overlap against the reward of contact (dimensionless).
    #[arg(long, value_name = "X", value_parser = not_negative, default_value_t = DockOptions::default().lambda, help_heading = SCORE)]
    lambda: f64,
    #[arg(long, value_name = "A", value_parser = not_negative, help = offset_help(), help_heading = SCORE)]
    offset: Option<f64>,
    /// Exponent of the bump kernel (dimensionless): large values harden the balls, `inf` makes them sharp.
    #[arg(long, value_name = "X", value_parser = exponent::parse, default_value_t = DockOptions::default().alpha, help_heading = SCORE)]
    alpha: f64,
    /// Weight in shape of atoms that no water reaches, against 1 for the others.
    #[arg(long, value_name = "X", value_parser = not_negative, default_value_t = DockOptions::default().core_weight, help_heading = SCORE)]
    core_weight: f64,
    /// Error of the fast path that is allowed, as a share of the best score. A smaller one lengthens the window of the kernel too, so that exact scores of
    /// runs with different tolerances differ.
    #[arg(long, value_name = "X", value_parser = above_zero, default_value_t = DockOptions::default().tolerance, help_heading = TRADE_OFFS)]
    tolerance: f64,
    /// Effects to score: auto takes those that the inputs call for; else any of shape, electrostatics, contact and restraint, with commas
    /// between them (shape is always on).
    #[arg(long, value_name = "NAMES", default_value = "auto", help_heading = SCORE)]
    effects: EffectChoice,
    /// Weight of the electrostatic energy: score per kcal/mol.
    #[arg(long, value_name = "X", value_parser = not_negative, default_value_t = DockOptions::default().electrostatics_weight, help_heading = SCORE)]
    electrostatics_weight: f64,
    /// Weight of the contact potential: score per RT.
    #[arg(long, value_name = "X", value_parser = not_negative, default_value_t = DockOptions::default().contact_weight, help_heading = SCORE)]
    contact_weight: f64,
    /// Contact potential to use in place of the program's own, as scripts/contact_potential.py writes it.
    #[arg(long, value_name = "CSV", help_heading = SCORE)]
    contact_potential: Option<PathBuf>,
    /// Weight of the fine contact potential, score per RT, by which poses are rescored where the contact effect is on; 0 for none.
    #[arg(long, value_name = "X", value_parser = not_negative, default_value_t = DockOptions::default().fine_contact_weight, help_heading = SCORE)]
    fine_contact_weight: f64,
    /// Fine contact potential to use in place of the program's own, as scripts/contact_potential.py --fine writes it.
    #[arg(long, value_name = "CSV", help_heading = SCORE)]
    fine_contact_potential: Option<PathBuf>,
    /// Weight of the atom pair potential, score per RT, by which poses are rescored where the contact effect is on; 0 for none.
    #[arg(long, value_name = "X", value_parser = not_negative, default_value_t = DockOptions::default().atom_pair_weight, help_heading = SCORE)]
    atom_pair_weight: f64,
    /// Weight of the atom pair potential where the pose comes to rest within 2 Å once atoms must not overlap, score per RT, by which poses are rescored
    /// where the contact effect is on; 0 for none.
    #[arg(long, value_name = "X", value_parser = not_negative, default_value_t = DockOptions::default().relaxed_weight, help_heading = SCORE)]
    relaxed_weight: f64,
    /// Atom pair potential to use in place of the program's own, as scripts/atom_pair_potential.py writes it.
    #[arg(long, value_name = "CSV", help_heading = SCORE)]
    atom_pair_potential: Option<PathBuf>,
    /// What a contact costs that a blocked atom makes: score.
    #[arg(long, value_name = "X", value_parser = not_negative, default_value_t = DockOptions::default().restraint_weight, help_heading = SCORE)]
    restraint_weight: f64,
    /// What may touch of an antibody, which is told by its sequence: cdrs, its complementarity-determining regions and what lies within 5 Å of them, or
    /// whole, all of it.
    #[arg(long, value_name = "cdrs|whole", default_value = DockOptions::default().antibody.name(), help_heading = SCORE)]
    antibody: AntibodySurface,
    /// Residues of the receptor to keep free of contact: H:1-50,52,52A,L for a range with all that is inserted in it, a residue, an inserted one and a
    /// chain. A chain without a name is _; after a residue its chain's name may be left out, unless another chain is called so.
    #[arg(long, value_name = "RESIDUES", help_heading = SCORE)]
    block_receptor: Option<ResidueSelection>,
    /// Residues of the ligand to keep free of contact, likewise.
    #[arg(long, value_name = "RESIDUES", help_heading = SCORE)]
    block_ligand: Option<ResidueSelection>,
    /// What a pose earns in which all attracted residues touch, else the share of them that does: score. In the search each contact of theirs earns a
    /// 250th, divided by their number.
    #[arg(long, value_name = "X", value_parser = not_negative, default_value_t = DockOptions::default().active_weight, help_heading = SCORE)]
    active_weight: f64,
    /// Residues of the receptor thought to be in contact, likewise: poses that touch them rank higher.
    #[arg(long, value_name = "RESIDUES", help_heading = SCORE)]
    active_receptor: Option<ResidueSelection>,
    /// Residues of the ligand thought to be in contact, likewise.
    #[arg(long, value_name = "RESIDUES", help_heading = SCORE)]
    active_ligand: Option<ResidueSelection>,
    /// What a pose earns in which the active site of a peptidase touches, else the share of its catalytic residues that does: score. Peptidases are told by their
    /// sequence, and this counts where the contact effect is on, no residue is attracted and the other is neither peptidase nor antibody; 0 for none.
    #[arg(long, value_name = "X", value_parser = not_negative, default_value_t = DockOptions::default().peptidase_weight, help_heading = SCORE)]
    peptidase_weight: f64,
    /// What an atom costs that lies where residues missing from the other side's file are, in gaps of a chain or past its ends, times how likely they are there:
    /// score; 0 for nothing.
    #[arg(long, value_name = "X", value_parser = not_negative, default_value_t = DockOptions::default().unresolved_weight, help_heading = SCORE)]
    unresolved_weight: f64,
    /// What an atom near an end of its chain, or near a gap in it, costs that touches the other side: score; 0 for nothing.
    #[arg(long, value_name = "X", value_parser = not_negative, default_value_t = DockOptions::default().termini_weight, help_heading = SCORE)]
    termini_weight: f64,
    /// pH at which charges are assigned.
    #[arg(long, value_name = "PH", value_parser = not_negative, default_value_t = DockOptions::default().ph, help_heading = SCORE)]
    ph: f64,
}

/// Options of the search.
#[derive(Args, Debug)]
pub struct SearchArguments {
    #[arg(long, value_name = "N", value_parser = at_least_one, help = rotations_help(), help_heading = TRADE_OFFS)]
    rotations: Option<usize>,
    /// Rotations by the field's count for an angle in degrees: 3600 (15/D)^3, so 15 gives 3,600 and 6 gives 56,250.
    #[arg(long, value_name = "D", value_parser = rotations_of_angle, conflicts_with = "rotations", help_heading = TRADE_OFFS)]
    angle: Option<usize>,
    /// Search again, among this many rotations, about the best: their peaks take the place of the best rotations' own.
    #[arg(long, value_name = "N", value_parser = at_least_one, help_heading = TRADE_OFFS)]
    fine_rotations: Option<usize>,
    /// The same by the field's count for an angle in degrees, as with --angle.
    #[arg(long, value_name = "D", value_parser = rotations_of_angle, conflicts_with = "fine_rotations", help_heading = TRADE_OFFS)]
    fine_angle: Option<usize>,
    /// Share of the finer rotations that are searched.
    #[arg(long, value_name = "X", value_parser = above_zero, default_value_t = DockOptions::default().fine_share, help_heading = TRADE_OFFS)]
    fine_share: f64,
    #[command(flatten)]
    kernel: KernelArguments,
    /// Floating-point type of the search: single or double, which allows tolerances from 1e-4 down to 1e-6. What is reported is in double precision
    /// either way.
    #[arg(long, value_name = "single|double", default_value = DockOptions::default().precision.name(), help_heading = TRADE_OFFS)]
    precision: Precision,
    /// What correlates: cpu, or gpu, a graphics processor driven through Vulkan, Metal or Direct3D 12, in single precision; of several the environment
    /// variable WGPU_ADAPTER_NAME names one.
    #[arg(long, value_name = "cpu|gpu", default_value = DockOptions::default().engine.name(), help_heading = TRADE_OFFS)]
    engine: EngineChoice,
    /// Peaks kept of each rotation.
    #[arg(long, value_name = "N", value_parser = at_least_one, default_value_t = DockOptions::default().per_rotation, help_heading = TRADE_OFFS)]
    per_rotation: usize,
    /// Poses kept of all rotations.
    #[arg(long, value_name = "N", value_parser = at_least_one, default_value_t = DockOptions::default().poses, help_heading = TRADE_OFFS)]
    poses: usize,
    #[arg(long, value_name = "N", help = refine_help(), help_heading = TRADE_OFFS)]
    refine: Option<usize>,
    #[arg(long, value_name = "A", value_parser = not_negative, help = cluster_radius_help(), help_heading = RANKING)]
    cluster_radius: Option<f64>,
    /// Of meshes: nodes of the grid that each part is sampled on, as 2^18 or 262144 [default: 2^18].
    #[arg(long, value_name = "M", value_parser = grid, help_heading = MESHES)]
    sample_grid: Option<usize>,
    /// Of meshes: weights of the balls, those whose summed bumps come closest to one inside and to zero outside, or one [default: fitted].
    #[arg(long, value_name = "fitted|unit", value_parser = sample_weights, help_heading = MESHES)]
    sample_weights: Option<SampleWeights>,
    /// List every pose, but for those within a step of the search of a better refined one; without this, one row a cluster, its best pose.
    #[arg(long, help_heading = RANKING)]
    no_cluster: bool,
}

impl KernelArguments {
    /// The options with everything else at its default.
    ///
    /// # Errors
    /// [`Failure`] when a contact potential cannot be read.
    pub fn options(&self) -> Result<DockOptions, Failure> {
        let default = DockOptions::default();
        Ok(DockOptions {
            contact_potential: read_potential(
                self.contact_potential.as_deref(),
                "contact-potential",
                "contact_potential.py",
                Potential::parse,
            )?,
            fine_contact_weight: self.fine_contact_weight,
            fine_contact_potential: read_potential(
                self.fine_contact_potential.as_deref(),
                "fine-contact-potential",
                "contact_potential.py --fine",
                DistanceBinnedPotential::parse,
            )?,
            atom_pair_weight: self.atom_pair_weight,
            relaxed_weight: self.relaxed_weight,
            atom_pair_potential: read_potential(
                self.atom_pair_potential.as_deref(),
                "atom-pair-potential",
                "atom_pair_potential.py",
                AtomPairPotential::parse,
            )?,
            resolution: self.resolution.unwrap_or(default.resolution),
            pass_length: self.pass_length,
            spacing: self.spacing,
            lambda: self.lambda,
            offset: self.offset.unwrap_or(default.offset),
            alpha: self.alpha,
            core_weight: self.core_weight,
            tolerance: self.tolerance,
            effects: self.effects.clone(),
            electrostatics_weight: self.electrostatics_weight,
            contact_weight: self.contact_weight,
            restraint_weight: self.restraint_weight,
            antibody: self.antibody,
            block_receptor: self.block_receptor.clone(),
            block_ligand: self.block_ligand.clone(),
            active_weight: self.active_weight,
            peptidase_weight: self.peptidase_weight,
            unresolved_weight: self.unresolved_weight,
            termini_weight: self.termini_weight,
            active_receptor: self.active_receptor.clone(),
            active_ligand: self.active_ligand.clone(),
            ph: self.ph,
            ..default
        })
    }
}

impl SearchArguments {
    /// The options as the search takes them; the machine's are at their defaults.
    ///
    /// # Errors
    /// As [`KernelArguments::options`].
    pub fn options(&self) -> Result<DockOptions, Failure> {
        let kernel = self.kernel.options()?;
        let options = DockOptions {
            rotations: self.angle.or(self.rotations).unwrap_or(kernel.rotations),
            fine_rotations: self.fine_angle.or(self.fine_rotations),
            fine_share: self.fine_share,
            precision: self.precision,
            engine: self.engine,
            per_rotation: self.per_rotation,
            poses: self.poses,
            refine: self.refine,
            cluster_radius: self.cluster_radius.unwrap_or(kernel.cluster_radius),
            sample_grid: self.sample_grid,
            sample_weights: self.sample_weights,
            every_pose: self.no_cluster,
            ..kernel
        };
        refuse_idle(&options)?;
        Ok(options)
    }

    /// The options of a search for rings, whose residues are alike on both sides.
    ///
    /// # Errors
    /// As [`KernelArguments::options`].
    pub fn ring_options(&self, symmetry: Symmetry) -> Result<DockOptions, Failure> {
        let options = self.options()?;
        Ok(DockOptions {
            rotations: self.rotations.unwrap_or(match symmetry.folds() {
                Some(_) => AXES_ACROSS,
                None => AXES,
            }),
            symmetry: Some(symmetry),
            block_ligand: options.block_receptor.clone(),
            active_ligand: options.active_receptor.clone(),
            ..options
        })
    }

    /// The offset, where it is given.
    pub fn offset(&self) -> Option<f64> {
        self.kernel.offset
    }

    /// Further lengths that are given.
    pub fn given_lengths(&self) -> GivenLengths {
        GivenLengths {
            resolution: self.kernel.resolution.is_some(),
            cluster_radius: self.cluster_radius.is_some(),
        }
    }
}

/// Weights by their name.
fn sample_weights(text: &str) -> Result<SampleWeights, String> {
    match text {
        "fitted" => Ok(SampleWeights::Fitted),
        "unit" => Ok(SampleWeights::Unit),
        _ => Err("fitted or unit is needed".to_owned()),
    }
}

/// The table that an option names, if it does; `script` writes such tables.
fn read_potential<P>(
    path: Option<&Path>,
    option: &str,
    script: &str,
    parse: fn(&str) -> Result<P, PotentialError>,
) -> Result<Option<P>, Failure> {
    let Some(path) = path else {
        return Ok(None);
    };
    let remedy = format!("give a table as scripts/{script} writes it, or leave --{option} out");
    let text = std::fs::read_to_string(path)
        .map_err(|error| Failure::input(&error).at(path).remedy(&remedy))?;
    let table = parse(&text).map_err(|error| {
        Failure::input(&error)
            .at(path)
            .on_line(Some(error.line as u64))
            .remedy(remedy)
    })?;
    Ok(Some(table))
}
