//! Distance restraints of a run's poses: the number that each satisfies, and `restraints.csv` with every distance.

use std::io;

use crate::dock::plan::DockPlan;
use crate::output::tables::fields::{Column, number};
use crate::rank::ranking::RankedPose;
use crate::table_text::cells::TableWriter;

/// Columns of `restraints.csv`.
const HEADER: [&str; 6] = ["rank", "restraint", "distance", "lower", "upper", "met"];

/// The effective distance (Å) of each restraint at a pose, and whether it is satisfied.
fn distances(plan: &DockPlan, pose: &RankedPose) -> impl Iterator<Item = (f64, bool)> {
    let positions = plan.knots().map(|knots| knots.centers.as_slice());
    plan.restraints.at(positions, &pose.pose)
}

/// The number of restraints that a pose satisfies.
fn count(plan: &DockPlan, pose: &RankedPose) -> usize {
    distances(plan, pose).filter(|(_, met)| *met).count()
}

/// The most restraints that any of the poses satisfies; `None` without restraints or poses.
pub fn most_met(plan: &DockPlan, poses: &[RankedPose]) -> Option<usize> {
    let counts = poses.iter().map(|pose| count(plan, pose));
    counts.max().filter(|_| !plan.restraints.is_empty())
}

/// The column `restraints_met` of `poses.csv`; `None` without restraints.
pub fn met(plan: &DockPlan, poses: &[RankedPose]) -> Option<Column> {
    let count = |pose| count(plan, pose);
    (!plan.restraints.is_empty()).then(|| Column {
        name: "restraints_met".to_owned(),
        fields: poses.iter().map(|pose| count(pose).to_string()).collect(),
    })
}

/// Writes `restraints.csv`: a row per pose and restraint, with the effective distance and its bounds in Å.
pub fn write_to(
    plan: &DockPlan,
    poses: &[RankedPose],
    stream: &mut dyn io::Write,
) -> io::Result<()> {
    let mut table = TableWriter::new(stream);
    table.row(HEADER)?;
    for (rank, pose) in (1..).zip(poses) {
        let of_plan = &plan.restraints;
        let restraints = of_plan.names.iter().zip(&of_plan.distances.list);
        for ((name, restraint), (distance, met)) in restraints.zip(distances(plan, pose)) {
            let [distance, lower, upper] = [distance, restraint.lower, restraint.upper].map(number);
            table.row([
                &rank.to_string(),
                name,
                &distance,
                &lower,
                &upper,
                &met.to_string(),
            ])?;
        }
    }
    table.flush()
}
