//! Curves on logarithmic axes, several panels to a picture, under one legend.

use crate::tradeoff::axis::{Scale, tick_text};
use crate::tradeoff::drawing::{Anchor, CHARACTER, Colour, Drawing, LINE, Mark, text_width};
use crate::tradeoff::frame::{BLACK, Frame, MARGIN, Side, text};

/// Edge lengths of a panel's axes in pixels.
const AXES: [f64; 2] = [430.0, 340.0];
/// Length of the stroke that stands for a curve in the legend.
const SAMPLE: f64 = 28.0;

/// What numbers stand along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ticks {
    /// Powers of ten, with twos and fives where there is room.
    Ten,
    /// Powers of two, written as such.
    Two,
}

/// An axis.
#[derive(Clone, Debug)]
pub struct Axis {
    /// What it shows, with its unit.
    pub label: String,
    /// Its numbers.
    pub ticks: Ticks,
}

/// How the points of a curve are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// A line and filled discs.
    Line,
    /// A dashed line and hollow discs.
    Dashed,
    /// A dashed line alone.
    Thin,
    /// A dashed line alone, to guide the eye: it may leave the axes' range.
    Guide,
    /// Filled discs alone.
    Discs,
    /// Hollow discs alone, larger than the others, which may lie in them.
    HollowDiscs,
}

/// A curve, or points.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name in the legend, where curves of one name in several panels stand once; empty for none.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// How it is shown.
    pub style: Style,
    /// Places in the panel's units; those that a logarithm cannot show are left out.
    pub points: Vec<[f64; 2]>,
}

/// A pair of axes with curves.
#[derive(Clone, Debug)]
pub struct Panel {
    /// What stands above it.
    pub title: String,
    /// The axis below.
    pub across: Axis,
    /// The axis at the left.
    pub up: Axis,
    /// The curves, later ones over earlier ones.
    pub series: Vec<Series>,
}

/// Draws panels, `columns` of them to a row, and a legend below.
pub fn draw(panels: &[Panel], columns: usize) -> Drawing {
    let columns = columns.clamp(1, panels.len().max(1));
    let size = [
        MARGIN[0] + AXES[0] + MARGIN[2],
        MARGIN[1] + AXES[1] + MARGIN[3],
    ];
    let mut marks = Vec::new();
    for (index, panel) in panels.iter().enumerate() {
        let left = (index % columns) as f64 * size[0] + MARGIN[0];
        let top = (index / columns) as f64 * size[1] + MARGIN[1];
        panel.draw([left, top], &mut marks);
    }
    let width = columns as f64 * size[0];
    let top = panels.len().div_ceil(columns) as f64 * size[1];
    let height = legend(panels, width, top, &mut marks);
    Drawing {
        width,
        height,
        marks,
    }
}

/// One entry a name, on as many lines as it takes; the height below them.
fn legend(panels: &[Panel], width: f64, top: f64, marks: &mut Vec<Mark>) -> f64 {
    let mut named: Vec<&Series> = Vec::new();
    for series in panels.iter().flat_map(|panel| &panel.series) {
        if !series.name.is_empty() && named.iter().all(|other| other.name != series.name) {
            named.push(series);
        }
    }
    let (mut x, mut y) = (MARGIN[0], top + 4.0);
    for series in named {
        let takes = SAMPLE + 8.0 + text_width(&series.name) + 3.0 * CHARACTER;
        if x > MARGIN[0] && x + takes > width {
            (x, y) = (MARGIN[0], y + LINE + 6.0);
        }
        let middle = [x + SAMPLE / 2.0, y];
        series.stroke(vec![[x, y], [x + SAMPLE, y]], marks);
        series.discs(&[middle], marks);
        marks.push(text(
            [x + SAMPLE + 8.0, y],
            Anchor::Start,
            BLACK,
            &series.name,
        ));
        x += takes;
    }
    y + LINE + 4.0
}

impl Series {
    fn stroke(&self, through: Vec<[f64; 2]>, marks: &mut Vec<Mark>) {
        if !matches!(self.style, Style::Discs | Style::HollowDiscs) {
            marks.push(Mark::Line {
                through,
                colour: self.colour,
                width: 1.5,
                dashed: self.style != Style::Line,
            });
        }
    }

