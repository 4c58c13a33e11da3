//! `skiagraph view`: shows methods in a window.

use crate::args::commands::ViewArgs;
use crate::args::shared::GpuArgs;
use crate::error::CliError;
#[cfg(feature = "window")]
use crate::{args::shared::SceneArgs, scene_selection::SceneSelection, terminal::Terminal};
#[cfg(feature = "window")]
use skiagraph_viewer::Opening;

/// Opens the window and blocks until it is closed.
///
/// # Errors
/// If a display or a GPU is missing, or a method or param is unknown.
#[cfg(feature = "window")]
pub fn view(args: &ViewArgs, gpu: &GpuArgs) -> Result<(), CliError> {
    let named = args.scene.clone();
    let opening = Opening {
        methods: args.methods.clone(),
        params: args.params.clone(),
        map_size: args.map_size,
        size: args.size.0,
        scene: named.scene().to_owned(),
        // The arguments say of camera and light what holds for the scene that they name.
        load_scene: Box::new(move |scene| {
            let loaded = if scene == named.scene() {
                SceneSelection::load(&named)
            } else {
                SceneSelection::load(&SceneArgs::default().of(scene))
            };
            let SceneSelection { scene, views, .. } = loaded?;
            Ok((scene, views))
        }),
        gpu: gpu.request(),
    };
    Ok(skiagraph_viewer::open(opening, &Terminal)?)
}

/// Returns an error: this build of the program has no window.
///
/// # Errors
/// Always.
#[cfg(not(feature = "window"))]
pub fn view(_: &ViewArgs, _: &GpuArgs) -> Result<(), CliError> {
    Err(CliError::Input(
        "this program was built without its window; build it with the feature `window`, which is \
         on unless --no-default-features is given"
            .into(),
    ))
}
