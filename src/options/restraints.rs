//! Options on known contacts.

use std::path::Path;

use clap::{Args, ValueEnum, ValueHint};
use knotdock_structures::molecule::ResidueSelection;
use serde::{Deserialize, Serialize};

use super::values::number;
use crate::predictions::PredictionSource;
use crate::priors::membrane::MembraneChoice;
use crate::priors::peptidase;
use crate::restraints::{Crosslink, Needed, RestraintFile, RestraintFileError};

/// What is known of the contacts: residues that make them or make none, antibodies, peptidases.
#[derive(Args, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[command(next_help_heading = "Restraints (molecules)")]
#[serde(deny_unknown_fields)]
pub struct RestraintOptions {
    /// What may touch of an antibody, which is detected from its sequence: cdrs, its complementarity-determining
    /// regions and what lies within 5 Å of them, or whole, all of it.
    #[arg(long, value_enum, value_name = "cdrs|whole", hide_possible_values = true, default_value_t = AntibodySurface::Cdrs)]
    pub antibody: AntibodySurface,
    /// Residues of the receptor to keep free of contact: H:1-50,52,52A,L for a range with all that is inserted in it,
    /// a residue, an inserted one and a chain. A chain without a name is _; after a residue its chain's name may be
    /// left out, unless another chain is called so.
    #[arg(long, value_name = "RESIDUES")]
    pub block_receptor: Option<ResidueSelection>,
    /// Residues of the ligand to keep free of contact, likewise.
    #[arg(long, value_name = "RESIDUES")]
    pub block_ligand: Option<ResidueSelection>,
    /// Active residues of the receptor, thought to be in contact: poses that touch them rank higher, by
    /// --active-weight. In the search each contact of theirs earns a 250th of that, divided by their number.
    #[arg(long, value_name = "RESIDUES")]
    pub active_receptor: Option<ResidueSelection>,
    /// Active residues of the ligand, likewise.
    #[arg(long, value_name = "RESIDUES")]
    pub active_ligand: Option<ResidueSelection>,
    /// Distances that are known between receptor and ligand: a table (columns receptor, ligand, lower, target, upper,
    /// group; residues as A:57, atoms as A:57.CA) or a .tbl of HADDOCK and CNS. Poses that cannot satisfy them are not
    /// searched.
    #[arg(long, value_name = "FILE", value_parser = restraint_file, value_hint = ValueHint::FilePath)]
    pub restraints: Option<RestraintFile>,
    /// How many of the restraints a pose has to satisfy: a number, or a share such as 60%. Fewer than all, where some
    /// may be false.
    #[arg(long, value_name = "K|SHARE", default_value_t = Needed::default())]
    pub restraints_need: Needed,
    /// The reagent of cross-links: rows of --restraints without an upper bound get that of its CA atoms. DSS or BS3:
    /// 30 Å.
    #[arg(long, value_name = "NAME")]
    pub crosslink: Option<Crosslink>,
    /// How likely each residue of the receptor is in the interface, as a predictor says: a table (columns chain,
    /// residue, probability), or bfactor for the B values of the receptor's file. Poses that touch the likely ones rank
    /// higher, by --interface-weight.
    #[arg(long, value_name = "FILE|bfactor", value_parser = PredictionSource::read, value_hint = ValueHint::FilePath)]
    pub interface_receptor: Option<PredictionSource>,
    /// The same of the ligand.
    #[arg(long, value_name = "FILE|bfactor", value_parser = PredictionSource::read, value_hint = ValueHint::FilePath)]
    pub interface_ligand: Option<PredictionSource>,
    /// A membrane that no atom of the other molecule enters: receptor or ligand, whose file marks its planes as those
    /// of OPM and PPM do, or the lowest and highest z in Å of the receptor's file (--membrane=-15,15). Poses in it are
    /// not searched, but for what lies between the samples, which costs --membrane-weight.
    #[arg(
        long,
        value_name = "receptor|ligand|LOW,HIGH",
        allow_hyphen_values = true
    )]
    pub membrane: Option<MembraneChoice>,
    /// What a pose earns in which the active site of a peptidase touches, else the share of its catalytic residues
    /// that does: score. Peptidases are detected from their sequence, and this counts where the contact effect is on,
    /// no residue is active and the other is neither peptidase nor antibody; 0 for none.
    #[arg(long, value_name = "X", value_parser = number(0.0..=1e6), default_value_t = peptidase::WEIGHT)]
    pub peptidase_weight: f64,
}

impl RestraintOptions {
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
}

/// The restraints of a file.
fn restraint_file(path: &str) -> Result<RestraintFile, RestraintFileError> {
    RestraintFile::read(Path::new(path))
}

/// What part of an antibody may touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum AntibodySurface {
    /// Its CDRs and what lies about them.
    #[default]
    Cdrs,
    /// All of it.
    Whole,
}
