//! Memory that a plan's own textures and buffers take, and the limit on it.

use super::text;
use crate::errors::plan::OutputError;
use crate::flow::{Allocation, Alone, Schedule};
use crate::resource::{Growth, Origin, Resource, ResourceId, ResourceKind};
use crate::source::Span;

/// Greatest number of allocations that a memory table lists; small ones rarely matter.
const ROWS: usize = 12;

/// Memory that one texture or buffer of the graph takes on the device; the host's resources have no
/// entry.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct MemoryEntry {
    /// [Full name](crate#terms) of the material, or of a buffer or texture that only one pass uses
    /// ([`Resource::name`]).
    pub name: String,
    /// Format of the texture that takes the memory; `None` for a buffer.
    pub format: Option<wgt::TextureFormat>,
    /// Width and height in texels of mip 0 of the texture that takes the memory; for a buffer `[n,
    /// 1]`, where n is its size in bytes.
    pub size: [u32; 2],
    /// Number of mip levels of the texture that takes the memory; 1 for a buffer.
    pub mips: u32,
    /// Number of array layers of the texture that takes the memory, or of slices of mip 0 of a 3D
    /// texture; 1 for a buffer.
    pub layers: u32,
    /// Memory in bytes that all texels or items take, without padding that a driver adds; the whole
    /// size also if the memory is shared. Doubled if a pass also reads the resource as it was in
    /// the frame before (`.previous`).
    pub bytes: u64,
    /// [Full names](crate#terms) of the other materials that use bytes of the same memory at other
    /// times of the frame, in the order of their first use; empty if the memory is not shared.
    pub shared_with: Vec<String>,
    /// Reason for which the memory is not shared; `None` if it may be.
    pub alone: Option<Alone>,
}

/// Resources of a plan, and the schedule with their allocations.
#[derive(Clone, Copy)]
pub(super) struct Memory<'a> {
    pub resources: &'a [Resource],
    pub schedule: &'a Schedule,
}

