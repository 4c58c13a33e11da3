//! Opening an adapter and a device as the command line and the tests do. A host program brings its
//! own.
//!
//! ```no_run
//! use skiagraph_gpu::device::{self, Wanted};
//!
//! for adapter in device::adapters() {
//!     println!("{} on {}", adapter.name, adapter.backend);
//! }
//! let wanted = Wanted { adapter: Some("llvmpipe"), ..Wanted::default() };
//! let gpu = device::open_with(&wanted)?;
//! println!("opened {}", gpu.adapter.get_info().name);
//! # Ok::<(), device::GpuError>(())
//! ```

use crate::experimental;
use skiagraph_graph::PartialBackend;
use std::{cmp::Reverse, time::Duration};

/// An open device.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The instance.
    pub instance: wgpu::Instance,
    /// The adapter.
    pub adapter: wgpu::Adapter,
    /// The device, with the adapter's own limits and those of [`useful_features`] (and of what was
    /// wanted) that it has.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Bytes for the textures and buffers of a graph, where they are known: for
    /// [`PlanRequest::memory_limit`](skiagraph_graph::PlanRequest::memory_limit).
    pub memory: Option<u64>,
    /// How long a frame may take, where there is a limit: for
    /// [`Executor::finish_within`](crate::Executor::finish_within).
    pub timeout: Option<Duration>,
}

/// Which device to open. Fields left out are chosen automatically.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wanted<'a> {
    /// A part of the adapter's name, in any case. `None`: `WGPU_ADAPTER_NAME`, else any name.
    pub adapter: Option<&'a str>,
    /// The backends that it may be of. `None`: those that `WGPU_BACKEND` lists, else [`BACKENDS`].
    pub backends: Option<wgpu::Backends>,
    /// Features besides [`useful_features`] that the device shall have if the adapter has them:
    /// those of `Graph::features`. Experimental ones, which wgpu holds may misbehave, stay off but
    /// for `EXPERIMENTAL_RAY_QUERY`, whose use here was reviewed.
    pub features: wgpu::Features,
}

/// The backends that are searched unless others are asked for. GL is none of them: what it runs is
/// the same GPU once more, with fewer features, and not every graph is proven there.
pub const BACKENDS: wgpu::Backends = wgpu::Backends::VULKAN
    .union(wgpu::Backends::METAL)
    .union(wgpu::Backends::DX12);

/// Why no device could be opened.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// There is no adapter at all.
    #[error(
        "no usable GPU adapter was found (Vulkan, Metal and Direct3D 12 were tried).\n\
         Install a driver; without a GPU, a software one: \
         `apt-get install mesa-vulkan-drivers libvulkan1` on Debian and Ubuntu,\n\
         `dnf install mesa-vulkan-drivers vulkan-loader` on Fedora, \
         `pacman -S vulkan-swrast vulkan-icd-loader` on Arch"
    )]
    NoAdapter,
    /// The backends that were asked for have no adapter.
    #[error(
        "no GPU adapter of the backend {wanted} was found; there are: {seen}.\n\
         GL needs the driver's EGL: `apt-get install libegl1 libgles2 libgl1-mesa-dri` on Debian \
         and Ubuntu"
    )]
    NoSuchBackend {
        /// Their names, or what `WGPU_BACKEND` says where that names none.
        wanted: String,
        /// Names and backends of the adapters there are.
        seen: String,
    },
    /// There are adapters, but none of that name.
    #[error("no adapter is called `{name}`; there are: {seen}")]
    NoSuchAdapter {
        /// The name that was asked for.
        name: String,
        /// Names and backends of those there are.
        seen: String,
    },
    /// The adapter gives no device.
    #[error("the adapter `{adapter}` gives no device: {why}")]
    Device {
        /// Its name.
        adapter: String,
        /// The driver's reason.
        why: String,
    },
}

/// Optional features that graphs and their timing make use of where an adapter has them.
pub fn useful_features() -> wgpu::Features {
    wgpu::Features::TIMESTAMP_QUERY
        | wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS
        | wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES
        | wgpu::Features::PIPELINE_STATISTICS_QUERY
        | wgpu::Features::FLOAT32_FILTERABLE
        | wgpu::Features::SUBGROUP
        | wgpu::Features::DEPTH_CLIP_CONTROL
}

/// Returns the backend as [`PlanRequest::partial_backend`](skiagraph_graph::PlanRequest) wants it:
/// `None` if it gives all of WebGPU.
pub fn partial(backend: wgpu::Backend) -> Option<PartialBackend> {
    (backend == wgpu::Backend::Gl).then(|| PartialBackend {
        name: backend.to_str().to_owned(),
        lacks: "no `textureLoad` from depth textures, no 32-bit float targets everywhere, and \
                compilers of its own that get some loops wrong"
            .to_owned(),
    })
}

fn instance(backends: wgpu::Backends) -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = backends;
    // Debug labels, which wgpu hands on in debug builds, crash Mesa 22.3; a dispatch of more groups
    // than there may be is a graph's mistake that only this check keeps from the driver.
    descriptor.flags = wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL.with_env();
    wgpu::Instance::new(descriptor)
}

