//! Reports of `knotdock dock`: effects, errors, and assumptions on the inputs.

use std::collections::BTreeMap;

use crate::tables::report::counted;
use crate::tradeoff::choice::MIN_ROTATIONS;
use knotdock::dock::outcome::{DockOutcome, EffectCost};
use knotdock::dock::plan::DockPlan;
use knotdock::output::tables::restraints::most_met;
use knotdock::priors::active_residues::AssumedSite;
use knotdock::priors::flexible_regions::FlexibleRegions;
use knotdock::priors::restrained::Restrained;
use knotdock::rank::ranking::RankedPose;
use knotdock::rank::sharp::SharpFinding;
use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::terms::pose::Membrane;
use knotdock_structures::molecule::LabelReport;

/// The effects that were on with their costs, and the error of the fast path.
pub fn outcome_text(plan: &DockPlan, outcome: &DockOutcome) -> String {
    let mut lines: Vec<String> = outcome.effects.iter().map(effect_text).collect();
    if let Some(site) = plan.active_site() {
        lines.push(site_text(site));
    }
    let restraints = &plan.restraints.distances;
    if !restraints.list.is_empty() {
        lines.push(format!(
            "{}, of which a pose has to satisfy {}: only such poses were searched",
            counted(restraints.list.len(), "distance restraint"),
            restraints.needed
        ));
    }
    if let Some(adapter) = &outcome.adapter {
        lines.insert(
            0,
            format!(
                "Searched on {} ({}{}), {} rotations in flight; the times below are on the clock",
                adapter.name,
                adapter.backend,
                if adapter.software {
                    ", a program that plays a graphics processor"
                } else {
                    ""
                },
                adapter.rotations_in_flight
            ),
        );
    }
    lines.push(format!(
        "All together: {} compressed functions, {:.1e} of the best score lost by compression",
        outcome.rank, outcome.rank_error
    ));
    if let Some(stopped) = outcome.stopped {
        lines.push(format!(
            "Stopped for the deadline: searched {} of {} rotations, evenly spread over all orientations, and kept the best {}",
            stopped.rotations,
            plan.rotations,
            counted(stopped.poses, "pose")
        ));
    }
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
        counted(outcome.clusters, "cluster")
    ));
    lines.join("\n")
}

/// The cost of an effect.
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
    let names: Vec<&str> = outcome.poses.first().map_or(Vec::new(), |row| {
        let acting = row.pose_terms.iter().filter(|(_, value)| value.is_some());
        acting.map(|(term, _)| term.label).collect()
    });
    let stage = outcome.timing.iter().find(|stage| stage.name == "rescore");
    let stage = stage.filter(|_| !names.is_empty())?;
    Some(format!(
        "Rescored by {} in {:.2} s",
        joined(&names),
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

/// Warning that a deadline left time for too few rotations.
pub fn few_rotations_warning(outcome: &DockOutcome, has_deadline: bool) -> Option<String> {
    let few = has_deadline && outcome.searched < MIN_ROTATIONS;
    few.then(|| {
        format!(
            "the budget left time for {} only, and fewer than {MIN_ROTATIONS} find little: allow more time, or leave \
             more of the machine to the run",
            counted(outcome.searched, "rotation")
        )
    })
}

/// Remark that an active site is assumed, and what follows.
pub fn site_text(site: &AssumedSite) -> String {
    format!(
        "Active site: {site}; poses that touch it rank higher, --config restraints.peptidase_weight=0 leaves that out"
    )
}

/// Names joined by commas, the last by "and".
fn joined(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [name] => (*name).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
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
        lines.extend(within_text(known));
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

/// Restraints that are left out, since docking does not change them.
fn within_text(known: &Restrained) -> Option<String> {
    let within = known.within_one_molecule;
    let all = within + known.distances.list.len();
    let is = if within == 1 { "is" } else { "are" };
    (within > 0).then(|| {
        format!(
            "{within} of {all} restraints {is} within one molecule, which docking does not change"
        )
    })
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
            match unresolved.ends {
                0 => {}
                1 => parts.push("1 terminus past which residues may be unresolved".to_owned()),
                ends => parts.push(format!(
                    "{ends} termini past which residues may be unresolved"
                )),
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

/// Charges and contact types assumed of one side, if effects use them.
pub fn assumed(side: &str, labels: &LabelReport, plan: &DockPlan) -> Option<String> {
    let names = |unknown: &BTreeMap<String, usize>| {
        let names = unknown
            .iter()
            .map(|(name, count)| format!("{count} {name}"));
        names.collect::<Vec<_>>().join(", ")
    };
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
            parts.push(format!(
                "no charges known for {}",
                names(&labels.unknown_charges)
            ));
        }
    }
    if plan.is_on(Effect::Contact) && !labels.unknown_types.is_empty() {
        parts.push(format!(
            "no contact types for {}",
            names(&labels.unknown_types)
        ));
    }
    (!parts.is_empty()).then(|| format!("The {side}: {}", parts.join("; ")))
}
