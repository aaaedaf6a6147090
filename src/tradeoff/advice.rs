//! Which setting to take, in words.

use serde::Serialize;

use super::settings::Knob;
use super::sweep::{FIRST, Measured, Tradeoff};

/// Rows of the reference that a setting may miss, over those that the best setting misses, and still be taken.
const SPARE: f64 = 0.05;

/// What to take, and what it gives up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Advice {
    /// The setting to take.
    pub take: String,
    /// Its options of `knotdock dock`.
    pub arguments: String,
    /// The same in words, with what it gives up, and what less and more time buy.
    pub text: String,
}

/// The advice of a sweep: the cheapest setting whose error is at most the tolerance of the default and that misses at most
/// 5 of the reference's first 100 rows more than whatever setting misses the fewest. `None` for a sweep without settings.
pub fn advice(tradeoff: &Tradeoff) -> Option<Advice> {
    let default = tradeoff.measured.first()?;
    let tolerance = default.setting.options.tolerance;
    let runs = || {
        let runs = tradeoff.measured.iter();
        runs.filter(|run| run.setting.knob != Knob::Reference)
    };
    let best = runs().map(|run| run.agreement).fold(0.0, f64::max);
    let serves = |run: &&Measured| {
        run.error.rms <= tolerance.max(default.error.rms) && run.agreement >= best - SPARE
    };
    let cheapest = |a: &&Measured, b: &&Measured| a.cost().total_cmp(&b.cost());
    let take = runs().filter(serves).min_by(cheapest).unwrap_or(default);
    let mut text = format!(
        "Take {}: {} of processor time ({} on the clock), an error of {:.1e} of the best score, and {:.0} of the {} rows that the reference \
         ranks first, with {} times the rotations, are within {:.2} of one of its first {FIRST}.",
        told(take),
        seconds(take.cost()),
        seconds(take.wall_seconds()),
        take.error.rms,
        100.0 * take.agreement,
        FIRST,
        rotations_ratio(tradeoff),
        tradeoff.radius,
    );
    if !take.same_score(&default.setting.options) {
        text += " It ranks by another score than the default's.";
    }
    if take.setting.knob == Knob::Default {
        text += " No cheaper setting does as well.";
    } else {
        text += &format!(
            " The default takes {} and has {:.1e} and {:.0}.",
            seconds(default.cost()),
            default.error.rms,
            100.0 * default.agreement
        );
    }
    // What a third of the time, or less, still gives.
    let quick = runs()
        .filter(|run| run.cost() <= 0.5 * take.cost())
        .max_by(|a, b| {
            a.agreement
                .total_cmp(&b.agreement)
                .then(b.cost().total_cmp(&a.cost()))
        });
    text += &match quick {
        Some(quick) => format!(
            " In half the time or less, {} ({}) gives up most of what it must: {:.0} rows remain, at an error of {:.1e}.",
            told(quick),
            seconds(quick.cost()),
            100.0 * quick.agreement,
            quick.error.rms
        ),
        None => " No setting takes half the time or less.".to_owned(),
    };
    let sharper = runs()
        .filter(|run| {
            run.same_score(&default.setting.options) && run.error.rms <= 0.5 * take.error.rms
        })
        .min_by(cheapest);
    if let Some(sharper) = sharper {
        text += &format!(
            " Where the error matters, {} ({}) brings it to {:.1e}.",
            told(sharper),
            seconds(sharper.cost()),
            sharper.error.rms
        );
    }
    let wider = runs()
        .filter(|run| run.cost() > take.cost() && run.agreement > take.agreement + 0.02)
        .min_by(cheapest);
    if let Some(wider) = wider {
        text += &format!(
            " Where time allows, {} ({}) finds {:.0} of the rows.",
            told(wider),
            seconds(wider.cost()),
            100.0 * wider.agreement
        );
    }
    Some(Advice {
        take: take.setting.name.clone(),
        arguments: take.setting.arguments.clone(),
        text,
    })
}

/// Rotations of the reference over the default's.
fn rotations_ratio(tradeoff: &Tradeoff) -> usize {
    let rotations = |knob: Knob| {
        let run = tradeoff
            .measured
            .iter()
            .find(|run| run.setting.knob == knob);
        run.map_or(1, |run| run.setting.options.rotations)
    };
    rotations(Knob::Reference) / rotations(Knob::Default).max(1)
}

/// A setting by its name, and its options where the name is not all of them.
fn told(run: &Measured) -> String {
    let setting = &run.setting;
    match setting.knob {
        Knob::Default => "the default".to_owned(),
        Knob::Combination => format!("{} ({})", setting.name, setting.arguments),
        _ => setting.arguments.clone(),
    }
}

fn seconds(seconds: f64) -> String {
    if seconds < 10.0 {
        format!("{seconds:.1} s")
    } else {
        format!("{seconds:.0} s")
    }
}
