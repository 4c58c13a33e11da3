//! Runs the methods of a desired state on a scene.

use crate::desired_state::{DesiredState, FrameSnapshot, Loaded};
use crate::ground_truth::Question;
use crate::slot::{How, Lost, Slot};
use skiagraph_compare::error::{CompareError, explain};
use skiagraph_compare::measuring::{frame, ground_truth::PrimaryVisibility};
use skiagraph_compare::pictures::colours::ClipPlanes;
use skiagraph_compare::sink::Session;
use skiagraph_gpu::{Content, Executor};
use skiagraph_graph::Sources;
use skiagraph_passes::SceneProvider;
use skiagraph_reference::{Progress, unshadowed};
use std::sync::Arc;

/// A scene on a device, with what draws it.
pub struct Stage {
    /// Name of the scene, as the desired state has it.
    pub name: String,
    /// The scene with its views.
    pub loaded: Loaded,
    provider: SceneProvider,
    /// Draws the primitive ids, in pictures of that size.
    primitives: Option<(Executor, [u32; 2])>,
}

/// Times of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// True to take GPU timestamps.
    pub has_timestamps: bool,
    /// Time in seconds that shaders read as `frame.seconds`.
    pub seconds: f32,
}

impl Stage {
    /// Puts a scene on stage. What draws it is made with the first frame.
    pub fn new(name: &str, loaded: Loaded) -> Self {
        Self {
            name: name.to_owned(),
            provider: SceneProvider::new(loaded.scene.clone()),
            loaded,
            primitives: None,
        }
    }

    /// Runs a frame of each method of the desired state. `slots` are these methods, with the files
    /// that they were read from.
    ///
    /// # Errors
    /// A scene without views; a camera that shows nothing; a graph of the visible triangles that
    /// cannot run. [`Lost`] if a method has lost the device.
    pub async fn take_snapshot(
        &mut self,
        session: Session<'_>,
        (slots, sources): (&mut [Slot], &dyn Sources),
        desired: &DesiredState,
        clock: Clock,
    ) -> Result<Result<FrameSnapshot, Lost>, CompareError> {
        let view = desired.view.as_ref().or(self.loaded.views.first());
        let Some(view) = view.cloned() else {
            return Err(CompareError::Input(format!("{} has no view", self.name)));
        };
        view.check().map_err(CompareError::Input)?;
        self.provider.set_view(&view, desired.size);
        let camera = view.camera(desired.size);
        let primitives = self.primitives(session, sources, desired.size).await?;
        let light = self.provider.light();
        let (scene, progress) = (&self.loaded.scene, Progress::default());
        let facing = unshadowed(&scene.mesh, &camera, &light, &primitives, progress);
        let facing = facing.map_err(|error| CompareError::Input(error.to_string()))?;
        let how = How {
            size: desired.size,
            timing: clock.has_timestamps,
            all_passes: desired.all_passes,
            seconds: clock.seconds,
            planes: ClipPlanes::new(&view),
        };
        let mut methods = Vec::new();
        for (slot, method) in slots.iter_mut().zip(&desired.methods) {
            match slot
                .take_snapshot(session, &mut self.provider, method, &how)
                .await
            {
                Ok(snapshot) => methods.push(snapshot),
                Err(lost) => return Ok(Err(lost)),
            }
        }
        Ok(Ok(FrameSnapshot {
            desired: desired.clone(),
            question: Question {
                scene: scene.clone(),
                camera,
                light,
                primitives: Arc::new(primitives),
                outdated: Arc::default(),
            },
            facing: Arc::new(facing),
            methods,
        }))
    }

    /// The primitive that each pixel shows.
    async fn primitives(
        &mut self,
        session: Session<'_>,
        sources: &dyn Sources,
        size: [u32; 2],
    ) -> Result<Vec<u32>, CompareError> {
        let wrong = |why: String| CompareError::Input(format!("no picture of the scene: {why}"));
        let provider = &mut self.provider;
        let is_stale = |(_, planned): &(_, [u32; 2])| *planned != size;
        if self.primitives.as_ref().is_none_or(is_stale) {
            let plan = PrimaryVisibility::load(sources)?.plan(session, size, provider)?;
            let executor = Executor::on(session.gpu, plan, provider);
            self.primitives = Some((executor.map_err(|error| wrong(explain(&error)))?, size));
        }
        let Some((executor, _)) = &mut self.primitives else {
            return Ok(Vec::new());
        };
        let read = match executor.refresh(provider) {
            Ok(_) => frame::read(session, executor, &["primitive"]).await,
            Err(error) => Err(error),
        };
        let contents = read.map_err(|error| {
            self.primitives = None;
            wrong(explain(&error))
        })?;
        let ids = contents.get("primitive").and_then(Content::as_u32);
        ids.ok_or_else(|| wrong("its primitives are not integers".into()))
    }
}
