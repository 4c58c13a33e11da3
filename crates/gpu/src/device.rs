//! Opening an adapter and a device as the command line and the tests do. A host program brings its
//! own.

use crate::experimental;
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
    /// Bytes for the textures and buffers of a graph, where somebody knows: for
    /// [`PlanRequest::memory_limit`](skiagraph_graph::PlanRequest::memory_limit).
    pub memory: Option<u64>,
    /// How long a frame may take, where there is a limit: for
    /// [`Executor::finish_within`](crate::Executor::finish_within).
    pub timeout: Option<Duration>,
}

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
    /// There are adapters, but none of that name.
    #[error("no adapter is called `{name}`; there are: {seen}")]
    NoSuchAdapter {
        /// The name that was asked for.
        name: String,
        /// Names of those there are.
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

fn instance() -> wgpu::Instance {
    // A GL adapter is the same device once more with fewer features, so GL is left out.
    let backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = backends;
    descriptor.flags = wgpu::InstanceFlags::empty().with_env();
    wgpu::Instance::new(descriptor)
}

fn enumerate(instance: &wgpu::Instance) -> Vec<wgpu::Adapter> {
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    adapters.sort_by_key(|adapter| {
        Reverse(match adapter.get_info().device_type {
            wgpu::DeviceType::DiscreteGpu => 4,
            wgpu::DeviceType::IntegratedGpu => 3,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Cpu => 1,
            wgpu::DeviceType::Other => 0,
        })
    });
    adapters
}

/// Every usable adapter, the one that [`open`] prefers first.
pub fn adapters() -> Vec<wgpu::AdapterInfo> {
    enumerate(&instance())
        .iter()
        .map(wgpu::Adapter::get_info)
        .collect()
}

/// Opens the adapter whose name contains `name` (in any case), or `WGPU_ADAPTER_NAME`, or the best
/// there is: a discrete GPU before an integrated one before a software adapter.
///
/// # Errors
/// See [`GpuError`].
pub fn open(name: Option<&str>) -> Result<Gpu, GpuError> {
    open_with(name, wgpu::Features::empty())
}

/// [`open`], and the device has those of `wanted` besides that its adapter offers: those of
/// `Graph::features`. Experimental features, which wgpu holds may misbehave, stay off but for
/// `EXPERIMENTAL_RAY_QUERY`, whose use here was reviewed.
///
/// # Errors
/// See [`GpuError`].
pub fn open_with(name: Option<&str>, wanted: wgpu::Features) -> Result<Gpu, GpuError> {
    let wanted = wanted - (wgpu::Features::all_experimental_mask() - experimental::REVIEWED);
    let instance = instance();
    let adapters = enumerate(&instance);
    if adapters.is_empty() {
        return Err(GpuError::NoAdapter);
    }
    let name = name
        .map(str::to_owned)
        .or_else(|| std::env::var("WGPU_ADAPTER_NAME").ok())
        .filter(|name| !name.is_empty());
    let names: Vec<String> = adapters
        .iter()
        .map(|adapter| adapter.get_info().name)
        .collect();
    let fits = |adapter: &wgpu::Adapter| {
        name.as_ref().is_none_or(|name| {
            adapter
                .get_info()
                .name
                .to_lowercase()
                .contains(&name.to_lowercase())
        })
    };
    let Some(adapter) = adapters.into_iter().find(fits) else {
        return Err(GpuError::NoSuchAdapter {
            name: name.unwrap_or_default(),
            seen: names.join(", "),
        });
    };
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
