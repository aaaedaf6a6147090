//! One rotation, prepared: its spectrum, and the value and force at any translation.

use super::columns::{Harmonic, Layout};
use super::{Frame, Workspace};
use crate::vectorized::vectorized;
use nalgebra::{UnitQuaternion, Vector3};
use std::sync::Arc;

/// The spectrum of one rotation.
#[derive(Clone, Debug)]
pub struct Prepared {
    layout: Arc<Layout>,
    frame: Frame,
    rotation: UnitQuaternion<f64>,
    values: Vec<Harmonic>,
}

impl Prepared {
    pub(super) fn new(
        layout: Arc<Layout>,
        frame: Frame,
        rotation: UnitQuaternion<f64>,
        values: Vec<Harmonic>,
    ) -> Self {
        Self {
            layout,
            frame,
            rotation,
            values,
        }
    }

    /// Modes in use, conjugates counted.
    pub fn modes(&self) -> usize {
        self.layout.modes
    }

    /// The rotation.
    pub fn rotation(&self) -> &UnitQuaternion<f64> {
        &self.rotation
    }

    /// |G^(w; R)| / volume of every mode of the plan's set, 0 for those not in use: what [`crate::transform::truncation::Tail`] and
    /// [`crate::transform::truncation::Selection::by_magnitude`] take. `count` is the number of modes in the set.
    pub fn magnitudes(&self, count: usize) -> Vec<f64> {
        self.layout.magnitudes(&self.values, count)
    }

    /// Value at a pose of this rotation with translation `translation` (Å, as in [`crate::se3::Pose`]), and its gradient per Å. O(modes).
    pub fn gradient(
        &self,
        translation: &Vector3<f64>,
        work: &mut Workspace,
    ) -> (f64, Vector3<f64>) {
        match self.frame.position(&self.rotation, translation) {
            Some(position) => vectorized(
                #[inline(always)]
                || work.place.sum(&self.layout, &self.values, &position),
            ),
            None => Default::default(),
        }
    }
}
