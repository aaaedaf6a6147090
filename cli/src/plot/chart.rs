//! Curves on logarithmic axes, several panels to a picture, under one legend.

use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, ValueFormatter};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::labels::{Anchor, CHARACTER, LINE, place, text_width};
use knotdock_structures::Error;

/// Edge lengths of a panel in pixels, labels and margins included.
const PANEL: [u32; 2] = [526, 440];
/// Height of text in pixels as plotters counts it; 13 in the SVG, so that characters are about [`CHARACTER`] wide.
const TEXT: f64 = 16.0;
/// Room in pixels at the left of a legend.
const INDENT: i32 = 76;
/// Length in pixels of a curve's stroke in the legend.
const SAMPLE: i32 = 28;
const BLACK: RGBColor = RGBColor(0x22, 0x22, 0x22);
const GREY: RGBColor = RGBColor(0xdd, 0xdd, 0xdd);

/// Red, green and blue.
pub type Colour = [u8; 3];

type Drawn = DrawingAreaErrorKind<std::io::Error>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Numbers along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ticks {
    /// Powers of ten, with twos and fives if there is room.
    Ten,
    /// Powers of two, written as such.
    Two,
}

/// An axis.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Its quantity, with the unit.
    pub label: String,
    /// Its numbers.
    pub ticks: Ticks,
    /// A value at the lower end whose tick is a word.
    pub named: Option<(f64, &'static str)>,
    /// The largest value that there can be, such as 100 of a percentage.
    pub most: Option<f64>,
}

/// Style of a curve's points.
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
    /// Hollow discs alone, larger than the others, which may be in them.
    HollowDiscs,
}

/// A curve, or points.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name in the legend, once for curves of one name in several panels; empty for none.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// How it is shown.
    pub style: Style,
    /// Places in the panel's units; those that a logarithm cannot show are left out.
    pub points: Vec<[f64; 2]>,
    /// Names of the points, written beside them where there is room, those of earlier series first; empty for none.
    pub labels: Vec<String>,
}

/// A pair of axes with curves.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Its title.
    pub title: String,
    /// The axis below.
    pub across: Axis,
    /// The axis at the left.
    pub up: Axis,
    /// The curves, later ones over earlier ones.
    pub series: Vec<Series>,
}

/// Draws panels, `columns` of them to a row, and a legend below; the SVG file.
///
/// # Errors
/// [`Error`] where plotters cannot draw it.
pub fn draw(panels: &[Panel], columns: usize) -> Result<String, Error> {
    let columns = columns.clamp(1, panels.len().max(1));
    let rows = panels.len().div_ceil(columns);
    let width = columns as u32 * PANEL[0];
    let entries = Entries::new(panels, width as i32);
    let top = rows as u32 * PANEL[1];
    let mut svg = String::new();
    let mut drawing = || -> Result<(), Drawn> {
        let size = (width, top + entries.height);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        let (above, below) = root.split_vertically(top);
        let areas = above.split_evenly((rows, columns));
        for (area, panel) in areas.iter().zip(panels) {
            panel.draw(area)?;
        }
        entries.draw(&below)?;
        root.present()
    };
    drawing().map_err(|error| Error::machine(format!("the chart cannot be drawn: {error}")))?;
    Ok(svg)
}

/// The legend: one entry a name, on as many lines as it takes.
struct Entries<'a> {
    /// Left end and height of the middle of each, in pixels of the legend.
    places: Vec<([i32; 2], &'a Series)>,
    height: u32,
}

impl<'a> Entries<'a> {
    fn new(panels: &'a [Panel], width: i32) -> Self {
        let mut places: Vec<([i32; 2], &Series)> = Vec::new();
        let line = LINE as i32 + 6;
        let [mut x, mut y] = [INDENT, line / 2];
        for series in panels.iter().flat_map(|panel| &panel.series) {
            let seen = places.iter().any(|(_, other)| other.name == series.name);
            if series.name.is_empty() || seen {
                continue;
            }
            let takes = SAMPLE + 8 + (text_width(&series.name) + 3.0 * CHARACTER) as i32;
            if x > INDENT && x + takes > width {
                [x, y] = [INDENT, y + line];
            }
            places.push(([x, y], series));
            x += takes;
        }
        let height = (y + line) as u32;
        Self { places, height }
    }

    fn draw(&self, area: &Area) -> Result<(), Drawn> {
        for ([x, y], series) in &self.places {
            let ends = [(*x, *y), (x + SAMPLE, *y)];
            match series.style {
                Style::Discs | Style::HollowDiscs => {}
                Style::Line => area.draw(&PathElement::new(ends, series.stroke()))?,
                Style::Dashed | Style::Thin | Style::Guide => {
                    area.draw(&DashedPathElement::new(ends, 6, 4, series.stroke()))?;
                }
            }
            for disc in series.disc((x + SAMPLE / 2, *y)) {
                area.draw(&disc)?;
            }
            let at = (x + SAMPLE + 8, *y);
            area.draw(&Text::new(
                series.name.as_str(),
                at,
                text(BLACK, Anchor::Start),
            ))?;
        }
        Ok(())
    }
}

