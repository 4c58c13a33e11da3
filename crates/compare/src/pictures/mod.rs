//! Texels and items as files: the pictures of a run, and what `run --save` writes of any material.

pub mod buffer_csv;
pub mod colours;
pub mod material;
mod png;
pub mod run_pictures;
pub mod save;
