//! A binary bounding volume hierarchy over a mesh's triangles.

mod build;
mod median;
mod merge;
mod tree;

pub use tree::{Bvh, BvhNode, MAX_DEPTH};
