//! The picture of a sweep: error, agreement and, with a known complex, ranks against time, on logarithmic axes, the
//! fronts marked.

use crate::plot::chart::{Axis, Colour, Panel, Series, Style, draw};
use crate::tradeoff::measured::{FIRST, Measured, Tradeoff};
use crate::tradeoff::settings::Parameter;
use knotdock_structures::Error;

/// Where nothing of the reference is missed: half a row, which a logarithm can show.
const NONE_MISSED: f64 = 0.5;

const FRONT: Colour = [0x88, 0x88, 0x88];

/// Colours that colour-blind readers can distinguish too (Okabe and Ito, and Tol's bright scheme).
fn colour(parameter: Parameter) -> Colour {
    match parameter {
        Parameter::Default => [0x00, 0x00, 0x00],
        Parameter::Reference => [0x77, 0x77, 0x77],
        Parameter::Repeat => [0xbb, 0xbb, 0xbb],
        Parameter::Option("tolerance") => [0xd5, 0x5e, 0x00],
        Parameter::Option("spacing") => [0xe6, 0x9f, 0x00],
        Parameter::Option("resolution") => [0x00, 0x9e, 0x73],
        Parameter::Option("rotations") => [0x00, 0x72, 0xb2],
        Parameter::Option("fine_rotations") => [0x33, 0x22, 0x88],
        Parameter::Option("per_rotation") => [0x56, 0xb4, 0xe9],
        Parameter::Option("refine") => [0xaa, 0x33, 0x77],
        Parameter::Option("sample_grid") => [0x8b, 0x5a, 0x2b],
        Parameter::Option(_) => [0x99, 0x99, 0x33],
        Parameter::Combination => [0xcc, 0x33, 0x11],
    }
}

/// A setting as a point of a panel.
struct Point<'a> {
    run: &'a Measured,
    value: f64,
    front: bool,
}

impl Point<'_> {
    fn place(&self) -> [f64; 2] {
        [self.run.cost(), self.value]
    }

    /// Whether its name is written before those of others: the front's, the default's and the reference's.
    fn is_important(&self) -> bool {
        self.front
            || matches!(
                self.run.setting.parameter,
                Parameter::Default | Parameter::Reference
            )
    }
}

pub fn plot(tradeoff: &Tradeoff) -> Result<String, Error> {
    let points = |value: &dyn Fn(&Measured) -> Option<f64>, front: fn(&Measured) -> bool| {
        let runs = tradeoff.measured.iter();
        runs.filter_map(|run| {
            Some(Point {
                run,
                value: value(run).filter(|value| *value > 0.0 && value.is_finite())?,
                front: front(run),
            })
        })
        .collect::<Vec<_>>()
    };
    let missed = |run: &Measured| {
        let is_reference = run.setting.parameter == Parameter::Reference;
        (!is_reference).then_some((FIRST as f64 * (1.0 - run.agreement)).max(NONE_MISSED))
    };
    let mut panels = vec![
        panel(
            "Fast path against the exact sum",
            Axis::ten("error, rms, share of the best score"),
            &points(&|run| Some(run.error.rms), |run| run.front_error),
        ),
        panel(
            "Against the reference",
            Axis {
                named: Some((NONE_MISSED, "none")),
                most: Some(FIRST as f64),
                ..Axis::ten("of its first 100 rows, missed (%)")
            },
            &points(&missed, |run| run.front_agreement),
        ),
    ];
    if tradeoff.with_native {
        let rank = |run: &Measured| run.native?.first_near_native.map(|rank| rank as f64);
        panels.push(panel(
            "Against the known complex",
            Axis::ten("rank of the first near-native pose"),
            &points(&rank, |_| false),
        ));
    }
    // No pose may be near the known complex, or no error above zero.
    panels.retain(|panel| panel.series.iter().any(|series| !series.points.is_empty()));
    let columns = panels.len();
    draw(&panels, columns)
}

/// A panel: the front as a dashed line, filled discs on it and hollow ones off it.
fn panel(title: &str, up: Axis, points: &[Point]) -> Panel {
    let mut front: Vec<[f64; 2]> = points
        .iter()
        .filter(|p| p.front)
        .map(Point::place)
        .collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut series = vec![Series {
        name: String::new(),
        colour: FRONT,
        style: Style::Thin,
        points: front,
        labels: Vec::new(),
    }];
    // Names of earlier series are written first.
    for important in [true, false] {
        for point in points
            .iter()
            .filter(|point| point.is_important() == important)
        {
            let parameter = point.run.setting.parameter;
            series.push(Series {
                name: String::new(),
                colour: colour(parameter),
                style: if point.front {
                    Style::Discs
                } else {
                    Style::HollowDiscs
                },
                points: vec![point.place()],
                labels: vec![point.run.setting.name.clone()],
            });
        }
    }
    // Entries of the legend alone.
    let mut entry = |name: &str, colour, style| {
        series.push(Series {
            name: name.to_owned(),
            colour,
            style,
            points: Vec::new(),
            labels: Vec::new(),
        });
    };
    for point in points {
        let parameter = point.run.setting.parameter;
        entry(parameter.name(), colour(parameter), Style::HollowDiscs);
    }
    entry(
        "filled: nothing is better in less time",
        FRONT,
        Style::Discs,
    );
    let timed = points.iter().all(|point| point.run.cpu_seconds().is_some());
    Panel {
        title: title.to_owned(),
        // What settings are compared by.
        across: Axis::ten(if timed {
            "processor time, s"
        } else {
            "time on the clock, s"
        }),
        up,
        series,
    }
}
