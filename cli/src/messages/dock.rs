//! Reports of `knotdock dock`: effects, errors, and assumptions on the inputs.

use std::collections::BTreeMap;
use std::path::Path;

use crate::messages::shown::shell_word;
use crate::tables::report::{counted, text_table};
use knotdock::dock::gaps::DockedAtGap;
use knotdock::dock::outcome::{DockOutcome, EffectCost};
use knotdock::dock::plan::DockPlan;
use knotdock::options::EngineChoice;
use knotdock::options::values::{angle_of_rotations, rotations_of_angle};
use knotdock::output::files::seal::REPORT;
use knotdock::output::records::manifest::Chosen;
use knotdock::output::tables::restraints::most_met;
use knotdock::priors::active_residues::AssumedSite;
use knotdock::priors::flexible_regions::FlexibleRegions;
use knotdock::priors::restrained::Restrained;
use knotdock::rank::ranking::RankedPose;
use knotdock::rank::sharp::{SharpFinding, SharpPose};
use knotdock::redock::{Agreement, FIRST_CLUSTERS, OtherPose, Redocking, RelaxedPose};
use knotdock::table_text::named_columns::listed;
use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::terms::pose::Membrane;
use knotdock_structures::mesh::Figure;
use knotdock_structures::molecule::LabelReport;

/// The effects that were on with their costs, and the error of the fast path.
pub fn outcome_text(outcome: &DockOutcome) -> String {
    let mut lines: Vec<String> = outcome.effects.iter().map(effect_text).collect();
    if let Some(adapter) = &outcome.adapter {
        let software = match adapter.software {
            true => ", a program that plays a graphics processor",
            false => "",
        };
        let text = format!(
            "Searched on {} ({}{software}), {} rotations in flight; the times below are on the clock",
            adapter.name, adapter.backend, adapter.rotations_in_flight
        );
        lines.insert(0, text);
    }
    lines.push(format!(
        "All together: {} compressed functions, {:.1e} of the best score lost by compression",
        outcome.rank, outcome.rank_error
    ));
    if let Some(fine) = outcome.fine {
        lines.push(format!(
            "Searched {} finer rotations, those nearest to the best {} rotations",
            fine.rotations, fine.cells
        ));
    }
    lines.extend(rescored_text(outcome));
    lines.extend(sharp_text(outcome));
    lines.extend(error_text(outcome));
    lines.push(format!(
        "{} in {}",
        counted(outcome.poses_kept, "pose"),
        counted(outcome.clusters.len(), "cluster")
    ));
    lines.join("\n")
}

fn effect_text(cost: &EffectCost) -> String {
    match (cost.on, cost.effect) {
        (false, effect) => format!("Effect {effect}: off ({})", cost.reason),
        (true, effect) => format!(
            "Effect {effect} ({}): {:.1} of the compressed functions, {} of a rotation",
            cost.reason,
            cost.functions,
            milliseconds_text(cost.milliseconds_per_rotation)
        ),
    }
}

/// A time in milliseconds as people say it, to two digits.
pub fn milliseconds_text(milliseconds: f64) -> String {
    match milliseconds {
        ms if ms >= 9.95 => format!("{ms:.0} ms"),
        ms if ms >= 0.995 => format!("{ms:.1} ms"),
        ms if ms >= 0.0995 => format!("{ms:.2} ms"),
        ms => format!("{:.0} µs", 1e3 * ms),
    }
}

/// The pose terms that rescored, and their time.
fn rescored_text(outcome: &DockOutcome) -> Option<String> {
    let terms = outcome.poses.first()?.pose_terms.iter();
    let acting = terms.filter(|(_, value)| value.is_some());
    let labels: Vec<&str> = acting.map(|(term, _)| term.label).collect();
    let mut stages = outcome.timing.iter();
    let stage = stages.find(|stage| stage.name == "rescore" && !labels.is_empty())?;
    Some(format!(
        "Rescored by {} in {:.2} s",
        labels.join(", "),
        stage.wall_seconds
    ))
}

/// The finding of the sharp stage, and its time.
fn sharp_text(outcome: &DockOutcome) -> Option<String> {
    let sharp = outcome.sharp.as_ref()?;
    let stage = outcome.timing.iter().find(|stage| stage.name == "sharp")?;
    let finding = match sharp.finding {
        SharpFinding::ExactFit => "an exact fit stands out: ranked by it",
        SharpFinding::Requested => "no exact fit stands out; ranked by sharp fits, as requested",
        SharpFinding::NoExactFit => "no exact fit; ranked by the soft score",
    };
    let margin = sharp.evidence.map(|evidence| {
        let (margin, needed) = (evidence.margin(), evidence.needed);
        format!(" (margin {margin:.1} standard deviations, {needed:.1} needed)")
    });
    Some(format!(
        "Sharp fits of {} in {:.2} s: {finding}{}",
        counted(sharp.poses, "pose"),
        stage.wall_seconds,
        margin.unwrap_or_default()
    ))
}

