//! Scenes for Skiagraph: a triangle [`Mesh`], named [`View`]s, a [`DirectionalLight`], and the [`Bvh`] over them.
//!
//! The crate knows no GPU. World space is right-handed, units are the scene's own; positions are `f32` (what a file
//! holds and a GPU reads), cameras and lights are `f64` so that an exact reference starts from unrounded input.

pub mod adjacency;
pub mod bvh;
pub mod camera;
pub mod error;
pub mod generate;
pub mod hard;
pub mod library;
pub mod light;
pub mod mesh;
pub mod obj;
pub mod report;
pub mod scene_file;
mod weld;
pub mod whole;

pub use adjacency::{Adjacency, NO_NEIGHBOUR};
pub use bvh::{Bvh, BvhNode};
pub use camera::{Camera, View};
pub use error::SceneError;
pub use library::{ObjSetup, SceneLibrary, SceneListing, SceneRequest};
pub use light::{DirectionalLight, LightFit};
pub use mesh::{Group, Mesh};
pub use obj::{ObjOptions, QuadDiagonal, load_obj};
pub use report::ImportReport;
pub use scene_file::{MeshSource, SceneFile};
pub use whole::Limit;

/// A mesh with the views and the light under which it is drawn.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name shown in tables and results.
    pub name: String,
    /// Every triangle, receivers and casters alike.
    pub mesh: Mesh,
    /// At least one view; the first is the default.
    pub views: Vec<View>,
    /// The light.
    pub light: DirectionalLight,
}

impl Scene {
    /// The view of that name, if the scene has one.
    pub fn view(&self, name: &str) -> Option<&View> {
        self.views.iter().find(|view| view.name == name)
    }
}
