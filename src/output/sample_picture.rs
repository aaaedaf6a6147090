//! A picture of a sampled solid (SVG): the depth and the skeletal density on a slice, the slice of the balls, and the balls
//! from outside.
//!
//! The slice is the plane through the middle of the solid across the shortest edge of its bounding box.

use std::fmt::Write;
use std::path::Path;

use knotdock_structures::mesh::Solid;
use knotdock_structures::sampling::Ball;
use knotdock_structures::sampling::grid::ON_SURFACE;
use knotdock_structures::sampling::skeletal_density::share;
use rayon::prelude::*;

use super::whole_file::{FileError, write_whole};

/// Pixels along the longer edge of a slice.
const PIXELS: usize = 72;

/// Edge of a panel in the picture, in SVG units.
const PANEL: f64 = 360.0;

/// Balls shown from outside at most: the largest.
const SHOWN: usize = 3000;

/// Writes the picture of `balls` (in the solid's unit) beside the fields of `solid`.
///
/// # Errors
/// [`FileError`] when the file cannot be made or written.
pub fn write_picture(solid: &Solid, balls: &[Ball], path: &Path) -> Result<(), FileError> {
    let text = picture(solid, balls);
    write_whole(path, |file| file.write_all(text.as_bytes()))
}

/// Across, up and toward the viewer: axes of the picture.
fn axes(solid: &Solid) -> [usize; 3] {
    let half = solid.half_sides();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| half[b].total_cmp(&half[a]));
    let toward = order[2];
    [(toward + 1) % 3, (toward + 2) % 3, toward]
}

fn picture(solid: &Solid, balls: &[Ball]) -> String {
    let [across, up, toward] = axes(solid);
    let half = solid.half_sides();
    let reach = half[across].max(half[up]) * 1.1;
    let scale = PANEL / (2.0 * reach);
    let place = |value: f64| PANEL / 2.0 + scale * value;
    let mut svg = String::new();
    let width = 4.0 * PANEL;
    // Writing to a string cannot fail.
    let _ = writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {}\" font-family=\"sans-serif\" font-size=\"14\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>",
        PANEL + 24.0
    );
    let panel = |svg: &mut String, index: usize, title: &str, content: &str| {
        let _ = writeln!(
            svg,
            "<g transform=\"translate({} 0)\"><text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{title}</text>\n{content}</g>",
            index as f64 * PANEL,
            PANEL / 2.0,
            PANEL + 16.0
        );
    };

    let step = 2.0 * reach / PIXELS as f64;
    let fields: Vec<(f64, f64)> = (0..PIXELS * PIXELS)
        .into_par_iter()
        .map(|pixel| {
            let mut point = [0.0; 3];
            point[across] = -reach + step * ((pixel % PIXELS) as f64 + 0.5);
            point[up] = -reach + step * ((pixel / PIXELS) as f64 + 0.5);
            let depth = match solid.depth(point) {
                depth if depth.abs() < ON_SURFACE => 0.0,
                depth => depth,
            };
            let density = if depth > 0.0 {
                share(solid, point, depth)
            } else {
                0.0
            };
            (depth, density)
        })
        .collect();
    let deepest = fields
        .iter()
        .map(|(depth, _)| depth.abs())
        .fold(0.0, f64::max);
    let densest = fields
        .iter()
        .map(|(_, density)| *density)
        .fold(0.0, f64::max);
    let depth = pixels(&fields, |(depth, _)| {
        let share = (depth.abs() / deepest).sqrt();
        let fade = |full: f64| (255.0 - share * (255.0 - full)) as u8;
        Some(if *depth > 0.0 {
            [fade(190.0), fade(60.0), fade(20.0)]
        } else {
            [fade(40.0), fade(90.0), fade(170.0)]
        })
    });
    panel(&mut svg, 0, "depth: inside red, outside blue", &depth);
    let density = pixels(&fields, |(depth, density)| {
        let share = density / densest;
        (*depth > 0.0).then_some([
            (255.0 * share.sqrt()) as u8,
            (235.0 * share) as u8,
            (60.0 + 120.0 * (1.0 - share)) as u8,
        ])
    });
    panel(
        &mut svg,
        1,
        "skeletal density: the brighter the more",
        &density,
    );

    let mut slice = String::new();
    for ball in balls {
        let off = ball.center[toward];
        let squared = ball.radius * ball.radius - off * off;
        if squared > 0.0 {
            let _ = writeln!(
                slice,
                "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{:.2}\" fill=\"#d06020\" fill-opacity=\"0.12\" stroke=\"#a04010\" stroke-width=\"0.5\"/>",
                place(ball.center[across]),
                PANEL - place(ball.center[up]),
                scale * squared.sqrt()
            );
        }
    }
    slice += &outline(solid, [across, up, toward], place);
    panel(&mut svg, 2, "slice of the balls, and of the mesh", &slice);

    let mut shown: Vec<&Ball> = balls.iter().collect();
    shown.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    shown.truncate(SHOWN);
    shown.sort_by(|a, b| (a.center[toward] + a.radius).total_cmp(&(b.center[toward] + b.radius)));
    let mut view = String::from(
        "<defs><radialGradient id=\"ball\" cx=\"35%\" cy=\"30%\"><stop offset=\"0\" stop-color=\"#fff4e0\"/>\
         <stop offset=\"1\" stop-color=\"#b06030\"/></radialGradient></defs>\n",
    );
    for ball in shown {
        let _ = writeln!(
            view,
            "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{:.2}\" fill=\"url(#ball)\" stroke=\"#703010\" stroke-width=\"0.2\"/>",
            place(ball.center[across]),
            PANEL - place(ball.center[up]),
            scale * ball.radius
        );
    }
    let title = if balls.len() > SHOWN {
        format!("the {SHOWN} largest of {} balls", balls.len())
    } else {
        format!("{} balls", balls.len())
    };
    panel(&mut svg, 3, &title, &view);
    svg + "</svg>\n"
}

