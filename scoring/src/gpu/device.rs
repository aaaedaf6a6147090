//! The graphics processor that is used, and its errors.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;
use thiserror::Error;

/// Names part of an adapter's name, in any case, where several are there (as in other programs that use wgpu).
pub const ADAPTER_VARIABLE: &str = "WGPU_ADAPTER_NAME";

/// Time that a batch may take before the device is given up.
const PATIENCE: Duration = Duration::from_secs(120);

/// Why the correlation cannot run on a graphics processor.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum GpuError {
    /// No adapter, or none of the requested name.
    #[error("no graphics processor{}: the system's Vulkan, Metal or Direct3D 12 driver shows {}", of(.wanted), joined(.found))]
    NoAdapter {
        /// Value of [`ADAPTER_VARIABLE`].
        wanted: Option<String>,
        /// Names of the adapters there are.
        found: Vec<String>,
    },
    /// The plan asks for more than the adapter has.
    #[error("{adapter} is too small: {what}")]
    TooSmall {
        /// The adapter's name.
        adapter: String,
        /// The missing feature or limit.
        what: String,
    },
    /// Numbers that no computation takes.
    #[error("{0}")]
    Input(String),
    /// The driver reported an error.
    #[error("{adapter}: {message}")]
    Driver {
        /// The adapter's name.
        adapter: String,
        /// Message of the driver.
        message: String,
    },
}

fn of(wanted: &Option<String>) -> String {
    wanted
        .as_ref()
        .map_or_else(String::new, |name| format!(" named like \"{name}\""))
}

fn joined(found: &[String]) -> String {
    if found.is_empty() {
        "none".into()
    } else {
        found.join(", ")
    }
}

/// An opened graphics processor.
#[derive(Clone)]
pub struct GpuDevice {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    /// Bytes that one buffer may have.
    pub(crate) binding_limit: usize,
    info: wgpu::AdapterInfo,
    /// Whether shaders test each index.
    is_checked: bool,
    /// The first error since they were last asked for.
    failure: Arc<Mutex<Option<String>>>,
    /// Why the device is lost, if it is.
    lost: Arc<OnceLock<String>>,
}

impl GpuDevice {
    /// Opens the adapter that `wanted` names (part of its name, in any case), else the first of the best kind.
    ///
    /// A discrete card comes before one within the processor, and software rendering last.
    ///
    /// # Errors
    /// [`GpuError`] where none is there or it cannot be opened.
    pub fn open(wanted: Option<&str>) -> Result<Self, GpuError> {
        Self::open_as(wanted, false)
    }

    /// As [`Self::open`], with no more than every adapter has: buffers of 128 MiB, 16 KiB of workgroup memory, no
    /// feature; and every index in a shader is tested. For checks.
    ///
    /// # Errors
    /// [`GpuError`] where none is there or it cannot be opened.
    #[doc(hidden)]
    pub fn open_least(wanted: Option<&str>) -> Result<Self, GpuError> {
        Self::open_as(wanted, true)
    }

