//! Opens a wgpu adapter and device, chosen by name, backend and features. A host program may pass
//! its own device and queue to [`Executor::new`](crate::Executor::new) instead.
//!
//! ```no_run
//! use skiagraph_gpu::device::{self, Wanted};
//!
//! for adapter in device::adapters() {
//!     println!("{} on {}", adapter.name, adapter.backend);
//! }
//! let mut wanted = Wanted::default();
//! wanted.adapter = Some("llvmpipe");
//! let gpu = device::open_with(&wanted)?;
//! println!("opened {}", gpu.adapter.get_info().name);
//! # Ok::<(), device::GpuError>(())
//! ```

use crate::{experimental, pipelines::pipelines::Pipelines};
use skiagraph_graph::{AdapterFacts, PartialBackend};
use std::{cmp::Reverse, time::Duration};

/// An open wgpu device with its instance, adapter and queue.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Gpu {
    /// The wgpu instance that the adapter was found in.
    pub instance: wgpu::Instance,
    /// The adapter (physical device or software rasteriser) that `device` was opened on.
    pub adapter: wgpu::Adapter,
    /// The device. It has all limits of the adapter. Its features are those of [`useful_features`]
    /// and of [`Wanted::features`] that the adapter offers.
    pub device: wgpu::Device,
    /// The queue that work for the device is submitted to.
    pub queue: wgpu::Queue,
    /// Shader modules and pipelines that executors created by
    /// [`Executor::on`](crate::Executor::on) share.
    pub pipelines: Pipelines,
    /// Most bytes that the textures and buffers of a graph may take together. The host passes it on
    /// as [`PlanRequest::memory_limit`](skiagraph_graph::PlanRequest::memory_limit). `None` for no
    /// limit, as [`open`] and [`open_with`] set it; wgpu does not tell how much memory a device
    /// has.
    pub memory: Option<u64>,
    /// Longest time to wait for the GPU to finish a frame. The host passes it on to
    /// [`Executor::finish_within`](crate::Executor::finish_within). `None` for no limit, as
    /// [`open`] and [`open_with`] set it.
    pub timeout: Option<Duration>,
}

/// Choice of the device that [`open_with`] opens. The [`Default`] accepts any adapter of
/// [`BACKENDS`], unless the environment variables `WGPU_ADAPTER_NAME` and `WGPU_BACKEND` say
/// otherwise.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub struct Wanted<'a> {
    /// Text that the adapter's name must contain, or else its driver's name and version, so that
    /// two drivers of one GPU can be told apart; upper and lower case are the same. `None` takes
    /// the text from the environment variable `WGPU_ADAPTER_NAME`, or accepts any adapter if that
    /// is not set.
    pub adapter: Option<&'a str>,
    /// The backends to search. `None` searches those that the environment variable `WGPU_BACKEND`
    /// lists, separated by commas, or [`BACKENDS`] if that is not set.
    pub backends: Option<wgpu::Backends>,
    /// Features that the device gets besides [`useful_features`] if the adapter offers them;
    /// usually those that the graph to be run names
    /// ([`Graph::features`](skiagraph_graph::Graph::features)). Experimental features of wgpu are
    /// ignored here, except `EXPERIMENTAL_RAY_QUERY`, whose use in this crate was reviewed.
    pub features: wgpu::Features,
}

impl Wanted<'_> {
    /// Sets [`features`](Self::features).
    #[must_use]
    pub fn with_features(mut self, features: wgpu::Features) -> Self {
        self.features = features;
        self
    }
}

/// The backends that [`open`] and [`open_with`] search by default: Vulkan, Metal and Direct3D 12.
/// GL is left out: it would list the same GPU a second time with fewer features, and not every
/// graph is tested on it. In a browser there is only its WebGPU.
pub const BACKENDS: wgpu::Backends = wgpu::Backends::VULKAN
    .union(wgpu::Backends::METAL)
    .union(wgpu::Backends::DX12)
    .union(wgpu::Backends::BROWSER_WEBGPU);