impl Memory<'_> {
    pub fn entries(&self) -> Vec<MemoryEntry> {
        let entry = |id: &ResourceId| {
            let resource = &self.resources[id.0];
            let placed = &self.schedule.aliases;
            let slot = placed.of.get(id)?;
            let (format, size, mips, layers) = match &resource.kind {
                ResourceKind::Texture(texture) => (
                    Some(texture.format),
                    texture.size,
                    texture.mips,
                    texture.layers,
                ),
                _ => {
                    let edge = u32::try_from(resource.kind.bytes()).unwrap_or(u32::MAX);
                    (None, [edge, 1], 1, 1)
                }
            };
            let aliases = placed.list[*slot].aliases.iter();
            Some(MemoryEntry {
                name: resource.name.clone(),
                format,
                size,
                mips,
                layers,
                bytes: self.bytes_of(*id),
                shared_with: aliases
                    .filter(|other| *other != id && placed.overlap(*id, **other))
                    .map(|other| self.resources[other.0].name.clone())
                    .collect(),
                alone: placed.alone.get(id).copied(),
            })
        };
        self.schedule.lifetimes.keys().filter_map(entry).collect()
    }

    pub fn growing(&self, limits: &wgt::Limits) -> Vec<(ResourceId, Growth)> {
        let largest = limits
            .max_buffer_size
            .min(limits.max_storage_buffer_binding_size);
        let live = growing(self.schedule.lifetimes.keys(), self.resources);
        let bounded = |(id, growth): (ResourceId, &Growth)| {
            let fits = match &self.resources[id.0].kind {
                ResourceKind::Buffer(buffer) => {
                    let items = buffer.stride.saturating_mul(buffer.count?);
                    let fixed = buffer.bytes.saturating_sub(items);
                    largest.saturating_sub(fixed).checked_div(buffer.stride)?
                }
                _ => u64::from(limits.max_texture_array_layers),
            };
            let max = growth.max.min(fits);
            let counter = growth.counter.clone();
            Some((id, Growth { counter, max }))
        };
        live.filter_map(bounded).collect()
    }

    pub fn bytes(&self) -> u64 {
        let allocations = self.schedule.aliases.list.iter();
        let bytes = allocations.map(|allocation| self.allocation_bytes(allocation));
        bytes.fold(0, u64::saturating_add)
    }

    pub fn saved_bytes(&self) -> u64 {
        let own = self.schedule.aliases.of.keys().map(|id| self.bytes_of(*id));
        own.fold(0, u64::saturating_add)
            .saturating_sub(self.bytes())
    }

    pub fn table(&self) -> String {
        let allocations = self.schedule.aliases.list.iter();
        let mut rows: Vec<(u64, [String; 4])> = allocations
            .map(|allocation| (self.allocation_bytes(allocation), self.row(allocation)))
            .collect();
        rows.sort_by_key(|(bytes, _)| std::cmp::Reverse(*bytes));
        let rest = rows.split_off(rows.len().min(ROWS));
        if !rest.is_empty() {
            let bytes = rest.iter().map(|(bytes, _)| *bytes);
            let sum = bytes.fold(0, u64::saturating_add);
            rows.push((sum, named(format!("{} more", rest.len()))));
        }
        rows.push((self.bytes(), named("all together".to_owned())));
        let width = |column: usize| {
            let cells = rows.iter().map(|(_, cells)| cells[column].chars().count());
            cells.max().unwrap_or_default()
        };
        let [name, size, format] = [0, 1, 2].map(width);
        let line = |(bytes, cells): &(u64, [String; 4])| {
            let bytes = text::bytes(*bytes);
            let [names, sizes, formats, alone] = cells;
            let line =
                format!("{names:name$}  {sizes:size$}  {formats:format$}  {bytes:>10}  {alone}");
            line.trim_end().to_owned()
        };
        rows.iter().map(line).collect::<Vec<_>>().join("\n")
    }

    /// Returns the names of the resources, the size and the format of an allocation, and the reason
    /// for which it is not shared, as text.
    fn row(&self, allocation: &Allocation) -> [String; 4] {
        let name = |alias: &ResourceId| self.resources[alias.0].name.as_str();
        let names: Vec<&str> = allocation.aliases.iter().map(name).collect();
        let versions = match self.versions(allocation.aliases[0]) {
            1 => String::new(),
            versions => format!(", {versions} versions"),
        };
        let (size, format) = match &self.resources[allocation.aliases[0].0].kind {
            ResourceKind::Texture(texture) => {
                let mut size = format!("{}×{}", texture.size[0], texture.size[1]);
                if texture.layers > 1 {
                    size.push_str(&format!(", {} layers", texture.layers));
                }
                if texture.mips > 1 {
                    size.push_str(&format!(", {} mips", texture.mips));
                }
                (size, format!("{:?}", texture.format))
            }
            _ => ("buffer".to_owned(), String::new()),
        };
        // One name may be as long as a line; many are as good as a few.
        let names = match &names[..] {
            [first, second, third, .., _] => {
                format!(
                    "{first}, {second}, {third} and {} more in turn",
                    names.len() - 3
                )
            }
            [_] | [] => names.join(""),
            _ => format!("{} in turn", names.join(", ")),
        };
        let alone = self.schedule.aliases.alone.get(&allocation.aliases[0]);
        let alone = alone.map_or("", |alone| alone.text()).to_owned();
        [text::cut(&names, 40), size + &versions, format, alone]
    }

    /// Returns the error for a plan whose textures and buffers take more than `limit` bytes
    /// together; `None` if they do not, or without a limit. The error is reported at `place`.
    pub fn check(&self, limit: Option<u64>, place: Span) -> Option<OutputError> {
        let takes = self.bytes();
        let limit = limit.filter(|limit| takes > *limit)?;
        let largest = self.schedule.aliases.list.iter().max_by_key(|allocation| {
            // Among equals the first one counts: `max_by_key` would take the last.
            let first = std::cmp::Reverse(allocation.aliases[0]);
            (self.allocation_bytes(allocation), first)
        });
        Some(OutputError::Memory {
            graph: place.file.name.to_string(),
            takes: text::bytes(takes),
            limit: text::bytes(limit),
            table: self.table(),
            largest: largest
                .and_then(|largest| self.resources[largest.aliases[0].0].declared.clone()),
            place,
        })
    }

    fn allocation_bytes(&self, allocation: &Allocation) -> u64 {
        let versions = self.versions(allocation.aliases[0]);
        allocation.bytes.saturating_mul(versions as u64)
    }

    fn bytes_of(&self, id: ResourceId) -> u64 {
        let bytes = self.resources[id.0].kind.bytes();
        bytes.saturating_mul(self.versions(id) as u64)
    }

    pub fn versions(&self, id: ResourceId) -> usize {
        1 + usize::from(self.schedule.ping_pong.contains(&id))
    }
}

/// A row of the table with nothing but a name.
fn named(name: String) -> [String; 4] {
    [name, String::new(), String::new(), String::new()]
}

/// Returns the resources that grow, with their growth. Last frame's version of a growing resource
/// is not listed.
pub(super) fn growing<'a>(
    ids: impl Iterator<Item = &'a ResourceId>,
    resources: &'a [Resource],
) -> impl Iterator<Item = (ResourceId, &'a Growth)> {
    ids.filter_map(|id| match &resources[id.index()] {
        Resource {
            origin: Origin::Own,
            growth: Some(growth),
            ..
        } => Some((*id, growth)),
        _ => None,
    })
}
