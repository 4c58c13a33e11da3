//! Phase 6: the [`Plan`], with everything that an executor needs to create resources and to run
//! passes on a device.

mod backend;
pub(crate) mod check;
pub(crate) mod items;
pub(crate) mod make;
pub(crate) mod memory;
#[expect(
    clippy::module_inception,
    reason = "the folder is named after what it makes"
)]
pub(crate) mod plan;
pub(crate) mod readable;
pub(crate) mod summary;
pub mod text;
mod uniforms;
mod usages;

pub use items::PartSummary;
pub use make::CulledPass;
pub use memory::MemoryEntry;
pub use plan::Plan;
pub use summary::{OutputSummary, PassSummary};