    fn discs(&self, places: &[[f64; 2]], marks: &mut Vec<Mark>) {
        if matches!(self.style, Style::Thin | Style::Guide) {
            return;
        }
        let radius = if self.style == Style::HollowDiscs {
            6.5
        } else {
            3.5
        };
        for &at in places {
            marks.push(Mark::Disc {
                at,
                radius,
                colour: self.colour,
                filled: matches!(self.style, Style::Line | Style::Discs),
            });
        }
    }
}

impl Axis {
    /// An axis of powers of ten.
    pub fn ten(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ticks: Ticks::Ten,
        }
    }

    /// An axis of powers of two.
    pub fn two(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ticks: Ticks::Two,
        }
    }

    fn side(&self, scale: Scale) -> Side<'_> {
        let ticks = match self.ticks {
            Ticks::Ten => scale
                .ticks()
                .into_iter()
                .map(|tick| (tick, tick_text(tick)))
                .collect(),
            Ticks::Two => scale
                .powers_of_two()
                .into_iter()
                .map(|power| (2f64.powi(power), format!("2^{power}")))
                .collect(),
        };
        Side {
            scale,
            label: &self.label,
            ticks,
        }
    }
}

impl Panel {
    fn scale(&self, axis: usize) -> Scale {
        let shown = |point: &&[f64; 2]| point.iter().all(|value| *value > 0.0 && value.is_finite());
        let series = self.series.iter();
        Scale::over(
            series
                .filter(|series| series.style != Style::Guide)
                .flat_map(|series| series.points.iter().filter(shown))
                .map(|point| point[axis]),
        )
    }

    /// Draws the panel with the upper left of its axes at `origin`.
    fn draw(&self, origin: [f64; 2], marks: &mut Vec<Mark>) {
        let frame = Frame {
            origin,
            size: AXES,
            title: &self.title,
            across: self.across.side(self.scale(0)),
            up: self.up.side(self.scale(1)),
        };
        frame.draw(marks);
        let [left, top, right, bottom] = frame.edges();
        for series in &self.series {
            let places: Vec<[f64; 2]> = series
                .points
                .iter()
                .filter(|point| point.iter().all(|value| *value > 0.0 && value.is_finite()))
                .map(|&point| {
                    // Only lines that guide the eye can leave the frame, and end on it.
                    let [x, y] = frame.place(point);
                    [x.clamp(left, right), y.clamp(top, bottom)]
                })
                .collect();
            series.stroke(places.clone(), marks);
            series.discs(&places, marks);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(name: &str, style: Style, points: Vec<[f64; 2]>) -> Series {
        Series {
            name: name.to_owned(),
            colour: [0, 0, 200],
            style,
            points,
        }
    }

    /// Every curve lies within its axes, one name stands once in the legend, and what has no logarithm is left out.
    #[test]
    fn curves_lie_within_their_axes() {
        let panel = |name: &str| Panel {
            title: "title".to_owned(),
            across: Axis::two("modes"),
            up: Axis::ten("error"),
            series: vec![
                series(
                    name,
                    Style::Line,
                    vec![[64.0, 1e-2], [4096.0, 1e-5], [8.0, 0.0]],
                ),
                series("guide", Style::Guide, vec![[1e9, 1e-9], [1e9, 1e9]]),
            ],
        };
        let drawing = draw(&[panel("ours"), panel("ours"), panel("theirs")], 2);
        let discs: Vec<[f64; 2]> = drawing
            .marks
            .iter()
            .filter_map(|mark| match mark {
                Mark::Disc { at, .. } => Some(*at),
                _ => None,
            })
            .collect();
        // Two a panel and one for each of the two names that have discs.
        assert_eq!(discs.len(), 8);
        for [x, y] in discs {
            assert!(x > 0.0 && x < drawing.width && y > 0.0 && y < drawing.height);
        }
        let svg = drawing.svg();
        assert_eq!(svg.matches(">ours</text>").count(), 1);
        assert_eq!(svg.matches(">guide</text>").count(), 1);
        assert!(svg.contains(">2^6</text>") && svg.contains(">2^12</text>"));
        assert!(draw(&[], 3).svg().contains("svg"));
    }
}
