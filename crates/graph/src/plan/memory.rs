//! What a plan's own textures and buffers take.

use super::{Buffer, Plan, Resource, ResourceId, ResourceKind};

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
            let Resource { name, kind, .. } = &self.resources[id.0];
            let (format, size, mips, layers, bytes) = match kind {
                ResourceKind::Texture(texture) => (
                    Some(texture.format),
                    texture.size,
                    texture.mips,
                    texture.layers,
                    texture.bytes(),
                ),
                ResourceKind::Buffer(Buffer { bytes, .. }) => {
                    let edge = u32::try_from(*bytes).unwrap_or(u32::MAX);
                    (None, [edge, 1], 1, 1, *bytes)
                }
                ResourceKind::Sampler(_) | ResourceKind::Provided(_) => return None,
            };
            Some(MemoryEntry {
                name: name.clone(),
                format,
                size,
                mips,
                layers,
                bytes,
                shared_with: Vec::new(),
            })
        };
        self.lifetimes.keys().filter_map(entry).collect()
    }

    /// Bytes of the graph's own textures and buffers.
    pub fn memory_bytes(&self) -> u64 {
        let entries = self.memory().into_iter();
        entries
            .map(|entry| entry.bytes)
            .fold(0, u64::saturating_add)
    }

    /// Bytes saved by resources that share memory. None do so far.
    pub fn saved_bytes(&self) -> u64 {
        0
    }
}
