//! The correlation at one pose, without a grid: G(R, t) = sum_w G^(w; R) exp(2 pi i w.t) over m' chosen modes.
//!
//! The correlation is a trigonometric polynomial in t, so its value and gradient at any pose are sums over modes. B&I:
//! section 4.1, eq. 50 for collision, the end of 4.2 for the score, Fig. 9 for times. There are two ways:
//!
//! - [`TruncatedCorrelation::prepare`] sums the ligand's knots into the spectrum of one rotation. Each translation then
//!   costs O(m') by [`RotationSpectrum::gradient`], with the force.
//! - [`TruncatedCorrelation::gradient`] takes a pose with a new rotation: every knot reads the receptor's components
//!   and their slopes, which gives force and torque together, O(m' x ligand knots).
//!
//! # Conventions
//!
//! A pose takes a ligand knot at y to R y + t in the receptor's file frame; force per Å, torque per radian about the
//! ligand's centre. Modes are counted with their conjugates, and the lifted axis is summed over. All sums run in f64.
//! The polynomial repeats with the box. Where the ligand's centre lies outside the box, whose edge no contact reaches,
//! value and gradient are zero.

mod columns;
mod components;
mod frame;
mod gather;
mod knots;
mod place;
mod read;
mod rotation_spectrum;
mod workspace;

pub use rotation_spectrum::RotationSpectrum;
pub use workspace::Workspace;

use crate::engine::Plan;
use crate::engine::ReceptorSpectra;
use crate::rigid_move::PoseGradient;
use crate::se3::Pose;
use crate::transform::Real;
use crate::transform::truncation::Selection;
use crate::vectorized::vectorized;
use columns::{Harmonic, Layout};
use frame::Frame;
use knotdock_structures::Knots;
use knots::Block;
use nalgebra::{UnitQuaternion, Vector3};
use std::sync::Arc;

/// One pair of knot sets at chosen modes, ready for one pose at a time.
pub struct TruncatedCorrelation {
    layout: Arc<Layout>,
    frame: Frame,
    /// The receptor's components that knots read: E and O of each kept mode, over the volume.
    components: Vec<Vec<Harmonic>>,
    /// The ligand's knots by the component that they read.
    blocks: Vec<Block>,
}

impl TruncatedCorrelation {
    /// Takes the selected modes of a correlation ([`crate::quantity::Quantity`] says of what: score, slice or
    /// sensitivity).
    pub fn new<T: Real>(
        plan: &Plan,
        spectra: &ReceptorSpectra<T>,
        ligand: &Knots,
        selection: &Selection,
    ) -> Self {
        assert_eq!(
            plan.frame(),
            UnitQuaternion::identity(),
            "a plan along the axes of the file is needed"
        );
        let layout = Layout::new(plan.modes(), selection);
        let components = components::of(plan, spectra, ligand.len());
        let volume = plan.modes().volume();
        // The receptor lies in the middle of its block, not at the origin: that phase is taken out once.
        let turns = components::centering(plan, spectra);
        let values = components
            .iter()
            .map(|component| {
                layout.harmonics_of(1.0 / volume, |place| {
                    component.mode(spectra, place) * turns(place)
                })
            })
            .collect();
        let blocks = components
            .iter()
            .enumerate()
            .flat_map(|(index, component)| {
                Block::of(index, &component.knots, ligand, plan.ligand_center())
            })
            .collect();
        Self {
            frame: Frame {
                receptor_center: plan.receptor_center(),
                ligand_center: plan.ligand_center(),
                half: Vector3::from(plan.modes().lengths) * 0.5,
            },
            layout: Arc::new(layout),
            components: values,
            blocks,
        }
    }

    /// Modes in use, conjugates counted.
    pub fn modes(&self) -> usize {
        self.layout.modes
    }

    /// Buffers; nothing else is allocated by [`Self::gradient`] and [`RotationSpectrum::gradient`].
    pub fn workspace(&self) -> Workspace {
        Workspace::new(&self.layout, self.blocks.len())
    }

    /// Value and gradient at a pose: force per Å, torque per radian about the ligand's centre.
    pub fn gradient(&self, pose: &Pose, work: &mut Workspace) -> (f64, PoseGradient) {
        let Some(center) = self.frame.position(&pose.rotation, &pose.translation) else {
            return Default::default();
        };
        vectorized(
            #[inline(always)]
            || {
                let rotation = pose.rotation.to_rotation_matrix();
                let mut score = 0.0;
                let mut gradient = PoseGradient::default();
                for block in &self.blocks {
                    let arms = block.turned(&rotation);
                    let values = &self.components[block.component];
                    let read = work.read.read(&self.layout, values, &arms, &center);
                    block.gather(&read, &arms, &mut score, &mut gradient);
                }
                (score, gradient)
            },
        )
    }

    /// The spectrum G^(w; R) of one rotation.
    pub fn prepare(
        &self,
        rotation: &UnitQuaternion<f64>,
        work: &mut Workspace,
    ) -> RotationSpectrum {
        let mut values = vec![[0.0; 4]; self.layout.harmonics.len()];
        vectorized(
            #[inline(always)]
            || {
                work.gather.gather(
                    &self.layout,
                    &self.components,
                    &self.blocks,
                    &rotation.to_rotation_matrix(),
                    &mut values,
                );
            },
        );
        RotationSpectrum::new(Arc::clone(&self.layout), self.frame, *rotation, values)
    }
}
