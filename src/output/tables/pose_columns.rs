//! The columns of `poses.csv` that a search fills, in order.
//!
//! | columns | content |
//! |---|---|
//! | `score` | the score that orders the rows: the cluster's if rows are clusters, else the pose's |
//! | `pose_score` | `search_score`, the pose terms and `other_copies` together |
//! | `search_score` | exact correlation at the pose, which is the sum of the effects |
//! | effects, pose terms | their weighted values by id; empty where one is off |
//! | `sharp`, `sharp_energy`, `sharp_clashes` | the sharp fit; not with `--sharp off` |
//!
//! Columns for diagnosis come last: the values of the fast path, and the pose's origin.

use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::terms::pose::{POSE_TERMS, TermDefinition};

use crate::output::tables::fields::number;
use crate::rank::ranking::RankedPose;

/// A column: its name, and its field of a pose.
pub(crate) struct PoseColumn {
    pub name: &'static str,
    pub field: Box<dyn Fn(&RankedPose) -> String>,
}

/// A column of any text.
fn text(name: &'static str, field: impl Fn(&RankedPose) -> String + 'static) -> PoseColumn {
    PoseColumn {
        name,
        field: Box::new(field),
    }
}

/// A column of numbers.
fn column(name: &'static str, value: impl Fn(&RankedPose) -> f64 + 'static) -> PoseColumn {
    text(name, move |row| number(value(row)))
}

/// A column of numbers that some poses lack.
fn optional(
    name: &'static str,
    value: impl Fn(&RankedPose) -> Option<f64> + 'static,
) -> PoseColumn {
    text(name, move |row| value(row).map(number).unwrap_or_default())
}

/// A column of counts that some poses lack.
fn count(name: &'static str, value: impl Fn(&RankedPose) -> Option<usize> + 'static) -> PoseColumn {
    text(name, move |row| {
        value(row).map_or_else(String::new, |value| value.to_string())
    })
}

/// The columns after `rank`: with those of sharp fits if these were made, those for diagnosis if requested, and those of the
/// pose terms that are shown.
pub(crate) fn columns(
    (sharp, diagnostics): (bool, bool),
    is_shown: impl Fn(&TermDefinition) -> bool,
) -> Vec<PoseColumn> {
    let mut columns = vec![
        column("score", |row| row.score),
        count("cluster", |row| row.cluster),
        count("cluster_size", |row| row.cluster_size),
        optional("pose_score", |row| row.pose_score),
        optional("search_score", |row| row.search_score),
    ];
    for effect in Effect::ALL {
        columns.push(optional(effect.name(), move |row| {
            row.terms[effect as usize]
        }));
    }
    for term in POSE_TERMS.iter().filter(|term| is_shown(term)) {
        columns.push(optional(term.id, |row| row.pose_terms.get(term.id)));
    }
    columns.push(optional("other_copies", |row| row.other_copies));
    if sharp {
        columns.extend(of_sharp_fits());
    }
    columns.push(optional("z_score", |row| row.z_score));
    for (index, name) in ["qw", "qx", "qy", "qz"].into_iter().enumerate() {
        columns.push(column(name, move |row| row.pose.quaternion()[index]));
    }
    for (index, name) in ["tx", "ty", "tz"].into_iter().enumerate() {
        columns.push(column(name, move |row| row.pose.translation[index]));
    }
    if diagnostics {
        columns.extend(for_diagnosis());
    }
    columns
}

/// Columns of the sharp fit: its part of the pose score, then the energy (RT) and clashes of the optimum.
fn of_sharp_fits() -> [PoseColumn; 3] {
    [
        optional("sharp", |row| row.sharp?.score),
        optional("sharp_energy", |row| Some(row.sharp?.energy)),
        count("sharp_clashes", |row| Some(row.sharp?.clashes)),
    ]
}

/// Columns on the search's way to a pose.
fn for_diagnosis() -> Vec<PoseColumn> {
    let mut columns = vec![
        optional("cluster_score", |row| row.cluster_score),
        text("refined", |row| row.refined.to_string()),
        text("rotation", |row| row.rotation.to_string()),
        column("score_grid", |row| row.score_grid),
        optional("score_unfiltered", |row| Some(row.shape?.unfiltered)),
    ];
    for (index, name) in ["slice_0", "slice_r0", "slice_2r0"].into_iter().enumerate() {
        columns.push(optional(name, move |row| Some(row.shape?.slices[index])));
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// A term whose id is a column's name already would hide one of the two.
    #[test]
    fn names_are_distinct_and_hold_every_term() {
        let names: Vec<&str> = columns((true, true), |_| true)
            .iter()
            .map(|column| column.name)
            .collect();
        let distinct: HashSet<&str> = names.iter().copied().collect();
        assert_eq!(distinct.len(), names.len());
        assert!(POSE_TERMS.iter().all(|term| distinct.contains(term.id)));
        assert!(
            Effect::ALL
                .iter()
                .all(|effect| distinct.contains(effect.name()))
        );
        let default = columns((true, false), |_| true);
        assert!(
            default
                .iter()
                .map(|column| column.name)
                .eq(names[..default.len()].iter().copied())
        );
    }
}
