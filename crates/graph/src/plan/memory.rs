//! Memory of a plan's own textures and buffers, and the limit on it.

use super::{make::growing, plan::Plan, text};
use crate::{
    errors::plan::OutputError,
    flow::aliases::Allocation,
    resource::{Growth, ResourceId, ResourceKind},
};

/// Rows of a memory table: the small ones rarely show what does not fit.
const ROWS: usize = 12;

/// One of the graph's own textures or buffers, and the memory it takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryEntry {
    /// The material, or a pass's own buffer.
    pub name: String,
    /// Format of a texture; `None` for a buffer.
    pub format: Option<wgt::TextureFormat>,
    /// Width and height in texels of a texture's mip 0; `[bytes, 1]` of a buffer.
    pub size: [u32; 2],
    /// Mip levels of a texture; 1 for a buffer.
    pub mips: u32,
    /// Array layers of a texture; 1 for a buffer.
    pub layers: u32,
    /// Bytes of its texels or items; drivers may add to it.
    pub bytes: u64,
    /// Materials that live in the same memory at other times of the frame; the memory is as large
    /// as the largest of them.
    pub shared_with: Vec<String>,
}

impl Plan {
    /// The graph's own textures and buffers with what they take, in the order of the document.
    pub fn memory(&self) -> Vec<MemoryEntry> {
        let entry = |id: &ResourceId| {
            let resource = self.resource(*id);
            let slot = self.schedule().aliases.of.get(id)?;
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
            let others = self.schedule().aliases.list[*slot].aliases.iter();
            Some(MemoryEntry {
                name: resource.name.clone(),
                format,
                size,
                mips,
                layers,
                bytes: resource
                    .kind
                    .bytes()
                    .saturating_mul(self.versions(*id) as u64),
                shared_with: others
                    .filter(|other| *other != id)
                    .map(|other| self.resource(*other).name.clone())
                    .collect(),
            })
        };
        self.schedule().lifetimes.keys().filter_map(entry).collect()
    }

    /// The live buffers and textures that may grow, each with where its frame counts the items or
    /// layers that it would have needed, and the most that it may have: by the document, and by the
    /// device's limits.
    pub fn growing(&self) -> Vec<(ResourceId, Growth)> {
        let limits = &self.request.limits;
        let largest = limits
            .max_buffer_size
            .min(limits.max_storage_buffer_binding_size);
        let live = growing(self.schedule().lifetimes.keys(), &self.resources);
        let bounded = |(id, growth): (ResourceId, &Growth)| {
            let fits = match &self.resource(id).kind {
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

    /// Bytes of the graph's own textures and buffers. One that is also read as it was in the frame
    /// before takes its size twice.
    pub fn memory_bytes(&self) -> u64 {
        let allocations = self.schedule().aliases.list.iter();
        let bytes = allocations.map(|allocation| self.allocation_bytes(allocation));
        bytes.fold(0, u64::saturating_add)
    }

    /// Bytes that would be needed besides if no two resources shared memory.
    pub fn saved_bytes(&self) -> u64 {
        let saved = |allocation: &Allocation| {
            let others = allocation.aliases.len() as u64 - 1;
            others.saturating_mul(self.allocation_bytes(allocation))
        };
        let allocations = self.schedule().aliases.list.iter();
        allocations.map(saved).fold(0, u64::saturating_add)
    }

    /// Returns a table of the largest uses of memory: a line per allocation, the largest first,
    /// then the rest in one, then the sum. Materials that take turns in one allocation stand
    /// together.
    pub fn memory_table(&self) -> String {
        let allocations = self.schedule().aliases.list.iter();
        let mut rows: Vec<(u64, [String; 3])> = allocations
            .map(|allocation| (self.allocation_bytes(allocation), self.row(allocation)))
            .collect();
        rows.sort_by_key(|(bytes, _)| std::cmp::Reverse(*bytes));
        let rest = rows.split_off(rows.len().min(ROWS));
        if !rest.is_empty() {
            let sum = rest
                .iter()
                .fold(0, |sum: u64, (bytes, _)| sum.saturating_add(*bytes));
            let name = format!("{} more", rest.len());
            rows.push((sum, [name, String::new(), String::new()]));
        }
        let all = ["all together".to_owned(), String::new(), String::new()];
        rows.push((self.memory_bytes(), all));
        let width = |column: usize| {
            let cells = rows.iter().map(|(_, cells)| cells[column].chars().count());
            cells.max().unwrap_or_default()
        };
        let [name, size, format] = [0, 1, 2].map(width);
        let line = |(bytes, cells): &(u64, [String; 3])| {
            let bytes = text::bytes(*bytes);
            format!(
                "{:name$}  {:size$}  {:format$}  {bytes:>10}",
                cells[0], cells[1], cells[2]
            )
        };
        rows.iter().map(line).collect::<Vec<_>>().join("\n")
    }

    /// Name, size and format of an allocation.
    fn row(&self, allocation: &Allocation) -> [String; 3] {
        let names: Vec<&str> = allocation
            .aliases
            .iter()
            .map(|alias| self.resource(*alias).name.as_str())
            .collect();
        let versions = match self.versions(allocation.aliases[0]) {
            1 => String::new(),
            versions => format!(", {versions} versions"),
        };
        let (size, format) = match &self.resource(allocation.aliases[0]).kind {
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
        [text::cut(&names, 40), size + &versions, format]
    }

    /// Reports a plan that takes more memory than there is.
    pub(super) fn check_memory(&self, limit: Option<u64>) -> Option<OutputError> {
        let takes = self.memory_bytes();
        let limit = limit.filter(|limit| takes > *limit)?;
        let largest = self
            .schedule()
            .aliases
            .list
            .iter()
            .max_by_key(|allocation| {
                // Among equals the first one counts: `max_by_key` would take the last.
                let first = std::cmp::Reverse(allocation.aliases[0]);
                (self.allocation_bytes(allocation), first)
            });
        let place = self.graph().place();
        Some(OutputError::Memory {
            graph: place.file.name.to_string(),
            takes: text::bytes(takes),
            limit: text::bytes(limit),
            table: self.memory_table(),
            largest: largest.and_then(|largest| self.resource(largest.aliases[0]).declared.clone()),
            place,
        })
    }

    fn allocation_bytes(&self, allocation: &Allocation) -> u64 {
        let alias = allocation.aliases[0];
        let bytes = self.resource(alias).kind.bytes();
        bytes.saturating_mul(self.versions(alias) as u64)
    }

    /// How many textures or buffers a resource takes: two if it is also read as it was in the frame
    /// before.
    pub fn versions(&self, id: ResourceId) -> usize {
        1 + usize::from(self.schedule().ping_pong.contains(&id))
    }
}
