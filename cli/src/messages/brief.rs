//! Messages of `knotdock dock` without `--verbose`: the score and its reasons, the expected cost, the cost, and next
//! steps.

use std::path::Path;

use crate::shell_word::shell_word;
use crate::tables::report::counted;
use knotdock::dock::outcome::DockOutcome;
use knotdock::dock::plan::DockPlan;
use knotdock::options::EngineChoice;
use knotdock::options::values::{angle_of_rotations, rotations_of_angle};
use knotdock::output::files::seal::REPORT;
use knotdock::output::records::manifest::Chosen;
use knotdock::rank::sharp::{SharpFinding, SharpPose};
use knotdock::table_text::named_columns::listed;
use knotdock_scoring::terms::effect::Effect;
use knotdock_structures::molecule::LabelReport;

use crate::messages::dock::{known_text, milliseconds_text};

/// The effects that score and why, and what is known of the complex. Of the effects that do not score those that the
/// inputs call for and lack something.
pub fn score_text(plan: &DockPlan, sides: &[&str]) -> String {
    let words = |on: bool| -> Vec<String> {
        let decided = plan.decisions.iter().filter(|decision| decision.on == on);
        // Nothing is known of most complexes.
        let decided = decided.filter(|decision| on || decision.effect != Effect::Restraint);
        decided
            .map(|decision| match (decision.on, decision.effect) {
                (true, Effect::Shape) => "shape".to_owned(),
                (_, effect) => format!("{effect} ({})", decision.reason),
            })
            .collect()
    };
    let mut text = format!("Scored by {}", words(true).join(", "));
    if let Some(site) = plan.active_site() {
        text += &format!(", active site ({site})");
    }
    let off = words(false);
    if !off.is_empty() {
        text += &format!("; not by {}", off.join(", "));
    }
    let known = known_text(sides, &plan.restraints);
    if !known.is_empty() {
        text += &format!("; known: {}", known.join(", "));
    }
    let unknown: Vec<String> = plan.labels.iter().filter_map(unknown_text).collect();
    if !unknown.is_empty() {
        text += &format!(
            "; no charges or contact types are known for {}",
            unknown.join(", ")
        );
    }
    text
}

/// Residues of one side whose charges or contact types are not known.
fn unknown_text(labels: &LabelReport) -> Option<String> {
    let names = labels
        .unknown_charges
        .keys()
        .chain(labels.unknown_types.keys());
    let mut names: Vec<&str> = names.map(String::as_str).collect();
    names.sort_unstable();
    names.dedup();
    (!names.is_empty()).then(|| names.join(", "))
}

/// Largest angle between rotations that anybody searches by, degrees.
const LARGEST_ANGLE: usize = 30;

/// How many rotations are searched, and the time and memory that the search is expected to take.
///
/// A number of rotations that may be meant as an angle is answered with that angle's, unless it `is_angle`.
pub fn expected_text(plan: &DockPlan, chosen: Option<&Chosen>, is_angle: bool) -> String {
    let rotations = plan.search.space.sampled(plan.rotations);
    let mut text = format!("Searches {} {rotations}", plan.rotations);
    if plan.options.search.symmetry.is_none() {
        let angle = angle_of_rotations(plan.rotations);
        if angle <= 180.0 {
            text += &format!(", about {angle:.0} degrees apart");
        }
        let may_be_meant = !is_angle && plan.rotations <= LARGEST_ANGLE;
        let meant = rotations_of_angle(plan.rotations as f64).filter(|_| may_be_meant);
        if let Some(count) = meant {
            text += &format!(" (--rotations {}deg would be {count})", plan.rotations);
        }
    }
    if let Some(finer) = plan.options.search.fine_rotations {
        text += &format!(", then {finer} finer ones about the best");
    }
    let memory = plan.memory_bytes() as f64 / 1e6;
    text += &match plan.options.search.engine {
        EngineChoice::Gpu => format!(" on a graphics processor, in {memory:.0} MB"),
        EngineChoice::Cpu => format!(
            ": about {} of search and {memory:.0} MB on {}",
            time_text(plan.search_seconds(plan.rotations)),
            counted(plan.in_flight(), "thread")
        ),
    };
    if let Some(chosen) = chosen {
        let options = &plan.options;
        text += &format!(
            "; chosen: --tolerance {} and a spacing of {:.4}",
            options.kernel.tolerance, plan.spacing
        );
        if let Some(error) = chosen.predicted_error {
            text += &format!(", for an error of {error:.1e}");
        }
        if let Some(seconds) = chosen.budget_seconds {
            text += &format!("; ends within {}", time_text(seconds));
        }
    }
    text
}

/// A share as people say it.
fn share_text(share: f64) -> String {
    match 100.0 * share {
        percent if percent >= 0.1 => format!("{percent:.1}%"),
        percent if percent >= 0.001 => format!("{percent:.3}%"),
        percent => format!("{percent:.0e}%"),
    }
}

