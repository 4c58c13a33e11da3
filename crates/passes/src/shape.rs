//! Where the mesh of a provider is, and how it came there.

use glam::DAffine3;
use skiagraph_scene::Movable;
use std::sync::Arc;

/// How the corners of the mesh came to be where they are.
#[derive(Clone, Default)]
pub(crate) struct Shape {
    /// Parts that move by themselves, if there are any.
    pub parts: Option<Arc<Movable>>,
    /// Where the parts are, one map each; none if they were deformed since.
    pub maps: Vec<DAffine3>,
    /// True for each part whose triangles are wound the other way than at rest.
    pub mirrored: Vec<bool>,
    /// True if the parts are in spaces of their own and were never given places.
    pub is_unplaced: bool,
    /// True if the mesh moves, so that trees are worth their memory.
    pub is_deformed: bool,
    /// True if the mesh was deformed since its hierarchy was fitted, otherwise than by maps.
    pub is_bent: bool,
}