/// The error of the fast path; no lines where errors have no scale.
fn error_text(outcome: &DockOutcome) -> Vec<String> {
    let error = outcome.error;
    if !error.worst.is_finite() {
        return Vec::new();
    }
    vec![
        format!(
            "Fast path against the exact sum, over {}: {:.1e} of the best score rms, {:.1e} at worst",
            counted(error.poses, "pose"),
            error.rms,
            error.worst
        ),
        format!(
            "The low-pass moved their shape scores by {:.0}% of the best on average",
            100.0 * error.low_pass_share
        ),
    ]
}

/// Warning that the fast path was farther from the exact sum than the tolerance, or is on a grid that is too coarse.
pub fn error_warning(plan: &DockPlan, outcome: &DockOutcome) -> Option<String> {
    let (worst, tolerance) = (outcome.error.worst, plan.options.kernel.tolerance);
    if !worst.is_finite() {
        return Some(format!(
            "the best pose scores nothing, so errors have no scale: nothing fits at a resolution of {} {unit} on a grid of {:.4} {unit}",
            plan.options.kernel.resolution,
            plan.spacing,
            unit = plan.unit
        ));
    }
    let half = 0.5 * plan.options.kernel.resolution;
    if plan.spacing > half * (1.0 + 1e-9) {
        return Some(format!(
            "a grid spacing of {:.4} is above half of the resolution: the fast path was off by {worst:.1e} of the best \
             score at worst. What is reported is exact, but other poses may have been missed; use --spacing {half} or \
             less, or leave it out",
            plan.spacing
        ));
    }
    (worst > tolerance).then(|| {
        format!(
            "the fast path was off by {worst:.1e} of the best score at worst, more than the tolerance of \
             {tolerance:e}: what is reported is exact, but \
             other poses may have been missed; use a lower --tolerance or a finer --spacing than {:.4}",
            plan.spacing
        )
    })
}

/// Warning that no pose satisfies as many restraints as are needed.
pub fn restraints_warning(plan: &DockPlan, poses: &[RankedPose]) -> Option<String> {
    let known = &plan.restraints.distances;
    let (most, count) = (most_met(plan, poses)?, known.list.len());
    (most < known.needed).then(|| {
        let needed = match known.needed {
            needed if needed == count => format!("all {count}"),
            needed => format!("{needed} of the {count}"),
        };
        format!(
            "no pose satisfies {needed} restraints, at most {most}: they may contradict each other; restraints.csv has \
             the distances, and --restraints-need allows for false ones"
        )
    })
}

/// Remark that an active site is assumed, and its effect.
pub fn site_text(site: &AssumedSite) -> String {
    format!(
        "Active site: {site}; poses that touch it rank higher, --config restraints.peptidase_weight=0 leaves that out"
    )
}

/// Given knowledge of the complex: restraints, predictions and a membrane.
pub fn known_text(sides: &[&str], known: &Restrained) -> Vec<String> {
    let mut lines = Vec::new();
    if !known.is_empty() {
        let restraints = &known.distances;
        lines.push(match (restraints.needed, restraints.list.len()) {
            (needed, count) if needed == count => {
                format!("{} to satisfy", counted(count, "distance restraint"))
            }
            (needed, count) => format!("{needed} of {count} distance restraints to satisfy"),
        });
        if let Some([least, most]) = known.widened {
            let by = match (format!("{least:.1}"), format!("{most:.1}")) {
                (least, most) if least == most => least,
                (least, most) => format!("{least} to {most}"),
            };
            lines.push(format!(
                "upper bounds widened by {by} Å for hydrogens, which the .tbl counts (--tbl-bounds written leaves that \
                 out)"
            ));
        }
        let within = known.within_one_molecule;
        if within > 0 {
            let all = within + restraints.list.len();
            let is = if within == 1 { "is" } else { "are" };
            lines.push(format!(
                "{within} of {all} restraints {is} within one molecule, which docking does not change"
            ));
        }
    }
    for (side, residues) in sides.iter().zip(&known.predicted) {
        if !residues.is_empty() {
            let residues = counted(residues.len(), "residue");
            lines.push(format!("interface predictions of {residues} of the {side}"));
        }
    }
    if let Some(Membrane { side, low, high }) = &known.membrane
        && let (Some(own), Some(other)) = (sides.get(*side), sides.get(1 - *side))
    {
        lines.push(format!(
            "a membrane from z = {low} to {high} Å in the file of the {own}, which the {other} stays out of"
        ));
    }
    lines
}

