//! Engines of a run: the CPU's cores, or a graphics processor with an engine on the CPU beside it.

use crate::options::EngineChoice;
use crate::search::plan::SearchPlan;
use knotdock_scoring::engine::CpuEngine;
use knotdock_scoring::peaks::Peak;
use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use serde::Serialize;
use std::sync::OnceLock;

#[cfg(feature = "gpu")]
use knotdock_scoring::engine::gpu::GpuEngine;
#[cfg(feature = "gpu")]
use knotdock_scoring::gpu::{ADAPTER_VARIABLE, GpuDevice, GpuError};
#[cfg(feature = "gpu")]
use knotdock_scoring::peaks::NEIGHBOURS;

/// The graphics processor that correlated.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Adapter {
    /// Its name.
    pub name: String,
    /// The interface that it was driven through, such as `vulkan`.
    pub backend: &'static str,
    /// Whether it is a program on the CPU that plays one.
    pub software: bool,
    /// Rotations that were in flight at once, images counted.
    pub rotations_in_flight: usize,
}

/// Sets the runtime folder if the environment lacks it, as in many containers: without it graphics drivers, which search it
/// for a display, write `error: XDG_RUNTIME_DIR` on the terminal. None is needed.
///
/// To be called before the program has other threads.
pub fn name_runtime_folder() {
    #[cfg(target_os = "linux")]
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: the process has one thread, so that no other reads the environment meanwhile.
        unsafe {
            let folder = format!("/run/user/{}", libc::getuid());
            std::env::set_var("XDG_RUNTIME_DIR", folder);
        }
    }
}

/// The engines of a scan.
pub(crate) struct ScanEngine {
    /// Maps voxels to places, and scans without a graphics processor.
    pub cpu: CpuEngine,
    #[cfg(feature = "gpu")]
    pub gpu: Option<GpuEngine>,
    /// The graphics processor in use.
    adapter: Option<Adapter>,
    /// Why it is not in use, if it was to be taken if it could.
    failure: OnceLock<String>,
    /// Rotations in flight on the CPU: the plan's, or fewer if the engine needs more memory than was planned.
    pub in_flight: usize,
}

impl ScanEngine {
    /// The pose of a peak, as the grid has it.
    pub fn grid_pose(&self, plan: &SearchPlan, peak: &Peak) -> Pose {
        let (rotation, turn) = plan.rotations.rotation(peak.rotation as usize);
        let position = self.cpu.position_after(turn, peak.voxel as usize);
        let place = plan.engine.receptor_center() + position;
        Pose::about(rotation, plan.engine.ligand_center(), place)
    }
}

/// A graphics processor that cannot be used.
pub(super) fn no_graphics(error: impl std::fmt::Display) -> Error {
    Error::machine(format!("--engine gpu: {error}")).help(
        "dock with --engine cpu, or see docs/method/engines.md for what a graphics processor needs",
    )
}

impl ScanEngine {
    /// The engines of a plan.
    pub fn new(plan: &SearchPlan, cpu: CpuEngine) -> Result<Self, Error> {
        let mut engine = Self {
            cpu,
            #[cfg(feature = "gpu")]
            gpu: None,
            adapter: None,
            failure: OnceLock::new(),
            in_flight: plan.in_flight,
        };
        match plan.device {
            EngineChoice::Cpu => {}
            EngineChoice::Gpu => engine.open_gpu(plan).map_err(no_graphics)?,
            EngineChoice::Auto => engine
                .open_gpu(plan)
                .unwrap_or_else(|error| engine.leave_card(&error)),
        }
        Ok(engine)
    }

    /// The graphics processor that correlated all, if one did.
    pub fn adapter(&self) -> Option<Adapter> {
        match self.failure.get() {
            None => self.adapter.clone(),
            Some(_) => None,
        }
    }

    /// Why a graphics processor that was to be taken if it could was not.
    pub fn failure(&self) -> Option<String> {
        self.failure.get().cloned()
    }

    /// Goes on without the graphics processor.
    pub fn leave_card(&self, error: &impl std::fmt::Display) {
        // The first reason stands.
        let _ = self.failure.set(error.to_string());
    }

    #[cfg(feature = "gpu")]
    fn open_gpu(&mut self, plan: &SearchPlan) -> Result<(), GpuError> {
        let name = std::env::var(ADAPTER_VARIABLE).ok();
        let name = name.filter(|name| !name.is_empty());
        let is_chosen = plan.device == EngineChoice::Gpu || name.is_some();
        let device = match GpuDevice::open(name.as_deref()) {
            Err(GpuError::NoAdapter { .. }) if !is_chosen => return Ok(()),
            device => device?,
        };
        if device.is_software() && !is_chosen {
            return Ok(());
        }
        let (count, bytes) = (plan.per_rotation, plan.graphics_bytes);
        let gpu = GpuEngine::new(&device, &self.cpu, count, NEIGHBOURS, bytes);
        let gpu = gpu?;
        self.adapter = Some(Adapter {
            name: device.name().to_owned(),
            backend: device.backend(),
            software: device.is_software(),
            rotations_in_flight: gpu.in_flight(),
        });
        self.gpu = Some(gpu);
        Ok(())
    }

    #[cfg(not(feature = "gpu"))]
    fn open_gpu(&mut self, _: &SearchPlan) -> Result<(), &'static str> {
        Err("this build was made without the feature `gpu`")
    }
}