/// Reasons why [`open`] or [`open_with`] could not open a device.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No adapter was found: none on [`BACKENDS`] if neither [`Wanted::backends`] nor
    /// `WGPU_BACKEND` named backends, or else none on any backend.
    #[error(
        "no usable GPU adapter was found (Vulkan, Metal and Direct3D 12 were tried).\n\
         Install a driver; without a GPU, a software one: \
         `apt-get install mesa-vulkan-drivers libvulkan1` on Debian and Ubuntu,\n\
         `dnf install mesa-vulkan-drivers vulkan-loader` on Fedora, \
         `pacman -S vulkan-swrast vulkan-icd-loader` on Arch"
    )]
    NoAdapter,
    /// The backends that [`Wanted::backends`] or `WGPU_BACKEND` named have no adapter, but others
    /// have.
    #[error(
        "no GPU adapter of the backend {wanted} was found; there are: {seen}.\n\
         GL needs the driver's EGL: `apt-get install libegl1 libgles2 libgl1-mesa-dri` on Debian \
         and Ubuntu"
    )]
    NoSuchBackend {
        /// Names of the requested backends, separated by commas, or the text of `WGPU_BACKEND`; in
        /// backticks.
        wanted: String,
        /// Names of the adapters of all backends, each with its backend in brackets, separated by
        /// commas.
        seen: String,
    },
    /// No adapter of the searched backends has a name or a driver that contains the requested text.
    #[error("no adapter is called `{name}`; there are: {seen}")]
    NoSuchAdapter {
        /// The requested text: [`Wanted::adapter`], or else `WGPU_ADAPTER_NAME`.
        name: String,
        /// Names of the adapters of the searched backends, each with its backend and driver in
        /// brackets, separated by commas.
        seen: String,
    },
    /// The adapter refused to open a device.
    #[error("the adapter `{adapter}` gives no device: {why}")]
    Device {
        /// Name of the adapter that refused.
        adapter: String,
        /// Message of wgpu.
        why: String,
    },
}

/// Returns the optional wgpu features that graphs and their timing use where an adapter has them:
/// timestamp and pipeline-statistics queries, filtering of 32-bit floats, subgroups, and unclipped
/// depth.
pub fn useful_features() -> wgpu::Features {
    wgpu::Features::TIMESTAMP_QUERY
        | wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS
        | wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES
        | wgpu::Features::PIPELINE_STATISTICS_QUERY
        | wgpu::Features::FLOAT32_FILTERABLE
        | wgpu::Features::SUBGROUP
        | wgpu::Features::DEPTH_CLIP_CONTROL
}

/// Returns the description of a backend that lacks part of WebGPU, for
/// [`PlanRequest::partial_backend`](skiagraph_graph::PlanRequest). Only GL lacks a part; `None` for
/// every other backend.
pub fn partial(backend: wgpu::Backend) -> Option<PartialBackend> {
    (backend == wgpu::Backend::Gl).then(|| PartialBackend {
        name: backend.to_str().to_owned(),
        lacks: "no `textureLoad` from depth textures, no 32-bit float targets everywhere, and \
                compilers of its own that get some loops wrong"
            .to_owned(),
    })
}

/// Returns the facts about a device's adapter for
/// [`PlanRequest::adapter`](skiagraph_graph::PlanRequest).
pub fn adapter_facts(device: &wgpu::Device) -> AdapterFacts {
    let info = device.adapter_info();
    AdapterFacts {
        is_software: info.device_type == wgpu::DeviceType::Cpu,
        subgroup_size: info.subgroup_min_size,
    }
}

fn instance(backends: wgpu::Backends) -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = backends;
    // Debug labels, which wgpu hands on in debug builds, crash Mesa 22.3; a dispatch of more groups
    // than there may be is a graph's mistake that only this check keeps from the driver.
    descriptor.flags = wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL.with_env();
    wgpu::Instance::new(descriptor)
}

async fn enumerate(instance: &wgpu::Instance) -> Vec<wgpu::Adapter> {
    #[cfg(target_arch = "wasm32")]
    let mut adapters: Vec<wgpu::Adapter> = {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..wgpu::RequestAdapterOptions::default()
        };
        instance
            .request_adapter(&options)
            .await
            .into_iter()
            .collect()
    };
    #[cfg(not(target_arch = "wasm32"))]
    let mut adapters = instance.enumerate_adapters(wgpu::Backends::all()).await;
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

/// Lists the adapters of all backends in the order in which [`open`] prefers them: discrete GPUs,
/// integrated ones, virtual ones, software adapters, others. Among adapters of one type, GL
/// adapters come last; [`open`] skips them by default.
pub fn adapters() -> Vec<wgpu::AdapterInfo> {
    pollster::block_on(all_adapters())
}

async fn all_adapters() -> Vec<wgpu::AdapterInfo> {
    let adapters = enumerate(&instance(wgpu::Backends::all())).await;
    adapters.iter().map(wgpu::Adapter::get_info).collect()
}

