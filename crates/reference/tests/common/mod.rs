//! What several test files use. Not every file uses all of it.
#![allow(dead_code)]

pub mod scenes;
pub mod twin;
