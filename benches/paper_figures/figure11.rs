//! Figure 11: the bunny's balls by the grid size m and the protrusion factor mu.

use crate::panels::drawn;
use crate::scene::bunny_balls;
use std::error::Error;

/// The picture, as SVG: a row for each mu, a column for each grid.
pub fn picture(per_axis: &[usize]) -> Result<String, Box<dyn Error>> {
    let mut panels = Vec::new();
    for mu in [0.25, 0.5, 1.0] {
        for &per_axis in per_axis {
            let balls = bunny_balls(per_axis, mu)?;
            let power = (per_axis as f64).log2() * 3.0;
            panels.push((
                format!("m = 2^{power}, mu = {mu}: {} balls", balls.radii.len()),
                balls.knots(),
            ));
        }
    }
    Ok(drawn(&panels, per_axis.len()))
}
