//! Bevy without a window, frame by frame.

use bevy::{
    app::PluginGroupBuilder,
    camera::RenderTarget,
    core_pipeline::tonemapping::{DebandDither, Tonemapping},
    prelude::*,
    render::{
        RenderPlugin,
        render_resource::{PollType, TextureFormat},
        renderer::RenderDevice,
        view::screenshot::{Screenshot, ScreenshotCaptured},
    },
    window::ExitCondition,
};
use std::{
    error::Error,
    sync::{Arc, Mutex},
};

/// Frames after which a picture has come, in any case.
const LONGEST: usize = 64;

/// Bevy's own plug-ins for a program without a window, whose pipelines are compiled before the
/// frame that uses them.
pub fn without_window() -> PluginGroupBuilder {
    DefaultPlugins
        .set(WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..default()
        })
        .set(RenderPlugin {
            synchronous_pipeline_compilation: true,
            ..default()
        })
}

/// Runs a frame, and waits for the GPU.
pub fn update(app: &mut App) -> Result<(), Box<dyn Error>> {
    app.update();
    let device = app.world().resource::<RenderDevice>();
    device.poll(PollType::wait_indefinitely())?;
    Ok(())
}

/// Returns a camera that draws into an image of its own, as it is.
#[allow(dead_code, reason = "not every program has such a camera")]
pub fn camera(images: &mut Assets<Image>, size: UVec2) -> impl Bundle {
    let format = TextureFormat::Rgba8UnormSrgb;
    let target = images.add(Image::new_target_texture(size.x, size.y, format, None));
    (
        Camera3d::default(),
        RenderTarget::from(target),
        Msaa::Off,
        Tonemapping::None,
        DebandDither::Disabled,
    )
}

/// Runs frames until a picture of the camera's target has come.
#[allow(dead_code, reason = "not every program looks at its pictures")]
pub fn picture(app: &mut App, camera: Entity) -> Result<Image, Box<dyn Error>> {
    let target = app.world().get::<RenderTarget>(camera);
    let target = target.ok_or("the camera has no target")?.clone();
    let seen: Arc<Mutex<Option<Image>>> = Arc::default();
    let copy = Arc::clone(&seen);
    let mut screenshot = app.world_mut().spawn(Screenshot(target));
    screenshot.observe(move |captured: On<ScreenshotCaptured>| {
        if let Ok(mut seen) = copy.lock() {
            *seen = Some(captured.image.clone());
        }
    });
    for _ in 0..LONGEST {
        update(app)?;
        if let Some(image) = seen.lock().map_err(|_| "an observer panicked")?.take() {
            return Ok(image);
        }
    }
    Err("no picture has come".into())
}
