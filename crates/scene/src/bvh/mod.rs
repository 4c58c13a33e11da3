//! A binary bounding volume hierarchy over a mesh's triangles.

mod build;
mod levels;
mod light_space;
mod node;
mod ploc;
mod top;
mod tree;
mod two_level;

pub use light_space::{LightSpace, LightSpaceNode};
pub use node::{BvhNode, MAX_DEPTH};
pub use tree::Bvh;
pub use two_level::{Moved, Piece, Refit, TwoLevelBvh};
