//! Options on what a run writes.

use super::definition::{Flag, options};
use super::values::NOT_NEGATIVE;

options! {
    /// What a run writes.
    OutputOptions as output, "Output", Both {
        /// Complexes to write to top/.
        write_top: usize = 10, "COUNT", NOT_NEGATIVE;
        /// Add the diagnostic columns to poses.csv.
        diagnostics: bool = false, "", Flag;
        /// Write no report.html.
        #[serde(default)]
        no_report: bool = false, "", Flag;
    }
}