/// Text whose middle is at the height of its place.
fn text(colour: RGBColor, anchor: Anchor) -> TextStyle<'static> {
    let across = match anchor {
        Anchor::Start => HPos::Left,
        Anchor::Middle => HPos::Center,
        Anchor::End => HPos::Right,
    };
    TextStyle {
        color: colour.to_backend_color(),
        ..TextStyle::from(("monospace", TEXT).into_font())
    }
    .pos(Pos::new(across, VPos::Center))
}

impl Series {
    fn rgb(&self) -> RGBColor {
        let [red, green, blue] = self.colour;
        RGBColor(red, green, blue)
    }

    fn stroke(&self) -> ShapeStyle {
        self.rgb().stroke_width(2)
    }

    /// The marks that stand for a point; none for a bare line.
    fn disc<Place: Clone>(&self, at: Place) -> Vec<Circle<Place, i32>> {
        let filled = |colour: RGBColor, radius| Circle::new(at.clone(), radius, colour.filled());
        match self.style {
            Style::Thin | Style::Guide => Vec::new(),
            Style::Line | Style::Discs => vec![filled(self.rgb(), 4)],
            Style::Dashed => vec![filled(self.rgb(), 5), filled(WHITE, 3)],
            Style::HollowDiscs => vec![filled(self.rgb(), 7), filled(WHITE, 5)],
        }
    }

    /// The points that a logarithm can show, with their places among all.
    fn shown(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        let points = self.points.iter().copied().enumerate();
        points.filter(|(_, point)| point.iter().all(|value| *value > 0.0 && value.is_finite()))
    }
}

impl Axis {
    /// An axis of powers of ten.
    pub fn ten(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ticks: Ticks::Ten,
            named: None,
            most: None,
        }
    }

    /// An axis of powers of two.
    pub fn two(label: impl Into<String>) -> Self {
        Self {
            ticks: Ticks::Two,
            ..Self::ten(label)
        }
    }

    /// The axis over a range, with its numbers.
    fn over(&self, scale: Scale) -> LogAxis {
        let mut numbers: Vec<(f64, String)> = match self.ticks {
            Ticks::Ten => {
                let ticks = scale.ticks().into_iter();
                ticks.map(|tick| (tick, tick_text(tick))).collect()
            }
            Ticks::Two => {
                let powers = scale.powers_of_two().into_iter();
                powers
                    .map(|power| (2f64.powi(power), format!("2^{power}")))
                    .collect()
            }
        };
        if let Some((value, name)) = self.named {
            numbers.retain(|(tick, _)| *tick > 1.5 * value);
            if scale.range().contains(&value.log10()) {
                numbers.push((value, name.to_owned()));
            }
        }
        LogAxis {
            range: scale.range(),
            numbers,
        }
    }
}

/// A logarithmic axis as plotters takes one: its range in powers of ten, and numbers with how they read.
struct LogAxis {
    range: std::ops::Range<f64>,
    numbers: Vec<(f64, String)>,
}

impl LogAxis {
    /// The value itself, or the nearer end of the axis.
    fn clamp(&self, value: f64) -> f64 {
        10f64.powf(value.log10().clamp(self.range.start, self.range.end))
    }
}

impl Ranged for LogAxis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (value.log10() - self.range.start) / (self.range.end - self.range.start);
        from + (share * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            return Vec::new();
        }
        self.numbers.iter().map(|(value, _)| *value).collect()
    }

    fn range(&self) -> std::ops::Range<f64> {
        10f64.powf(self.range.start)..10f64.powf(self.range.end)
    }
}

impl ValueFormatter<f64> for LogAxis {
    fn format_ext(&self, value: &f64) -> String {
        let number = self.numbers.iter().find(|(number, _)| number == value);
        number.map_or_else(String::new, |(_, text)| text.clone())
    }
}

impl Panel {
    fn scale(&self, axis: usize) -> Scale {
        let series = self.series.iter();
        Scale::over(
            series
                .filter(|series| series.style != Style::Guide)
                .flat_map(|series| series.shown())
                .map(|(_, point)| point[axis]),
            [&self.across, &self.up][axis].most,
        )
    }

