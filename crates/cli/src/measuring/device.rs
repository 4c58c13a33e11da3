//! Opening a GPU, and what is to be known of it before anything is measured.

use crate::args::shared::GpuArgs;
use crate::error::{CliError, with_causes};
use crate::records::results::Adapter;
use skiagraph_gpu::{
    device::{self, Gpu, GpuError, Wanted},
    timing::{self, Trust},
};
use skiagraph_graph::Graph;
use std::time::Duration;

/// Opens the adapter asked for, or the best one, with those features of the graphs that it has.
///
/// # Errors
/// [`CliError::NoGpu`] with the way out.
pub fn open<'a>(
    args: &GpuArgs,
    graphs: impl IntoIterator<Item = &'a Graph>,
) -> Result<Gpu, CliError> {
    let all = |all, graph: &Graph| all | graph.features();
    let features = graphs.into_iter().fold(wgpu::Features::empty(), all);
    let wanted = Wanted {
        adapter: args.adapter.as_deref(),
        backends: args.backend.map(wgpu::Backends::from),
        features,
    };
    let mut gpu =
        device::open_with(&wanted).map_err(|error: GpuError| CliError::NoGpu(error.to_string()))?;
    let is_software = gpu.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
    gpu.memory = args
        .memory_limit
        .or_else(|| is_software.then(free_memory).flatten());
    gpu.timeout = (args.timeout > 0).then(|| Duration::from_secs(args.timeout));
    Ok(gpu)
}

/// Memory that the machine has free: a software adapter's. What it has besides is lent out by most
/// systems before it is there, and a process that then uses it is killed. `None` where the system
/// does not say.
fn free_memory() -> Option<u64> {
    let mut system = sysinfo::System::new();
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

/// How results name the adapter; `trust` says whether its timestamps are true.
pub fn describe(gpu: &Gpu, trust: Trust) -> Adapter {
    let info = gpu.adapter.get_info();
    Adapter {
        driver: driver(&info),
        backend: info.backend.to_str().into(),
        device_type: format!("{:?}", info.device_type),
        name: info.name,
        gpu_unavailable: match trust {
            Trust::Trusted => None,
            Trust::Untrusted { reason } => Some(reason),
        },
    }
}

/// Driver and version in one string.
pub fn driver(info: &wgpu::AdapterInfo) -> String {
    format!("{} {}", info.driver, info.driver_info)
        .trim()
        .into()
}

/// Tells whether this device's timestamps are true.
pub fn timestamp_trust(gpu: &Gpu) -> Trust {
    timing::check(&gpu.device, &gpu.queue).unwrap_or_else(|error| Trust::Untrusted {
        reason: format!(
            "the check of its timestamps failed: {}",
            with_causes(&error)
        ),
    })
}
