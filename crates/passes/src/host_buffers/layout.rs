//! Vertices as they lie in a host's buffer, and how they are read.

use super::{decoder::HostDecoder, error::HostMeshError};
use half::f16;
use wgpu::VertexFormat;

/// Formats of attributes, in the order of their numbers in place.wgsl.
const FORMATS: [VertexFormat; 11] = [
    VertexFormat::Float32x3,
    VertexFormat::Float16x4,
    VertexFormat::Snorm16x4,
    VertexFormat::Unorm16x4,
    VertexFormat::Sint16x4,
    VertexFormat::Uint16x4,
    VertexFormat::Snorm8x4,
    VertexFormat::Unorm8x4,
    VertexFormat::Sint8x4,
    VertexFormat::Uint8x4,
    // Read as `Float32x3`.
    VertexFormat::Float32x4,
];

/// Range of vertices in a buffer of the host, such as one mesh of a mega-buffer. Positions are
/// three f32 at the start of each vertex, and there are no normals, unless its methods say
/// otherwise.
///
/// Attributes have one of the formats `Float32x3`, `Float32x4`, `Float16x4`, and `Snorm`, `Unorm`,
/// `Sint`, `Uint` of `16x4` and `8x4`, of which the fourth component is not read. A mesh whose
/// integers stand for other lengths gets the scale and offset in the map of its part. The inverse
/// transpose of a part's map moves its normals, so normals are those of the surface that the stored
/// positions form; where the map's scale differs by axis, normals of the mesh in its true shape
/// need a [decoder](Self::with_decoder).
#[derive(Clone, Debug)]
pub struct HostVertices {
    pub(super) buffer: wgpu::Buffer,
    pub(super) offset: u64,
    pub(super) stride: u64,
    pub(super) count: u32,
    pub(super) position: Attribute,
    pub(super) normal: Option<Attribute>,
    /// Reads them in place of both attributes.
    pub(super) decoder: Option<HostDecoder>,
}

/// Attribute of a vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attribute {
    pub name: &'static str,
    pub format: VertexFormat,
    /// Offset within a vertex, in bytes.
    pub at: u64,
}

impl HostVertices {
    /// Creates the range of `count` vertices from byte `offset` of a buffer on, each `stride` bytes
    /// after the one before. The buffer needs the usage `STORAGE`; `offset` and `stride` are
    /// divisible by 4. [`HostMesh::new`](crate::HostMesh::new) checks this, and that the formats
    /// can be read.
    pub fn new(buffer: &wgpu::Buffer, offset: u64, stride: u64, count: u32) -> Self {
        Self {
            buffer: buffer.clone(),
            offset,
            stride,
            count,
            position: Attribute::new("position", VertexFormat::Float32x3, 0),
            normal: None,
            decoder: None,
        }
    }

    /// Sets the format of positions, and their offset within a vertex in bytes, divisible by 4.
    pub fn with_position(mut self, format: VertexFormat, at: u64) -> Self {
        self.position = Attribute::new("position", format, at);
        self
    }

    /// Sets the format of normals, of any length, and their offset within a vertex in bytes,
    /// divisible by 4. Without them, or where one is 0, triangles have the normals of their planes.
    pub fn with_normal(mut self, format: VertexFormat, at: u64) -> Self {
        self.normal = Some(Attribute::new("normal", format, at));
        self
    }

    /// Has a module of the host read positions and normals, in place of the two attributes: for
    /// other formats, or for what is packed in ways of the host's own.
    pub fn with_decoder(mut self, decoder: &HostDecoder) -> Self {
        self.decoder = Some(decoder.clone());
        self
    }

    /// True if vertices have normals.
    pub(super) fn has_normals(&self) -> bool {
        match &self.decoder {
            Some(decoder) => decoder.has_normals,
            None => self.normal.is_some(),
        }
    }

    /// The attributes that are read, unless a module of the host reads vertices.
    fn attributes(&self) -> impl Iterator<Item = Attribute> {
        let attributes = [Some(self.position), self.normal].into_iter().flatten();
        attributes.filter(|_| self.decoder.is_none())
    }

