//! Options on ranking: how poses become rows.

use clap::Args;
use serde::{Deserialize, Serialize};

use super::values::not_negative;

/// How poses become rows of the table.
#[derive(Args, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[command(next_help_heading = "Ranking")]
#[serde(deny_unknown_fields)]
pub struct RankingOptions {
    /// RMSD within which poses form a cluster, in Å, over the ligand's CA atoms or a mesh's sample points; of meshes
    /// by default 2.273 times the offset.
    #[arg(long, value_name = "A", value_parser = not_negative, default_value_t = 5.0)]
    pub cluster_radius: f64,
    /// List every pose, but for those within a step of the search of a better refined one; without this, one row a
    /// cluster, its best pose.
    #[arg(long)]
    pub no_cluster: bool,
}
