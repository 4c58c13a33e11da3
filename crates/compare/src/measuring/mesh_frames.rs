//! The mesh in each frame of a path on which parts of it move.
//!
//! ```
//! use skiagraph_compare::measuring::mesh_frames::MeshFrames;
//! use skiagraph_scene::{SceneLibrary, SceneRequest};
//!
//! let library = SceneLibrary::default();
//! let request = SceneRequest { argument: "park".into(), obj: None };
//! let (scene, _) = library.load(&request)?;
//! for path in library.paths("park")? {
//!     match MeshFrames::new(&path, &scene.mesh, 2)? {
//!         Some(frames) => assert_ne!(frames.mesh(0).positions, frames.mesh(1).positions),
//!         None => println!("nothing moves along {}", path.view.name),
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::CompareError;
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{CameraPath, Mesh};

/// The mesh of each frame, all with the same triangles.
pub struct MeshFrames {
    frames: Vec<Mesh>,
}

impl MeshFrames {
    /// Builds the meshes of the first frames of a path; `None` where nothing moves.
    ///
    /// # Errors
    /// A part that the mesh has not, that is welded to others, or that f32 cannot hold where it is
    /// moved to.
    pub fn new(
        path: &CameraPath,
        mesh: &Mesh,
        frames: usize,
    ) -> Result<Option<Self>, CompareError> {
        let Some(movable) = path.movable(mesh).map_err(CompareError::Input)? else {
            return Ok(None);
        };
        let shape = |frame| path.shape(&movable, frame).map_err(CompareError::Input);
        let frames = (0..path.frames()).take(frames).map(shape);
        let frames = frames.collect::<Result<_, _>>()?;
        Ok(Some(Self { frames }))
    }

    /// The mesh of a frame.
    pub fn mesh(&self, frame: usize) -> &Mesh {
        &self.frames[frame]
    }

    /// Gives the provider the mesh of the first frame, whose triangles and normals may be others
    /// than those that it has.
    pub fn begin(&self, provider: &mut SceneProvider) {
        if let Some(first) = self.frames.first() {
            provider.set_mesh(first.clone());
        }
    }

    /// Gives the provider the mesh of a frame as the host of a moving mesh does; what stands is not
    /// given again.
    ///
    /// # Errors
    /// Places that are no longer finite.
    pub fn show(&self, frame: usize, provider: &mut SceneProvider) -> Result<(), CompareError> {
        let mesh = &self.frames[frame];
        let shown = &provider.scene().mesh;
        if shown.positions == mesh.positions && shown.normals == mesh.normals {
            return Ok(());
        }
        let deformed = provider.deform(mesh.positions.clone(), mesh.normals.clone());
        deformed.map_err(|error| CompareError::Input(format!("frame {frame}: {error}")))
    }
}
