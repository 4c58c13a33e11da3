//! What a plan's own textures and buffers take, and whether that is too much.

use super::{Plan, ResourceId, ResourceKind};
use crate::{
    diagnostics::{Code, Diagnostic},
    draw::text,
    pool::{Slot, bytes},
};

/// Rows of a memory table: what does not fit is rarely found among the small ones.
const ROWS: usize = 12;

/// One of the graph's own textures or buffers, and the memory it takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryEntry {
    /// The material, or a pass's own buffer.
    pub name: String,
    /// Format of a texture; `None` for a buffer.
    pub format: Option<wgpu::TextureFormat>,
    /// Width and height in texels of a texture's mip 0; `[bytes, 1]` of a buffer.
    pub size: [u32; 2],
    /// Mip levels of a texture; 1 for a buffer.
    pub mips: u32,
    /// Array layers of a texture; 1 for a buffer.
    pub layers: u32,
    /// What its texels or items take; drivers may add to it.
    pub bytes: u64,
    /// Materials that live in the same memory at other times of the frame; the memory is as large as the largest of them.
    pub shared_with: Vec<String>,
}

impl Plan {
    /// The graph's own textures and buffers with what they take, in the order of the document.
    pub fn memory(&self) -> Vec<MemoryEntry> {
        let entry = |id: &ResourceId| {
            let resource = &self.resources[id.0];
            let slot = self.slots.of.get(id)?;
            let (format, size, mips, layers) = match &resource.kind {
                ResourceKind::Texture(texture) => (
                    Some(texture.format),
                    texture.size,
                    texture.mips,
                    texture.layers,
                ),
                _ => {
                    let edge = u32::try_from(bytes(resource)).unwrap_or(u32::MAX);
                    (None, [edge, 1], 1, 1)
                }
            };
            let others = self.slots.list[*slot].tenants.iter();
            Some(MemoryEntry {
                name: resource.name.clone(),
                format,
                size,
                mips,
                layers,
                bytes: bytes(resource).saturating_mul(self.versions(*id) as u64),
                shared_with: others
                    .filter(|other| *other != id)
                    .map(|other| self.resources[other.0].name.clone())
                    .collect(),
            })
        };
        self.lifetimes.keys().filter_map(entry).collect()
    }

    /// Bytes of the graph's own textures and buffers. One that is also read as it was in the frame before takes its size twice.
    pub fn memory_bytes(&self) -> u64 {
        let slots = self.slots.list.iter().map(|slot| self.slot_bytes(slot));
        slots.fold(0, u64::saturating_add)
    }

    /// Bytes that would be needed besides if no two resources shared memory.
    pub fn saved_bytes(&self) -> u64 {
        let of_slot =
            |slot: &Slot| (slot.tenants.len() as u64 - 1).saturating_mul(self.slot_bytes(slot));
        self.slots
            .list
            .iter()
            .map(of_slot)
            .fold(0, u64::saturating_add)
    }

    /// What takes the most memory, for a person who must save some: a line per allocation, the largest first, then the rest in one,
    /// then the sum. Materials that take turns in one allocation stand together.
    pub fn memory_table(&self) -> String {
        let mut rows: Vec<(u64, [String; 3])> = self
            .slots
            .list
            .iter()
            .map(|slot| (self.slot_bytes(slot), self.row(slot)))
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
    fn row(&self, slot: &Slot) -> [String; 3] {
        let names: Vec<&str> = slot
            .tenants
            .iter()
            .map(|tenant| self.resources[tenant.0].name.as_str())
            .collect();
        let versions = match self.versions(slot.tenants[0]) {
            1 => String::new(),
            versions => format!(", {versions} versions"),
        };
        let (size, format) = match &self.resources[slot.tenants[0].0].kind {
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

    /// Refuses a plan that takes more than there is, with what takes the most.
    pub(super) fn check_memory(&self, limit: Option<u64>) -> Option<Diagnostic> {
        let takes = self.memory_bytes();
        let limit = limit.filter(|limit| takes > *limit)?;
        let message = format!(
            "the materials of `{}` take {}, but there are only {} of memory for them",
            self.graph.place().file.name,
            text::bytes(takes),
            text::bytes(limit)
        );
        let help = format!(
            "make the largest ones smaller (a smaller viewport, the param that sizes them, fewer layers, a format with fewer bytes), or allow more memory\n{}",
            self.memory_table()
        );
        let largest = self.slots.list.iter().max_by_key(|slot| {
            // Of equals the first one: `max_by_key` would take the last.
            (self.slot_bytes(slot), std::cmp::Reverse(slot.tenants[0]))
        });
        let place = largest.and_then(|slot| self.resources[slot.tenants[0].0].declared.clone());
        let error = Diagnostic::error(Code::Memory, message).help(help);
        Some(match place {
            Some(span) => error.at(span, "the largest of them"),
            None => error.at(self.graph.place(), ""),
        })
    }

    fn slot_bytes(&self, slot: &Slot) -> u64 {
        let tenant = slot.tenants[0];
        bytes(&self.resources[tenant.0]).saturating_mul(self.versions(tenant) as u64)
    }

    /// How many allocations a resource has: two if it is also read as it was in the frame before.
    pub(crate) fn versions(&self, id: ResourceId) -> usize {
        1 + usize::from(self.histories.contains(&id))
    }
}
