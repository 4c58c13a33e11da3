//! Items that several test files use. Not every file uses all of it.
#![allow(dead_code)]

pub mod f32_shading;
pub mod scenes;
