//! Scenes for Skiagraph: a triangle [`Mesh`] with its hierarchy ([`Bvh`]), named [`View`]s, and
//! [`Light`]s.
//!
//! Meshes and scenes from files (`.obj`, `.gltf`, `.ron`) need the feature `files`.
//!
//! The crate does not use the GPU. World space is right-handed and in scene units, of any length.
//! Positions are `f32` (the precision of mesh files and of the GPU); cameras and lights are `f64`,
//! so that an exact reference starts from unrounded input. A *primitive* is a triangle, and its
//! *id* the index in [`Mesh::triangles`]. A *receiver* is a point that is lit, a *caster* a
//! triangle that may keep the light from it. *Light space* is the space of a shadow map.
//!
//! ```
//! use skiagraph_scene::{Bvh, DirectionalLight, Indexed};
//!
//! let square = [[0.0; 3], [0.0, 0.0, 8.0], [8.0, 0.0, 8.0], [8.0, 0.0, 0.0]];
//! let mesh = Indexed {
//!     positions: &square,
//!     normals: &[],
//!     indices: &[0, 1, 2, 0, 2, 3],
//! }
//! .mesh()?;
//! assert_eq!(Bvh::build(&mesh).primitives.len(), 2);
//! // The light space of the sun, straight above: 8 by 8 units, and 0.2 % more.
//! let sun = DirectionalLight::new(glam::DVec3::NEG_Y);
//! let half = sun.fit(mesh.used_positions()).extent.x;
//! assert!((half - 4.0).abs() < 0.01);
//! # Ok::<(), skiagraph_scene::IndexedError>(())
//! ```

pub mod adjacency;
#[cfg(feature = "files")]
mod border;
#[cfg(feature = "files")]
mod builder;
pub mod bvh;
pub mod camera;
pub mod error;
pub mod free;
#[cfg(feature = "files")]
pub mod generate;
#[cfg(feature = "files")]
pub mod gltf;
#[cfg(feature = "files")]
pub mod ground;
#[cfg(feature = "files")]
mod handed;
pub mod indexed;
mod keys;
#[cfg(feature = "files")]
pub mod library;
pub mod light;
pub mod light_kind;
#[cfg(feature = "files")]
mod limit;
pub mod mask;
pub mod material;
#[cfg(feature = "files")]
mod material_use;
pub mod mesh;
#[cfg(feature = "files")]
pub mod mesh_file;
pub mod motion;
pub mod movable;
#[cfg(feature = "files")]
pub mod obj;
pub mod outline;
pub mod packed_masks;
pub mod parts;
pub mod path;
#[cfg(feature = "files")]
pub mod pattern;
#[cfg(feature = "files")]
pub mod report;
mod scene;
#[cfg(feature = "files")]
pub mod scene_file;
#[cfg(feature = "files")]
pub mod scene_writer;
#[cfg(feature = "schema")]
mod schema;
pub mod shadows;
pub mod sheets;
pub mod texels;
#[cfg(feature = "files")]
mod text;
pub mod texture;
#[cfg(feature = "files")]
mod texture_file;
mod vector;
pub mod weld;

pub use adjacency::{Adjacency, NO_NEIGHBOUR};
pub use bvh::{Bvh, BvhNode, LightSpace, LightSpaceNode, TwoLevelBvh};
pub use camera::{Camera, LEAST_DEPTH, View};
pub use error::SceneError;
pub use indexed::{Indexed, IndexedError};
pub use light::{DirectionalLight, LightFit};
pub use light_kind::{
    LIGHT_GAP, Light, LightKind, LightParameters, PointLight, SpotLight, Towards,
};
pub use mask::Mask;
pub use material::{Material, Surfaces};
pub use mesh::{Group, Mesh};
pub use motion::{Motion, PoseKey, RigidKey};
pub use movable::{Movable, MoveError, MovedPart, PartPlace};
pub use outline::Outline;
pub use parts::Parts;
pub use path::{CameraKey, CameraPath, LightKey};
pub use scene::Scene;
#[cfg(feature = "schema")]
pub use schema::schema;
pub use shadows::Shadows;
pub use sheets::Sheets;
pub use texture::{Texture, Wrap};

#[cfg(feature = "files")]
pub use self::{
    gltf::load_gltf,
    ground::{Ground, add_ground, has_ground},
    handed::{forget_handed, hand_over},
    library::{SceneLibrary, SceneListing, cache_folder},
    limit::Limit,
    material_use::MaterialUse,
    mesh_file::{MeshFile, MeshFileOptions},
    obj::{Concave, ObjMaterials, ObjOptions, QuadDiagonal, load_obj},
    pattern::Pattern,
    report::ImportReport,
    scene_file::{MeshSource, SceneFile},
    scene_writer::{scene_text, view_text},
};
