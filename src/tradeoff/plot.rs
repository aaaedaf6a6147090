//! The picture of a sweep: error, agreement and, with a known complex, ranks against time, on logarithmic axes, the fronts marked.

use crate::tradeoff::axis::{Scale, tick_text};
use crate::tradeoff::drawing::{Anchor, CHARACTER, Colour, Drawing, LINE, Mark, text_width};
use crate::tradeoff::frame::{BLACK, Frame, MARGIN, Side, text};
use crate::tradeoff::measured::{FIRST, Measured, Tradeoff};
use crate::tradeoff::settings::Parameter;

/// Edge lengths of a panel's axes in pixels.
const AXES: [f64; 2] = [430.0, 380.0];
/// Where nothing of the reference is missed: half a row, which a logarithm can show.
const NONE_MISSED: f64 = 0.5;

const FRONT: Colour = [0x88, 0x88, 0x88];

/// Colours that stay apart for colour-blind readers too (Okabe and Ito, and Tol's bright scheme).
fn colour(parameter: Parameter) -> Colour {
    match parameter {
        Parameter::Default => [0x00, 0x00, 0x00],
        Parameter::Reference => [0x77, 0x77, 0x77],
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

/// One pair of axes with its points.
struct Panel<'a> {
    title: &'static str,
    label: &'static str,
    points: Vec<Point<'a>>,
    /// A value whose tick reads otherwise.
    named: Option<(f64, &'static str)>,
}

/// Draws a sweep.
pub fn plot(tradeoff: &Tradeoff) -> Drawing {
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
        let counted = run.setting.parameter != Parameter::Reference;
        counted.then_some((FIRST as f64 * (1.0 - run.agreement)).max(NONE_MISSED))
    };
    let mut panels = vec![
        Panel {
            title: "Fast path against the exact sum",
            label: "error, rms, share of the best score",
            points: points(&|run| Some(run.error.rms), |run| run.front_error),
            named: None,
        },
        Panel {
            title: "Against the reference",
            label: "of its first 100 rows, missed (%)",
            points: points(&missed, |run| run.front_agreement),
            named: Some((NONE_MISSED, "none")),
        },
    ];
    if tradeoff.with_native {
        let rank = |run: &Measured| run.native?.first_near_native.map(|rank| rank as f64);
        panels.push(Panel {
            title: "Against the known complex",
            label: "rank of the first near-native pose",
            points: points(&rank, |_| false),
            named: None,
        });
    }
    // No pose may be near the known complex, or no error above zero.
    panels.retain(|panel| !panel.points.is_empty());
    let width = MARGIN[0] + AXES[0] + MARGIN[2];
    let height = MARGIN[1] + AXES[1] + MARGIN[3];
    let mut marks = Vec::new();
    for (index, panel) in panels.iter().enumerate() {
        panel.draw([index as f64 * width + MARGIN[0], MARGIN[1]], &mut marks);
    }
    let whole = width * panels.len().max(1) as f64;
    let below = legend(tradeoff, whole, height, &mut marks);
    Drawing {
        width: whole,
        height: below,
        marks,
    }
}

/// One colour a parameter, and what filled discs mean, on as many lines as it takes; the height below them.
fn legend(tradeoff: &Tradeoff, width: f64, top: f64, marks: &mut Vec<Mark>) -> f64 {
    let mut parameters: Vec<Parameter> = Vec::new();
    for run in &tradeoff.measured {
        if !parameters.contains(&run.setting.parameter) {
            parameters.push(run.setting.parameter);
        }
    }
    let entries = parameters
        .iter()
        .map(|&parameter| (colour(parameter), false, parameter.name()))
        .chain([(FRONT, true, "filled: nothing is better in less time")]);
    let (mut x, mut y) = (MARGIN[0], top + 4.0);
    for (colour, filled, name) in entries {
        let takes = 20.0 + text_width(name) + 3.0 * CHARACTER;
        if x + takes > width {
            (x, y) = (MARGIN[0], y + LINE + 6.0);
        }
        marks.push(Mark::Disc {
            at: [x + 6.0, y],
            radius: 5.0,
            colour,
            filled,
        });
        marks.push(text([x + 18.0, y], Anchor::Start, BLACK, name));
        x += takes;
    }
    y + LINE + 4.0
}

impl Panel<'_> {
    /// Draws the panel with the upper left of its axes at `origin`.
    fn draw(&self, origin: [f64; 2], marks: &mut Vec<Mark>) {
        let across = Scale::over(self.points.iter().map(|point| point.run.cost()));
        let up = Scale::over(self.points.iter().map(|point| point.value));
        let numbered = |ticks: Vec<f64>| ticks.into_iter().map(|tick| (tick, tick_text(tick)));
        let mut up_ticks: Vec<(f64, String)> = numbered(up.ticks()).collect();
        if let Some((value, name)) = self.named {
            up_ticks.retain(|(tick, _)| *tick > 1.5 * value);
            if self.points.iter().any(|point| point.value <= value) {
                up_ticks.push((value, name.to_owned()));
            }
        }
        let told = |point: &Point| point.run.cpu_seconds().is_some();
        let frame = Frame {
            origin,
            size: AXES,
            title: self.title,
            across: Side {
                scale: across,
                // What settings are compared by.
                label: if self.points.iter().all(told) {
                    "processor time, s"
                } else {
                    "time on the clock, s"
                },
                ticks: numbered(across.ticks()).collect(),
            },
            up: Side {
                scale: up,
                label: self.label,
                ticks: up_ticks,
            },
        };
        frame.draw(marks);
        let place = |point: &Point| frame.place([point.run.cost(), point.value]);
        let mut front: Vec<[f64; 2]> = self.points.iter().filter(|p| p.front).map(place).collect();
        front.sort_by(|a, b| a[0].total_cmp(&b[0]));
        marks.push(Mark::Line {
            through: front,
            colour: FRONT,
            width: 1.5,
            dashed: true,
        });
        for point in &self.points {
            marks.push(Mark::Disc {
                at: place(point),
                radius: 5.0,
                colour: colour(point.run.setting.parameter),
                filled: point.front,
            });
        }
        let places: Vec<[f64; 2]> = self.points.iter().map(place).collect();
        self.name_points(&places, frame.edges(), marks);
    }

    /// Writes the names of settings beside their points, where they cover neither points nor each other: those of the front, the default and
    /// the reference first. A name for which there is no room is left out; the table has it.
    fn name_points(&self, places: &[[f64; 2]], frame: [f64; 4], marks: &mut Vec<Mark>) {
        const APART: f64 = 9.0;
        let mut taken: Vec<[f64; 4]> = places
            .iter()
            .map(|&[x, y]| [x - 6.0, y - 6.0, x + 6.0, y + 6.0])
            .collect();
        let important = |point: &Point| {
            point.front
                || matches!(
                    point.run.setting.parameter,
                    Parameter::Default | Parameter::Reference
                )
        };
        let mut order: Vec<usize> = (0..self.points.len()).collect();
        order.sort_by_key(|&index| !important(&self.points[index]));
        for index in order {
            let ([x, y], point) = (places[index], &self.points[index]);
            let name = &point.run.setting.name;
            let (wide, high) = (text_width(name), LINE);
            let candidates = [
                ([x + APART, y], Anchor::Start),
                ([x - APART, y], Anchor::End),
                ([x, y - high], Anchor::Middle),
                ([x, y + high], Anchor::Middle),
                ([x + 0.7 * APART, y - 0.8 * high], Anchor::Start),
                ([x + 0.7 * APART, y + 0.8 * high], Anchor::Start),
                ([x - 0.7 * APART, y - 0.8 * high], Anchor::End),
                ([x - 0.7 * APART, y + 0.8 * high], Anchor::End),
            ];
            let free = candidates.into_iter().find_map(|(at, anchor)| {
                let from = match anchor {
                    Anchor::Start => at[0],
                    Anchor::Middle => at[0] - wide / 2.0,
                    Anchor::End => at[0] - wide,
                };
                let (upper, lower) = (at[1] - high / 2.0, at[1] + high / 2.0);
                let area = [from, upper, from + wide, lower];
                let inside = area[0] > frame[0] + 2.0
                    && area[1] > frame[1] + 2.0
                    && area[2] < frame[2] - 2.0
                    && area[3] < frame[3] - 2.0;
                let covers = |other: &[f64; 4]| {
                    area[0] < other[2]
                        && other[0] < area[2]
                        && area[1] < other[3]
                        && other[1] < area[3]
                };
                (inside && !taken.iter().any(covers)).then_some((at, anchor, area))
            });
            if let Some((at, anchor, area)) = free {
                taken.push(area);
                let colour = colour(point.run.setting.parameter);
                marks.push(text(at, anchor, colour, name));
            }
        }
    }
}
