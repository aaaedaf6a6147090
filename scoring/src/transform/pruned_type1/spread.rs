//! Spreading: knots onto the block of the fine grid that they occupy.

use super::{Forward, ForwardWorkspace};
use crate::transform::Real;
use crate::transform::spreading::MAX_WIDTH;

impl<T: Real> Forward<T> {
    /// Spreads knots onto the block: `points` in Å relative to the block's centre, `weights` as `[knot][component]`.
    ///
    /// Knots farther from the centre than the planned extent are not allowed (debug builds panic).
    #[inline(always)]
    pub fn spread(&self, points: &[[f64; 3]], weights: &[T], work: &mut ForwardWorkspace<T>) {
        work.block.fill(T::zero());
        if self.kernel.width() <= 4 {
            self.spread_lanes::<4>(points, weights, work);
        } else if self.kernel.width() <= 8 {
            self.spread_lanes::<8>(points, weights, work);
        } else {
            self.spread_lanes::<MAX_WIDTH>(points, weights, work);
        }
    }

    #[inline(always)]
    fn spread_lanes<const LANES: usize>(
        &self,
        points: &[[f64; 3]],
        weights: &[T],
        work: &mut ForwardWorkspace<T>,
    ) {
        let width = self.kernel.width();
        let [bx, by, bz] = self.block;
        let stride = bz + MAX_WIDTH;
        let center = self.center();
        let scale = self.cells_per_length();
        let mut values = [[T::zero(); MAX_WIDTH]; 3];
        for (point, weights) in points.iter().zip(weights.chunks_exact(self.components)) {
            let mut first = [0usize; 3];
            for axis in 0..3 {
                let u = point[axis] * scale[axis] + center[axis];
                let start = self.kernel.place(u, &mut values[axis]);
                debug_assert!(start >= 0 && start as usize + width <= self.block[axis]);
                first[axis] = start.max(0) as usize;
            }
            let mut z_values = [T::zero(); LANES];
            z_values.copy_from_slice(&values[2][..LANES]);
            for (component, &weight) in weights.iter().enumerate() {
                for (ix, &vx) in values[0][..width].iter().enumerate() {
                    let scaled = weight * vx;
                    let plane = (component * bx + first[0] + ix) * by;
                    for (iy, &vy) in values[1][..width].iter().enumerate() {
                        let value = scaled * vy;
                        let start = (plane + first[1] + iy) * stride + first[2];
                        let Some(row) = work.block.get_mut(start..start + LANES) else {
                            debug_assert!(false, "a window beyond the block");
                            continue;
                        };
                        for lane in 0..LANES {
                            row[lane] += value * z_values[lane];
                        }
                    }
                }
            }
        }
    }
}