    fn draw(&self, area: &Area) -> Result<(), Drawn> {
        let across = || self.across.over(self.scale(0));
        let up = || self.up.over(self.scale(1));
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ("monospace", TEXT).into_font().color(&BLACK))
            .margin(10)
            .x_label_area_size(48)
            .y_label_area_size(66)
            .build_cartesian_2d(across(), up())?;
        chart
            .configure_mesh()
            .x_desc(&self.across.label)
            .y_desc(&self.up.label)
            .label_style(("monospace", TEXT).into_font().color(&BLACK))
            .axis_desc_style(("monospace", TEXT).into_font().color(&BLACK))
            .bold_line_style(GREY)
            .light_line_style(TRANSPARENT)
            .axis_style(BLACK)
            .draw()?;
        // Only lines that guide the eye can leave the frame, and end on it.
        let ends = [across(), up()];
        let place_of = |[x, y]: [f64; 2]| (ends[0].clamp(x), ends[1].clamp(y));
        for series in &self.series {
            let places: Vec<(f64, f64)> = series.shown().map(|(_, at)| place_of(at)).collect();
            match series.style {
                Style::Discs | Style::HollowDiscs => {}
                _ if places.len() < 2 => {}
                Style::Line => {
                    chart.draw_series(LineSeries::new(places.clone(), series.stroke()))?;
                }
                Style::Dashed | Style::Thin | Style::Guide => {
                    let dashes = DashedLineSeries::new(places.clone(), 6, 4, series.stroke());
                    chart.draw_series(dashes)?;
                }
            }
            chart.draw_series(places.into_iter().flat_map(|at| series.disc(at)))?;
        }
        let plotting = chart.plotting_area();
        let pixel = |point: [f64; 2]| {
            let (x, y) = plotting.map_coordinate(&place_of(point));
            [f64::from(x), f64::from(y)]
        };
        let mut named = Vec::new();
        let mut others = Vec::new();
        let mut lines = Vec::new();
        for series in &self.series {
            if !matches!(series.style, Style::Discs | Style::HollowDiscs) {
                let ends: Vec<[f64; 2]> = series.shown().map(|(_, at)| pixel(at)).collect();
                lines.extend(ends.windows(2).map(|ends| [ends[0], ends[1]]));
            }
            for (index, point) in series.shown() {
                match series.labels.get(index) {
                    Some(label) => named.push((pixel(point), label.as_str(), series.rgb())),
                    // A line has no mark at its points.
                    None if series.disc(()).is_empty() => {}
                    None => others.push(pixel(point)),
                }
            }
        }
        let (xs, ys) = plotting.get_pixel_range();
        let frame = [xs.start, ys.start, xs.end, ys.end].map(f64::from);
        let points: Vec<([f64; 2], &str)> =
            named.iter().map(|(at, label, _)| (*at, *label)).collect();
        // Pixels are those of the whole picture, as a backend takes them.
        let corner = area.get_pixel_range();
        for ((_, label, colour), free) in named.iter().zip(place(&points, (&others, &lines), frame))
        {
            if let Some(([x, y], anchor)) = free {
                let at = (x as i32 - corner.0.start, y as i32 - corner.1.start);
                area.draw(&Text::new(*label, at, text(*colour, anchor)))?;
            }
        }
        Ok(())
    }
}

/// Share of an axis that a dot takes to either side, and a little more.
const DOT: f64 = 0.03;

/// A logarithmic axis: from and to, in powers of ten.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    low: f64,
    high: f64,
}

impl Scale {
    /// An axis that holds all values with some room, at least from one to five; up to `most` where values have a most,
    /// with room for the dot of one that is it.
    pub fn over(values: impl Iterator<Item = f64>, most: Option<f64>) -> Self {
        let (low, high) = values
            .map(f64::log10)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            });
        if low > high {
            return Self {
                low: 0.0,
                high: 1.0,
            };
        }
        let room = (0.08 * (high - low)).max(0.5 * (0.7 - (high - low)).max(0.1));
        let (low, mut highest) = (low - room, high + room);
        if let Some(most) = most.map(f64::log10) {
            let dot = DOT * (most - low);
            let end = if high > most - dot {
                high.max(most) + dot
            } else {
                most
            };
            highest = highest.min(end);
        }
        Self { low, high: highest }
    }

    pub fn range(self) -> std::ops::Range<f64> {
        self.low..self.high
    }

    /// Where numbers stand: at powers of ten, with twos and fives between where few of these are in view.
    pub fn ticks(self) -> Vec<f64> {
        let digits: &[f64] = if self.high - self.low > 2.5 {
            &[1.0]
        } else {
            &[1.0, 2.0, 5.0]
        };
        let powers = self.low.floor() as i32..=self.high.ceil() as i32;
        powers
            .flat_map(|power| digits.iter().map(move |digit| digit * 10f64.powi(power)))
            .filter(|tick| (self.low..=self.high).contains(&tick.log10()))
            .collect()
    }

    /// Powers of two within the axis, as exponents: every one, or every second or third if they would be too
    /// close.
    pub fn powers_of_two(self) -> Vec<i32> {
        let doubling = 2f64.log10();
        let step = (((self.high - self.low) / doubling / 8.0).ceil() as i32).max(1);
        let first = (self.low / doubling).ceil() as i32;
        let last = (self.high / doubling).floor() as i32;
        (first..=last).filter(|power| power % step == 0).collect()
    }
}

