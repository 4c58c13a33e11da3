//! `skiagraph view`: shows methods in a window.

use crate::args::commands::ViewArgs;
use crate::args::shared::GpuArgs;
use crate::error::CliError;
#[cfg(feature = "window")]
use crate::{args::shared::SceneArgs, scene_selection::SceneSelection, terminal::Terminal};
#[cfg(any(test, not(feature = "window")))]
use skiagraph_compare::wording::command_line;
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
    Err(CliError::Input(without_window(std::env::args_os())))
}

/// Returns the message of a program without its window, with the command to type for the words of
/// this one.
#[cfg(any(test, not(feature = "window")))]
fn without_window(words: impl Iterator<Item = std::ffi::OsString>) -> String {
    let words = command_line(words);
    let words = words.trim_start_matches("skiagraph ");
    format!(
        "this program was built without its window, as `./run.sh` builds it\n  \
         in the folder of the checkout type:  cargo run --release -- {words}\n  \
         elsewhere install it with the window:  cargo install --path CHECKOUT/crates/cli"
    )
}

#[cfg(test)]
mod tests {
    #[test]
    fn without_a_window_the_command_to_type_is_told() {
        let words = [
            "target/release/skiagraph",
            "view",
            "my method.ron",
            "--set",
            "n=1",
        ];
        let text = super::without_window(words.into_iter().map(Into::into));
        let command = "cargo run --release -- view 'my method.ron' --set n=1\n";
        assert!(text.contains(command), "{text}");
        assert!(text.contains("./run.sh"), "{text}");
    }
}
