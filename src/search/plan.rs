//! Plan of a search.

use crate::options::{DockOptions, EngineChoice};
use crate::pose_space::PoseSpace;
use crate::pose_space::rotations::RotationSample;
use crate::search::allowed::{Allowed, SearchRestraints};
use knotdock_scoring::engine::Plan;
use std::sync::Arc;

/// Plan of a search: its space, its device and the number of its peaks.
#[derive(Clone, Debug)]
pub struct SearchPlan {
    /// Grid, modes and terms of the correlations.
    pub engine: Arc<Plan>,
    /// The poses that are searched.
    pub space: PoseSpace,
    /// Translations that distance restraints and a membrane allow; `None` without any.
    pub(crate) allowed: Option<Allowed>,
    /// The rotations that are sampled.
    pub rotations: RotationSample,
    /// Share of the finer set that is searched.
    pub fine_share: f64,
    /// Peaks kept of each rotation.
    pub per_rotation: usize,
    /// Peaks kept over all rotations.
    pub kept: usize,
    /// Number of rotations after which a search stops that repeats one within a time; `None`: after the last.
    pub stop_after: Option<usize>,
    /// Rotations in flight at once.
    pub in_flight: usize,
    /// The device that correlates.
    pub device: EngineChoice,
    /// Bytes of the graphics processor's memory that rotations in flight may take; 0 on the CPU.
    pub graphics_bytes: u64,
}

impl SearchPlan {
    /// A search by the options and the restraints, with the number of rotations in flight and the bytes of graphics memory.
    pub fn new(
        engine: Arc<Plan>,
        space: PoseSpace,
        options: &DockOptions,
        restraints: SearchRestraints,
        (in_flight, graphics_bytes): (usize, u64),
    ) -> Self {
        let counts = (options.search.rotations, options.search.fine_rotations);
        let rotations = space.rotations(&engine, counts);
        let step = space.step(rotations.covering_radius);
        Self {
            allowed: Allowed::new(restraints, &engine, step),
            rotations,
            engine,
            space,
            fine_share: options.search.fine_share,
            per_rotation: options.search.per_rotation,
            kept: options.search.poses,
            stop_after: options.stopped.map(|stopped| stopped.rotations),
            in_flight,
            device: options.engine(),
            graphics_bytes,
        }
    }

    /// Largest rotation of the ligand in radians between a pose and the nearest sampled one.
    pub fn rotation_step(&self) -> f64 {
        self.space.step(self.rotations.covering_radius)
    }
}
