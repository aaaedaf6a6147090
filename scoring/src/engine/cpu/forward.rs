//! The turned ligand's transform.

use super::{COLUMNS, CpuEngine, Workspace};
use crate::engine::packed::{LANES, Packet, packets_of_half};
use crate::transform::Real;
use nalgebra::UnitQuaternion;

impl<T: Real> CpuEngine<T> {
    #[inline(always)]
    pub(super) fn spread(&self, rotation: &UnitQuaternion<f64>, work: &mut Workspace<T>) {
        let matrix = (self.plan.frame() * rotation).to_rotation_matrix();
        for (point, y) in work.points.iter_mut().zip(&self.ligand) {
            *point = (matrix * y).into();
        }
        self.forward
            .spread(&work.points, &self.weights, &mut work.forward);
    }

    /// Forward along x, column by column: completes a component of the ligand's transform.
    #[inline(always)]
    pub(super) fn columns(&self, component: usize, work: &mut Workspace<T>) {
        let modes = self.plan.modes();
        let mx = self.forward.line_length();
        let rank = self.rank();
        for start in (0..modes.columns.len()).step_by(COLUMNS) {
            let end = (start + COLUMNS).min(modes.columns.len());
            self.forward
                .columns(start..end, &mut work.forward, &mut work.lines[LANES..]);
            for (index, column) in modes.columns[start..end].iter().enumerate() {
                let turned = &mut work.turned[self.packing.range(start + index, rank)];
                let (up, down) = turned.split_at_mut(packets_of_half(column) * rank);
                let zero = LANES + index * mx;
                let own = up[component..].iter_mut().step_by(rank);
                for (packet, values) in own.zip(work.lines[zero..].chunks_exact(LANES)) {
                    if let Ok(values) = values.try_into() {
                        *packet = Packet::of(values);
                    }
                }
                // Place mx is that of kx = 0 again: the next line's first value stands there.
                let own = down[component..].iter_mut().step_by(rank);
                let falling = work.lines[..=zero + mx].rchunks_exact(LANES);
                for (packet, values) in own.zip(falling) {
                    if let Ok(values) = values.try_into() {
                        *packet = Packet::reversed(values);
                    }
                }
                down[component].set(0, work.lines[zero]);
            }
        }
    }
}
