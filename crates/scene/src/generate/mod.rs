//! Meshes that the crate generates, with the same bits on every machine.
//!
//! Only operations that IEEE 754 rounds correctly are used (`+ − × ÷ √`): angles go through a
//! series of our own, not through the platform's `sin`.

mod avenue;
mod city;
mod forest;
mod generator;
mod level;
pub mod numbers;
mod park;
mod solid;
mod stamp;
mod tree;

pub use generator::{Generator, TRIANGLES};
