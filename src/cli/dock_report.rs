//! What `knotdock dock` tells of a run: effects, errors, and what was assumed of the inputs.

use std::collections::BTreeMap;

use knotdock::output::report::counted;
use knotdock::search::{AssumedSite, DockOutcome, DockPlan, Effect, Loose};
use knotdock::tradeoff::choice::MIN_ROTATIONS;
use knotdock_structures::molecule::LabelReport;

/// Which effects were on and what they cost, and how far the fast path was off.
pub fn told(plan: &DockPlan, outcome: &DockOutcome) -> String {
    let effects = outcome
        .effects
        .iter()
        .map(|cost| match (cost.on, cost.effect) {
            (false, effect) => format!("Effect {effect}: off ({})", cost.reason),
            (true, Effect::Shape) => format!(
                "Effect shape ({}): rank {}, {:.2} ms a rotation",
                cost.reason, cost.rank, cost.milliseconds_per_rotation
            ),
            (true, effect) => format!(
                "Effect {effect} ({}): without it the rank is lower by {} and a rotation takes {:.2} ms less",
                cost.reason, cost.rank, cost.milliseconds_per_rotation.max(0.0)
            ),
        });
    let mut lines: Vec<String> = effects.collect();
    if let Some(site) = plan.active_site() {
        lines.push(site_told(site));
    }
    if let Some(adapter) = &outcome.adapter {
        lines.insert(
            0,
            format!(
                "Searched on {} ({}{}), {} rotations in flight; the times below are of one CPU thread",
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
        "All together: rank {}, {:.1e} of the best score lost by compression",
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
    let row = outcome.poses.first();
    let attracting = match plan.active_site() {
        Some(_) => "the active site",
        None => "attracted residues",
    };
    let terms = [
        ("fine contacts", row.and_then(|row| row.fine_contact)),
        ("atom pairs", row.and_then(|row| row.atom_pair)),
        ("atom pairs once relaxed", row.and_then(|row| row.relaxed)),
        (attracting, row.and_then(|row| row.attraction)),
        ("missing residues", row.and_then(|row| row.missing)),
        ("ends of chains", row.and_then(|row| row.chain_ends)),
    ];
    let terms = terms.iter().filter(|(_, value)| value.is_some());
    let names: Vec<&str> = terms.map(|(name, _)| *name).collect();
    let stage = outcome.timing.iter().find(|stage| stage.name == "rescore");
    if let (false, Some(stage)) = (names.is_empty(), stage) {
        lines.push(format!(
            "Rescored by {} in {:.2} s",
            listed(&names),
            stage.wall_seconds
        ));
    }
    let error = outcome.error;
    if error.worst.is_finite() {
        lines.push(format!(
            "Fast path against the exact sum, over {}: {:.1e} of the best score rms, {:.1e} at worst",
            counted(error.poses, "pose"),
            error.rms,
            error.worst
        ));
        lines.push(format!(
            "The low-pass moved their shape scores by {:.0}% of the best on average",
            100.0 * error.low_pass_share
        ));
    }
    lines.push(format!(
        "{} in {}",
        counted(outcome.poses_kept, "pose"),
        counted(outcome.clusters, "cluster")
    ));
    lines.join("\n")
}

/// What is wrong with a run's scores, if its fast path was farther from the exact sum than was asked for.
pub fn error_warning(plan: &DockPlan, outcome: &DockOutcome) -> Option<String> {
    let (worst, tolerance) = (outcome.error.worst, plan.options.tolerance);
    if !worst.is_finite() {
        return Some(format!(
            "the best pose scores nothing, so errors have no scale: nothing fits at a resolution of {} {unit} on a grid of {:.4} {unit}",
            plan.options.resolution,
            plan.spacing,
            unit = plan.unit
        ));
    }
    (worst > tolerance).then(|| {
        format!(
            "the fast path was off by {worst:.1e} of the best score at worst, more than the tolerance of {tolerance:e}: what is reported is exact, but \
             other poses may have been missed; use a lower --tolerance or a finer --spacing than {:.4}",
            plan.spacing
        )
    })
}

/// That a deadline left time for too few rotations.
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

/// That an active site is assumed, and what follows.
pub fn site_told(site: &AssumedSite) -> String {
    format!(
        "Active site: {site}; poses that touch it rank higher, --peptidase-weight 0 leaves that out"
    )
}

/// Names with commas between them, and the last after an "and".
fn listed(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [name] => (*name).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The chance that a ranking holds what is looked for, and what it rests on.
pub fn chance_told(chance: f64) -> String {
    format!(
        "Chance that one of the first ten clusters is acceptable: {:.0}%, as of known pairs docked like this",
        100.0 * chance
    )
}

/// What is loose of each side and costs poses something: residues that its file does not show, and those near ends.
pub fn loose_told(sides: &[&str], loose: &Loose) -> Vec<String> {
    let of = loose.missing_residues.iter().zip(&loose.chain_end_residues);
    let told = sides.iter().zip(of).map(|(side, (missing, near))| {
        let (mut parts, mut options) = (Vec::new(), Vec::new());
        if missing.gaps > 0 {
            parts.push(format!(
                "{} missing in {}",
                counted(missing.residues, "residue"),
                counted(missing.gaps, "gap")
            ));
        }
        if missing.ends > 0 {
            let ends = counted(missing.ends, "end");
            parts.push(format!("{ends} of chains that may go on"));
        }
        if !missing.segments.is_empty() {
            options.push("--unresolved-weight 0");
        } else if let Some(last) = parts.last_mut() {
            last.push_str(", which the rest leaves no room");
        }
        if near.residues > 0 {
            let residues = counted(near.residues, "residue");
            parts.push(format!("{residues} near ends of chains or gaps"));
            options.push("--termini-weight 0");
        }
        let leave = if options.len() > 1 { "leave" } else { "leaves" };
        let pay = match options.join(" and ") {
            none if none.is_empty() => none,
            all => format!("; poses pay for atoms that lie or touch there, {all} {leave} that out"),
        };
        (!parts.is_empty()).then(|| format!("The {side}: {}{pay}", parts.join(", ")))
    });
    told.flatten().collect()
}

/// How many Cys and His are charged as what binds a metal, behind other words.
pub fn metal_bound(labels: &LabelReport) -> String {
    match labels.metal_bound {
        0 => String::new(),
        bound => format!(", {bound} Cys and His charged as bound to a metal"),
    }
}

/// What was assumed of one side's charges and contact types, where effects use them.
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
            plan.options.ph,
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
