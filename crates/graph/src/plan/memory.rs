//! What a plan's own textures and buffers take.

use super::{Plan, ResourceId, ResourceKind};
use crate::pool::{Slot, bytes};

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

    fn slot_bytes(&self, slot: &Slot) -> u64 {
        let tenant = slot.tenants[0];
        bytes(&self.resources[tenant.0]).saturating_mul(self.versions(tenant) as u64)
    }

    /// How many allocations a resource has: two if it is also read as it was in the frame before.
    pub(crate) fn versions(&self, id: ResourceId) -> usize {
        1 + usize::from(self.histories.contains(&id))
    }
}
