//! What is looked at: a still view, or every frame of a camera path.

use crate::error::CliError;
use crate::files::fingerprint::Fingerprint;
use crate::wording::did_you_mean;
use skiagraph_scene::{CameraPath, Scene, View};

/// One place of a comparison.
#[derive(Clone, Debug)]
pub enum Subject {
    /// One picture.
    Still(View),
    /// A picture for each frame.
    Path(CameraPath),
}

impl Subject {
    /// Its name in results.
    pub fn name(&self) -> &str {
        match self {
            Self::Still(view) => &view.name,
            Self::Path(path) => &path.view.name,
        }
    }

    /// The views of its frames.
    pub fn views(&self) -> Vec<View> {
        match self {
            Self::Still(view) => vec![view.clone()],
            Self::Path(path) => path.views().collect(),
        }
    }

    /// Whether its light is one with extent.
    pub fn has_extent(&self, scene: &Scene) -> bool {
        let (Self::Still(view) | Self::Path(CameraPath { view, .. })) = self;
        scene.light_of(view).has_extent()
    }

    /// With what it depends on.
    pub fn fingerprint(&self, of: Fingerprint) -> Fingerprint {
        match self {
            Self::Still(view) => of.with_view(view),
            Self::Path(path) => of.with_text(&format!("{path:?}")),
        }
    }

    /// A scene's path of that name, or all of them.
    ///
    /// # Errors
    /// The scene has no such path, or none at all.
    pub fn paths(scene: &str, paths: Vec<CameraPath>, name: &str) -> Result<Vec<Self>, CliError> {
        let names: Vec<&str> = paths.iter().map(|path| path.view.name.as_str()).collect();
        if names.is_empty() {
            return Err(CliError::Input(format!(
                "the scene `{scene}` has no camera paths\n  a scene file lists them as `paths: \
                 [(name: …, fov_y_degrees: …, near: …, far: …, keys: [(at: SECONDS, eye: …, \
                 direction: …), …])]`"
            )));
        }
        if name != "all" && !names.contains(&name) {
            let hint = did_you_mean(name, names.iter().copied());
            return Err(CliError::Input(format!(
                "the scene `{scene}` has no path `{name}`{hint}\n  paths: {}, or all of them: all",
                names.join(", ")
            )));
        }
        let asked = |path: &CameraPath| name == "all" || path.view.name == name;
        Ok(paths.into_iter().filter(asked).map(Self::Path).collect())
    }
}
