//! Advice on which setting to take.

use serde::Serialize;

use crate::tradeoff::measured::{FIRST, Measured, Tradeoff};
use crate::tradeoff::settings::Parameter;

/// Share of the reference's rows that a doubling of the time must find for it to be worth its price.
const DOUBLING: f64 = 0.1;

/// Share of the reference's rows that a setting may find fewer of than the default and still keep the answer.
const KEEPS: f64 = 0.05;

/// Recommended setting, and what it gives up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Advice {
    /// The setting to take.
    pub take: String,
    /// Its options of `knotdock dock`.
    pub arguments: String,
    /// The same in words, with what it gives up, and what less and more time buy.
    pub text: String,
}

/// Share of the reference's rows that a setting finds.
fn share(run: &Measured) -> String {
    format!("{:.0}%", 100.0 * run.agreement)
}

/// What half the time buys: `quick` is the best setting that takes no more.
fn quick_text(quick: Option<&Measured>, keeps: impl Fn(&&Measured) -> bool) -> String {
    match quick {
        Some(quick) if keeps(&quick) => format!(
            " In half the time or less, {} ({}) finds {}, at an error of {:.1e}.",
            setting_text(quick),
            seconds(quick.cost()),
            share(quick),
            quick.error.rms
        ),
        Some(quick) => format!(
            " No setting that takes half the time or less keeps the answer: the best, {} ({}), finds {}.",
            setting_text(quick),
            seconds(quick.cost()),
            share(quick)
        ),
        None => " No setting takes half the time or less.".to_owned(),
    }
}

/// The advice of a sweep; `None` for a sweep without settings.
///
/// Among settings whose error is within the default's tolerance it is the one that finds most of the reference's
/// rows. A doubling of the time must be worth a tenth of them.
///
/// Only settings that keep the answer are advised: those that find as many of the reference's rows as the default
/// does, less 5 in 100. The error alone does not say so. It is measured over the poses that a setting found, and
/// fewer rotations find fewer poses at no larger an error.
pub fn advice(tradeoff: &Tradeoff) -> Option<Advice> {
    let default = tradeoff.measured.first()?;
    let tolerance = default.setting.options.kernel.tolerance;
    let runs = || {
        let runs = tradeoff.measured.iter();
        runs.filter(|run| run.setting.parameter != Parameter::Reference)
    };
    let serves = |run: &&Measured| run.error.rms <= tolerance.max(default.error.rms);
    let keeps = |run: &&Measured| run.agreement >= default.agreement - KEEPS;
    let worth = |run: &Measured| run.agreement - DOUBLING * run.cost().max(1e-6).log2();
    let cheapest = |a: &&Measured, b: &&Measured| a.cost().total_cmp(&b.cost());
    let take = runs()
        .filter(serves)
        .filter(keeps)
        .max_by(|a, b| worth(a).total_cmp(&worth(b)))
        .unwrap_or(default);
    let mut text = format!(
        "Take {}: {} of processor time ({} on the clock), an error of {:.1e} of the best score, and {} of the first {FIRST} rows of the \
         reference, which has {} times the rotations of the default, within {:.3} of one of its own.",
        setting_text(take),
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
    if take.setting.parameter != Parameter::Default {
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
            let cheaper = b.cost().total_cmp(&a.cost());
            a.agreement.total_cmp(&b.agreement).then(cheaper)
        });
    text += &quick_text(quick, keeps);
    let sharper = runs()
        .filter(|run| {
            run.same_score(&default.setting.options) && run.error.rms <= 0.5 * take.error.rms
        })
        .filter(keeps)
        .min_by(cheapest);
    if let Some(sharper) = sharper {
        text += &format!(
            " Where the error matters, {} ({}) brings it to {:.1e}.",
            setting_text(sharper),
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
            setting_text(wider),
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
    let rotations = |parameter: Parameter| {
        let run = tradeoff
            .measured
            .iter()
            .find(|run| run.setting.parameter == parameter);
        run.map_or(1, |run| run.setting.options.search.rotations)
    };
    rotations(Parameter::Reference) / rotations(Parameter::Default).max(1)
}

/// A setting by its name, and its options where the name is not all of them.
fn setting_text(run: &Measured) -> String {
    let setting = &run.setting;
    match setting.parameter {
        Parameter::Default => "the default".to_owned(),
        Parameter::Combination => format!("{} ({})", setting.name, setting.arguments),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dock::outcome::MeasuredError;
    use crate::dock::outcome::StageTime;
    use crate::options::DockOptions;
    use crate::tradeoff::settings::Setting;

    fn measured(
        parameter: Parameter,
        rotations: usize,
        cost: f64,
        rms: f64,
        agreement: f64,
    ) -> Measured {
        let options =
            DockOptions::default().changed(|options| options.search.rotations = rotations);
        let stage = StageTime {
            name: "search",
            wall_seconds: cost,
            cpu_seconds: Some(cost),
        };
        Measured {
            setting: Setting {
                parameter,
                name: format!("{} {rotations}", parameter.name()),
                arguments: format!("--rotations {rotations}"),
                options,
            },
            grid: [60; 3],
            spacing: 2.25,
            modes: 1000,
            rank: 7,
            spreading_width: 4,
            refined: 0,
            timing: vec![stage],
            error: MeasuredError {
                poses: 100,
                rms,
                worst: 2.0 * rms,
                low_pass_share: 0.1,
            },
            definition_rms: rms,
            definition_correlation: Some(0.99),
            agreement,
            native: None,
            front_error: false,
            front_agreement: false,
        }
    }

    fn text(rest: &[Measured]) -> String {
        let mut runs = vec![
            measured(Parameter::Default, 3600, 4.0, 1.2e-3, 0.85),
            measured(Parameter::Reference, 14_400, 16.0, 1.1e-3, 1.0),
        ];
        runs.extend_from_slice(rest);
        let tradeoff = Tradeoff {
            measured: runs,
            refused: Vec::new(),
            radius: 5.0,
            with_native: false,
        };
        advice(&tradeoff).unwrap().text
    }

    /// Found by a user: 600 rotations were "more exact", since the few poses that they found happened to have half
    /// the error, while they found 56% of the reference's rows.
    #[test]
    fn what_loses_the_answer_is_not_advised() {
        let few = measured(Parameter::Option("rotations"), 600, 1.5, 5e-4, 0.56);
        let said = text(std::slice::from_ref(&few));
        assert!(said.starts_with("Take the default"), "{said}");
        assert!(!said.contains("Where the error matters"), "{said}");
        assert!(
            said.contains("keeps the answer: the best, --rotations 600"),
            "{said}"
        );
        // Nor where it costs next to nothing.
        let said = text(&[measured(
            Parameter::Option("rotations"),
            600,
            0.01,
            5e-4,
            0.56,
        )]);
        assert!(said.starts_with("Take the default"), "{said}");
    }

    #[test]
    fn what_keeps_the_answer_is() {
        let sharp = measured(Parameter::Option("spacing"), 3600, 6.0, 4e-4, 0.84);
        let quick = measured(Parameter::Option("resolution"), 3600, 1.9, 1.3e-3, 0.81);
        let said = text(&[sharp, quick]);
        assert!(said.contains("Where the error matters"), "{said}");
        assert!(
            said.contains("In half the time or less") || said.starts_with("Take --rotations"),
            "{said}"
        );
    }
}
