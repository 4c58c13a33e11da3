#![doc = include_str!("../README.md")]
//!
//! docs/embedding.md in the repository is the guide for engines.
//!
//! - [`SceneProvider`] uploads a [`skiagraph_scene::Scene`] piece by piece, as the passes of a
//!   graph need it.
//! - [`registry`] knows the standard pass kinds and [`Trace`], which traces a buffer of rays on
//!   compute shaders and writes a buffer of hits.
//! - [`EmbeddedSources`] holds the documents and shaders of the presets, [`presets()`] lists the
//!   presets.
//!
//! # Terms
//!
//! [`skiagraph_graph`](skiagraph_graph#terms) explains documents, passes, plans and providers.
//!
//! - *Shadow method*: a graph document with the output `visibility`, the share of the light that
//!   arrives at each pixel: 0 in shadow, 1 in full light. A *preset* ([`Preset`]) is one that ships
//!   with Skiagraph.
//! - *World space* is right-handed. Its lengths are *scene units*, of any length.
//! - *Primitive*: a triangle of the mesh. Its *id* is its index in
//!   [`Mesh::triangles`](skiagraph_scene::Mesh::triangles). Positions are *welded*: corners of
//!   equal position share one.
//! - *Receiver*: the point of a surface that a pixel shows. *Caster*: a triangle that may keep the
//!   light from it.
//! - *Light space*: the space of a shadow map ([`LightUniform`](uniforms::LightUniform)).
//! - *Light with an extent*: a sun with an angular diameter, or a lamp with a radius. Its shadows
//!   have a penumbra; those of other lights are *hard*.
//! - *Part*: a piece of the mesh that the host moves by itself
//!   ([`SceneProvider::set_transforms`]).
//! - *Masked* triangle: one that the alpha of its texture cuts out.
//! - *Hierarchy*: a bounding-volume hierarchy over the triangles. It is *refitted* if only its
//!   boxes change, not its tree.

mod adjacencies;
mod atlas;
mod buffers;
mod built;
mod changes;
#[cfg(feature = "embree")]
mod embree;
mod error;
mod eye;
mod geometry;
mod hierarchies;
mod host;
mod host_buffers;
mod lights;
pub mod names;
mod outlines;
mod painted;
mod part;
mod part_mesh;
mod parts;
mod piece;
mod placed;
mod presets;
mod provider;
mod ray_query;
mod recorded;
mod solids;
mod space;
mod trace;
mod trees;
pub mod uniforms;
mod view;

pub use atlas::MaterialRecord;
pub use built::{Built, How, Work};
pub use error::Error;
pub use eye::{Depth, Eye, EyeError};
pub use host::{GpuMesh, GpuMeshError};
pub use host_buffers::{HostDecoder, HostIndices, HostMesh, HostMeshError, HostVertices};
pub use part_mesh::PartMesh;
pub use parts::{PartId, Room};
pub use presets::{EmbeddedSources, Preset, load_unit_visibility, presets, registry};
pub use provider::{InEncoder, SceneProvider};
pub use trace::{Direction, Engine, Mode, Trace};
pub use view::SceneView;
