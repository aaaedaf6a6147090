//! A picture of a sampled solid (SVG): the depth and the skeletal density on a slice, the slice of the balls, and the
//! balls from outside.
//!
//! The slice is the plane through the middle of the solid across the shortest edge of its bounding box.

use std::path::Path;

use rayon::prelude::*;

use crate::plot::chart::Colour;
use crate::plot::svg::Svg;
use crate::solid_files::write_text;
use knotdock::geometry::bracket::{bounds, shifted};
use knotdock::geometry::obstacle::reduce::reduced;
use knotdock::output::files::whole_file::StagedFile;
use knotdock_structures::Error;
use knotdock_structures::mesh::Solid;
use knotdock_structures::sampling::Ball;
use knotdock_structures::sampling::grid::ON_SURFACE;
use knotdock_structures::sampling::skeletal_density::share;

/// Pixels along the longer edge of a slice.
const PIXELS: usize = 72;

/// Edge of a panel in the picture, in SVG units.
const PANEL: f64 = 360.0;

/// Balls shown from outside at most: the largest.
const SHOWN: usize = 3000;

/// How a ball looks that the slice meets, and one from outside.
const SLICED: &str =
    "fill=\"#d06020\" fill-opacity=\"0.12\" stroke=\"#a04010\" stroke-width=\"0.5\"";
const HELD: &str = "fill=\"#d8d8d8\"";
const SEEN: &str = "fill=\"url(#ball)\" stroke=\"#703010\" stroke-width=\"0.2\"";

/// Writes the picture of `balls` (in the solid's unit) beside the fields of `solid`.
pub fn write_picture(solid: &Solid, balls: &[Ball], path: &Path) -> Result<StagedFile, Error> {
    write_text(path, &picture(solid, balls))
}

/// Writes the picture of a solid between two sets of balls: the slices of both, and the outer balls from outside.
pub fn write_ball_picture(
    inner: &[Ball],
    outer: &[Ball],
    path: &Path,
) -> Result<StagedFile, Error> {
    let (low, high) = bounds(outer);
    let middle = [0, 1, 2].map(|axis| -0.5 * (low[axis] + high[axis]));
    let view = View::of_box([0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis])));
    let [inner, outer] = [inner, outer].map(|balls| {
        let balls = balls.iter().map(|ball| shifted(ball, middle));
        balls.collect::<Vec<Ball>>()
    });
    let mut svg = Svg::new(2.0 * PANEL, PANEL + 24.0);
    let title = "slice of outer balls (grey) and inner balls (orange)";
    panel(&mut svg, 0, title, |svg| {
        draw_slices(svg, &sliced(&outer, &view), &view, HELD);
        draw_slices(svg, &sliced(&inner, &view), &view, SLICED);
    });
    panel(&mut svg, 1, &shown_balls(outer.len()), |svg| {
        draw_balls(svg, &outer, &view)
    });
    write_text(path, &svg.finish())
}

/// The circles in which the slice meets balls, as balls on it, without those in another one.
fn sliced(balls: &[Ball], view: &View) -> Vec<Ball> {
    reduced(balls.iter().filter_map(|ball| {
        let mut center = ball.center;
        center[view.axes[2]] = 0.0;
        let radius = view.sliced_square(ball).max(0.0).sqrt();
        (radius > 0.0).then_some(Ball { center, radius })
    }))
}

/// The axes and the scale of the picture.
struct View {
    /// Across, up and toward the viewer.
    axes: [usize; 3],
    /// Half of a panel's edge, in the solid's unit.
    reach: f64,
    /// SVG units in the solid's unit.
    scale: f64,
}

impl View {
    /// The view of a box about the origin, across its shortest edge.
    fn of_box(half: [f64; 3]) -> Self {
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| half[b].total_cmp(&half[a]));
        let toward = order[2];
        let [across, up] = [(toward + 1) % 3, (toward + 2) % 3];
        let reach = half[across].max(half[up]) * 1.1;
        Self {
            axes: [across, up, toward],
            reach,
            scale: PANEL / (2.0 * reach),
        }
    }

    /// Place of a point, given across and up, in its panel.
    fn place(&self, [across, up]: [f64; 2]) -> [f64; 2] {
        let place = |value: f64| PANEL / 2.0 + self.scale * value;
        [place(across), PANEL - place(up)]
    }

    /// Squared radius of the circle in which the slice meets a ball; not above zero if it does not.
    fn sliced_square(&self, ball: &Ball) -> f64 {
        let off = ball.center[self.axes[2]];
        ball.radius * ball.radius - off * off
    }

    fn center(&self, ball: &Ball) -> [f64; 2] {
        let [across, up, _] = self.axes;
        self.place([ball.center[across], ball.center[up]])
    }
}