/// A number of termini.
pub fn termini_text(count: usize) -> String {
    match count {
        1 => "1 terminus".to_owned(),
        _ => format!("{count} termini"),
    }
}

/// Flexible regions of each side that cost poses score: unresolved segments and residues near termini.
pub fn regions_text(sides: &[&str], regions: &FlexibleRegions) -> Vec<String> {
    let regions = regions.unresolved.iter().zip(&regions.termini);
    let lines = sides
        .iter()
        .zip(regions)
        .map(|(side, (unresolved, termini))| {
            let (mut parts, mut options) = (Vec::new(), Vec::new());
            if unresolved.gaps > 0 {
                parts.push(format!(
                    "{} unresolved in {}",
                    counted(unresolved.residues, "residue"),
                    counted(unresolved.gaps, "gap")
                ));
            }
            if unresolved.ends > 0 {
                let ends = termini_text(unresolved.ends);
                parts.push(format!("{ends} past which residues may be unresolved"));
            }
            if !unresolved.segments.is_empty() {
                options.push("--config terms.unresolved_weight=0");
            } else if let Some(last) = parts.last_mut() {
                last.push_str(", for which the body leaves no room");
            }
            if termini.residues > 0 {
                let residues = counted(termini.residues, "residue");
                parts.push(format!("{residues} near termini or gaps"));
                options.push("--config terms.termini_weight=0");
            }
            let leave = if options.len() > 1 { "leave" } else { "leaves" };
            let cost = match options.join(" and ") {
                none if none.is_empty() => none,
                all => format!("; contacts and clashes there cost score, {all} {leave} that out"),
            };
            (!parts.is_empty()).then(|| format!("The {side}: {}{cost}", parts.join(", ")))
        });
    lines.flatten().collect()
}

/// Number of Cys and His charged as bound to a metal, to follow other words; empty if none is.
pub fn metal_bound(labels: &LabelReport) -> String {
    match labels.metal_bound {
        0 => String::new(),
        bound => format!(", {bound} Cys and His charged as bound to a metal"),
    }
}

/// Names with their numbers: `2 HEM, 1 ZN`.
pub fn counted_names(names: &BTreeMap<String, usize>) -> String {
    let names = names.iter().map(|(name, count)| format!("{count} {name}"));
    names.collect::<Vec<_>>().join(", ")
}

/// Charges and contact types assumed of one side, if effects use them.
pub fn assumed(side: &str, labels: &LabelReport, plan: &DockPlan) -> Option<String> {
    let mut parts = Vec::new();
    if plan.is_on(Effect::Electrostatics) {
        let [amino, carboxyl] = labels.termini;
        parts.push(format!(
            "net charge {:+} e at pH {}, {amino} amino and {carboxyl} carboxyl ends charged, {} capped{}",
            labels.net_charge,
            plan.options.terms.ph,
            counted(labels.gaps, "gap"),
            metal_bound(labels)
        ));
        if !labels.unknown_charges.is_empty() {
            let names = counted_names(&labels.unknown_charges);
            parts.push(format!("no charges known for {names}"));
        }
    }
    if plan.is_on(Effect::Contact) && !labels.unknown_types.is_empty() {
        let names = counted_names(&labels.unknown_types);
        parts.push(format!("no contact types for {names}"));
    }
    (!parts.is_empty()).then(|| format!("The {side}: {}", parts.join("; ")))
}

/// A line a stage, with its time on the clock and of all processors, and a line an effect, with its part of a rotation.
pub fn timings_text(outcome: &DockOutcome) -> String {
    let stages = outcome.timing.iter().map(|stage| {
        let cpu = stage.cpu_seconds;
        vec![
            stage.name.to_owned(),
            format!("{:.3}", stage.wall_seconds),
            cpu.map_or_else(|| "-".to_owned(), |seconds| format!("{seconds:.3}")),
        ]
    });
    let effects = outcome.effects.iter().map(|cost| {
        vec![
            cost.effect.to_string(),
            format!("{:.1}", cost.functions),
            format!("{:.3}", cost.milliseconds_per_rotation),
        ]
    });
    let stages = text_table("stage|wall s|CPU s", stages);
    let effects = text_table("effect|functions|ms a rotation", effects);
    format!("{stages}\n\n{effects}")
}

