//! Scenes for Skiagraph: a triangle [`Mesh`], named [`View`]s, its [`Light`]s, and the
//! [`Bvh`] over them.
//!
//! The crate knows no GPU. World space is right-handed, units are the scene's own; positions are
//! `f32` (what a file holds and a GPU reads), cameras and lights are `f64` so that an exact
//! reference starts from unrounded input.

pub mod adjacency;
mod builder;
pub mod bvh;
pub mod camera;
pub mod error;
pub mod generate;
pub mod gltf;
pub mod library;
pub mod light;
pub mod light_kind;
mod limit;
pub mod mask;
pub mod material;
pub mod mesh;
pub mod movable;
pub mod obj;
pub mod packed_masks;
pub mod parts;
pub mod path;
pub mod pattern;
pub mod report;
mod scene;
pub mod scene_file;
pub mod texture;
pub mod weld;

pub use adjacency::{Adjacency, NO_NEIGHBOUR};
pub use bvh::{Bvh, BvhNode, LightSpace, LightSpaceNode};
pub use camera::{Camera, View};
pub use error::SceneError;
pub use gltf::load_gltf;
pub use library::{ObjSetup, SceneLibrary, SceneListing, SceneRequest};
pub use light::{DirectionalLight, LightFit};
pub use light_kind::{LIGHT_GAP, Light, LightKind, PointLight, SpotLight, Towards};
pub use limit::Limit;
pub use mask::Mask;
pub use material::{Material, Surfaces};
pub use mesh::{Group, Mesh};
pub use movable::Movable;
pub use obj::{Concave, ObjMaterials, ObjOptions, QuadDiagonal, load_obj};
pub use parts::Parts;
pub use path::{CameraKey, CameraPath, LightKey};
pub use pattern::Pattern;
pub use report::ImportReport;
pub use scene::Scene;
pub use scene_file::{MeshSource, SceneFile};
pub use texture::{Texture, Wrap};
