//! The upper part of Figure 7: a section through the gap function, its truncation to m' modes, and the error.

use crate::whole::Whole;
use knotdock_cli::plot::svg::Svg;

/// Panels show the whole function and these powers of two of modes.
const POWERS: [u32; 5] = [6, 8, 10, 12, 14];
/// Edge of a section, and the room about it.
const SIDE: f64 = 192.0;
const GAP: f64 = 12.0;
const ABOVE: f64 = 30.0;
/// Residuals are shown from this share of the peak on, by their logarithm.
const FAINTEST: f64 = 1e-5;

/// The picture, as SVG.
pub fn sections(whole: &Whole) -> String {
    let mut columns = vec![("all modes".to_owned(), whole.values().to_vec())];
    for (power, [dominant, _]) in whole.selections() {
        if POWERS.contains(&power) {
            columns.push((format!("m' = 2^{power}"), whole.truncated(&dominant)));
        }
    }
    let left = |column: usize| GAP + column as f64 * (SIDE + GAP);
    let mut svg = Svg::new(left(columns.len()), ABOVE + 2.0 * (SIDE + GAP));
    let n = whole.grid().per_axis;
    let mut paint = |corner: [f64; 2], shade: &dyn Fn(usize) -> f64| {
        // The plane z = 0, its origin in the middle, the row of the largest y first.
        let index = |pixel: usize| (pixel + n / 2) % n;
        let rows = (0..n)
            .rev()
            .flat_map(|row| (0..n).map(move |column| (row, column)));
        let colours: Vec<_> = rows
            .map(|(row, column)| {
                let light = 1.0 - shade((index(column) * n + index(row)) * n);
                Some([(255.0 * light.clamp(0.0, 1.0)) as u8; 3])
            })
            .collect();
        svg.at(corner, |svg| svg.pixels(SIDE / n as f64, n, &colours));
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
    for (column, (name, _)) in columns.iter().enumerate() {
        svg.text([left(column) + SIDE / 2.0, ABOVE / 2.0 + 5.0], name);
    }
    let words = ["below:", "|error| / peak,", "white 1e-5", "to black 1"];
    for (line, words) in words.iter().enumerate() {
        let y = ABOVE + SIDE + GAP + 55.0 + 22.0 * line as f64;
        svg.text([left(0) + SIDE / 2.0, y], words);
    }
    svg.finish()
}
