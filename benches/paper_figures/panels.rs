//! Panels of balls, to one scale.

use knotdock_cli::plot::svg::Svg;
use knotdock_scoring::minkowski::Knot;

/// Edge of a panel, in SVG units; also the number of cells along it in which a ball has to be seen.
const PANEL: f64 = 330.0;
/// Height of a panel with its title.
const HEIGHT: f64 = PANEL + 24.0;
/// How a ball looks.
const SEEN: &str = "fill=\"url(#ball)\" stroke=\"#703010\" stroke-width=\"0.2\"";

/// Sets of balls with their titles as SVG, `columns` of them side by side. One scale serves all, so that sums look as
/// much larger as they are.
pub fn drawn(panels: &[(String, Vec<Knot>)], columns: usize) -> String {
    let reach = panels.iter().map(|(_, balls)| reach(balls));
    let scale = 0.5 * PANEL / reach.fold(0.0, f64::max);
    let rows = panels.len().div_ceil(columns);
    let mut svg = Svg::new(PANEL * columns as f64, HEIGHT * rows as f64);
    svg.ball_gradient("ball", "#fff4e0", "#b06030");
    for (index, (title, balls)) in panels.iter().enumerate() {
        let place = [index % columns, index / columns].map(|number| number as f64);
        svg.at([PANEL * place[0], HEIGHT * place[1]], |svg| {
            svg.text([PANEL / 2.0, PANEL + 16.0], title);
            svg.styled(SEEN, |svg| {
                for [x, y, _, radius] in seen(balls, scale) {
                    svg.circle([x, y], radius, "");
                }
            });
        });
    }
    svg.finish()
}

/// Farthest that balls reach from the origin along x or y.
fn reach(balls: &[Knot]) -> f64 {
    let of = |ball: &Knot| ball[0].abs().max(ball[1].abs()) + ball[3];
    balls.iter().map(of).fold(0.0, f64::max)
}

/// The balls that are seen from +z, in the panel's units, the nearest to the viewer last.
fn seen(balls: &[Knot], scale: f64) -> Vec<Knot> {
    let placed = |ball: &Knot| {
        let [x, y, z, radius] = ball.map(|length| scale * length);
        [PANEL / 2.0 + x, PANEL / 2.0 - y, z, radius]
    };
    let balls: Vec<Knot> = balls.iter().map(placed).collect();
    let cells = PANEL as usize;
    let mut nearest = vec![(f64::NEG_INFINITY, usize::MAX); cells * cells];
    for (index, [x, y, z, radius]) in balls.iter().copied().enumerate() {
        let range = |middle: f64| {
            let end = (middle + radius).ceil().clamp(0.0, PANEL) as usize;
            (middle - radius).floor().max(0.0) as usize..end
        };
        for row in range(y) {
            for column in range(x) {
                let [right, down] = [column as f64 + 0.5 - x, row as f64 + 0.5 - y];
                let square = radius * radius - right * right - down * down;
                let front = z + square.max(0.0).sqrt();
                if square > 0.0 && front > nearest[row * cells + column].0 {
                    nearest[row * cells + column] = (front, index);
                }
            }
        }
    }
    let mut seen: Vec<usize> = nearest.into_iter().map(|(_, index)| index).collect();
    seen.sort_unstable();
    seen.dedup();
    let mut seen: Vec<Knot> = seen.iter().filter_map(|&i| balls.get(i).copied()).collect();
    seen.sort_by(|a, b| (a[2] + a[3]).total_cmp(&(b[2] + b[3])));
    seen
}
