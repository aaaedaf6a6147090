//! The correlation at one pose, without a grid: G(R, t) = sum_w G^(w; R) exp(2 pi i w.t) over m' chosen modes.
//!
//! The correlation is a trigonometric polynomial in t, so its value and gradient at any pose are sums over modes (B&I,
//! section 4.1, eq. 50, and the end of 4.2). There are two ways:
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
//! The polynomial repeats with the box. With the ligand's centre outside the box, whose edge no contact reaches, value
//! and gradient are zero.

mod components;
mod layout;
mod tables;

use crate::engine::{Plan, ReceptorSpectra};
use crate::rigid_move::PoseGradient;
use crate::se3::Pose;
use crate::transform::modes::ModeSet;
use crate::transform::truncation::Selection;
use crate::vectorized::vectorize;
use knotdock_structures::Knots;
use layout::{Harmonic, Layout};
use nalgebra::{UnitQuaternion, Vector3};
use num_complex::Complex64;
use std::sync::Arc;
use tables::{Block, GatherTables, PlaceTables, ReadTables};

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
    /// Takes the selected modes of a correlation, of any [`crate::quantity::Quantity`].
    pub fn new(
        plan: &Plan,
        spectra: &ReceptorSpectra,
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
        // The receptor is in the middle of its block, not at the origin: that phase is taken out once.
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
        vectorize!({
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
        })
    }

    /// The spectrum G^(w; R) of one rotation.
    pub fn prepare(
        &self,
        rotation: &UnitQuaternion<f64>,
        work: &mut Workspace,
    ) -> RotationSpectrum {
        let mut values = vec![[0.0; 4]; self.layout.harmonics.len()];
        vectorize!({
            work.gather.gather(
                &self.layout,
                &self.components,
                &self.blocks,
                &rotation.to_rotation_matrix(),
                &mut values,
            );
        });
        RotationSpectrum {
            layout: Arc::clone(&self.layout),
            frame: self.frame,
            rotation: *rotation,
            values,
        }
    }
}

/// Places of the two bodies.
#[derive(Clone, Copy, Debug)]
struct Frame {
    pub receptor_center: Vector3<f64>,
    pub ligand_center: Vector3<f64>,
    /// Half the box, Å.
    pub half: Vector3<f64>,
}

impl Frame {
    /// The ligand's centre relative to the receptor's, Å; `None` outside the box.
    pub fn position(
        &self,
        rotation: &UnitQuaternion<f64>,
        translation: &Vector3<f64>,
    ) -> Option<Vector3<f64>> {
        let position = rotation * self.ligand_center + translation - self.receptor_center;
        (0..3)
            .all(|axis| position[axis].abs() <= self.half[axis])
            .then_some(position)
    }
}

/// Tables of phases: one evaluation at a time, for any configuration of the same pair and no more modes.
#[derive(Clone, Debug)]
pub struct Workspace {
    read: ReadTables,
    place: PlaceTables,
    gather: GatherTables,
}

impl Workspace {
    fn new(layout: &Layout, blocks: usize) -> Self {
        Self {
            read: ReadTables::new(layout),
            place: PlaceTables::new(layout),
            gather: GatherTables::new(layout, blocks),
        }
    }
}

/// The spectrum of one rotation.
#[derive(Clone, Debug)]
pub struct RotationSpectrum {
    layout: Arc<Layout>,
    frame: Frame,
    rotation: UnitQuaternion<f64>,
    values: Vec<Harmonic>,
}

impl RotationSpectrum {
    /// A correlation whose spectrum is known from elsewhere, a grid for instance: `mode` gives G^(w) / volume by place
    /// in the set, and must be that of a real function. Both bodies have their centres at the origin and the rotation
    /// is none, so that a pose's translation is the place in the box at which the correlation is read.
    pub fn from_spectrum(
        modes: &ModeSet,
        selection: &Selection,
        mode: impl Fn(usize) -> Complex64,
    ) -> Self {
        let layout = Layout::new(modes, selection);
        Self {
            frame: Frame {
                receptor_center: Vector3::zeros(),
                ligand_center: Vector3::zeros(),
                half: Vector3::from(modes.lengths) * 0.5,
            },
            rotation: UnitQuaternion::identity(),
            values: layout.harmonics_of(1.0, mode),
            layout: Arc::new(layout),
        }
    }

    /// Buffers for [`Self::gradient`], where no `TruncatedCorrelation` has made them.
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
            Some(position) => vectorize!(work.place.sum(&self.layout, &self.values, &position)),
            None => Default::default(),
        }
    }
}