/// A time as people say it.
pub fn time_text(seconds: f64) -> String {
    match seconds {
        s if s < 10.0 => format!("{s:.1} s"),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// The cost of a finished run of `seconds`, the error of the fast path, and what else decided the ranking.
pub fn cost_text(plan: &DockPlan, outcome: &DockOutcome, seconds: f64) -> String {
    let costs = || outcome.effects.iter().filter(|cost| cost.on);
    let rotation = costs().map(|cost| cost.milliseconds_per_rotation).sum();
    let parts = costs().map(|cost| {
        let time = milliseconds_text(cost.milliseconds_per_rotation);
        format!("{} {time}", cost.effect)
    });
    let parts: Vec<String> = parts.collect();
    let mut lines = vec![match parts.len() {
        0 | 1 => format!(
            "Took {seconds:.1} s; a rotation takes {}",
            milliseconds_text(rotation)
        ),
        _ => format!(
            "Took {seconds:.1} s; a rotation takes {} ({})",
            milliseconds_text(rotation),
            parts.join(", ")
        ),
    }];
    if let Some(adapter) = &outcome.adapter {
        lines.push(format!("Searched on {}", adapter.name));
    }
    if outcome.error.worst.is_finite() {
        lines.push(format!(
            "Accuracy: scores of the search are within {} of the exact ones, of the best score ({} checked; tolerance {})",
            share_text(outcome.error.worst),
            counted(outcome.error.poses, "pose"),
            share_text(plan.options.kernel.tolerance)
        ));
    }
    if let Some(stopped) = outcome.stopped {
        lines.push(format!(
            "Stopped at the time limit: searched {} of {} rotations",
            stopped.rotations, plan.rotations
        ));
    }
    match outcome.sharp.as_ref().map(|sharp| sharp.finding) {
        Some(SharpFinding::ExactFit) => lines.extend(rewarded_text(outcome)),
        Some(SharpFinding::Requested) => {
            lines.push("Ranked by fits at atomic resolution, though none stands out".to_owned());
        }
        Some(SharpFinding::NoExactFit) | None => {}
    }
    lines.join("\n")
}

/// The ranks of the rows that earn score for a fit that stands out; `None` if there are none.
fn rewarded_text(outcome: &DockOutcome) -> Option<String> {
    let rows = outcome.poses.iter().enumerate();
    let rewarded = rows.filter(|(_, row)| row.sharp.is_some_and(SharpPose::is_rewarded));
    let ranks: Vec<String> = rewarded.map(|(row, _)| (row + 1).to_string()).collect();
    let subject = match ranks.len() {
        0 => return None,
        1 => "Rank",
        _ => "Ranks",
    };
    let earn = if ranks.len() == 1 { "earns" } else { "earn" };
    Some(format!(
        "{subject} {} {earn} score for a fit at atomic resolution that stands out (--sharp off ranks without it)",
        listed(ranks.iter().map(String::as_str))
    ))
}

/// Where the results are, and what can be done with them.
pub fn next_text(
    directory: &Path,
    outcome: &DockOutcome,
    written: usize,
    has_report: bool,
) -> String {
    let directory = directory.display().to_string();
    let rows = outcome.poses.len();
    let listed = match rows == outcome.clusters {
        true => counted(rows, "cluster"),
        false => counted(rows, "pose"),
    };
    let mut steps = Vec::new();
    if has_report {
        steps.push((
            format!("open {}", shell_word(&format!("{directory}/{REPORT}"))),
            "look at them in a browser".to_owned(),
        ));
    }
    if written < rows {
        let ranks = match (written + 1, rows.min(written + 10)) {
            (first, last) if first == last => first.to_string(),
            (first, last) => format!("{first}-{last}"),
        };
        steps.push((
            format!("knotdock export {} --rank {ranks}", shell_word(&directory)),
            format!("more complexes than the {written} in {directory}/top"),
        ));
    }
    let widest = steps
        .iter()
        .map(|(command, _)| command.chars().count())
        .max();
    let steps = steps.iter().map(|(command, what)| {
        format!("\n  {command:<width$}  {what}", width = widest.unwrap_or(0))
    });
    format!(
        "{listed} in {directory}/poses.csv{}",
        steps.collect::<String>()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_and_times_are_short() {
        for (share, text) in [
            (0.012, "1.2%"),
            (3e-3, "0.3%"),
            (2e-4, "0.020%"),
            (1e-6, "1e-4%"),
        ] {
            assert_eq!(share_text(share), text);
        }
        for (seconds, text) in [
            (3.21, "3.2 s"),
            (75.0, "75 s"),
            (600.0, "10 min"),
            (9000.0, "2.5 h"),
        ] {
            assert_eq!(time_text(seconds), text);
        }
    }
}
