//! Cells of a grid that single balls hold, by which most balls of a sum are left out before they are stored.
//!
//! Most balls of a sum are deep inside the union, but few in a single other ball. A ball that meets none but held cells
//! changes no complement within the grid's cube: each of these cells is in a ball that is kept.

use knotdock_structures::sampling::Ball;
use knotdock_structures::sampling::grid::Grid;

/// The cells about the nodes of a grid, a bit each.
pub struct HeldCells {
    grid: Grid,
    /// Words per row along x.
    words: usize,
    held: Vec<u64>,
}

impl HeldCells {
    /// None is held yet.
    pub fn new(grid: Grid) -> Self {
        let words = grid.per_axis().div_ceil(64);
        Self {
            held: vec![0; grid.per_axis() * grid.per_axis() * words],
            grid,
            words,
        }
    }

    /// Whether a ball, relative to the middle of the grid, meets a cell that is not held yet; then the cells in it are
    /// held from now on.
    pub fn takes(&mut self, ball: &Ball) -> bool {
        let reach = self.grid.epsilon() * (1.0 + 1e-9);
        let meets = self.any_row(ball.center, ball.radius + reach, |row, from, to| {
            let held = (from / 64..to.div_ceil(64)).all(|word| {
                let wanted = mask(from, to, word);
                row.get(word).is_some_and(|bits| bits & wanted == wanted)
            });
            !held
        });
        // Rounding leaves in doubt what is on the sphere, which may not count as held.
        let within = (ball.radius - reach) * (1.0 - 1e-9);
        if meets && within > 0.0 {
            self.any_row(ball.center, within, |row, from, to| {
                for word in from / 64..to.div_ceil(64) {
                    if let Some(bits) = row.get_mut(word) {
                        *bits |= mask(from, to, word);
                    }
                }
                false
            });
        }
        meets
    }

    /// Visits the row of nodes within `radius` of a point at each y and z, until `visit` answers yes: its bits, the
    /// first node along x and the one after the last.
    fn any_row(
        &mut self,
        center: [f64; 3],
        radius: f64,
        mut visit: impl FnMut(&mut [u64], usize, usize) -> bool,
    ) -> bool {
        let (grid, words) = (self.grid, self.words);
        let h = grid.spacing();
        let range = |axis: usize, radius: f64| {
            let number = |place: f64| (place + grid.half()) / h;
            let first = number(center[axis] - radius).ceil().max(0.0) as usize;
            let last = number(center[axis] + radius).floor();
            let end = if last < 0.0 { 0 } else { last as usize + 1 };
            first..end.min(grid.per_axis())
        };
        for z in range(2, radius) {
            let dz = grid.coordinate(z) - center[2];
            for y in range(1, radius) {
                let dy = grid.coordinate(y) - center[1];
                let left = radius * radius - dy * dy - dz * dz;
                if left < 0.0 {
                    continue;
                }
                let nodes = range(0, left.sqrt());
                let first = (z * grid.per_axis() + y) * words;
                if let Some(row) = self.held.get_mut(first..first + words)
                    && !nodes.is_empty()
                    && visit(row, nodes.start, nodes.end)
                {
                    return true;
                }
            }
        }
        false
    }
}

/// The bits of a word that stand for the numbers `from` to before `to`.
fn mask(from: usize, to: usize, word: usize) -> u64 {
    let low = from.saturating_sub(64 * word).min(64);
    let high = to.saturating_sub(64 * word).min(64);
    let below = |count: usize| {
        if count >= 64 {
            u64::MAX
        } else {
            (1 << count) - 1
        }
    };
    below(high) & !below(low)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Balls left out meet only cells that are in one of the balls taken.
    #[test]
    fn balls_left_out_add_nothing() {
        let grid = Grid::of_edge(2.0, 70);
        let mut cells = HeldCells::new(grid);
        let (mut taken, mut left) = (Vec::new(), Vec::new());
        for i in 1..3000u32 {
            let part = |step: f64| (f64::from(i) * step).fract();
            let ball = Ball {
                center: [0.8191, 0.671, 0.5497].map(|step| 2.4 * part(step) - 1.2),
                radius: 0.6 / f64::from(i).sqrt() + 0.05,
            };
            match cells.takes(&ball) {
                true => taken.push(ball),
                false => left.push(ball),
            }
        }
        assert!(
            left.len() > 500 && taken.len() > 100,
            "{} {}",
            left.len(),
            taken.len()
        );
        for ball in &left {
            for number in 0..200 {
                let z = 1.0 - (2.0 * f64::from(number) + 1.0) / 200.0;
                let angle = 2.399_963_229_728_653 * f64::from(number);
                let across = (1.0 - z * z).sqrt();
                let unit = [across * angle.cos(), across * angle.sin(), z];
                let point = [0, 1, 2].map(|axis| ball.center[axis] + ball.radius * unit[axis]);
                let is_in = |other: &Ball| {
                    let square = (0..3).map(|k| (other.center[k] - point[k]).powi(2));
                    square.sum::<f64>() <= other.radius * other.radius
                };
                let inside_cube = point.iter().all(|part| part.abs() <= 1.0);
                assert!(!inside_cube || taken.iter().any(is_in), "{point:?}");
            }
        }
    }
}
