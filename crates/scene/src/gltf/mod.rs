//! glTF 2.0 files, parsed by the `gltf` crate and welded into a [`Mesh`](crate::Mesh).
//!
//! The mesh is made of the triangles of its default scene (of the first one, else of all meshes)
//! with the transforms of their nodes and instances, morph targets by their weights, skins in the
//! pose of their joints' nodes, all of it at rest. `alphaMode: MASK` is a mask, which the
//! alpha of vertices is a part of; `BLEND` counts as opaque. Primitives without normals are flat.
//! Parts that are passed over stand in the report. Cameras, lights (KHR_lights_punctual) and
//! animations of nodes are a [`GltfScene`].

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