    fn open_as(wanted: Option<&str>, least: bool) -> Result<Self, GpuError> {
        let instance =
            wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let backends = wgpu::Backends::PRIMARY;
        let mut adapters = pollster::block_on(instance.enumerate_adapters(backends));
        let found: Vec<String> = adapters.iter().map(|one| one.get_info().name).collect();
        adapters.sort_by_key(|one| kind_order(one.get_info().device_type));
        let wanted = wanted.map(str::to_lowercase);
        let fits = |name: &str| {
            let named = |part: &String| name.to_lowercase().contains(part);
            wanted.as_ref().is_none_or(named)
        };
        let adapter = adapters
            .into_iter()
            .find(|one| fits(&one.get_info().name))
            .ok_or(GpuError::NoAdapter { wanted, found })?;
        let info = adapter.get_info();
        let request = adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("knotdock"),
            required_limits: if least {
                wgpu::Limits::default()
            } else {
                adapter.limits()
            },
            ..Default::default()
        });
        let (device, queue) = pollster::block_on(request).map_err(|error| GpuError::Driver {
            adapter: info.name.clone(),
            message: error.to_string(),
        })?;
        let failure = Arc::new(Mutex::new(None));
        let noted = Arc::clone(&failure);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            note(&noted, error.to_string());
        }));
        let lost = Arc::new(OnceLock::new());
        let noted = Arc::clone(&lost);
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                // The first reason stands.
                let _ = noted.set(message);
            }
        });
        let limits = device.limits();
        let longest = (limits.max_buffer_size).min(limits.max_storage_buffer_binding_size);
        Ok(Self {
            binding_limit: usize::try_from(longest).unwrap_or(usize::MAX),
            device,
            queue,
            info,
            is_checked: least,
            failure,
            lost,
        })
    }

    /// Compiles a shader. Sizes in it must be those of its buffers.
    pub(super) fn shader(&self, name: &str, source: &str) -> wgpu::ShaderModule {
        let descriptor = wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        };
        if self.is_checked {
            return self.device.create_shader_module(descriptor);
        }
        // SAFETY: shaders here index by sizes that also made their buffers, their loops end by the same sizes, and no
        // divisor is zero. Tests run all of them with the checks on, to the same results.
        unsafe {
            self.device
                .create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked())
        }
    }

    /// The device with buffers of at most `bytes`, for tests of computations that divide theirs.
    #[doc(hidden)]
    pub fn with_buffers_of(&self, bytes: usize) -> Self {
        Self {
            binding_limit: bytes.min(self.binding_limit),
            ..self.clone()
        }
    }

    /// The adapter's name.
    pub fn name(&self) -> &str {
        &self.info.name
    }

    /// The interface that it is driven through, such as `vulkan`.
    pub fn backend(&self) -> &'static str {
        self.info.backend.to_str()
    }

    /// Whether it is a program on the processor that plays a graphics card: right, and slow.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// Waits until a submission is done, or all are.
    pub(crate) fn wait(
        &self,
        submission: impl Into<Option<wgpu::SubmissionIndex>>,
    ) -> Result<(), GpuError> {
        let waited = self.device.poll(wgpu::PollType::Wait {
            submission_index: submission.into(),
            timeout: Some(PATIENCE),
        });
        self.check()?;
        match waited {
            Ok(_) => Ok(()),
            Err(error) => Err(self.driver(error.to_string())),
        }
    }

    /// Fails if the device has reported an error since the last time, or is lost.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        let failure = self
            .failure
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        match failure.as_ref().or(self.lost.get()) {
            Some(message) => Err(self.driver(message.clone())),
            None => Ok(()),
        }
    }

    /// Refuses numbers that are not finite, or beyond those whose squares single precision holds.
    pub(crate) fn finite<const N: usize>(
        &self,
        what: &str,
        all: &[[f64; N]],
    ) -> Result<(), GpuError> {
        let finite = |one: &[f64; N]| one.iter().all(|part| part.abs() <= 1e18);
        match all.iter().position(|one| !finite(one)) {
            None => Ok(()),
            Some(index) => Err(GpuError::Input(format!(
                "{what} {index} is not finite, or larger than 1e18: {:?}",
                all[index]
            ))),
        }
    }

    pub(crate) fn driver(&self, message: String) -> GpuError {
        GpuError::Driver {
            adapter: self.info.name.clone(),
            message,
        }
    }

    pub(crate) fn too_small(&self, what: String) -> GpuError {
        GpuError::TooSmall {
            adapter: self.info.name.clone(),
            what,
        }
    }
}

fn kind_order(kind: wgpu::DeviceType) -> u8 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

/// Keeps the first message.
fn note(failure: &Mutex<Option<String>>, message: String) {
    failure
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .get_or_insert(message);
}
