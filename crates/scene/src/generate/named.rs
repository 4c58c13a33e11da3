//! The list of generated meshes.

use super::park;
use crate::mesh::Mesh;

/// Names that [`by_name`] knows.
pub const NAMES: [&str; 1] = ["park"];

/// The generated mesh of that name.
pub fn by_name(name: &str) -> Option<Mesh> {
    match name {
        "park" => Some(park::build()),
        _ => None,
    }
}
