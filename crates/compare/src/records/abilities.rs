//! Abilities of an adapter: its limits and features, and whether its clock can be trusted.
//!
//! ```
//! use skiagraph_compare::{
//!     measuring::{abilities::abilities, device::{self, GpuRequest}},
//!     records::abilities::Ability,
//! };
//!
//! if let Ok(gpu) = device::open(&GpuRequest::default(), []) {
//!     let abilities = abilities(&gpu);
//!     assert!(abilities.limits.texture_edge >= 2048);
//!     println!("{abilities}, ray queries: {}", abilities.has(Ability::RayQuery));
//! }
//! ```

use crate::records::results::{Adapter, Machine};
use crate::wording::bytes;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, fmt};

/// Abilities of an opened adapter: the JSON that `doctor --format json` prints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Abilities {
    /// Version of this schema: 1.
    pub schema: u32,
    /// The program that asked, `skiagraph 0.1.0`.
    pub program: String,
    /// Machine that the adapter is in.
    pub machine: Machine,
    /// All adapters of the machine, the preferred one first.
    pub adapters: Vec<Adapter>,
    /// The adapter that was opened. `gpu_unavailable` holds the reason why its timestamps cannot be
    /// trusted; absent if they can.
    pub adapter: Adapter,
    /// Limits of the adapter.
    pub limits: Limits,
    /// All optional abilities: true for those that the adapter has.
    pub features: BTreeMap<Ability, bool>,
}

/// Limits of an adapter, in wgpu's terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limits {
    /// Most texels along an edge of a 2D texture.
    pub texture_edge: u32,
    /// Most bytes of a storage buffer that a shader sees at once.
    pub storage_binding: u64,
    /// Most bytes of a buffer.
    pub buffer: u64,
    /// Most bytes that the textures and buffers of a graph may take together
    /// ([`Gpu::memory`](skiagraph_gpu::device::Gpu::memory)); null where the driver does not say.
    pub memory: Option<u64>,
    /// Most invocations (threads) of a workgroup.
    pub threads: u32,
    /// Most workgroups along a dimension of a dispatch.
    pub groups: u32,
}

/// Optional ability of an adapter that graphs or their timing use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ability {
    /// Timestamps around passes: `TIMESTAMP_QUERY`.
    Timestamps,
    /// Timestamps between passes: `TIMESTAMP_QUERY_INSIDE_ENCODERS`.
    TimestampsBetween,
    /// Timestamps inside passes: `TIMESTAMP_QUERY_INSIDE_PASSES`.
    TimestampsInside,
    /// Filtering of textures of 32-bit floats: `FLOAT32_FILTERABLE`.
    FilteredFloats,
    /// Ray queries in shaders: `EXPERIMENTAL_RAY_QUERY`.
    RayQuery,
}

impl Ability {
    /// All abilities, in the order in which they are shown.
    pub const ALL: [Self; 5] = [
        Self::Timestamps,
        Self::TimestampsBetween,
        Self::TimestampsInside,
        Self::FilteredFloats,
        Self::RayQuery,
    ];

    /// Returns the feature of wgpu that gives this ability.
    pub fn feature(self) -> wgpu::Features {
        match self {
            Self::Timestamps => wgpu::Features::TIMESTAMP_QUERY,
            Self::TimestampsBetween => wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS,
            Self::TimestampsInside => wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES,
            Self::FilteredFloats => wgpu::Features::FLOAT32_FILTERABLE,
            Self::RayQuery => wgpu::Features::EXPERIMENTAL_RAY_QUERY,
        }
    }

    /// Returns the name and use of the ability, as text for a list.
    pub fn purpose(self) -> &'static str {
        match self {
            Self::Timestamps => "timestamps: GPU time of each pass",
            Self::TimestampsBetween => "timestamps between passes: GPU time of copies and clears",
            Self::TimestampsInside => {
                "timestamps inside passes: the way around drivers that time compute wrongly"
            }
            Self::FilteredFloats => "filtering of 32-bit float textures",
            Self::RayQuery => "ray queries: `Trace` with `engine: RayQuery`",
        }
    }
}

impl Abilities {
    /// True if the adapter has this ability.
    pub fn has(&self, ability: Ability) -> bool {
        self.features.get(&ability).copied().unwrap_or_default()
    }
}

/// Returns an adapter as `doctor` lists it: name, graphics API, device type and driver, separated
/// by ` · `.
pub fn line(adapter: &Adapter) -> String {
    let (name, backend) = (&adapter.name, &adapter.backend);
    let (kind, driver) = (&adapter.device_type, &adapter.driver);
    format!("{name} · {backend} · {kind} · {driver}")
}

impl fmt::Display for Abilities {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let limits = &self.limits;
        let (edge, storage) = (limits.texture_edge, limits.storage_binding);
        // Larger meshes are drawn and traced in parts, but indices are bound whole.
        let (storage, triangles) = (bytes(storage), storage / 12 / 1_000_000);
        let memory = limits.memory.map(bytes);
        let memory = memory.unwrap_or("what the driver gives (it does not say how much)".into());
        writeln!(f, "\nChosen: {}", line(&self.adapter))?;
        writeln!(f, "  textures: up to {edge}x{edge}")?;
        write!(f, "  storage buffer binding: up to {storage} ")?;
        writeln!(f, "(indices of {triangles} million triangles)")?;
        writeln!(f, "  buffer: up to {}", bytes(limits.buffer))?;
        writeln!(f, "  memory for a graph: {memory}")?;
        let (threads, groups) = (limits.threads, limits.groups);
        write!(f, "  compute: {threads} invocations per workgroup, ")?;
        writeln!(f, "{groups} groups per dimension")?;
        for ability in Ability::ALL {
            let has = if self.has(ability) { "yes" } else { "no" };
            writeln!(f, "  {has:<3} {}", ability.purpose())?;
        }
        let are_true = "true (a long dispatch after a raster pass takes as long as the clock says)";
        match &self.adapter.gpu_unavailable {
            None => writeln!(f, "  GPU times: {are_true}"),
            Some(reason) => writeln!(f, "  GPU times: none, {reason}"),
        }
    }
}