fn picture(solid: &Solid, balls: &[Ball]) -> String {
    let view = View::of_box(solid.half_sides());
    let fields = fields(solid, &view);
    let mut svg = Svg::new(4.0 * PANEL, PANEL + 24.0);
    panel(&mut svg, 0, "depth: inside red, outside blue", |svg| {
        draw_depth(svg, &fields);
    });
    let title = "skeletal density: the brighter the more";
    panel(&mut svg, 1, title, |svg| draw_density(svg, &fields));
    let title = "slice of the balls, and of the mesh";
    panel(&mut svg, 2, title, |svg| {
        draw_slice(svg, solid, balls, &view);
    });
    panel(&mut svg, 3, &shown_balls(balls.len()), |svg| {
        draw_balls(svg, balls, &view)
    });
    svg.finish()
}

/// Title of the balls shown from outside.
fn shown_balls(count: usize) -> String {
    if count > SHOWN {
        format!("the {SHOWN} largest of {count} balls")
    } else {
        format!("{count} balls")
    }
}

fn panel(svg: &mut Svg, index: usize, title: &str, content: impl FnOnce(&mut Svg)) {
    svg.at([index as f64 * PANEL, 0.0], |svg| {
        svg.text([PANEL / 2.0, PANEL + 16.0], title);
        content(svg);
    });
}

/// Depth and skeletal density at the pixels of the slice, row by row from the lowest.
fn fields(solid: &Solid, view: &View) -> Vec<(f64, f64)> {
    let [across, up, _] = view.axes;
    let reach = view.reach;
    let step = 2.0 * reach / PIXELS as f64;
    (0..PIXELS * PIXELS)
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
        .collect()
}

fn draw_depth(svg: &mut Svg, fields: &[(f64, f64)]) {
    let deepest = fields
        .iter()
        .map(|(depth, _)| depth.abs())
        .fold(0.0, f64::max);
    pixels(svg, fields, |(depth, _)| {
        let share = (depth.abs() / deepest).sqrt();
        let fade = |full: f64| (255.0 - share * (255.0 - full)) as u8;
        Some(if *depth > 0.0 {
            [fade(190.0), fade(60.0), fade(20.0)]
        } else {
            [fade(40.0), fade(90.0), fade(170.0)]
        })
    });
}

fn draw_density(svg: &mut Svg, fields: &[(f64, f64)]) {
    let densest = fields
        .iter()
        .map(|(_, density)| *density)
        .fold(0.0, f64::max);
    pixels(svg, fields, |(depth, density)| {
        let share = density / densest;
        (*depth > 0.0).then_some([
            (255.0 * share.sqrt()) as u8,
            (235.0 * share) as u8,
            (60.0 + 120.0 * (1.0 - share)) as u8,
        ])
    });
}

/// Draws the circles and the outline in which the slice meets balls and mesh.
fn draw_slice(svg: &mut Svg, solid: &Solid, balls: &[Ball], view: &View) {
    draw_slices(svg, balls, view, SLICED);
    let segments = outline(solid, view.axes);
    let placed = segments.map(|ends| ends.map(|end| view.place(end)));
    svg.segments(placed, "fill=\"none\" stroke=\"black\" stroke-width=\"1\"");
}

fn draw_slices(svg: &mut Svg, balls: &[Ball], view: &View, style: &str) {
    for ball in balls {
        let squared = view.sliced_square(ball);
        if squared > 0.0 {
            svg.circle(view.center(ball), view.scale * squared.sqrt(), style);
        }
    }
}

/// Draws the largest balls from outside, the nearest to the viewer last.
fn draw_balls(svg: &mut Svg, balls: &[Ball], view: &View) {
    let [.., toward] = view.axes;
    let mut shown: Vec<&Ball> = balls.iter().collect();
    shown.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    shown.truncate(SHOWN);
    shown.sort_by(|a, b| (a.center[toward] + a.radius).total_cmp(&(b.center[toward] + b.radius)));
    svg.ball_gradient("ball", "#fff4e0", "#b06030");
    for ball in &shown {
        svg.circle(view.center(ball), view.scale * ball.radius, SEEN);
    }
}

/// Draws a field, the row of the lowest points last.
fn pixels(svg: &mut Svg, fields: &[(f64, f64)], colour: impl Fn(&(f64, f64)) -> Option<Colour>) {
    // Fewer shades make longer runs and a smaller file.
    let shade = |field| colour(field).map(|shade| shade.map(|part| part / 12 * 12));
    let rows = fields.chunks(PIXELS).rev();
    let colours: Vec<Option<Colour>> = rows.flat_map(|row| row.iter().map(shade)).collect();
    svg.pixels(PANEL / PIXELS as f64, PIXELS, &colours);
}

/// The segments in which the mesh meets the slice, in the solid's unit across and up.
fn outline(solid: &Solid, [across, up, toward]: [usize; 3]) -> impl Iterator<Item = [[f64; 2]; 2]> {
    let mesh = solid.mesh();
    mesh.triangles().iter().filter_map(move |triangle| {
        let corners = triangle.map(|corner| mesh.positions()[corner as usize]);
        let mut ends = Vec::new();
        for side in 0..3 {
            let (a, b) = (corners[side], corners[(side + 1) % 3]);
            if (a[toward] > 0.0) != (b[toward] > 0.0) {
                let share = a[toward] / (a[toward] - b[toward]);
                ends.push([across, up].map(|axis| a[axis] + share * (b[axis] - a[axis])));
            }
        }
        ends.try_into().ok()
    })
}