/// Opens a device on the first adapter of [`adapters`] whose name contains `name`, or else whose
/// driver's does; upper and lower case are the same. `None` takes the text from the environment
/// variable `WGPU_ADAPTER_NAME`, or accepts any name if that is not set. The search covers the
/// backends that `WGPU_BACKEND` lists, or [`BACKENDS`] if that is not set.
///
/// # Errors
/// See [`GpuError`].
pub fn open(name: Option<&str>) -> Result<Gpu, GpuError> {
    open_with(&Wanted {
        adapter: name,
        ..Wanted::default()
    })
}

/// Opens a device as [`open`] does, with the adapter name, backends and additional features that
/// `wanted` chooses.
///
/// # Errors
/// See [`GpuError`].
pub fn open_with(wanted: &Wanted<'_>) -> Result<Gpu, GpuError> {
    pollster::block_on(request(wanted))
}

/// Opens a device as [`open_with`] does, without holding the thread: in a browser, where no thread
/// can wait, the browser's own device.
///
/// # Errors
/// See [`GpuError`].
pub async fn request(wanted: &Wanted<'_>) -> Result<Gpu, GpuError> {
    let of_environment = std::env::var("WGPU_BACKEND").ok();
    let of_environment = of_environment.filter(|words| !words.trim().is_empty());
    let words = of_environment.as_deref();
    let listed = words.map(wgpu::Backends::from_comma_list);
    let asked = wanted.backends.or(listed);
    let instance = instance(asked.unwrap_or(BACKENDS));
    let adapters = enumerate(&instance).await;
    if adapters.is_empty() {
        let infos = all_adapters().await;
        return Err(match (asked, wanted.backends, of_environment) {
            (None, ..) => GpuError::NoAdapter,
            _ if infos.is_empty() => GpuError::NoAdapter,
            (Some(_), None, Some(words)) => no_such_backend(words, &infos),
            (Some(backends), ..) => no_such_backend(names_of(backends), &infos),
        });
    }
    let name = wanted.adapter.map(str::to_owned);
    let name = name.or_else(|| std::env::var("WGPU_ADAPTER_NAME").ok());
    let name = name.filter(|name| !name.is_empty());
    let wanted_name = name.as_deref().unwrap_or_default().to_lowercase();
    let infos: Vec<_> = adapters.iter().map(wgpu::Adapter::get_info).collect();
    let find = |text: fn(&wgpu::AdapterInfo) -> String| {
        let mut texts = infos.iter().map(text);
        texts.position(|text| text.to_lowercase().contains(&wanted_name))
    };
    let named = find(|info| info.name.clone());
    let Some(at) = named.or_else(|| find(driver)) else {
        return Err(GpuError::NoSuchAdapter {
            name: name.unwrap_or_default(),
            seen: list(&infos),
        });
    };
    device_of(instance, adapters[at].clone(), wanted.features).await
}

/// The device of an adapter, with those of these features that it offers.
async fn device_of(
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
    let (device, queue) = request.await.map_err(|error| GpuError::Device {
        adapter: adapter.get_info().name,
        why: error.to_string(),
    })?;
    Ok(Gpu {
        instance,
        adapter,
        pipelines: Pipelines::shared(&device),
        device,
        queue,
        memory: None,
        timeout: None,
    })
}

fn no_such_backend(wanted: String, infos: &[wgpu::AdapterInfo]) -> GpuError {
    GpuError::NoSuchBackend {
        wanted: format!("`{wanted}`"),
        seen: list(infos),
    }
}

/// The names of some backends, as `WGPU_BACKEND` has them.
fn names_of(backends: wgpu::Backends) -> String {
    let names = wgpu::Backend::ALL.into_iter();
    let names = names.filter(|backend| backends.contains((*backend).into()));
    let names = names.map(wgpu::Backend::to_str);
    names.collect::<Vec<_>>().join(",")
}

/// Name and version of an adapter's driver.
fn driver(info: &wgpu::AdapterInfo) -> String {
    format!("{} {}", info.driver, info.driver_info)
}

/// Adapters for a message.
fn list(adapters: &[wgpu::AdapterInfo]) -> String {
    let name = |info: &wgpu::AdapterInfo| {
        let backend = info.backend.to_str();
        match driver(info).trim() {
            "" => format!("{} ({backend})", info.name),
            driver => format!("{} ({backend}, {driver})", info.name),
        }
    };
    adapters.iter().map(name).collect::<Vec<_>>().join(", ")
}
