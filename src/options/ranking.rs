//! Options on ranking, how poses become rows, and on the files of a run.

use serde::{Deserialize, Serialize};

use super::definition::{Choice, Flag, options};
use super::values::{CountOrAll, NOT_NEGATIVE};

options! {
    /// How poses become rows of the table.
    RankingOptions as ranking, "Ranking", Both {
        /// RMSD within which poses form a cluster, over the ligand's CA atoms.
        ///
        /// The default is 9 if active residues, a site or restraints are given. For meshes the radius is over the sample
        /// points, and the default is 2.273 times the offset.
        cluster_radius: f64 = 5.0, "ANGSTROM", NOT_NEGATIVE;
        /// Fit the best poses at atomic resolution: auto, on or off.
        ///
        /// auto ranks by these fits if one stands out as an exact fit does. on always ranks by them. off makes none.
        #[serde(default = "before_sharp_fits")]
        sharp: SharpChoice = SharpChoice::Auto, "auto|on|off", Choice;
        /// List every pose, not the best one of each cluster.
        ///
        /// Refined poses within a step of the search of a better one are left out.
        no_cluster: bool = false, "", Flag;
        /// Rows of poses.csv with exact scores: the best COUNT, or all.
        ///
        /// An exact score costs as much as a rotation of the search. Rows come in the order of the fast path's scores,
        /// whose error each run measures; those beyond COUNT have no exact columns. With --no-cluster, and in ensembles,
        /// all rows have them and are ordered by them.
        #[serde(default)]
        exact: Option<usize> = Some(200), "COUNT|all", CountOrAll;
    }
}

impl OutputOptions {
    /// The first of some rows, which are written as complexes.
    pub fn top<'a, T>(&self, rows: &'a [T]) -> &'a [T] {
        rows.get(..self.write_top).unwrap_or(rows)
    }
}

/// Value of records that are older than the option: their complexes are as they were searched.
fn before_refined_complexes() -> bool {
    true
}

/// Value of records that are older than the option.
fn before_sharp_fits() -> SharpChoice {
    SharpChoice::Off
}

/// Use of fits at atomic resolution in the ranking.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SharpChoice {
    /// They rank if one stands out.
    #[default]
    Auto,
    /// They always rank.
    On,
    /// None are made.
    Off,
}

options! {
    /// What a run writes.
    OutputOptions as output, "Output", Both {
        /// Complexes to write to top/.
        write_top: usize = 10, "COUNT", NOT_NEGATIVE;
        /// Write complexes as they were searched, with the clashes that a search forgives.
        ///
        /// By default their side chains are packed, and atoms that overlap are moved apart (`knotdock refine`), unless
        /// --budget is given. Ranks and scores are of the poses that were searched either way.
        #[serde(default = "before_refined_complexes")]
        raw: bool = false, "", Flag;
        /// Add the diagnostic columns to poses.csv.
        diagnostics: bool = false, "", Flag;
        /// Write no report.html.
        #[serde(default)]
        no_report: bool = false, "", Flag;
    }
}
