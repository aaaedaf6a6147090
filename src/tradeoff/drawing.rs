//! A drawing of lines, markers and text, written as SVG or rasterised as PNG (`raster`).
//!
//! Both come from one list of marks, so that the two pictures agree. Text is set in a monospaced face whose characters are all
//! [`CHARACTER`] wide: the space that a label takes is known without asking a font, the SVG needs none but the reader's own, and
//! the PNG carries characters rasterised beforehand (Noto Sans Mono).

use std::fmt::Write;

/// Width in pixels that a character takes at the size of labels.
pub const CHARACTER: f64 = 8.0;
/// Height in pixels of a line of labels.
pub const LINE: f64 = 16.0;

/// Red, green and blue.
pub type Colour = [u8; 3];

/// Which part of a text lies at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its left end.
    Start,
    /// Its middle.
    Middle,
    /// Its right end.
    End,
}

/// Something drawn. Places are pixels from the upper left.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A line through points.
    Line {
        /// The points, in order.
        through: Vec<[f64; 2]>,
        /// Its colour.
        colour: Colour,
        /// Its width.
        width: f64,
        /// Whether it is dashed.
        dashed: bool,
    },
    /// A round marker.
    Disc {
        /// Its middle.
        at: [f64; 2],
        /// Its radius.
        radius: f64,
        /// Colour of its rim.
        colour: Colour,
        /// Whether it is filled with that colour, or with white.
        filled: bool,
    },
    /// A line of text, half of its height above its place and half below.
    Text {
        /// Its place.
        at: [f64; 2],
        /// Which part of it lies there.
        anchor: Anchor,
        /// Its colour.
        colour: Colour,
        /// Whether it runs upward rather than to the right.
        upward: bool,
        /// The text; characters beyond Latin-1 show as a question mark in the PNG.
        text: String,
    },
}

/// Width of a text in pixels.
pub fn text_width(text: &str) -> f64 {
    CHARACTER * text.chars().count() as f64
}

/// Marks on a white ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Width in pixels.
    pub width: f64,
    /// Height in pixels.
    pub height: f64,
    /// The marks, later ones over earlier ones.
    pub marks: Vec<Mark>,
}

/// A colour as SVG writes it.
fn hexadecimal([red, green, blue]: Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Text with what XML reserves written out.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

impl Drawing {
    /// The drawing as SVG.
    pub fn svg(&self) -> String {
        let (width, height) = (self.width, self.height);
        // Thirteen pixels make characters of a monospaced face about eight wide; `textLength` makes them so in any.
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             font-family=\"Noto Sans Mono, DejaVu Sans Mono, Menlo, Consolas, monospace\" font-size=\"13\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        );
        for mark in &self.marks {
            // Writing to a string cannot fail.
            let _ = match mark {
                Mark::Line {
                    through,
                    colour,
                    width,
                    dashed,
                } => {
                    let points: Vec<String> = through
                        .iter()
                        .map(|[x, y]| format!("{x:.1},{y:.1}"))
                        .collect();
                    writeln!(
                        svg,
                        "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\"{}/>",
                        points.join(" "),
                        hexadecimal(*colour),
                        if *dashed {
                            " stroke-dasharray=\"6 4\""
                        } else {
                            ""
                        }
                    )
                }
                Mark::Disc {
                    at: [x, y],
                    radius,
                    colour,
                    filled,
                } => writeln!(
                    svg,
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"1.5\"/>",
                    if *filled {
                        hexadecimal(*colour)
                    } else {
                        "white".to_owned()
                    },
                    hexadecimal(*colour)
                ),
                Mark::Text {
                    at: [x, y],
                    anchor,
                    colour,
                    upward,
                    text,
                } => {
                    let anchor = match anchor {
                        Anchor::Start => "start",
                        Anchor::Middle => "middle",
                        Anchor::End => "end",
                    };
                    let turn = if *upward {
                        format!(" transform=\"rotate(-90 {x:.1} {y:.1})\"")
                    } else {
                        String::new()
                    };
                    writeln!(
                        svg,
                        "<text x=\"{x:.1}\" y=\"{y:.1}\" dominant-baseline=\"central\" text-anchor=\"{anchor}\" textLength=\"{}\" \
                         fill=\"{}\"{turn}>{}</text>",
                        text_width(text),
                        hexadecimal(*colour),
                        escaped(text)
                    )
                }
            };
        }
        svg.push_str("</svg>\n");
        svg
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing(marks: Vec<Mark>) -> Drawing {
        Drawing {
            width: 60.0,
            height: 40.0,
            marks,
        }
    }

    /// Text, lines and discs leave ink where they are placed, text as much as it is wide, and what XML reserves is written out.
    #[test]
    fn both_pictures_hold_every_mark() {
        let text = Mark::Text {
            at: [30.0, 20.0],
            anchor: Anchor::Middle,
            colour: [0; 3],
            upward: false,
            text: "a<Å&".to_owned(),
        };
        let disc = Mark::Disc {
            at: [50.0, 8.0],
            radius: 4.0,
            colour: [200, 0, 0],
            filled: true,
        };
        let drawing = drawing(vec![text, disc]);
        assert!(drawing.svg().contains(">a&lt;Å&amp;</text>"));
        let png = drawing.png().unwrap();
        let pixmap = tiny_skia::Pixmap::decode_png(&png).unwrap();
        assert_eq!([pixmap.width(), pixmap.height()], [120, 80]);
        let ink = |x: u32, y: u32| pixmap.pixel(x, y).unwrap().green() < 128;
        let text_columns: Vec<u32> = (0..120).filter(|&x| (28..52).any(|y| ink(x, y))).collect();
        let (first, last) = (text_columns[0], text_columns[text_columns.len() - 1]);
        assert!(
            first >= 28 && last < 92 && last - first > 48,
            "{first} {last}"
        );
        assert!(ink(100, 16) && !ink(5, 5));
    }

    #[test]
    fn a_drawing_without_extent_is_no_picture() {
        let nothing = Drawing {
            width: 0.0,
            ..drawing(Vec::new())
        };
        assert!(nothing.png().is_none());
    }
}
