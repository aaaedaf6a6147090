//! The frame of a panel: border, lines and numbers along two logarithmic axes, title and labels. Charts and the picture of a sweep share it.

use crate::tradeoff::axis::Scale;
use crate::tradeoff::drawing::{Anchor, Colour, Mark};

pub(super) const BLACK: Colour = [0x22, 0x22, 0x22];
const GREY: Colour = [0xdd, 0xdd, 0xdd];
/// Room around the axes in pixels: left, above, right, below.
pub(super) const MARGIN: [f64; 4] = [76.0, 44.0, 20.0, 56.0];

/// An axis: its range, what it shows, and numbers with what stands for them.
pub(super) struct Side<'a> {
    pub scale: Scale,
    pub label: &'a str,
    pub ticks: Vec<(f64, String)>,
}

/// A pair of axes at its place.
pub(super) struct Frame<'a> {
    /// Upper left of the axes.
    pub origin: [f64; 2],
    /// Lengths of the axes.
    pub size: [f64; 2],
    pub title: &'a str,
    pub across: Side<'a>,
    pub up: Side<'a>,
}

impl Frame<'_> {
    /// Left, upper, right and lower edge.
    pub fn edges(&self) -> [f64; 4] {
        let ([left, top], [wide, high]) = (self.origin, self.size);
        [left, top, left + wide, top + high]
    }

    /// Where a point of the axes' units lies.
    pub fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, _, _, bottom] = self.edges();
        [
            left + self.size[0] * self.across.scale.place(x),
            bottom - self.size[1] * self.up.scale.place(y),
        ]
    }

    /// Draws all but what the panel shows.
    pub fn draw(&self, marks: &mut Vec<Mark>) {
        let [left, top, right, bottom] = self.edges();
        let line = |through: Vec<[f64; 2]>, colour| Mark::Line {
            through,
            colour,
            width: 1.0,
            dashed: false,
        };
        for (tick, name) in &self.across.ticks {
            let x = left + self.size[0] * self.across.scale.place(*tick);
            marks.push(line(vec![[x, top], [x, bottom]], GREY));
            marks.push(text([x, bottom + 14.0], Anchor::Middle, BLACK, name));
        }
        for (tick, name) in &self.up.ticks {
            let y = bottom - self.size[1] * self.up.scale.place(*tick);
            marks.push(line(vec![[left, y], [right, y]], GREY));
            marks.push(text([left - 8.0, y], Anchor::End, BLACK, name));
        }
        let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
        marks.push(line([&corners[..], &corners[..1]].concat(), BLACK));
        let middle = 0.5 * (left + right);
        marks.push(text(
            [middle, top - 18.0],
            Anchor::Middle,
            BLACK,
            self.title,
        ));
        let below = [middle, bottom + 36.0];
        marks.push(text(below, Anchor::Middle, BLACK, self.across.label));
        marks.push(Mark::Text {
            at: [left - 60.0, 0.5 * (top + bottom)],
            anchor: Anchor::Middle,
            colour: BLACK,
            upward: true,
            text: self.up.label.to_owned(),
        });
    }
}

/// A level text.
pub(super) fn text(at: [f64; 2], anchor: Anchor, colour: Colour, text: &str) -> Mark {
    Mark::Text {
        at,
        anchor,
        colour,
        upward: false,
        text: text.to_owned(),
    }
}
