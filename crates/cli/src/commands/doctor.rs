//! `skiagraph doctor`: what this machine can do, and why not where it cannot.

use crate::{
    args::GpuArgs,
    error::{CliError, print},
    render,
    table::bytes,
};
use skiagraph_graph::{gpu, timing::Trust};
use skiagraph_scene::{SceneLibrary, library::ASSETS_VARIABLE};

/// Prints adapters, limits, features, whether timestamps are true, and where meshes are searched.
///
/// # Errors
/// No usable adapter, after all that can be said without one.
pub fn doctor(asked: &GpuArgs) -> Result<(), CliError> {
    let mut text = String::from("Adapters\n");
    let adapters = gpu::adapters();
    for info in &adapters {
        text.push_str(&format!(
            "  {} · {} · {:?} · {}\n",
            info.name,
            info.backend.to_str(),
            info.device_type,
            render::driver(info)
        ));
    }
    if adapters.is_empty() {
        text.push_str("  none\n");
    }
    print(&text)?;
    print(&meshes())?;
    let gpu = render::open(asked, wgpu::Features::empty())?;
    print(&chosen(&gpu))?;
    let verdict = match render::trust(&gpu) {
        Trust::Trusted => "  GPU times: true (a long dispatch after a raster pass takes as long as the clock says)".into(),
        Trust::Untrusted { reason } => format!("  GPU times: none, {reason}"),
    };
    print(&format!("{verdict}\n"))
}

fn chosen(gpu: &gpu::Gpu) -> String {
    let info = gpu.adapter.get_info();
    let limits = gpu.device.limits();
    let features = gpu.device.features();
    let mut text = format!(
        "\nChosen: {} · {} · {:?} · {}\n",
        info.name,
        info.backend.to_str(),
        info.device_type,
        render::driver(&info)
    );
    let edge = limits.max_texture_dimension_2d;
    // 32 bytes per ray, as the ray buffer holds them.
    let rays = limits.max_storage_buffer_binding_size / 32;
    text.push_str(&format!("  textures: up to {edge}x{edge}\n"));
    text.push_str(&format!(
        "  storage buffer binding: up to {} (rays of {} million pixels)\n",
        bytes(limits.max_storage_buffer_binding_size),
        rays / 1_000_000
    ));
    text.push_str(&format!(
        "  buffer: up to {}\n",
        bytes(limits.max_buffer_size)
    ));
    text.push_str(&match gpu.memory {
        Some(free) => format!("  memory for a graph: {}\n", bytes(free)),
        None => {
            "  memory for a graph: what the driver gives (it does not say how much)\n".to_owned()
        }
    });
    text.push_str(&format!(
        "  compute: {} invocations per workgroup, {} groups per dimension\n",
        limits.max_compute_invocations_per_workgroup, limits.max_compute_workgroups_per_dimension
    ));
    for (feature, use_of_it) in FEATURES {
        let has = if features.contains(feature) {
            "yes"
        } else {
            "no "
        };
        text.push_str(&format!("  {has} {use_of_it}\n"));
    }
    text
}

const FEATURES: [(wgpu::Features, &str); 4] = [
    (
        wgpu::Features::TIMESTAMP_QUERY,
        "timestamps: GPU time of each pass",
    ),
    (
        wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS,
        "timestamps between passes: GPU time of copies and clears",
    ),
    (
        wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES,
        "timestamps inside passes: the way around drivers that time compute wrongly",
    ),
    (
        wgpu::Features::FLOAT32_FILTERABLE,
        "filtering of 32-bit float textures",
    ),
];

fn meshes() -> String {
    let library = SceneLibrary::from_environment();
    let mut text = format!(
        "\nMeshes are searched beside the scene file, then (${ASSETS_VARIABLE}, cache folder) in\n"
    );
    for folder in &library.assets {
        let there = if folder.is_dir() {
            ""
        } else {
            " (no such folder)"
        };
        text.push_str(&format!("  {}{there}\n", folder.display()));
    }
    for scene in library.list() {
        let found = if scene.mesh_found { "found" } else { "missing" };
        text.push_str(&format!("  mesh of the scene {}: {found}\n", scene.name));
    }
    text
}
