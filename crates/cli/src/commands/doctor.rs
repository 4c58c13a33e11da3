//! `skiagraph doctor`: prints the abilities of this machine, and reasons for those that it lacks.

use crate::args::shared::GpuArgs;
use crate::error::CliError;
use crate::terminal::console::print;
use skiagraph_compare::measuring::device::{driver, open, timestamp_trust};
use skiagraph_compare::wording::bytes;
use skiagraph_gpu::{
    device::{self, Gpu},
    timing::Trust,
};
use skiagraph_scene::{SceneLibrary, library::ASSETS_VARIABLE};
use wgpu::Features as F;

/// Prints the adapters, their limits and features, the check of timestamps, and the folders that
/// are searched for meshes.
///
/// # Errors
/// If no usable adapter was found; the rest is printed first.
pub fn doctor(args: &GpuArgs) -> Result<(), CliError> {
    let mut text = String::from("Adapters\n");
    let adapters = device::adapters();
    for info in &adapters {
        text += &format!("  {}\n", adapter(info));
    }
    if adapters.is_empty() {
        text.push_str("  none\n");
    }
    print(&text)?;
    print(&meshes())?;
    let gpu = open(&args.request(), &[])?;
    print(&chosen(&gpu))?;
    let verdict = match timestamp_trust(&gpu) {
        Trust::Trusted => "  GPU times: true (a long dispatch after a raster pass takes as long \
            as the clock says)"
            .into(),
        Trust::Untrusted { reason } => format!("  GPU times: none, {reason}"),
    };
    print(&format!("{verdict}\n"))
}

fn adapter(info: &wgpu::AdapterInfo) -> String {
    format!(
        "{} · {} · {:?} · {}",
        info.name,
        info.backend.to_str(),
        info.device_type,
        driver(info)
    )
}

fn chosen(gpu: &Gpu) -> String {
    let limits = gpu.device.limits();
    let features = gpu.adapter.features();
    let mut text = format!("\nChosen: {}\n", adapter(&gpu.adapter.get_info()));
    let edge = limits.max_texture_dimension_2d;
    let storage = limits.max_storage_buffer_binding_size;
    // Larger meshes are drawn and traced in parts, but indices are bound whole.
    let (storage, triangles) = (bytes(storage), storage / 12 / 1_000_000);
    let memory = gpu.memory.map(bytes);
    let memory = memory.unwrap_or("what the driver gives (it does not say how much)".into());
    text += &format!("  textures: up to {edge}x{edge}\n");
    text += &format!(
        "  storage buffer binding: up to {storage} (indices of {triangles} million triangles)\n"
    );
    text += &format!("  buffer: up to {}\n", bytes(limits.max_buffer_size));
    text += &format!("  memory for a graph: {memory}\n");
    text += &format!(
        "  compute: {} invocations per workgroup, {} groups per dimension\n",
        limits.max_compute_invocations_per_workgroup, limits.max_compute_workgroups_per_dimension
    );
    for (feature, use_of_it) in FEATURES {
        let has = if features.contains(feature) {
            "yes"
        } else {
            "no"
        };
        text += &format!("  {has:<3} {use_of_it}\n");
    }
    text
}

const FEATURES: [(F, &str); 5] = [
    (F::TIMESTAMP_QUERY, "timestamps: GPU time of each pass"),
    (
        F::TIMESTAMP_QUERY_INSIDE_ENCODERS,
        "timestamps between passes: GPU time of copies and clears",
    ),
    (
        F::TIMESTAMP_QUERY_INSIDE_PASSES,
        "timestamps inside passes: the way around drivers that time compute wrongly",
    ),
    (F::FLOAT32_FILTERABLE, "filtering of 32-bit float textures"),
    (
        F::EXPERIMENTAL_RAY_QUERY,
        "ray queries: `Trace` with `engine: RayQuery`",
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
        text += &format!("  {}{there}\n", folder.display());
    }
    for scene in library.list() {
        let found = if scene.mesh_found { "found" } else { "missing" };
        text += &format!("  mesh of the scene {}: {found}\n", scene.name);
    }
    text
}
