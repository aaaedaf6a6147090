//! The tables and the picture: a column of panels for each quantity, a rotation above and a docking below.

use crate::measured::Measured;
use crate::report::Figure;
use crate::settings::{Setting, Varied};
use crate::table::{Cell, Table};
use knotdock_cli::plot::chart::{Axis, Colour, Panel, Series, Style};

const BLUE: Colour = [0x00, 0x72, 0xb2];
const GREEN: Colour = [0x00, 0x9e, 0x73];
const ORANGE: Colour = [0xe6, 0x9f, 0x00];

/// A quantity of the axis across.
struct Quantity {
    varied: Varied,
    name: &'static str,
    label: &'static str,
    value: fn(&Measured) -> f64,
}

const QUANTITIES: [Quantity; 3] = [
    Quantity {
        varied: Varied::Atoms,
        name: "atoms",
        label: "atoms of both bodies",
        value: |one| one.atoms as f64,
    },
    Quantity {
        varied: Varied::Grid,
        name: "points",
        label: "grid points",
        value: |one| one.points() as f64,
    },
    Quantity {
        varied: Varied::Rotations,
        name: "rotations",
        label: "rotations",
        value: |one| one.rotations as f64,
    },
];

/// A time of the axis at the left.
struct Time {
    name: &'static str,
    /// In the titles.
    short: &'static str,
    colour: Colour,
    value: fn(&Measured) -> f64,
}

const ROTATION: Time = Time {
    name: "a rotation",
    short: "rotation",
    colour: BLUE,
    value: |one| 1e3 * one.rotation(),
};
const SEARCH: Time = Time {
    name: "the search of a docking",
    short: "search",
    colour: ORANGE,
    value: |one| one.search,
};
const DOCKING: Time = Time {
    name: "a whole docking",
    short: "docking",
    colour: GREEN,
    value: |one| one.docking,
};

/// A power law, time = factor quantity^exponent.
#[derive(Clone, Copy)]
struct Power {
    factor: f64,
    exponent: f64,
}

impl Power {
    /// Least squares of the logarithms.
    fn fitted(points: &[[f64; 2]]) -> Self {
        let logs: Vec<[f64; 2]> = points.iter().map(|point| point.map(f64::ln)).collect();
        let count = logs.len() as f64;
        let mean = |axis: usize| logs.iter().map(|log| log[axis]).sum::<f64>() / count;
        let (x, y) = (mean(0), mean(1));
        let spread: f64 = logs.iter().map(|log| (log[0] - x).powi(2)).sum();
        let shared: f64 = logs.iter().map(|log| (log[0] - x) * (log[1] - y)).sum();
        let exponent = shared / spread;
        Self {
            factor: (y - exponent * x).exp(),
            exponent,
        }
    }

    fn at(self, quantity: f64) -> f64 {
        self.factor * quantity.powf(self.exponent)
    }
}

/// The measurements of a curve, by rising quantity: those that vary it, and the one that all curves share.
fn curve(
    settings: &[Setting],
    measured: &[Measured],
    quantity: &Quantity,
    time: &Time,
) -> Vec<[f64; 2]> {
    let belongs = |setting: &Setting| [Varied::Nothing, quantity.varied].contains(&setting.varied);
    let mut points: Vec<[f64; 2]> = settings
        .iter()
        .zip(measured)
        .filter(|(setting, _)| belongs(setting))
        .map(|(_, one)| [(quantity.value)(one), (time.value)(one)])
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

/// All that is written.
pub fn figure(settings: &[Setting], measured: &[Measured]) -> Figure {
    let panels = |times: &'static [Time], up: &'static str| {
        QUANTITIES
            .iter()
            .map(move |quantity| panel((settings, measured), quantity, times, up))
    };
    Figure {
        name: "growth",
        tables: vec![
            ("times", times(settings, measured)),
            ("exponents", exponents(settings, measured)),
        ],
        panels: panels(&[ROTATION], "processor time, ms")
            .chain(panels(&[SEARCH, DOCKING], "processor time, s"))
            .collect(),
        columns: QUANTITIES.len(),
    }
}

fn panel(
    (settings, measured): (&[Setting], &[Measured]),
    quantity: &Quantity,
    times: &[Time],
    up: &str,
) -> Panel {
    let mut series = Vec::new();
    let mut laws = Vec::new();
    for time in times {
        let points = curve(settings, measured, quantity, time);
        let power = Power::fitted(&points);
        laws.push(format!(
            "{} ~ {}^{:.2}",
            time.short, quantity.name, power.exponent
        ));
        let one = |name: &str, style, points| Series {
            name: name.to_owned(),
            colour: time.colour,
            style,
            points,
            labels: Vec::new(),
        };
        let fitted = points.iter().map(|point| [point[0], power.at(point[0])]);
        series.push(one("", Style::Thin, fitted.collect()));
        series.push(one(time.name, Style::Discs, points));
    }
    Panel {
        title: laws.join(", "),
        across: Axis::ten(quantity.label),
        up: Axis::ten(up),
        series,
    }
}

fn times(settings: &[Setting], measured: &[Measured]) -> Table {
    let varied = |setting: &Setting| {
        let found = QUANTITIES
            .iter()
            .find(|quantity| quantity.varied == setting.varied);
        found.map_or("nothing", |quantity| quantity.label)
    };
    let row = |(setting, one): (&Setting, &Measured)| {
        vec![
            Cell::Text(varied(setting).to_owned()),
            Cell::Text(one.grid.map(|n| n.to_string()).join(" x ")),
            Cell::Text(one.points().to_string()),
            Cell::Text(one.atoms.to_string()),
            Cell::Text(one.rotations.to_string()),
            Cell::Text(one.components.to_string()),
            Cell::Text(one.poses.to_string()),
            Cell::Number(1e3 * one.rotation()),
            Cell::Number(one.search),
            Cell::Number(one.docking),
        ]
    };
    Table {
        header: vec![
            "varied",
            "grid",
            "grid points",
            "atoms",
            "rotations",
            "components",
            "poses",
            "rotation (ms)",
            "search (s)",
            "docking (s)",
        ],
        rows: settings.iter().zip(measured).map(row).collect(),
    }
}

fn exponents(settings: &[Setting], measured: &[Measured]) -> Table {
    let row = |quantity: &Quantity| {
        let exponent = |time: &Time| {
            let power = Power::fitted(&curve(settings, measured, quantity, time));
            Cell::Text(format!("{:.2}", power.exponent))
        };
        vec![
            Cell::Text(quantity.label.to_owned()),
            exponent(&ROTATION),
            exponent(&SEARCH),
            exponent(&DOCKING),
        ]
    };
    Table {
        header: vec!["against", "rotation", "search", "docking"],
        rows: QUANTITIES.iter().map(row).collect(),
    }
}
