//! The upper part of Figure 7: a section through the gap function, what m' modes make of it, and what they miss.

use crate::whole::Whole;
use knotdock::tradeoff::drawing::{Anchor, Drawing, Mark};
use std::error::Error;
use tiny_skia::{Pixmap, PremultipliedColorU8};

/// Panels show the whole function and these powers of two of modes.
const POWERS: [u32; 5] = [6, 8, 10, 12, 14];
/// Edge of a section, and the room about it, in pixels of a drawing.
const SIDE: usize = 192;
const GAP: usize = 12;
const ABOVE: usize = 30;
/// Pixels of the PNG for each of a drawing.
const SCALE: usize = 2;
/// Residuals are shown from this share of the peak on, by their logarithm.
const FAINTEST: f64 = 1e-5;

/// The picture, as a PNG.
///
/// # Errors
/// Where the PNG cannot be coded.
pub fn sections(whole: &Whole) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut columns = vec![("all modes".to_owned(), whole.values().to_vec())];
    for (power, [dominant, _]) in whole.selections() {
        if POWERS.contains(&power) {
            columns.push((format!("m' = 2^{power}"), whole.truncated(&dominant)));
        }
    }
    let text = |at: [f64; 2], text: &str| Mark::Text {
        at,
        anchor: Anchor::Middle,
        colour: [0x22; 3],
        upward: false,
        text: text.to_owned(),
    };
    let left = |column: usize| GAP + column * (SIDE + GAP);
    let middle = |column: usize| (left(column) + SIDE / 2) as f64;
    let mut marks: Vec<Mark> = columns
        .iter()
        .enumerate()
        .map(|(column, (name, _))| text([middle(column), ABOVE as f64 / 2.0], name))
        .collect();
    for (line, words) in ["below:", "|error| / peak,", "white 1e-5", "to black 1"]
        .iter()
        .enumerate()
    {
        let y = ABOVE + SIDE + GAP + 50 + 22 * line;
        marks.push(text([middle(0), y as f64], words));
    }
    let drawing = Drawing {
        width: left(columns.len()) as f64,
        height: (ABOVE + 2 * (SIDE + GAP)) as f64,
        marks,
    };
    let mut pixmap = Pixmap::decode_png(&drawing.png().ok_or("no picture")?)?;
    let mut paint = |corner: [usize; 2], shade: &dyn Fn(usize) -> f64| {
        let n = whole.grid().per_axis;
        let (side, width) = (SCALE * SIDE, pixmap.width() as usize);
        for row in 0..side {
            for column in 0..side {
                // The plane z = 0, its origin in the middle.
                let index = |pixel: usize| (pixel * n / side + n / 2) % n;
                let light = 1.0 - shade((index(column) * n + index(side - 1 - row)) * n);
                let grey = (255.0 * light.clamp(0.0, 1.0)) as u8;
                let at = (SCALE * corner[1] + row) * width + SCALE * corner[0] + column;
                if let Some(colour) = PremultipliedColorU8::from_rgba(grey, grey, grey, 255) {
                    pixmap.pixels_mut()[at] = colour;
                }
            }
        }
    };
    for (column, (_, values)) in columns.iter().enumerate() {
        // A root shows the faint surroundings of the peak; what falls below zero is ripple and is shown as such.
        paint([left(column), ABOVE], &|point| {
            (values[point].abs() / whole.peak()).sqrt()
        });
        if column > 0 {
            paint([left(column), ABOVE + SIDE + GAP], &|point| {
                let error = (values[point] - whole.values()[point]).abs() / whole.peak();
                1.0 - error.max(FAINTEST).ln() / FAINTEST.ln()
            });
        }
    }
    Ok(pixmap.encode_png()?)
}
