//! Opens a GPU, describes it and its machine, and checks its timestamps.
//!
//! ```no_run
//! use skiagraph_compare::{
//!     graphs::preset,
//!     measuring::device::{self, GpuRequest},
//! };
//! use skiagraph_gpu::block_on;
//! use skiagraph_passes::EmbeddedSources;
//! use std::time::Duration;
//!
//! let presets = preset::load_all(&["crsm".into()], &EmbeddedSources)?;
//! let mut request = GpuRequest::default();
//! request.adapter = Some("llvmpipe".into());
//! request.timeout = Some(Duration::from_secs(60));
//! let gpu = device::open(&request, preset::graphs(&presets))?;
//! let trust = block_on(device::timestamp_trust(&gpu));
//! println!("{}", device::describe(&gpu, trust));
//! # Ok::<(), skiagraph_compare::error::CompareError>(())
//! ```

use crate::error::{CompareError, Result, with_causes};
use crate::files::write::{folder_of, write_whole};
use crate::records::results::{Adapter, Machine};
use crate::wording::or_nothing;
use skiagraph_gpu::device::{self, Gpu, GpuError, Wanted};
use skiagraph_gpu::timing::{self, Trust};
use skiagraph_gpu::{Pipelines, block_on};
use skiagraph_graph::Graph;
use skiagraph_scene::Limit;
use std::{path::PathBuf, time::Duration};
use sysinfo::{CpuRefreshKind, System};

/// Request for a GPU, with limits on the memory and time that a graph may take on it.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct GpuRequest {
    /// Part of the adapter's name, in any case. `None` takes it from the environment variable
    /// `WGPU_ADAPTER_NAME`, or the best adapter if that is not set.
    pub adapter: Option<String>,
    /// Graphics APIs through which the GPU may be used. `None` takes them from the environment
    /// variable `WGPU_BACKEND`, or Vulkan, Metal and Direct3D 12 if that is not set.
    pub backends: Option<wgpu::Backends>,
    /// Most bytes that textures and buffers of a graph may take. `None` means the machine's free
    /// memory on a software adapter, and no limit on others.
    pub memory_limit: Option<u64>,
    /// Time after which an unfinished frame is abandoned, and the device with it; `None` to wait
    /// without limit.
    pub timeout: Option<Duration>,
    /// Folder in which compiled shaders are kept from one run of the program to the next, in a file
    /// for each adapter; `None` keeps none.
    pub shader_cache: Option<PathBuf>,
}

/// Compiled shaders that are taken over: those of shaders that are edited would pile up.
const SHADERS: Limit = Limit {
    of: "a file of compiled shaders",
    mib: 256,
    way_out: "delete it",
};

/// Opens the requested adapter, with those features that `graphs` need or can use and that it has.
///
/// # Errors
/// [`CompareError::NoGpu`] if no adapter can be used; the message says what to do.
pub fn open<'a>(request: &GpuRequest, graphs: impl IntoIterator<Item = &'a Graph>) -> Result<Gpu> {
    block_on(self::request(request, graphs))
}

/// Opens an adapter as [`open`] does, without holding the thread.
///
/// # Errors
/// Those of [`open`].
pub async fn request<'a>(
    request: &GpuRequest,
    graphs: impl IntoIterator<Item = &'a Graph>,
) -> Result<Gpu> {
    let union = |features, graph: &Graph| features | graph.features();
    let mut features = graphs.into_iter().fold(wgpu::Features::empty(), union);
    let keeps_shaders = request.shader_cache.is_some();
    features.set(wgpu::Features::PIPELINE_CACHE, keeps_shaders);
    let mut wanted = Wanted::default().with_features(features);
    wanted.adapter = request.adapter.as_deref();
    wanted.backends = request.backends;
    let opened = device::request(&wanted).await;
    let mut gpu = opened.map_err(|error: GpuError| CompareError::NoGpu(error.to_string()))?;
    let is_software = gpu.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
    let memory = || is_software.then(free_memory).flatten();
    gpu.memory = request.memory_limit.or_else(memory);
    gpu.timeout = request.timeout;
    let key = wgpu::util::pipeline_cache_key(&gpu.adapter.get_info());
    if let (Some(folder), Some(key)) = (&request.shader_cache, key) {
        gpu.pipelines = kept_in(folder.join(key), &gpu.device);
    }
    Ok(gpu)
}

/// Creates an object without pipelines whose compiled shaders are kept in a file. Without a file
/// that can be read and written, shaders are compiled again.
fn kept_in(file: PathBuf, device: &wgpu::Device) -> Pipelines {
    let earlier = SHADERS.read(&file).unwrap_or_default();
    Pipelines::with_kept(device, earlier, move |bytes| {
        if std::fs::create_dir_all(folder_of(&file)).is_ok() {
            let _ = write_whole(&file, &bytes);
        }
    })
}

/// Memory that the machine has free: a software adapter's. What it has besides is lent out by most
/// systems before it is there, and a process that then uses it is killed. `None` where the system
/// does not say.
fn free_memory() -> Option<u64> {
    let mut system = System::new();
    system.refresh_memory();
    if system.total_memory() == 0 {
        return None;
    }
    // A container may have less than the machine. What it holds as file cache is free for all that.
    let of_group = system.cgroup_limits().map_or(u64::MAX, |limits| {
        limits.total_memory.saturating_sub(limits.rss)
    });
    Some(system.available_memory().min(of_group))
}

/// Describes this machine for results: host name, processor, and the load of the last minute.
pub fn machine() -> Machine {
    let mut system = System::new();
    system.refresh_cpu_list(CpuRefreshKind::nothing());
    let cpus = system.cpus();
    let load = System::load_average().one;
    Machine {
        host: System::host_name(),
        processor: or_nothing(cpus.first(), |cpu| cpu.brand().trim().into()),
        cores: cpus.len() as u32,
        // Windows has no such mean.
        load: cfg!(unix).then_some(load),
    }
}

/// Describes a GPU's adapter for results. `trust` comes from [`timestamp_trust`]; if the timestamps
/// cannot be trusted, the description holds the reason.
pub fn describe(gpu: &Gpu, trust: Trust) -> Adapter {
    Adapter {
        gpu_unavailable: match trust {
            Trust::Trusted => None,
            Trust::Untrusted { reason } => Some(reason),
        },
        ..adapter(gpu.adapter.get_info())
    }
}

/// Describes an adapter that may not be open, as if its timestamps could be trusted.
pub fn adapter(info: wgpu::AdapterInfo) -> Adapter {
    Adapter {
        driver: driver(&info),
        backend: info.backend.to_str().into(),
        device_type: format!("{:?}", info.device_type),
        name: info.name,
        gpu_unavailable: None,
    }
}

/// Returns the name and version of a driver as one text.
pub fn driver(info: &wgpu::AdapterInfo) -> String {
    let driver = format!("{} {}", info.driver, info.driver_info);
    driver.trim().into()
}

/// Checks whether a GPU's timestamps can be trusted, by timing work on it.
pub async fn timestamp_trust(gpu: &Gpu) -> Trust {
    let checked = timing::check(&gpu.device, &gpu.queue).await;
    checked.unwrap_or_else(|error| Trust::Untrusted {
        reason: format!(
            "the check of its timestamps failed: {}",
            with_causes(&error)
        ),
    })
}
