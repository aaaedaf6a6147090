//! Modes to values at points: the passes of `forward` backwards, each transposed.

use super::super::Real;
use super::super::spreading::MAX_WIDTH;
use super::{FIRST_GROUP, GROUP, Plan, SortedPoints, Workspace, place};
use num_complex::Complex;

impl<T: Real, const D: usize> Plan<T, D> {
    #[inline(always)]
    pub(super) fn run_adjoint(
        &self,
        points: &SortedPoints<D>,
        modes: &[Complex<T>],
        work: &mut Workspace<T, D>,
        values: &mut [Complex<T>],
    ) {
        if points.is_empty() {
            return;
        }
        work.used = true;
        let fine = self.grid.fine[0];
        let waiting = self.grid.widths[0];
        self.first_axis_to_grid(modes, work);
        for plane in 0..waiting {
            self.plane_to_grid(plane, work);
        }
        let mut done = waiting;
        for slab in 0..points.slabs.len().saturating_sub(1) {
            let needed = ((slab + 1) * self.grid.slab + waiting).min(fine);
            for plane in done..needed {
                self.plane_to_grid(plane, work);
            }
            done = done.max(needed);
            let range = points.slabs[slab]..points.slabs[slab + 1];
            if range.is_empty() {
                continue;
            }
            let Workspace {
                slots,
                footprint,
                ring,
                row,
                ..
            } = work;
            macro_rules! with_lanes {
                ($($lanes:literal)*) => {
                    match self.window.width.next_multiple_of(2) {
                        $($lanes => self.interpolate::<$lanes, { 2 * $lanes }>(points, range, slots, *row, footprint, ring, values),)*
                        _ => unreachable!("a plan's windows are 2 to {MAX_WIDTH} points wide"),
                    }
                };
            }
            with_lanes!(2 4 6 8 10 12 14 16);
        }
    }

    /// Transforms modes along the first axis into `middle`.
    #[inline(always)]
    fn first_axis_to_grid(&self, input: &[Complex<T>], work: &mut Workspace<T, D>) {
        let (length, modes) = (self.grid.fine[0], self.modes[0]);
        let Workspace {
            middle,
            lines,
            scratch,
            ..
        } = work;
        let zero = Complex::new(T::zero(), T::zero());
        let rest = middle.len() / length;
        for start in (0..rest).step_by(FIRST_GROUP) {
            let count = FIRST_GROUP.min(rest - start);
            let lines = &mut lines[..count * length];
            lines.fill(zero);
            for (index, &factor) in self.factors[0].iter().enumerate() {
                let to = place(index, modes, length);
                let source = &input[index * rest + start..][..count];
                for (line, value) in source.iter().enumerate() {
                    lines[line * length + to] = value.scale(factor);
                }
            }
            self.to_grid[0].process_with_scratch(lines, scratch);
            for (index, plane) in middle.chunks_exact_mut(rest).enumerate() {
                for (line, value) in plane[start..start + count].iter_mut().enumerate() {
                    *value = lines[line * length + index];
                }
            }
        }
    }

    /// Transforms a plane of `middle` along its own axes into its slot of the ring.
    #[inline(always)]
    fn plane_to_grid(&self, plane: usize, work: &mut Workspace<T, D>) {
        let (fine, modes) = (&self.grid.fine, &self.modes);
        let Workspace {
            ring,
            slots,
            row,
            plane: size,
            planes,
            middle,
            lines,
            scratch,
            ..
        } = work;
        let zero = Complex::new(T::zero(), T::zero());
        let mut kept: usize = modes[1..].iter().product();
        let input = &middle[plane * kept..(plane + 1) * kept];
        let [current, next] = planes;
        let mut rest = 1;
        for axis in (2..D).rev() {
            let length = fine[axis];
            let source = if axis + 1 == D {
                input
            } else {
                &current[..kept * rest]
            };
            let target = &mut next[..kept / modes[axis] * rest * length];
            let blocks = source
                .chunks_exact(modes[axis] * rest)
                .zip(target.chunks_exact_mut(rest * length));
            for (source, target) in blocks {
                for (group, lines) in target.chunks_mut(GROUP * length).enumerate() {
                    lines.fill(zero);
                    let count = lines.len() / length;
                    for (index, &factor) in self.factors[axis].iter().enumerate() {
                        let to = place(index, modes[axis], length);
                        let start = index * rest + group * GROUP;
                        for (line, value) in source[start..start + count].iter().enumerate() {
                            lines[line * length + to] = value.scale(factor);
                        }
                    }
                    self.to_grid[axis].process_with_scratch(lines, scratch);
                }
            }
            kept /= modes[axis];
            rest *= length;
            std::mem::swap(current, next);
        }
        let length = fine[1];
        let target = &mut ring[slots[plane]..slots[plane] + *size];
        for (group, rows) in target.chunks_mut(GROUP * *row).enumerate() {
            let count = rows.len() / *row;
            let lines = &mut lines[..count * length];
            lines.fill(zero);
            for (index, &factor) in self.factors[1].iter().enumerate() {
                let to = place(index, modes[1], length);
                let start = index * rest + group * GROUP;
                for (line, value) in current[start..start + count].iter().enumerate() {
                    lines[line * length + to] = value.scale(factor);
                }
            }
            self.to_grid[1].process_with_scratch(lines, scratch);
            for (line, row) in lines.chunks_exact(length).zip(rows.chunks_exact_mut(*row)) {
                // The padding repeats the row's beginning.
                for (value, target) in line.iter().cycle().zip(row.chunks_exact_mut(2)) {
                    target[0] = value.re;
                    target[1] = value.im;
                }
            }
        }
    }
}
