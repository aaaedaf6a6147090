//! Plan of a search: what it covers, where it runs and what it keeps.

use crate::options::{DockOptions, EngineChoice};
use crate::pose_space::PoseSpace;
use crate::pose_space::rotations::RotationSample;
use crate::search::allowed::{Allowed, Known};
use knotdock_scoring::engine::Plan;
use std::sync::Arc;

/// Plan of a search: what it covers, where it runs and what it keeps.
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
    /// What correlates.
    pub device: EngineChoice,
    /// Bytes of the graphics processor's memory that rotations in flight may take; 0 on the CPU.
    pub graphics_bytes: u64,
}

impl SearchPlan {
    /// A search by the options and what is known of the translations, with so many
    /// rotations in flight and so much graphics memory.
    pub fn new(
        engine: Arc<Plan>,
        space: PoseSpace,
        options: &DockOptions,
        known: Known,
        (in_flight, graphics_bytes): (usize, u64),
    ) -> Self {
        let rotations = space.rotations(
            &engine,
            (options.search.rotations, options.search.fine_rotations),
        );
        let step = space.step(rotations.covering_radius);
        Self {
            allowed: Allowed::new(known, &engine, step),
            rotations,
            engine,
            space,
            fine_share: options.search.fine_share,
            per_rotation: options.search.per_rotation,
            kept: options.search.poses,
            stop_after: options.stopped.map(|stopped| stopped.rotations),
            in_flight,
            device: options.search.engine,
            graphics_bytes,
        }
    }

    /// Largest rotation of the ligand in radians between a pose and the nearest sampled one.
    pub fn rotation_step(&self) -> f64 {
        self.space.step(self.rotations.covering_radius)
    }
}
