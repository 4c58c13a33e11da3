//! The pass kinds that need nothing but the graph: one file each.

mod clear;
mod compute;
mod copy;
mod fullscreen;
mod raster;

pub use clear::Clear;
pub use compute::Compute;
pub use copy::Copy;
pub use fullscreen::Fullscreen;
pub use raster::Raster;
