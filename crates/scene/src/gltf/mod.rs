//! glTF 2.0 files, parsed by the `gltf` crate and welded into a [`Mesh`](crate::Mesh).
//!
//! The mesh holds the triangles of the file's default scene; without a default scene those of the
//! first scene, and without scenes those of all meshes. Transforms of nodes and instances are
//! applied, morph targets by their weights, and skins in the pose of their joints' nodes, all at
//! rest. A material with `alphaMode: MASK` gets a mask, which includes the alpha of vertices;
//! `BLEND` counts as opaque. Primitives without normals are flat-shaded. A group of the mesh has
//! the name of its node, or else that of the node's mesh, or else `mesh N` with the number of that
//! mesh. The import report lists parts that are left out. Cameras, lights (KHR_lights_punctual) and
//! animations of nodes form a [`GltfScene`].

mod accessor;
mod animations;
mod beside;
mod buffers;
mod clips;
mod container;
mod document;
mod extensions;
mod fault;
mod import;
mod materials;
mod names;
mod nodes;
mod placements;
mod pose;
mod prepare;
mod prepare_looks;
mod prepare_storage;
mod scene;
mod vertex_alpha;

pub use clips::Clip;
pub use import::{load_gltf, load_gltf_scene, parse_gltf, parse_gltf_scene};
pub use scene::GltfScene;
