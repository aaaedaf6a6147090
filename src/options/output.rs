//! Options on what a run writes.

use clap::Args;
use serde::{Deserialize, Serialize};

/// What a run writes.
#[derive(Args, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[command(next_help_heading = "Output")]
#[serde(deny_unknown_fields)]
pub struct OutputOptions {
    /// Complexes to write to top/.
    #[arg(long, value_name = "COUNT", default_value_t = 10)]
    pub write_top: usize,
    /// Add the diagnostic columns to poses.csv.
    #[arg(long)]
    pub diagnostics: bool,
    /// Write no report.html.
    #[arg(long)]
    #[serde(default)]
    pub no_report: bool,
}
