//! Frames of a view or camera path: the camera of each, and its mesh if parts of it move.
//!
//! ```
//! use skiagraph_compare::measuring::{frame_sequence::FrameSequence, view_or_path::ViewOrPath};
//! use skiagraph_scene::SceneLibrary;
//!
//! let library = SceneLibrary::default();
//! let (scene, _) = library.load("park")?;
//! for path in library.paths("park")? {
//!     let frames = FrameSequence::new(&ViewOrPath::Path(path), &scene, None, Some(2))?;
//!     match &frames.meshes {
//!         Some(meshes) => assert_ne!(meshes[0].positions, meshes[1].positions),
//!         None => println!("nothing moves along {}", frames.poses[0].view.name),
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::measuring::camera_pose::CameraPose;
use crate::measuring::view_or_path::ViewOrPath;
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{CameraPath, Mesh, Movable, Scene};
use std::sync::Arc;

/// Parts of a mesh that move on a path.
#[derive(Debug)]
pub struct MovingParts {
    parts: Arc<Movable>,
    /// The mesh with these parts elsewhere than at rest; `None` if each frame has its own mesh.
    elsewhere: Option<Mesh>,
}

impl MovingParts {
    /// Whatever is in none of the parts is a last one, so that all of the mesh can be moved.
    fn new(parts: Movable, elsewhere: Option<Mesh>) -> Arc<Self> {
        let parts = Arc::new(parts.with_outside());
        Arc::new(Self { parts, elsewhere })
    }
    /// Returns the parts that move on the first of `paths` on which any do, to be moved on still
    /// views, too; `None` if none does.
    ///
    /// # Errors
    /// The errors of [`FrameSequence::new`] on that path.
    pub fn first(paths: &[CameraPath], mesh: &Mesh) -> Result<Option<Arc<Self>>> {
        for path in paths {
            let Some(parts) = path.movable(mesh).map_err(CompareError::Input)? else {
                continue;
            };
            for frame in 0..path.frames() {
                let shape = path.shape(&parts, frame).map_err(CompareError::Input)?;
                if shape.positions != parts.rest.positions {
                    return Ok(Some(Self::new(parts, Some(shape))));
                }
            }
        }
        Ok(None)
    }
}

/// The frames of a still view or camera path in order: the camera of each frame, and its mesh if
/// parts of the mesh move.
pub struct FrameSequence {
    /// Camera pose of each frame.
    pub poses: Vec<CameraPose>,
    /// Mesh of each frame, parallel to `poses`, all with the same triangles; `None` if no part of
    /// the mesh moves.
    pub meshes: Option<Vec<Mesh>>,
    /// The parts that move; `None` if no part does.
    moving: Option<Arc<MovingParts>>,
    /// Frames per second of the path's clock, which says when each is; not how fast they are drawn.
    frames_per_second: f64,
}

impl FrameSequence {
    /// Creates `count` frames of a view, all alike but for the jitter, or the first `count` of a
    /// path (all if it has fewer); with `None`, one frame of a view or all frames of a path.
    /// `jitter` is the number of sample positions within a pixel through which the frames cycle;
    /// `None` to sample pixel centres.
    ///
    /// # Errors
    /// A moving part that the mesh does not have, that shares vertices with other parts, or whose
    /// positions f32 cannot hold.
    pub fn new(
        view: &ViewOrPath,
        scene: &Scene,
        jitter: Option<u32>,
        count: Option<u32>,
    ) -> Result<Self> {
        let path = match view {
            ViewOrPath::Still(view) => {
                let views = vec![view.clone(); count.unwrap_or(1) as usize];
                return Ok(Self {
                    poses: CameraPose::numbered(views, jitter),
                    meshes: None,
                    moving: None,
                    frames_per_second: 30.0,
                });
            }
            ViewOrPath::Path(path) => path,
        };
        let count = path.frames().min(count.unwrap_or(u32::MAX));
        let views = (0..count).map(|frame| path.view(frame)).collect();
        let parts = path.movable(&scene.mesh).map_err(CompareError::Input)?;
        let shapes = |parts: &Movable| {
            let shapes = (0..count).map(|frame| path.shape(parts, frame));
            let shapes: Result<_, _> = shapes.collect();
            shapes.map_err(CompareError::Input)
        };
        Ok(Self {
            poses: CameraPose::numbered(views, jitter),
            meshes: parts.as_ref().map(shapes).transpose()?,
            moving: parts.map(|parts| MovingParts::new(parts, None)),
            frames_per_second: path.frames_per_second,
        })
    }

