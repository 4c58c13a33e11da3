//! Cameras of frames: the view of each, and its jitter within the pixels.
//!
//! ```
//! use skiagraph_compare::measuring::camera_pose::CameraPose;
//! use skiagraph_scene::SceneLibrary;
//!
//! let (scene, _) = SceneLibrary::default().load("park")?;
//! // Four frames of one view, each with a place of its own within the pixel.
//! let poses = CameraPose::numbered(vec![scene.views[0].clone(); 4], Some(4));
//! let jitters = poses.iter().map(|pose| pose.camera([64, 64]).jitter);
//! let jitters: Vec<_> = jitters.collect();
//! assert_ne!(jitters[0], jitters[1]);
//! # Ok::<(), skiagraph_scene::SceneError>(())
//! ```

use skiagraph_passes::SceneProvider;
use skiagraph_scene::{Camera, View};

/// Camera of one frame, without a viewport: the frame's view, and its jitter (the place within a
/// pixel at which the frame samples).
#[derive(Clone, Debug)]
pub struct CameraPose {
    /// The view of the frame.
    pub view: View,
    /// Number of the frame, and how many have a jitter of their own.
    jitter: Option<(u32, u32)>,
}

impl CameraPose {
    /// Creates a pose for each view; item `i` of `views` is the view of frame `i`. `jitter` is the
    /// number of sample positions within a pixel through which the frames cycle, 0 counting as 1;
    /// `None` to sample pixel centres.
    pub fn numbered(views: Vec<View>, jitter: Option<u32>) -> Vec<Self> {
        let pose = |(view, frame)| Self {
            view,
            jitter: jitter.map(|count| (frame, count)),
        };
        views.into_iter().zip(0..).map(pose).collect()
    }

    /// Returns the frame's camera for a viewport in pixels, with its jitter.
    pub fn camera(&self, viewport: [u32; 2]) -> Camera {
        let camera = self.view.camera(viewport);
        match self.jitter {
            Some((frame, count)) => camera.jittered(frame, count),
            None => camera,
        }
    }

    /// Sets the frame's view, light and camera in a provider of scene resources, for a viewport in
    /// pixels.
    pub fn show(&self, provider: &mut SceneProvider, viewport: [u32; 2]) {
        provider.set_view(&self.view, viewport);
        if self.jitter.is_some() {
            provider.set_camera(&self.camera(viewport));
        }
    }
}
