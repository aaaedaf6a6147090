//! Advice on which setting to take.

use serde::Serialize;

use crate::tradeoff::measured::{FIRST, Measured, Tradeoff};
use crate::tradeoff::settings::Parameter;
use knotdock::options::DockOptions;

/// Share of the reference's rows that a doubling of the time must find for it to be worth its price.
const DOUBLING: f64 = 0.1;

/// Share of the reference's rows that a setting may find fewer of than the default and still keep the answer.
const KEEPS: f64 = 0.05;

/// Recommended setting, and its loss.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Advice {
    pub take: String,
    /// Its options of `knotdock dock`.
    pub arguments: String,
    /// The same in words, with its loss, and the gains of less and more time.
    pub text: String,
}

/// Spread of repeats: ratios of the largest to the smallest time and error, and range of the agreement.
#[derive(Clone, Copy, Debug)]
struct Spread {
    cost: f64,
    error: f64,
    agreement: f64,
}

/// Spread that is assumed at the least, for repeats may agree by luck.
const LEAST: Spread = Spread {
    cost: 1.025,
    error: 1.05,
    agreement: 0.01,
};

impl Spread {
    fn of<'a>(runs: impl Iterator<Item = &'a Measured> + Clone) -> Self {
        let range = |value: fn(&Measured) -> f64| {
            let values = runs.clone().map(value);
            values.fold([f64::INFINITY, 0.0], |[low, high], value| {
                [value.min(low), value.max(high)]
            })
        };
        let ratio = |[low, high]: [f64; 2]| high / low.max(f64::MIN_POSITIVE);
        let [low, high] = range(|run| run.agreement);
        Self {
            cost: ratio(range(Measured::cost)).max(LEAST.cost),
            error: ratio(range(|run| run.error.rms)).max(LEAST.error),
            agreement: (high - low).max(LEAST.agreement),
        }
    }
}

/// Comparison of settings: a difference counts where it is more than twice the spread of repeats.
struct Comparison<'a> {
    default: &'a DockOptions,
    spread: Spread,
}