    /// Has parts that move on a path of the scene be pieces of the mesh here, too, so that frames
    /// can be timed before which they have moved. A path on which parts move keeps its own.
    pub fn with_moving(mut self, moving: Option<&Arc<MovingParts>>) -> Self {
        self.moving = self.moving.or_else(|| moving.cloned());
        self
    }

    /// Returns a mesh whose parts are elsewhere than in the frame with the index `index`: of a path
    /// that of the next frame, from the last on of the first, in which they are. `None` if no part
    /// of the mesh moves.
    pub fn elsewhere(&self, index: usize) -> Option<&Mesh> {
        let Some(meshes) = self.meshes.as_deref() else {
            return self.moving.as_ref()?.elsewhere.as_ref();
        };
        let mut next_meshes = meshes[index + 1..].iter().chain(&meshes[..index]);
        next_meshes.find(|mesh| mesh.positions != meshes[index].positions)
    }

    /// Sets the mesh of `scene` in a provider of its resources before [`show`](Self::show): in
    /// parts of which each that moves is a piece of its own, or as a whole if no part moves. `cut`
    /// is how the provider's mesh is cut, which stays if it is the same.
    pub fn begin(
        &self,
        scene: &Scene,
        provider: &mut SceneProvider,
        cut: &mut Option<Arc<Movable>>,
    ) {
        let parts = self.moving.as_ref().map(|moving| &moving.parts);
        match (parts, cut.as_ref()) {
            (None, None) => return,
            (Some(parts), Some(cut)) if Arc::ptr_eq(parts, cut) => return,
            (Some(parts), _) => provider.set_parts(parts.clone()),
            (None, Some(_)) => provider.set_mesh(scene.mesh.clone()),
        }
        *cut = parts.cloned();
    }

    /// Sets the camera, light and mesh of the frame with the index `frame` in a provider, for a
    /// viewport in pixels. Only positions and normals of the mesh are updated, and only if they
    /// have changed.
    ///
    /// # Errors
    /// Positions that are not finite.
    ///
    /// # Panics
    /// If there is no such frame.
    pub fn show(
        &self,
        frame: usize,
        viewport: [u32; 2],
        provider: &mut SceneProvider,
    ) -> Result<()> {
        self.poses[frame].show(provider, viewport);
        let rest = || Some(&self.moving.as_ref()?.parts.rest);
        let mesh = self.meshes.as_ref().map(|meshes| &meshes[frame]);
        let Some(Mesh {
            positions, normals, ..
        }) = mesh.or_else(rest)
        else {
            return Ok(());
        };
        let shown = &provider.scene().mesh;
        if (&shown.positions, &shown.normals) == (positions, normals) {
            return Ok(());
        }
        let deformed = provider.deform(positions.clone(), normals.clone());
        deformed.map_err(|error| CompareError::Input(format!("frame {frame}: {error}")))
    }

    /// Returns the number of frames in a second of the path's clock; all frames of a shorter path.
    pub fn second(&self) -> usize {
        (self.frames_per_second.ceil() as usize).clamp(1, self.poses.len().max(1))
    }

    /// Returns the time of the frame with the index `frame` since the first frame, in seconds, at
    /// the frame rate that the path states.
    pub fn seconds(&self, frame: usize) -> f32 {
        (frame as f64 / self.frames_per_second) as f32
    }
}
