//! Options on ranking: how poses become rows.

use clap::{Args, ValueEnum};
use serde::{Deserialize, Serialize};

use super::values::not_negative;

/// How poses become rows of the table.
#[derive(Args, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[command(next_help_heading = "Ranking")]
#[serde(deny_unknown_fields)]
pub struct RankingOptions {
    /// RMSD within which poses form a cluster, over the ligand's CA atoms.
    ///
    /// For meshes it is over the sample points, and the default is 2.273 times the offset.
    #[arg(long, value_name = "ANGSTROM", value_parser = not_negative, default_value_t = 5.0)]
    pub cluster_radius: f64,
    /// Fit the best poses at atomic resolution: auto, on or off.
    ///
    /// auto ranks by these fits if one stands out as an exact fit does. on always ranks by them. off makes none.
    #[arg(long, value_enum, value_name = "auto|on|off", hide_possible_values = true, default_value_t = SharpChoice::Auto)]
    #[serde(default = "before_sharp_fits")]
    pub sharp: SharpChoice,
    /// List every pose, not the best one of each cluster.
    ///
    /// Refined poses within a step of the search of a better one are left out.
    #[arg(long)]
    pub no_cluster: bool,
}

/// What records hold of runs that are older than the option.
fn before_sharp_fits() -> SharpChoice {
    SharpChoice::Off
}

/// Use of fits at atomic resolution in the ranking.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum SharpChoice {
    /// They rank where one stands out.
    #[default]
    Auto,
    /// They always rank.
    On,
    /// They are not looked for.
    Off,
}
