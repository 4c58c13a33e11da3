//! A binary bounding volume hierarchy over a mesh's triangles.

mod build;
mod light_space;
mod median;
mod tree;

pub use light_space::{LightSpace, LightSpaceNode};
pub use tree::{Bvh, BvhNode, MAX_DEPTH};
