//! Weights and tables of the terms of the score.

use clap::{Args, ValueHint};
use knotdock_scoring::terms::effect::contact::Potential;
use knotdock_scoring::terms::pose::{AtomPairPotential, DistanceBinnedPotential};
use serde::{Deserialize, Serialize};

use super::potential_file;
use super::term_weights::TermWeights;
use super::values::number;

/// Weights and tables of the terms of the score. The defaults of the weights were chosen on training pairs.
#[derive(Args, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[command(next_help_heading = "Terms (molecules)")]
#[serde(deny_unknown_fields)]
pub struct TermOptions {
    /// Weight in shape of atoms that no water reaches, against 1 for the others.
    #[arg(long, value_name = "NUMBER", value_parser = number(0.0..=1e3), default_value_t = 1.0)]
    pub core_weight: f64,
    /// Weights of effects and pose terms.
    #[command(flatten)]
    #[serde(flatten)]
    pub weights: TermWeights,
    /// Contact potential in place of the program's own.
    ///
    /// A table as scripts/potentials/contact_potential.py writes it.
    #[arg(long, value_name = "FILE", value_parser = potential_file::contact, value_hint = ValueHint::FilePath)]
    pub contact_potential: Option<Potential>,
    /// Fine contact potential in place of the program's own.
    ///
    /// A table as scripts/potentials/contact_potential.py --fine writes it.
    #[arg(long, value_name = "FILE", value_parser = potential_file::fine_contact, value_hint = ValueHint::FilePath)]
    pub fine_contact_potential: Option<DistanceBinnedPotential>,
    /// Atom pair potential in place of the program's own.
    ///
    /// A table as scripts/potentials/atom_pair_potential.py writes it.
    #[arg(long, value_name = "FILE", value_parser = potential_file::atom_pair, value_hint = ValueHint::FilePath)]
    pub atom_pair_potential: Option<AtomPairPotential>,
    /// pH at which charges are assigned.
    #[arg(long, value_name = "PH", value_parser = number(0.0..=14.0), default_value_t = 7.0)]
    pub ph: f64,
}
