//! Views of a scene that all of them share.

use crate::{error::Error, eye::Eye, provider::SceneProvider};
use skiagraph_gpu::{ExecuteError, Executor, Provider};
use skiagraph_scene::{Camera, LightKind};

/// One picture of a scene: its camera, its light and its size. Any number of views share one
/// [`SceneProvider`], whose meshes, hierarchies and textures exist once. Each view has an executor
/// of its own, or one for each of its lights:
///
/// ```no_run
/// use skiagraph_gpu::{Executor, Frame};
/// use skiagraph_passes::{SceneProvider, SceneView};
/// # fn frame(
/// #     provider: &mut SceneProvider,
/// #     views: &mut [(SceneView, Executor)],
/// #     encoder: &mut wgpu::CommandEncoder,
/// #     queue: &wgpu::Queue,
/// #     camera: &skiagraph_scene::Camera,
/// # ) -> Result<(), Box<dyn std::error::Error>> {
/// for (view, executor) in views {
///     view.set_camera(camera);
///     view.refresh(executor, provider)?;
///     executor.encode(encoder, &Frame::default())?;
/// }
/// // One submission: each view shows its own camera and light.
/// # Ok(())
/// # }
/// ```
///
/// A plan for a view takes its size, and the provider as the view sees it:
/// `PlanRequest::new(view.size(), view.apply(&mut provider))`.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneView {
    size: [u32; 2],
    eye: Eye,
    light: LightKind,
}

impl SceneView {
    /// Creates a view of `size`, width and height in pixels, from a camera under a light. A light
    /// that cannot be used is an error of the next [`refresh`](Self::refresh).
    pub fn new(size: [u32; 2], eye: &Eye, light: impl Into<LightKind>) -> Self {
        Self {
            size,
            eye: *eye,
            light: light.into(),
        }
    }

    /// Creates a view from a [`Camera`], whose viewport is the view's size, under a light.
    pub fn from_camera(camera: &Camera, light: impl Into<LightKind>) -> Self {
        Self::new(camera.viewport, &Eye::from(camera), light)
    }

    /// Returns width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns the camera.
    pub fn eye(&self) -> &Eye {
        &self.eye
    }

    /// Returns the light that the resources `light` and `light_area` describe for this view.
    pub fn light(&self) -> LightKind {
        self.light
    }

    /// Sets width and height in pixels. The next [`refresh`](Self::refresh) plans the executor's
    /// graph for this size.
    pub fn set_size(&mut self, size: [u32; 2]) {
        self.size = size;
    }

    /// Sets the camera to a host program's own.
    pub fn set_eye(&mut self, eye: &Eye) {
        self.eye = *eye;
    }

    /// Sets the view's camera and its size from a [`Camera`], whose viewport is the size.
    pub fn set_camera(&mut self, camera: &Camera) {
        self.eye = Eye::from(camera);
        self.size = camera.viewport;
    }

    /// Sets the light. After a change of its kind (directional, spot, point) graphs must be planned
    /// anew, as [`SceneProvider::set_light`] says.
    ///
    /// # Errors
    /// [`Error::Light`] for a light that cannot be used; the view then keeps its light.
    pub fn set_light(&mut self, light: impl Into<LightKind>) -> Result<(), Error> {
        let light = light.into();
        light.check().map_err(Error::Light)?;
        self.light = light;
        Ok(())
    }

    /// Sets the camera and the light of `provider` to this view's, and returns `provider`.
    pub fn apply<'p>(&self, provider: &'p mut SceneProvider) -> &'p mut SceneProvider {
        provider.set_eye(&self.eye);
        provider.set_light(self.light);
        provider
    }

    /// Brings an executor up to date with the scene as this view sees it:
    /// [resizes](Executor::resize) it if the size of the view is another one, and
    /// [refreshes](Executor::refresh) it. Call it before [`encode`](Executor::encode); frames that
    /// are already encoded keep their content. A view without pixels, as a minimised window has,
    /// leaves the executor as it is: a frame for it need not be encoded.
    ///
    /// # Errors
    /// Those of [`Executor::resize`] and [`Executor::refresh`].
    pub fn refresh(
        &self,
        executor: &mut Executor,
        provider: &mut SceneProvider,
    ) -> Result<(), ExecuteError> {
        self.bring(executor, self.apply(provider))
    }

    /// Does what [`refresh`](Self::refresh) does with the GPU's work in the
    /// [encoder of the frame](SceneProvider::in_encoder).
    ///
    /// # Errors
    /// Those of [`refresh`](Self::refresh) and [`SceneProvider::in_encoder`].
    pub fn refresh_in(
        &self,
        executor: &mut Executor,
        provider: &mut SceneProvider,
        encoder: &mut wgpu::CommandEncoder,
    ) -> Result<(), ExecuteError> {
        self.bring(executor, &mut self.apply(provider).in_encoder(encoder)?)
    }

    fn bring(
        &self,
        executor: &mut Executor,
        provider: &mut dyn Provider,
    ) -> Result<(), ExecuteError> {
        if self.size.contains(&0) {
            return Ok(());
        }
        if executor.plan().viewport() != self.size {
            executor.resize(self.size, provider)?;
        }
        executor.refresh(provider)
    }
}
