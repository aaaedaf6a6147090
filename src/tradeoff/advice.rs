//! Which setting to take, in words.

use serde::Serialize;

use super::measured::{FIRST, Measured, Tradeoff};
use super::settings::Knob;

/// Share of the reference's rows that a doubling of the time must find for it to be worth its price.
const DOUBLING: f64 = 0.1;

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

/// The advice of a sweep: among settings whose error is within the default's tolerance the one that finds most of the reference's rows, where
/// a doubling of the time must be worth a tenth of them. `None` for a sweep without settings.
pub fn advice(tradeoff: &Tradeoff) -> Option<Advice> {
    let default = tradeoff.measured.first()?;
    let tolerance = default.setting.options.tolerance;
    let runs = || {
        let runs = tradeoff.measured.iter();
        runs.filter(|run| run.setting.knob != Knob::Reference)
    };
    let serves = |run: &&Measured| run.error.rms <= tolerance.max(default.error.rms);
    let worth = |run: &Measured| run.agreement - DOUBLING * run.cost().max(1e-6).log2();
    let cheapest = |a: &&Measured, b: &&Measured| a.cost().total_cmp(&b.cost());
    let take = runs()
        .filter(serves)
        .max_by(|a, b| worth(a).total_cmp(&worth(b)))
        .unwrap_or(default);
    let share = |run: &Measured| format!("{:.0}%", 100.0 * run.agreement);
    let mut text = format!(
        "Take {}: {} of processor time ({} on the clock), an error of {:.1e} of the best score, and {} of the first {FIRST} rows of the \
         reference, which has {} times the rotations of the default, within {:.3} of one of its own.",
        told(take),
        seconds(take.cost()),
        seconds(take.wall_seconds()),
        take.error.rms,
        share(take),
        rotations_ratio(tradeoff),
        tradeoff.radius,
    );
    if !take.same_score(&default.setting.options) {
        text += " It ranks by another score than the default's.";
    }
    if take.setting.knob != Knob::Default {
        text += &format!(
            " The default takes {} and has {:.1e} and {}.",
            seconds(default.cost()),
            default.error.rms,
            share(default)
        );
    }
    let quick = runs()
        .filter(|run| run.cost() <= 0.5 * take.cost())
        .max_by(|a, b| {
            a.agreement
                .total_cmp(&b.agreement)
                .then(b.cost().total_cmp(&a.cost()))
        });
    text += &match quick {
        Some(quick) => format!(
            " In half the time or less, {} ({}) finds {}, at an error of {:.1e}.",
            told(quick),
            seconds(quick.cost()),
            share(quick),
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
            " Where time allows, {} ({}) finds {}.",
            told(wider),
            seconds(wider.cost()),
            share(wider)
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
    if seconds < 0.1 {
        format!("{:.0} ms", 1e3 * seconds)
    } else if seconds < 10.0 {
        format!("{seconds:.1} s")
    } else {
        format!("{seconds:.0} s")
    }
}
