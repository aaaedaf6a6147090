//! Drawings as PNG: paths by tiny-skia, characters by rasters made beforehand (Noto Sans Mono).

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use tiny_skia::{
    Color, FillRule, Paint, Path, PathBuilder, Pixmap, PremultipliedColorU8, Rect, Stroke,
    StrokeDash, Transform,
};

use crate::tradeoff::drawing::{Anchor, CHARACTER, Colour, Drawing, Mark};

/// Pixels of the PNG for each pixel of the drawing.
const SCALE: f32 = 2.0;

impl Drawing {
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