impl Comparison<'_> {
    /// Error of a setting; without a bound where it ranks by another score than the default's.
    fn loss(&self, run: &Measured) -> f64 {
        if run.same_score(self.default) {
            run.error.rms
        } else {
            f64::INFINITY
        }
    }

    fn is_cheaper(&self, a: &Measured, b: &Measured) -> bool {
        a.cost() * self.spread.cost.powi(2) < b.cost()
    }

    fn is_more_exact(&self, a: &Measured, b: &Measured) -> bool {
        self.loss(a) * self.spread.error.powi(2) < self.loss(b)
    }

    fn finds_more(&self, a: &Measured, b: &Measured) -> bool {
        a.agreement > b.agreement + 2.0 * self.spread.agreement
    }

    /// Whether `b` is not advised beside `a`: no cheaper, and less exact, or no more exact without finding more.
    fn beats(&self, a: &Measured, b: &Measured) -> bool {
        let is_worse =
            || self.loss(a) < self.loss(b) || self.is_cheaper(a, b) || self.finds_more(a, b);
        let is_better = || self.is_more_exact(b, a) || self.finds_more(b, a);
        !self.is_cheaper(b, a) && (self.is_more_exact(a, b) || !is_better() && is_worse())
    }

    /// Whether `a` is as good as `b` in every way and better in one, by the figures as they are.
    fn dominates(&self, a: &Measured, b: &Measured) -> bool {
        let of = |run: &Measured| [run.cost(), self.loss(run), -run.agreement];
        let pairs = || of(a).into_iter().zip(of(b));
        pairs().all(|(a, b)| a <= b) && pairs().any(|(a, b)| a < b)
    }

    /// What a setting is worth: the rows that it finds, less those that its time must find.
    fn worth(run: &Measured) -> f64 {
        run.agreement - DOUBLING * run.cost().max(1e-6).log2()
    }

    /// The difference of worth that counts.
    fn worth_margin(&self) -> f64 {
        2.0 * (self.spread.agreement + DOUBLING * self.spread.cost.log2())
    }
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
/// rows. A doubling of the time must be worth a tenth of them. The default is taken unless another is better by more
/// than twice the spread of its repeats; of others that differ by less it is the most exact.
///
/// Only settings that keep the answer are advised: those that find as many of the reference's rows as the default
/// does, less 5 in 100. The error alone does not say so. It is measured over the poses that a setting found, and
/// fewer rotations find fewer poses at no larger an error.
///
/// No setting is advised that another one equals in every way and beats in one, or that is less exact than the default
/// and no cheaper.
pub fn advice(tradeoff: &Tradeoff) -> Option<Advice> {
    let default = tradeoff.measured.first()?;
    let tolerance = default.setting.options.kernel.tolerance;
    let is_repeat = |run: &&Measured| {
        matches!(
            run.setting.parameter,
            Parameter::Default | Parameter::Repeat
        )
    };
    let of = Comparison {
        default: &default.setting.options,
        spread: Spread::of(tradeoff.measured.iter().filter(is_repeat)),
    };
    let is_default = |run: &Measured| run.setting.parameter == Parameter::Default;
    let measured = tradeoff.measured.iter();
    let settings: Vec<&Measured> = measured
        .filter(|run| run.setting.parameter.is_choice())
        .collect();
    let runs = || {
        settings.iter().copied().filter(|run| {
            let is_dominated = || settings.iter().any(|other| of.dominates(other, run));
            is_default(run) || !(of.beats(default, run) || is_dominated())
        })
    };
    let keeps = |run: &&Measured| run.agreement >= default.agreement - KEEPS;
    let serves = |run: &&Measured| run.error.rms <= tolerance.max(default.error.rms);
    let cheapest = |a: &&Measured, b: &&Measured| a.cost().total_cmp(&b.cost());
    let candidates = || runs().filter(serves).filter(keeps);
    let most = candidates()
        .map(Comparison::worth)
        .fold(Comparison::worth(default), f64::max);
    let is_best = |run: &&Measured| Comparison::worth(run) >= most - of.worth_margin();
    let take = if is_best(&default) {
        default
    } else {
        let best = candidates().filter(is_best);
        best.min_by(|a, b| of.loss(a).total_cmp(&of.loss(b)).then(cheapest(a, b)))
            .unwrap_or(default)
    };
    let others = || runs().filter(|run| !of.beats(take, run));
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
    let quick = others()
        .filter(|run| run.cost() <= 0.5 * take.cost())
        .max_by(|a, b| {
            let cheaper = b.cost().total_cmp(&a.cost());
            a.agreement.total_cmp(&b.agreement).then(cheaper)
        });
    text += &quick_text(quick, keeps);
    let sharper = others()
        .filter(|run| of.loss(run) <= 0.5 * take.error.rms)
        .filter(|run| run.cost() < default.cost() || of.loss(run) <= of.loss(default))
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
    let wider = others()
        .filter(|run| run.cost() > take.cost() && of.finds_more(run, take))
        .min_by(cheapest);
    if let Some(wider) = wider {
        text += &format!(
            " Where time allows, {} ({}) finds {}.",
            setting_text(wider),
            seconds(wider.cost()),
            share(wider)
        );
    }
    let Spread {
        cost,
        error,
        agreement,
    } = of.spread;
    text += &format!(
        " Repeats of the default differ by {:.0}% in time, {:.0}% in error and {:.0} rows of 100; settings that differ by \
         less than twice that count as equal.",
        100.0 * (cost - 1.0),
        100.0 * (error - 1.0),
        100.0 * agreement,
    );
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
    use crate::tradeoff::settings::Setting;
    use knotdock::dock::outcome::MeasuredError;
    use knotdock::dock::outcome::StageTime;
    use knotdock::options::DockOptions;

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

    /// The advice on settings beside the default, with repeats of it at these times.
    fn advice_with(repeats: [f64; 2], rest: &[Measured]) -> Advice {
        let mut runs = vec![
            measured(Parameter::Default, 3600, 4.0, 1.2e-3, 0.85),
            measured(Parameter::Reference, 14_400, 16.0, 1.1e-3, 1.0),
        ];
        let repeats = repeats.into_iter().zip([3604, 3596]);
        runs.extend(
            repeats.map(|(cost, rotations)| {
                measured(Parameter::Repeat, rotations, cost, 1.25e-3, 0.84)
            }),
        );
        runs.extend_from_slice(rest);
        let tradeoff = Tradeoff {
            measured: runs,
            refused: Vec::new(),
            radius: 5.0,
            with_native: false,
        };
        advice(&tradeoff).unwrap()
    }

    fn text(rest: &[Measured]) -> String {
        advice_with([4.1, 4.05], rest).text
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

    /// Found by a user: the advice was a coarser spacing that was no cheaper than the default and less exact, and
    /// where the error matters a third setting that was worse than the default, too.
    #[test]
    fn what_the_default_beats_is_not_advised() {
        let spacing = |number, cost, rms, agreement| {
            measured(Parameter::Option("spacing"), number, cost, rms, agreement)
        };
        let coarse = spacing(1, 4.1, 5.7e-3, 0.90);
        let third = spacing(2, 4.6, 2.5e-3, 0.86);
        let said = text(&[coarse, third]);
        assert!(said.starts_with("Take the default"), "{said}");
        assert!(!said.contains("--rotations 1"), "{said}");
        assert!(!said.contains("Where the error matters"), "{said}");
        assert!(
            said.contains("differ by 2% in time, 5% in error and 1 rows"),
            "{said}"
        );
    }

    /// A setting that is a third cheaper is taken where repeats of the default agree, and not where they differ by a
    /// quarter.
    #[test]
    fn differences_count_that_are_larger_than_those_of_repeats() {
        let cheaper = measured(Parameter::Option("spacing"), 9, 2.6, 1.2e-3, 0.85);
        let said = advice_with([4.1, 4.05], std::slice::from_ref(&cheaper));
        assert_eq!(said.arguments, "--rotations 9", "{}", said.text);
        let said = advice_with([5.2, 4.05], &[cheaper]);
        assert_eq!(said.arguments, "--rotations 3600", "{}", said.text);
    }

    /// Whatever a sweep measures, no advice names a setting that another one equals in every way and beats in one.
    #[test]
    fn nothing_that_is_dominated_is_named() {
        let mut state = 7u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 40) as f64 / (1 << 24) as f64
        };
        for _ in 0..500 {
            let rest: Vec<Measured> = (0..12)
                .map(|number| {
                    let cost = 4.0 * 2f64.powf(4.0 * random() - 2.0);
                    let rms = 1.2e-3 * 10f64.powf(2.0 * random() - 1.0);
                    let agreement = 0.7 + 0.25 * random();
                    let parameter = Parameter::Option("spacing");
                    measured(parameter, 10 + number, cost, rms, agreement)
                })
                .collect();
            let said = advice_with([4.1, 4.05], &rest).text;
            let default = measured(Parameter::Default, 3600, 4.0, 1.2e-3, 0.85);
            for run in &rest {
                let arguments = &run.setting.arguments;
                let is_named = [' ', ':']
                    .iter()
                    .any(|end| said.contains(&format!("{arguments}{end}")));
                let is_dominated = rest.iter().chain([&default]).any(|other| {
                    let of = |run: &Measured| [run.cost(), run.error.rms, -run.agreement];
                    let (other, run) = (of(other), of(run));
                    other != run && other.iter().zip(run).all(|(a, b)| *a <= b)
                });
                // By more than twice the spread of repeats, which is 5% of the error.
                let is_worse =
                    run.cost() >= default.cost() && run.error.rms > 1.11 * default.error.rms;
                assert!(!(is_named && (is_dominated || is_worse)), "{said}");
            }
        }
    }
}
