//! Weights and tables of the terms of the score.

use clap::{Args, ValueHint};
use knotdock_scoring::effect::contact::Potential;
use knotdock_scoring::rescoring::{AtomPairPotential, DistanceBinnedPotential};
use serde::{Deserialize, Serialize};

use super::potential_file;
use super::values::number;

/// Weights and tables of the terms of the score. The defaults of the weights were chosen on training pairs.
#[derive(Args, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[command(next_help_heading = "Terms (molecules)")]
#[serde(deny_unknown_fields)]
pub struct TermOptions {
    /// Weight in shape of atoms that no water reaches, against 1 for the others.
    #[arg(long, value_name = "X", value_parser = number(0.0..=1e3), default_value_t = 1.0)]
    pub core_weight: f64,
    /// Weight of the electrostatic energy: score per kcal/mol.
    #[arg(long, value_name = "X", value_parser = number(0.0..=1e6), default_value_t = 24.0)]
    pub electrostatics_weight: f64,
    /// Weight of the contact potential: score per RT.
    #[arg(long, value_name = "X", value_parser = number(0.0..=1e6), default_value_t = 2.0)]
    pub contact_weight: f64,
    /// Contact potential to use in place of the program's own, as scripts/contact_potential.py writes it.
    #[arg(long, value_name = "CSV", value_parser = potential_file::contact, value_hint = ValueHint::FilePath)]
    pub contact_potential: Option<Potential>,
    /// Weight of the fine contact potential, score per RT, by which poses are rescored where the contact effect is on; 0 for none.
    #[arg(long, value_name = "X", value_parser = number(0.0..=1e6), default_value_t = 2.0)]
    pub fine_contact_weight: f64,
    /// Fine contact potential to use in place of the program's own, as scripts/contact_potential.py --fine writes it.
    #[arg(long, value_name = "CSV", value_parser = potential_file::fine_contact, value_hint = ValueHint::FilePath)]
    pub fine_contact_potential: Option<DistanceBinnedPotential>,
    /// Weight of the atom pair potential, score per RT, by which poses are rescored where the contact effect is on; 0 for none.
    #[arg(long, value_name = "X", value_parser = number(0.0..=1e6), default_value_t = 1.0)]
    pub atom_pair_weight: f64,
    /// Weight of the atom pair potential where the pose comes to rest within 2 Å once atoms must not overlap: score per RT. Poses are
    /// rescored by it where the contact effect is on; 0 for none.
    #[arg(long, value_name = "X", value_parser = number(0.0..=1e6), default_value_t = 3.0)]
    pub relaxed_weight: f64,
    /// Atom pair potential to use in place of the program's own, as scripts/atom_pair_potential.py writes it.
    #[arg(long, value_name = "CSV", value_parser = potential_file::atom_pair, value_hint = ValueHint::FilePath)]
    pub atom_pair_potential: Option<AtomPairPotential>,
    /// What an atom costs that lies where residues missing from the other side's file are, in gaps of a chain or past its ends, times
    /// how likely they are there: score; 0 for nothing.
    #[arg(long, value_name = "X", value_parser = number(0.0..=1e6), default_value_t = 3.0)]
    pub unresolved_weight: f64,
    /// What an atom near an end of its chain, or near a gap in it, costs that touches the other side: score; 0 for nothing.
    #[arg(long, value_name = "X", value_parser = number(0.0..=1e6), default_value_t = 2.0)]
    pub termini_weight: f64,
    /// pH at which charges are assigned.
    #[arg(long, value_name = "PH", value_parser = number(0.0..=14.0), default_value_t = 7.0)]
    pub ph: f64,
}
