//! Parts whose vertices stay in a host's own buffers. Whenever such a part moves, or the host has
//! rewritten its vertices, kernels read them there and write what all passes of all graphs read:
//! `scene.positions`, `scene.normals`, and the boxes of the part's nodes in `scene.bvh_nodes`.

mod decoder;
mod error;
mod kernel_module;
mod layout;
mod mesh;
mod mesh_record;
mod rest;
mod writes;

pub use decoder::HostDecoder;
pub use error::HostMeshError;
pub use layout::HostVertices;
pub use mesh::{HostIndices, HostMesh};
pub(crate) use writes::{Bound, HostWrite, Kernel, Kernels};
