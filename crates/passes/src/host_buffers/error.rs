//! Why a host's vertices cannot be read.

use glam::Vec3;
use skiagraph_scene::IndexedError;
use wgpu::VertexFormat;

/// Reason why a [`HostMesh`](super::HostMesh) cannot be made of a host's vertices.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HostMeshError {
    /// The buffer lacks the usage `STORAGE`.
    #[error("the buffer of the vertices cannot be bound: it needs the usage STORAGE")]
    Usage,
    /// The buffer or decoder of the vertices is of another device, or the device is lost. Holds the
    /// thing that is of another device: `buffer` or `decoder`.
    #[error(
        "the {0} of the vertices is of another device than the one that was given, or that is \
         lost: make it on the device that the scene is drawn on"
    )]
    OtherDevice(&'static str),
    /// Vertices in another buffer are fewer or more than those of the mesh, or lack its normals.
    #[error(
        "the mesh has {} vertices with normals: {}, but given were {} with normals: {}; give as \
         many, in the same order",
        mesh.0, mesh.1, given.0, given.1
    )]
    OtherVertices {
        /// Number of the mesh's vertices, and true if they have normals.
        mesh: (u32, bool),
        /// Number of the vertices that were given, and true if they have normals.
        given: (u32, bool),
    },
    /// An offset or the stride is not divisible by 4.
    #[error(
        "the {what} of the vertices, {bytes} bytes, is not divisible by 4: pad them to words of \
         four bytes"
    )]
    Alignment {
        /// Length that is meant: `offset`, `stride`, or the attribute `position` or `normal`.
        what: &'static str,
        /// Length in bytes.
        bytes: u64,
    },
    /// An attribute has a format that is not read.
    #[error(
        "the {name} has the format {format:?}; read are Float32x3, Float32x4, Float16x4, and \
         Snorm, Unorm, Sint, Uint of 16x4 and 8x4, and others by a `HostDecoder`"
    )]
    Format {
        /// Attribute: `position` or `normal`.
        name: &'static str,
        /// Format that was given.
        format: VertexFormat,
    },
    /// The module of a [`HostDecoder`](super::HostDecoder) cannot be compiled.
    #[error(
        "the module that decodes a host's vertices cannot be compiled; it needs {needed}:\n{why}"
    )]
    Module {
        /// Functions that it needs.
        needed: &'static str,
        /// Reason that wgpu gives, with the line.
        why: String,
    },
    /// The device could not decode the vertices at rest. Holds the reason that wgpu gives.
    #[error("the vertices at rest could not be decoded by the host's module: {0}")]
    Decoding(String),
    /// An attribute reaches beyond the end of its vertex.
    #[error("the {name}, {format:?} at byte {at}, does not fit a vertex of {stride} bytes")]
    Attribute {
        /// Attribute: `position` or `normal`.
        name: &'static str,
        /// Its format.
        format: VertexFormat,
        /// Its offset within a vertex, in bytes.
        at: u64,
        /// Distance from a vertex to the next, in bytes.
        stride: u64,
    },
    /// The vertices reach beyond the end of their buffer.
    #[error(
        "{count} vertices of {stride} bytes from byte {offset} on reach beyond the end of their \
         buffer of {size} bytes"
    )]
    Beyond {
        /// Byte of the buffer at which they begin.
        offset: u64,
        /// Number of vertices.
        count: u32,
        /// Distance from a vertex to the next, in bytes.
        stride: u64,
        /// Size of the buffer in bytes.
        size: u64,
    },
    /// The vertices at rest were given with another number of bytes.
    #[error(
        "{needed} bytes of vertices at rest are needed, but {given} were given: give those of the \
         mesh alone, from its first vertex to its last"
    )]
    Rest {
        /// Number of bytes from the start of the first vertex to the end of the last.
        needed: u64,
        /// Number of bytes that were given.
        given: u64,
    },
    /// The device cannot bind so many bytes.
    #[error(
        "{what} of the mesh take {bytes} bytes, and the device binds {limit} at most: divide the \
         mesh"
    )]
    TooLarge {
        /// Data that is too large: `the vertices`, `the positions`, `the normals`.
        what: &'static str,
        /// Number of bytes.
        bytes: u64,
        /// Most bytes that the device binds.
        limit: u64,
    },
    /// The vertices and indices do not form a mesh, for example because an index lies beyond the
    /// last vertex.
    #[error(transparent)]
    Mesh(#[from] IndexedError),
    /// No triangle has three different positions.
    #[error("the mesh has no triangle with three different positions")]
    Empty,
    /// A vertex at rest lies outside of the bounds that were stated, or these are not finite.
    #[error(
        "the vertex at {position} at rest lies beyond the stated bounds {low} to {high}, or these \
         are not finite: state others"
    )]
    Bounds {
        /// Position of the vertex at rest.
        position: Vec3,
        /// Low corner of the bounds.
        low: Vec3,
        /// High corner of the bounds.
        high: Vec3,
    },
}
