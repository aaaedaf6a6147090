//! A drawing of lines, markers and text, written as SVG or rasterised as PNG.
//!
//! Both come from one list of marks, so that the two pictures agree. Text is set in a monospaced face whose characters are all
//! [`CHARACTER`] wide: the space that a label takes is known without asking a font, the SVG needs none but the reader's own, and
//! the PNG carries characters rasterised beforehand (Noto Sans Mono).

use std::fmt::Write;

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use tiny_skia::{
    Color, FillRule, Paint, Path, PathBuilder, Pixmap, PremultipliedColorU8, Rect, Stroke,
    StrokeDash, Transform,
};

/// Width in pixels that a character takes at the size of labels.
pub const CHARACTER: f64 = 8.0;
/// Height in pixels of a line of labels.
pub const LINE: f64 = 16.0;
/// Pixels of the PNG for each pixel of the drawing.
const SCALE: f32 = 2.0;

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

    /// The drawing as a PNG file; `None` for a drawing too large or small to be one.
    pub fn png(&self) -> Option<Vec<u8>> {
        let size = [self.width, self.height].map(|side| (side * f64::from(SCALE)).ceil() as u32);
        let mut pixmap = Pixmap::new(size[0], size[1])?;
        pixmap.fill(Color::WHITE);
        for mark in &self.marks {
            rasterise(mark, &mut pixmap);
        }
        pixmap.encode_png().ok()
    }
}

fn paint([red, green, blue]: Colour) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, 255);
    paint
}

/// Draws a mark. What has no extent leaves no trace.
fn rasterise(mark: &Mark, pixmap: &mut Pixmap) {
    let scaled = Transform::from_scale(SCALE, SCALE);
    match mark {
        Mark::Line {
            through,
            colour,
            width,
            dashed,
        } => {
            let mut builder = PathBuilder::new();
            for (index, [x, y]) in through.iter().enumerate() {
                if index == 0 {
                    builder.move_to(*x as f32, *y as f32);
                } else {
                    builder.line_to(*x as f32, *y as f32);
                }
            }
            let stroke = Stroke {
                width: *width as f32,
                dash: dashed
                    .then(|| StrokeDash::new(vec![6.0, 4.0], 0.0))
                    .flatten(),
                ..Stroke::default()
            };
            if let Some(path) = builder.finish() {
                pixmap.stroke_path(&path, &paint(*colour), &stroke, scaled, None);
            }
        }
        Mark::Disc {
            at: [x, y],
            radius,
            colour,
            filled,
        } => {
            let inside = if *filled { *colour } else { [255; 3] };
            let stroke = Stroke {
                width: 1.5,
                ..Stroke::default()
            };
            if let Some(path) = circle(*x as f32, *y as f32, *radius as f32) {
                pixmap.fill_path(&path, &paint(inside), FillRule::Winding, scaled, None);
                pixmap.stroke_path(&path, &paint(*colour), &stroke, scaled, None);
            }
        }
        Mark::Text {
            at,
            anchor,
            colour,
            upward,
            text,
        } => write_text(text, *at, *anchor, *colour, *upward, pixmap),
    }
}

fn circle(x: f32, y: f32, radius: f32) -> Option<Path> {
    let bounds = Rect::from_xywh(x - radius, y - radius, 2.0 * radius, 2.0 * radius)?;
    PathBuilder::from_oval(bounds)
}

/// Sets a text, character by character, at the pixels of the PNG.
fn write_text(
    text: &str,
    at: [f64; 2],
    anchor: Anchor,
    colour: Colour,
    upward: bool,
    pixmap: &mut Pixmap,
) {
    // Characters of a height of 32 pixels are 14 wide or so on the PNG, in the 16 that two pixels of the drawing's 8 give them.
    const SIZE: RasterHeight = RasterHeight::Size32;
    let advance = (CHARACTER * f64::from(SCALE)) as i64;
    let gap = (advance - get_raster_width(FontWeight::Regular, SIZE) as i64) / 2;
    let width = advance * text.chars().count() as i64;
    let before = match anchor {
        Anchor::Start => 0,
        Anchor::Middle => width / 2,
        Anchor::End => width,
    };
    let [x, y] = at.map(|place| (place * f64::from(SCALE)).round() as i64);
    for (index, character) in text.chars().enumerate() {
        let Some(raster) = get_raster(character, FontWeight::Regular, SIZE)
            .or_else(|| get_raster('?', FontWeight::Regular, SIZE))
        else {
            continue;
        };
        for (row, line) in raster.rows().enumerate() {
            for (column, &cover) in line.iter().enumerate() {
                // Along the text and across it.
                let along = index as i64 * advance + gap + column as i64 - before;
                let across = row as i64 - SIZE.val() as i64 / 2;
                let pixel = if upward {
                    [x + across, y - along]
                } else {
                    [x + along, y + across]
                };
                blend(pixmap, pixel, colour, cover);
            }
        }
    }
}

/// Lays a colour over a pixel, by how much of the pixel it covers (255: all). Pixels outside are left out.
fn blend(pixmap: &mut Pixmap, [x, y]: [i64; 2], colour: Colour, cover: u8) {
    let (width, height) = (i64::from(pixmap.width()), i64::from(pixmap.height()));
    if !(0..width).contains(&x) || !(0..height).contains(&y) {
        return;
    }
    let index = (y * width + x) as usize;
    if let Some(pixel) = pixmap.pixels_mut().get_mut(index) {
        let mixed = |over: u8, under: u8| {
            let cover = u32::from(cover);
            ((u32::from(over) * cover + u32::from(under) * (255 - cover)) / 255) as u8
        };
        let [red, green, blue] = colour;
        // The ground is opaque, so that premultiplied colours are plain ones.
        if let Some(mix) = PremultipliedColorU8::from_rgba(
            mixed(red, pixel.red()),
            mixed(green, pixel.green()),
            mixed(blue, pixel.blue()),
            255,
        ) {
            *pixel = mix;
        }
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
        let pixmap = Pixmap::decode_png(&png).unwrap();
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