/// A field as rows of rectangles, those of one colour side by side made one.
fn pixels(fields: &[(f64, f64)], color: impl Fn(&(f64, f64)) -> Option<[u8; 3]>) -> String {
    let size = PANEL / PIXELS as f64;
    let mut text = String::from("<g shape-rendering=\"crispEdges\">\n");
    for (row, fields) in fields.chunks(PIXELS).enumerate() {
        // Fewer shades make longer runs and a smaller file.
        let shades: Vec<Option<[u8; 3]>> = fields
            .iter()
            .map(|field| color(field).map(|shade| shade.map(|part| part / 12 * 12)))
            .collect();
        let mut from = 0;
        for run in shades.chunk_by(|a, b| a == b) {
            if let Some(Some([r, g, b])) = run.first() {
                let _ = writeln!(
                    text,
                    "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{size:.2}\" fill=\"#{r:02x}{g:02x}{b:02x}\"/>",
                    from as f64 * size,
                    PANEL - (row + 1) as f64 * size,
                    run.len() as f64 * size
                );
            }
            from += run.len();
        }
    }
    text + "</g>\n"
}

/// The segments in which the mesh meets the slice.
fn outline(solid: &Solid, [across, up, toward]: [usize; 3], place: impl Fn(f64) -> f64) -> String {
    let mut path = String::from("<path fill=\"none\" stroke=\"black\" stroke-width=\"1\" d=\"");
    let mesh = solid.mesh();
    for triangle in mesh.triangles() {
        let corners = triangle.map(|corner| mesh.positions()[corner as usize]);
        let mut ends = Vec::new();
        for side in 0..3 {
            let (a, b) = (corners[side], corners[(side + 1) % 3]);
            if (a[toward] > 0.0) != (b[toward] > 0.0) {
                let share = a[toward] / (a[toward] - b[toward]);
                ends.push([across, up].map(|axis| a[axis] + share * (b[axis] - a[axis])));
            }
        }
        if let [[x1, y1], [x2, y2]] = ends[..] {
            let _ = write!(
                path,
                "M{:.2} {:.2}L{:.2} {:.2}",
                place(x1),
                PANEL - place(y1),
                place(x2),
                PANEL - place(y2)
            );
        }
    }
    path + "\"/>\n"
}
