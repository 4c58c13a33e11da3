//! CPU references of the shaders, which tests across Skiagraph's crates hold the GPU against; the
//! tests are the files beside this crate's `src`.

pub mod cpu_reference;
