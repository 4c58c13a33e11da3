//! The names of what a scene gives, and what each depends on.

use std::sync::atomic::{AtomicU64, Ordering};

pub(crate) const POSITIONS: &str = "scene.positions";
pub(crate) const INDICES: &str = "scene.indices";
pub(crate) const NORMALS: &str = "scene.normals";
pub(crate) const NORMAL_INDICES: &str = "scene.normal_indices";
pub(crate) const ADJACENCY: &str = "scene.adjacency";
pub(crate) const BVH_NODES: &str = "scene.bvh_nodes";
pub(crate) const BVH_PRIMITIVES: &str = "scene.bvh_primitives";
pub(crate) const LIGHT_SPACE_NODES: &str = "scene.light_space_nodes";
pub(crate) const LIGHT_SPACE_PRIMITIVES: &str = "scene.light_space_primitives";
pub(crate) const TLAS: &str = "scene.tlas";
/// What `shared/masks.wgsl` reads: no items in a scene where no triangle is masked or double-sided.
pub const MASKS: &str = "scene.masks";
pub(crate) const UVS: &str = "scene.uvs";
pub(crate) const UV_INDICES: &str = "scene.uv_indices";
pub(crate) const MATERIALS: &str = "scene.materials";
pub(crate) const MATERIAL_INDICES: &str = "scene.material_indices";
pub(crate) const TEXELS: &str = "scene.texels";
/// The uniform of `shared/camera.wgsl`.
pub const CAMERA: &str = "camera";
/// The uniform of `shared/unprojection.wgsl`.
pub const UNPROJECTION: &str = "unprojection";
/// The uniform of `shared/light.wgsl`.
pub const LIGHT: &str = "light";
/// The uniform of `shared/light_area.wgsl`.
pub const LIGHT_AREA: &str = "light_area";

pub(crate) const NAMES: [&str; 20] = [
    POSITIONS,
    INDICES,
    NORMALS,
    NORMAL_INDICES,
    ADJACENCY,
    BVH_NODES,
    BVH_PRIMITIVES,
    LIGHT_SPACE_NODES,
    LIGHT_SPACE_PRIMITIVES,
    TLAS,
    MASKS,
    UVS,
    UV_INDICES,
    MATERIALS,
    MATERIAL_INDICES,
    TEXELS,
    CAMERA,
    UNPROJECTION,
    LIGHT,
    LIGHT_AREA,
];

/// A number that no provider of this process has counted yet: two that are equal are of the same
/// content, whoever gives it.
pub(crate) fn next_version() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

/// When what was set last.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Versions {
    pub camera: u64,
    pub light: u64,
    /// Places and normals of the mesh's corners.
    pub shape: u64,
    /// All else of the mesh.
    pub mesh: u64,
}

impl Versions {
    pub fn new() -> Self {
        Self {
            camera: next_version(),
            light: next_version(),
            shape: next_version(),
            mesh: next_version(),
        }
    }

    /// That of a resource: the latest of what it is made of.
    pub fn of(&self, name: &str) -> u64 {
        match name {
            CAMERA | UNPROJECTION => self.camera,
            LIGHT_AREA => self.light,
            LIGHT | LIGHT_SPACE_NODES | LIGHT_SPACE_PRIMITIVES => self.light.max(self.shape),
            POSITIONS | NORMALS | BVH_NODES | BVH_PRIMITIVES | TLAS => self.shape,
            _ => self.mesh,
        }
    }
}
