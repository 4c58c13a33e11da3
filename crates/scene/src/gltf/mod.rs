//! glTF 2.0 files, parsed by the `gltf` crate and welded into a [`Mesh`](crate::Mesh).
//!
//! What becomes of one: the triangles of its default scene (of the first one, else of all meshes)
//! with the transforms of their nodes; skins and morph targets at rest. `alphaMode: MASK` is a
//! mask, `BLEND` counts as opaque. Primitives without normals are flat.

mod accessor;
mod buffers;
mod document;
mod import;
mod materials;

pub use import::{load_gltf, parse_gltf};
