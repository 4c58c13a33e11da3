#![doc = include_str!("../README.md")]

mod case;
mod catalogue;
mod fences;
mod lamps;
mod light;
mod lists;
mod map;
mod masked;
mod plain;
mod rounding;
mod shape;
mod soft;
mod solids;
#[cfg(test)]
mod tests;
mod thin;
mod topology;

pub use case::{Casters, HardCase};
pub use catalogue::{case, cases};
