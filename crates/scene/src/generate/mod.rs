//! Meshes made by the program itself: the same bits on every machine.
//!
//! Only operations that IEEE 754 rounds correctly are used (`+ − × ÷ √`): angles go through a series of our own, not
//! through the platform's `sin`.

pub(crate) mod numbers;
mod park;
mod solid;

use crate::Mesh;

/// Names that [`by_name`] knows.
pub const NAMES: [&str; 1] = ["park"];

/// The generated mesh of that name.
pub fn by_name(name: &str) -> Option<Mesh> {
    match name {
        "park" => Some(park::build()),
        _ => None,
    }
}