    /// Checks that it can be read as it is described.
    pub(super) fn check(&self) -> Result<(), HostMeshError> {
        if !self.buffer.usage().contains(wgpu::BufferUsages::STORAGE) {
            return Err(HostMeshError::Usage);
        }
        let (offset, stride) = (self.offset, self.stride);
        let mut aligned = vec![("offset", offset), ("stride", stride)];
        for attribute in self.attributes() {
            attribute.check(stride)?;
            aligned.push((attribute.name, attribute.at));
        }
        if let Some(&(what, bytes)) = aligned.iter().find(|(_, at)| !at.is_multiple_of(4)) {
            return Err(HostMeshError::Alignment { what, bytes });
        }
        let (needed, size) = (self.offset.checked_add(self.length()), self.buffer.size());
        match needed {
            Some(needed) if needed <= size => Ok(()),
            _ => Err(HostMeshError::Beyond {
                offset,
                count: self.count,
                stride,
                size,
            }),
        }
    }

    /// Number of bytes from the start of the first vertex to the end of what is read of the last.
    pub(super) fn length(&self) -> u64 {
        let end = self.attributes().map(Attribute::end).max();
        // A module of the host may read all of it.
        let end = end.or(Some(self.stride.max(4)));
        let last = u64::from(self.count.saturating_sub(1)).saturating_mul(self.stride);
        last.saturating_add(end.unwrap_or_default())
    }

    /// Decodes an attribute of all vertices, whose bytes these are, without the host's module.
    pub(super) fn decoded(&self, attribute: Attribute, bytes: &[u8]) -> Vec<[f32; 3]> {
        let vertex = |index: u32| {
            let at = u64::from(index) * self.stride + attribute.at;
            attribute.decoded(&bytes[at as usize..])
        };
        (0..self.count).map(vertex).collect()
    }
}

impl Attribute {
    fn new(name: &'static str, format: VertexFormat, at: u64) -> Self {
        Self { name, format, at }
    }

    fn check(self, stride: u64) -> Result<(), HostMeshError> {
        let Self { name, format, at } = self;
        if !FORMATS.contains(&format) {
            return Err(HostMeshError::Format { name, format });
        }
        if at.checked_add(format.size()).is_none_or(|end| end > stride) {
            return Err(HostMeshError::Attribute {
                name,
                format,
                at,
                stride,
            });
        }
        Ok(())
    }

    fn end(self) -> u64 {
        self.at.saturating_add(self.format.size())
    }

    /// The number of its format in place.wgsl.
    pub fn code(self) -> u32 {
        let at = FORMATS.iter().position(|format| *format == self.format);
        at.map_or(0, |at| at as u32 % 10)
    }

    /// Three components, at the start of these bytes: each the f32 nearest to its value.
    fn decoded(self, bytes: &[u8]) -> [f32; 3] {
        let words = |at: usize| u16::from_le_bytes([bytes[2 * at], bytes[2 * at + 1]]);
        let [x, y, z] = [0, 1, 2];
        match self.format {
            VertexFormat::Float16x4 => [x, y, z].map(|at| f16::from_bits(words(at)).to_f32()),
            VertexFormat::Snorm16x4 => [x, y, z].map(|at| share(words(at).cast_signed(), 32767)),
            VertexFormat::Unorm16x4 => [x, y, z].map(|at| f32::from(words(at)) / 65535.0),
            VertexFormat::Sint16x4 => [x, y, z].map(|at| f32::from(words(at).cast_signed())),
            VertexFormat::Uint16x4 => [x, y, z].map(|at| f32::from(words(at))),
            VertexFormat::Snorm8x4 => [x, y, z].map(|at| share(bytes[at].cast_signed(), 127)),
            VertexFormat::Unorm8x4 => [x, y, z].map(|at| f32::from(bytes[at]) / 255.0),
            VertexFormat::Sint8x4 => [x, y, z].map(|at| f32::from(bytes[at].cast_signed())),
            VertexFormat::Uint8x4 => [x, y, z].map(|at| f32::from(bytes[at])),
            _ => bytemuck::pod_read_unaligned(&bytes[..12]),
        }
    }
}

fn share(integer: impl Into<f32>, most: i16) -> f32 {
    (integer.into() / f32::from(most)).max(-1.0)
}
