//! One rotation, prepared: its spectrum, and the value and force at any translation.

use super::columns::{Harmonic, Layout};
use super::frame::Frame;
use super::workspace::Workspace;
use crate::transform::modes::ModeSet;
use crate::transform::truncation::Selection;
use crate::vectorized::vectorized;
use nalgebra::{UnitQuaternion, Vector3};
use num_complex::Complex64;
use std::sync::Arc;

/// The spectrum of one rotation.
#[derive(Clone, Debug)]
pub struct RotationSpectrum {
    layout: Arc<Layout>,
    frame: Frame,
    rotation: UnitQuaternion<f64>,
    values: Vec<Harmonic>,
}

impl RotationSpectrum {
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

    /// A correlation whose spectrum is known from elsewhere, a grid for instance: `mode` gives G^(w) / volume by place
    /// in the set, and must be that of a real function. Both bodies have their centres at the origin and the rotation
    /// is none, so that a pose's translation is the place in the box at which the correlation is read.
    pub fn from_spectrum(
        modes: &ModeSet,
        selection: &Selection,
        mode: impl Fn(usize) -> Complex64,
    ) -> Self {
        let layout = Layout::new(modes, selection);
        let values = layout.harmonics_of(1.0, mode);
        let frame = Frame {
            receptor_center: Vector3::zeros(),
            ligand_center: Vector3::zeros(),
            half: Vector3::from(modes.lengths) * 0.5,
        };
        Self::new(Arc::new(layout), frame, UnitQuaternion::identity(), values)
    }

    /// Buffers for [`Self::gradient`], where no [`super::TruncatedCorrelation`] has made them.
    pub fn workspace(&self) -> Workspace {
        Workspace::new(&self.layout, 0)
    }

    /// Modes in use, conjugates counted.
    pub fn modes(&self) -> usize {
        self.layout.modes
    }

    /// The rotation.
    pub fn rotation(&self) -> &UnitQuaternion<f64> {
        &self.rotation
    }

    /// |G^(w; R)| / volume of every mode of the plan's set, 0 for those not in use: what [`crate::transform::truncation::rms_left_out`]
    /// and [`crate::transform::truncation::Selection::by_magnitude`] take. `count` is the number of modes in the set.
    pub fn magnitudes(&self, count: usize) -> Vec<f64> {
        self.layout.magnitudes(&self.values, count)
    }

    /// Value at a pose of this rotation with translation `translation` (Å, as in [`crate::se3::Pose`]), and its
    /// gradient per Å. O(modes).
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
