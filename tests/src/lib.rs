//! CPU references of the shaders, which tests across Skiagraph's crates hold the GPU against, and a
//! provider of buffers that tests and benchmarks write; the tests are the files beside this crate's
//! `src`.

pub mod cpu_reference;
pub mod extended;