/// A tick's number, at most five characters.
pub(super) fn tick_text(value: f64) -> String {
    if (0.01..1e5).contains(&value) {
        // Powers of ten come with their rounding.
        let text = format!("{value:.2}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{value:.0e}")
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
            labels: Vec::new(),
        }
    }

    /// Values of an attribute of every circle in an SVG.
    fn circles(svg: &str, attribute: &str) -> Vec<f64> {
        let circles = svg.split("<circle ").skip(1);
        circles
            .map(|circle| {
                let value = circle.split(&format!("{attribute}=\"")).nth(1).unwrap();
                value.split('"').next().unwrap().parse().unwrap()
            })
            .collect()
    }

    /// Every curve is within the picture, each name is once in the legend, and values without a logarithm are left out.
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
        let svg = draw(&[panel("ours"), panel("ours"), panel("theirs")], 2).unwrap();
        let (xs, ys) = (circles(&svg, "cx"), circles(&svg, "cy"));
        // Two a panel and one for each of the two names that have discs.
        assert_eq!(xs.len(), 8);
        assert!(
            xs.iter()
                .all(|x| (0.0..2.0 * f64::from(PANEL[0])).contains(x))
        );
        assert!(
            ys.iter()
                .all(|y| (0.0..3.0 * f64::from(PANEL[1])).contains(y))
        );
        let texts = |text: &str| svg.lines().filter(|line| line.trim() == text).count();
        assert_eq!([texts("ours"), texts("theirs"), texts("guide")], [1, 1, 1]);
        assert_eq!([texts("2^6"), texts("2^12")], [3, 3]);
        assert!(draw(&[], 3).unwrap().contains("svg"));
    }

    /// Points have their names beside them, and a named value its word on the axis.
    #[test]
    fn points_and_values_can_have_names() {
        let mut points = series("all", Style::Discs, vec![[1.0, 0.5], [10.0, 20.0]]);
        points.labels = vec!["slow & sure".to_owned(), "fast".to_owned()];
        let up = Axis {
            named: Some((0.5, "none")),
            ..Axis::ten("missed")
        };
        let panel = Panel {
            title: "title".to_owned(),
            across: Axis::ten("time, s"),
            up,
            series: vec![points],
        };
        let svg = draw(&[panel], 1).unwrap();
        let texts = |text: &str| svg.lines().filter(|line| line.trim() == text).count();
        assert_eq!(
            [texts("slow &amp; sure"), texts("fast"), texts("none")],
            [1, 1, 1]
        );
        assert_eq!(texts("0.5"), 0);
    }

    /// The axis of a share once ran on to 170%.
    #[test]
    fn an_axis_ends_at_the_most_that_there_can_be() {
        let of = |values: [f64; 2]| Scale::over(values.into_iter(), Some(100.0));
        assert_eq!(of([60.0, 90.0]).high, 2.0);
        assert!(of([1.0, 3.0]).high < 1.0);
        // A dot at the end has room, and half its width at the most.
        let full = of([60.0, 100.0]);
        assert!(full.high > 2.0 && full.high < 2.0 + 0.05 * (full.high - full.low));
        let past = of([60.0, 120.0]);
        assert!(past.high > 120f64.log10());
    }

    #[test]
    fn ticks_lie_within_the_axis_and_read_as_people_write() {
        let narrow = Scale::over([3.0, 40.0].into_iter(), None);
        assert_eq!(narrow.ticks(), [5.0, 10.0, 20.0]);
        let wide = Scale::over([1e-6, 1e-1].into_iter(), None);
        assert!(wide.ticks().len() >= 5);
        for scale in [
            narrow,
            wide,
            Scale::over([7.0].into_iter(), None),
            Scale::over(std::iter::empty(), None),
        ] {
            assert!(scale.low < scale.high && !scale.ticks().is_empty());
        }
        let powers = Scale::over([64.0, 2097152.0].into_iter(), None).powers_of_two();
        assert!(powers.contains(&6) && powers.contains(&21) && powers.len() <= 9);
        let texts = [0.5, 10.0, 1e-6, 0.05].map(tick_text);
        assert_eq!(texts, ["0.5", "10", "1e-6", "0.05"]);
    }
}