/// Effects that score, with reasons, and knowledge of the complex; of other effects those that lack something.
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
        EngineChoice::Cpu | EngineChoice::Auto => format!(
            ": about {} of search and {memory:.0} MB on {}",
            time_text(plan.search_seconds(plan.rotations).max(0.1)),
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

/// That a closer gap between meshes is searched, too.
pub fn closer_gap_text(offset: f64) -> String {
    format!(
        "Searches a gap of {} too, and keeps the one at which more of the surfaces face each other; --offset fixes the gap",
        Figure(offset)
    )
}

/// Facing areas at the gaps that were searched.
pub fn gaps_text(docked: &DockedAtGap) -> String {
    let [wide, closer] = docked.gaps;
    format!(
        "Facing area {} at a gap of {}, {} at {}: keeps the {} gap",
        Figure(wide.facing_area),
        Figure(wide.offset),
        Figure(closer.facing_area),
        Figure(closer.offset),
        if docked.gap == 0 { "wider" } else { "closer" }
    )
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

/// The cost of a finished run of `seconds`, the error of the fast path, and the other facts that decided the ranking.
pub fn cost_text(plan: &DockPlan, outcome: &DockOutcome, seconds: f64) -> String {
    let costs = || outcome.effects.iter().filter(|cost| cost.on);
    let rotation = costs().map(|cost| cost.milliseconds_per_rotation).sum();
    let parts = costs().map(|cost| {
        let time = milliseconds_text(cost.milliseconds_per_rotation);
        format!("{} {time}", cost.effect)
    });
    let parts: Vec<String> = parts.collect();
    let rotation = milliseconds_text(rotation);
    let mut lines = vec![match parts.len() {
        0 | 1 => format!("Took {seconds:.1} s; a rotation takes {rotation}"),
        _ => format!(
            "Took {seconds:.1} s; a rotation takes {rotation} ({})",
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
            "Stopped at the time limit: searched {} of {} rotations, and kept the best {}",
            stopped.rotations,
            plan.rotations,
            counted(stopped.poses, "pose")
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
    let (subject, earn) = match ranks.len() {
        0 => return None,
        1 => ("Rank", "earns"),
        _ => ("Ranks", "earn"),
    };
    Some(format!(
        "{subject} {} {earn} score for a fit at atomic resolution that stands out (--sharp off ranks without it)",
        listed(ranks.iter().map(String::as_str))
    ))
}

/// Whether docking agrees with a predicted complex, and how its pose scores.
pub fn redocking_text(found: &Redocking) -> String {
    let near = found.near.map(|near| {
        format!(
            "rank {} is the first pose near it (DockQ {:.2}, ligand RMSD {:.1} Å)",
            near.rank, near.dockq, near.lrmsd
        )
    });
    let near = near
        .as_deref()
        .unwrap_or("no pose of the search is near it");
    let verdict = match found.agreement {
        Agreement::Agrees => "Docking agrees with the predicted pose",
        Agreement::FoundLower => "Docking finds the predicted pose lower",
        Agreement::DoesNotAgree => "Docking does not agree with the predicted pose",
    };
    let RelaxedPose {
        rmsd_moved,
        pose_score,
        ..
    } = found.relaxed;
    let others = match found.best_elsewhere {
        None => format!("all of the first {FIRST_CLUSTERS} clusters are near it"),
        Some(OtherPose { rank, pose_score }) => format!(
            "relaxed in the same way, the best of the first {FIRST_CLUSTERS} clusters elsewhere (rank {rank}) scores \
             {pose_score:.0}, and {} of them score above the predicted pose",
            found.clusters_above
        ),
    };
    format!(
        "{verdict}: {near}\nRelaxed by {rmsd_moved:.1} Å, the predicted pose scores {pose_score:.0}; {others}"
    )
}

/// Places of the results, and next steps.
pub fn next_text(
    directory: &Path,
    outcome: &DockOutcome,
    written: usize,
    has_report: bool,
) -> String {
    let directory = directory.display().to_string();
    let rows = outcome.poses.len();
    let listed = counted(
        rows,
        if rows == outcome.clusters.len() {
            "cluster"
        } else {
            "pose"
        },
    );
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
    let widths = steps.iter().map(|(command, _)| command.chars().count());
    let width = widths.max().unwrap_or(0);
    let steps = steps
        .iter()
        .map(|(command, what)| format!("\n  {command:<width$}  {what}"));
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
