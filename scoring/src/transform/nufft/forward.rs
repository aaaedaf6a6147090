//! Points to modes: spreading and the transforms of the fine grid, plane by plane.

use super::super::Real;
use super::{FIRST_GROUP, GROUP, Plan, SortedPoints, Workspace, place};
use num_complex::Complex;

impl<T: Real, const D: usize> Plan<T, D> {
    #[inline(always)]
    pub(super) fn run_forward(
        &self,
        points: &SortedPoints<D>,
        weights: &[Complex<T>],
        work: &mut Workspace<T, D>,
        output: &mut [Complex<T>],
    ) {
        let fine = self.grid.fine[0];
        let waiting = self.grid.widths[0];
        if std::mem::take(&mut work.used) {
            work.ring.fill(T::zero());
        }
        let mut done = waiting;
        for slab in 0..points.slabs.len().saturating_sub(1) {
            let range = points.slabs[slab]..points.slabs[slab + 1];
            if !range.is_empty() {
                self.spread_by_width(points, range, weights, work);
            }
            let complete = ((slab + 1) * self.grid.slab).min(fine);
            for plane in done..complete {
                self.plane_to_modes(plane, work);
            }
            done = done.max(complete);
        }
        for plane in 0..waiting {
            self.plane_to_modes(plane, work);
        }
        self.first_axis_to_modes(work, output);
    }

    /// Transforms a finished plane along its own axes into `middle`, and clears it.
    #[inline(always)]
    fn plane_to_modes(&self, plane: usize, work: &mut Workspace<T, D>) {
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
        let kept: usize = modes[1..].iter().product();
        let output = &mut middle[plane * kept..(plane + 1) * kept];
        let [current, next] = planes;
        let rows = *size / *row;
        let length = fine[1];
        let mut empty = true;
        let source = &mut ring[slots[plane]..slots[plane] + *size];
        for (group, values) in source.chunks_mut(GROUP * *row).enumerate() {
            let count = values.len() / *row;
            let mut vacant = true;
            for (line, values) in lines
                .chunks_exact_mut(length)
                .zip(values.chunks_exact_mut(*row))
            {
                vacant &= gather(values, line);
                values.fill(T::zero());
            }
            let lines = &mut lines[..count * length];
            if !vacant {
                self.to_modes[1].process_with_scratch(lines, scratch);
                empty = false;
            }
            for (index, &factor) in self.factors[1].iter().enumerate() {
                let from = place(index, modes[1], length);
                let start = index * rows + group * GROUP;
                for (line, target) in current[start..start + count].iter_mut().enumerate() {
                    *target = lines[line * length + from].scale(factor);
                }
            }
        }
        if empty {
            output.fill(zero);
            return;
        }
        let mut kept = modes[1];
        let mut rest = rows;
        for axis in 2..D {
            let length = fine[axis];
            rest /= length;
            let values = &mut current[..kept * rest * length];
            let target = if axis + 1 == D {
                &mut *output
            } else {
                &mut next[..kept * modes[axis] * rest]
            };
            if rest == 1 {
                self.contiguous_to_modes(axis, values, target, scratch);
            } else {
                self.strided_to_modes(axis, rest, values, target, scratch);
            }
            kept *= modes[axis];
            std::mem::swap(current, next);
        }
    }

    /// Transforms lines along an axis into modes that lie side by side.
    #[inline(always)]
    fn contiguous_to_modes(
        &self,
        axis: usize,
        values: &mut [Complex<T>],
        target: &mut [Complex<T>],
        scratch: &mut [Complex<T>],
    ) {
        let (length, modes) = (self.grid.fine[axis], self.modes[axis]);
        let blocks = values
            .chunks_mut(GROUP * length)
            .zip(target.chunks_mut(GROUP * modes));
        for (lines, targets) in blocks {
            self.to_modes[axis].process_with_scratch(lines, scratch);
            for (line, target) in lines
                .chunks_exact(length)
                .zip(targets.chunks_exact_mut(modes))
            {
                let half = modes / 2;
                let (negative, positive) = target.split_at_mut(half);
                let (low, high) = self.factors[axis].split_at(half);
                for ((target, value), factor) in
                    negative.iter_mut().zip(&line[length - half..]).zip(low)
                {
                    *target = value.scale(*factor);
                }
                for ((target, value), factor) in positive.iter_mut().zip(line).zip(high) {
                    *target = value.scale(*factor);
                }
            }
        }
    }

    /// Transforms lines along an axis into modes `rest` values apart, the axes that remain between them.
    #[inline(always)]
    fn strided_to_modes(
        &self,
        axis: usize,
        rest: usize,
        values: &mut [Complex<T>],
        target: &mut [Complex<T>],
        scratch: &mut [Complex<T>],
    ) {
        let (length, modes) = (self.grid.fine[axis], self.modes[axis]);
        let blocks = values
            .chunks_exact_mut(rest * length)
            .zip(target.chunks_exact_mut(rest * modes));
        for (values, target) in blocks {
            for (group, lines) in values.chunks_mut(GROUP * length).enumerate() {
                self.to_modes[axis].process_with_scratch(lines, scratch);
                let count = lines.len() / length;
                for (index, &factor) in self.factors[axis].iter().enumerate() {
                    let from = place(index, modes, length);
                    let start = index * rest + group * GROUP;
                    for (line, target) in target[start..start + count].iter_mut().enumerate() {
                        *target = lines[line * length + from].scale(factor);
                    }
                }
            }
        }
    }

    /// Transforms `middle` along the first axis into `output`.
    #[inline(always)]
    fn first_axis_to_modes(&self, work: &mut Workspace<T, D>, output: &mut [Complex<T>]) {
        let (length, modes) = (self.grid.fine[0], self.modes[0]);
        let Workspace {
            middle,
            lines,
            scratch,
            ..
        } = work;
        let rest = middle.len() / length;
        for start in (0..rest).step_by(FIRST_GROUP) {
            let count = FIRST_GROUP.min(rest - start);
            for (index, plane) in middle.chunks_exact(rest).enumerate() {
                for (line, value) in plane[start..start + count].iter().enumerate() {
                    lines[line * length + index] = *value;
                }
            }
            let lines = &mut lines[..count * length];
            self.to_modes[0].process_with_scratch(lines, scratch);
            for (index, &factor) in self.factors[0].iter().enumerate() {
                let from = place(index, modes, length);
                let target = &mut output[index * rest + start..][..count];
                for (line, target) in target.iter_mut().enumerate() {
                    *target = lines[line * length + from].scale(factor);
                }
            }
        }
    }
}

/// Copies a row, its padding wrapped around the period, into a line; returns whether all of it is zero.
#[inline(always)]
fn gather<T: Real>(values: &[T], line: &mut [Complex<T>]) -> bool {
    let length = line.len();
    let mut vacant = true;
    let (body, tail) = values.split_at(2 * length);
    let number = |value: &[T]| Complex::new(value[0], value[1]);
    for (target, value) in line.iter_mut().zip(body.chunks_exact(2)) {
        *target = number(value);
        vacant &= target.re == T::zero() && target.im == T::zero();
    }
    // A short axis may be narrower than the lanes of a window, which then hold zeros.
    for (value, index) in tail.chunks_exact(2).zip((0..length).cycle()) {
        let value = number(value);
        line[index] = line[index] + value;
        vacant &= value.re == T::zero() && value.im == T::zero();
    }
    vacant
}