fn enumerate(instance: &wgpu::Instance) -> Vec<wgpu::Adapter> {
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    adapters.sort_by_key(|adapter| {
        let info = adapter.get_info();
        let kind = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => 4,
            wgpu::DeviceType::IntegratedGpu => 3,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Cpu => 1,
            wgpu::DeviceType::Other => 0,
        };
        Reverse((kind, info.backend != wgpu::Backend::Gl))
    });
    adapters
}

/// Every usable adapter of every backend, once for each: the one that [`open`] prefers first, and
/// those of GL, which it does not take unless asked to, behind their like.
pub fn adapters() -> Vec<wgpu::AdapterInfo> {
    enumerate(&instance(wgpu::Backends::all()))
        .iter()
        .map(wgpu::Adapter::get_info)
        .collect()
}

/// Opens the adapter whose name contains `name` (in any case), or `WGPU_ADAPTER_NAME`, or the best
/// there is: a discrete GPU before an integrated one before a software adapter. Its backend is one
/// of those that `WGPU_BACKEND` lists, or of [`BACKENDS`].
///
/// # Errors
/// See [`GpuError`].
pub fn open(name: Option<&str>) -> Result<Gpu, GpuError> {
    open_with(&Wanted {
        adapter: name,
        ..Wanted::default()
    })
}

/// [`open`] with more to be chosen.
///
/// # Errors
/// See [`GpuError`].
pub fn open_with(wanted: &Wanted<'_>) -> Result<Gpu, GpuError> {
    let of_environment = std::env::var("WGPU_BACKEND").ok();
    let of_environment = of_environment.filter(|words| !words.trim().is_empty());
    let listed = of_environment
        .as_deref()
        .map(wgpu::Backends::from_comma_list);
    let asked = wanted.backends.or(listed);
    let instance = instance(asked.unwrap_or(BACKENDS));
    let adapters = enumerate(&instance);
    if adapters.is_empty() {
        let others = self::adapters();
        return Err(match (asked, wanted.backends, of_environment) {
            (None, ..) => GpuError::NoAdapter,
            _ if others.is_empty() => GpuError::NoAdapter,
            (Some(_), None, Some(words)) => no_such_backend(words, &others),
            (Some(backends), ..) => no_such_backend(names_of(backends), &others),
        });
    }
    let name = wanted
        .adapter
        .map(str::to_owned)
        .or_else(|| std::env::var("WGPU_ADAPTER_NAME").ok())
        .filter(|name| !name.is_empty());
    let fits = |adapter: &&wgpu::Adapter| {
        name.as_ref().is_none_or(|name| {
            let of_adapter = adapter.get_info().name.to_lowercase();
            of_adapter.contains(&name.to_lowercase())
        })
    };
    let Some(adapter) = adapters.iter().find(fits) else {
        let infos: Vec<_> = adapters.iter().map(wgpu::Adapter::get_info).collect();
        return Err(GpuError::NoSuchAdapter {
            name: name.unwrap_or_default(),
            seen: list(&infos),
        });
    };
    device_of(instance, adapter.clone(), wanted.features)
}

/// The device of an adapter, with those of these features that it offers.
fn device_of(
    instance: wgpu::Instance,
    adapter: wgpu::Adapter,
    wanted: wgpu::Features,
) -> Result<Gpu, GpuError> {
    let wanted = wanted - (wgpu::Features::all_experimental_mask() - experimental::REVIEWED);
    let features = adapter.features() & (useful_features() | wanted);
    let request = adapter.request_device(&wgpu::DeviceDescriptor {
        label: Some("skiagraph"),
        required_features: features,
        experimental_features: experimental::token(features),
        required_limits: adapter.limits(),
        ..wgpu::DeviceDescriptor::default()
    });
    match pollster::block_on(request) {
        Ok((device, queue)) => Ok(Gpu {
            instance,
            adapter,
            device,
            queue,
            memory: None,
            timeout: None,
        }),
        Err(error) => Err(GpuError::Device {
            adapter: adapter.get_info().name,
            why: error.to_string(),
        }),
    }
}

fn no_such_backend(wanted: String, others: &[wgpu::AdapterInfo]) -> GpuError {
    GpuError::NoSuchBackend {
        wanted: format!("`{wanted}`"),
        seen: list(others),
    }
}

/// The names of some backends, as `WGPU_BACKEND` has them.
fn names_of(backends: wgpu::Backends) -> String {
    let names = wgpu::Backend::ALL.into_iter();
    let names = names.filter(|backend| backends.contains((*backend).into()));
    names
        .map(wgpu::Backend::to_str)
        .collect::<Vec<_>>()
        .join(",")
}

/// Adapters for a message.
fn list(adapters: &[wgpu::AdapterInfo]) -> String {
    let name = |info: &wgpu::AdapterInfo| format!("{} ({})", info.name, info.backend.to_str());
    adapters.iter().map(name).collect::<Vec<_>>().join(", ")
}
