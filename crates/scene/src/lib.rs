#![doc = include_str!("../README.md")]

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
