//! Finds out what an adapter can do, and where meshes are searched.
//!
//! ```
//! use skiagraph_compare::measuring::abilities::{adapters, meshes};
//!
//! for adapter in adapters() {
//!     println!("{adapter}");
//! }
//! print!("{}", meshes());
//! ```

use crate::measuring::device::{adapter, describe, machine, timestamp_trust};
use crate::records::abilities::{Abilities, Ability, Limits};
use crate::records::results::{Adapter, PROGRAM};
use skiagraph_gpu::block_on;
use skiagraph_gpu::device::{self, Gpu};
use skiagraph_scene::{SceneLibrary, library::ASSETS_VARIABLE};

/// Lists the adapters of this machine through all backends, the preferred one first.
pub fn adapters() -> Vec<Adapter> {
    device::adapters().into_iter().map(adapter).collect()
}

/// Returns the abilities of an opened adapter. Its timestamps are tried out by some work on it.
pub fn abilities(gpu: &Gpu) -> Abilities {
    let (limits, features) = (gpu.device.limits(), gpu.adapter.features());
    let has = |ability: Ability| (ability, features.contains(ability.feature()));
    Abilities {
        schema: 1,
        program: PROGRAM.into(),
        machine: machine(),
        adapters: adapters(),
        adapter: describe(gpu, block_on(timestamp_trust(gpu))),
        limits: Limits {
            texture_edge: limits.max_texture_dimension_2d,
            storage_binding: limits.max_storage_buffer_binding_size,
            buffer: limits.max_buffer_size,
            memory: gpu.memory,
            threads: limits.max_compute_invocations_per_workgroup,
            groups: limits.max_compute_workgroups_per_dimension,
        },
        features: Ability::ALL.map(has).into(),
    }
}

/// Returns the folders in which meshes of scenes are searched, and which scenes have theirs, as
/// lines of text.
pub fn meshes() -> String {
    let library = SceneLibrary::from_environment();
    let mut text = format!(
        "\nMeshes are searched beside the scene file, then (${ASSETS_VARIABLE}, cache folder) in\n"
    );
    for folder in &library.assets {
        let is_there = folder.is_dir();
        let there = if is_there { "" } else { " (no such folder)" };
        text += &format!("  {}{there}\n", folder.display());
    }
    for scene in library.list() {
        let state = if scene.mesh_found { "found" } else { "missing" };
        text += &format!("  mesh of the scene {}: {state}\n", scene.name);
    }
    text
}
