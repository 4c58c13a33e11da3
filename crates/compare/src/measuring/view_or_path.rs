//! Views of a comparison: still views and camera paths.
//!
//! ```
//! use skiagraph_compare::measuring::view_or_path::{ViewOrPath, under_lights};
//! use skiagraph_scene::SceneLibrary;
//!
//! let library = SceneLibrary::default();
//! let (scene, _) = library.load("park")?;
//! let mut places = ViewOrPath::paths(&scene, library.paths("park")?, "all", None)?;
//! let views = under_lights(&scene, scene.views.clone(), None)?;
//! places.extend(views.into_iter().map(ViewOrPath::Still));
//! for place in &places {
//!     println!("{}: {:?}", place.name(), place.light(&scene));
//! }
//! assert!(places.len() > scene.views.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::files::fingerprint::Fingerprint;
use crate::wording::unknown;
use skiagraph_scene::{CameraPath, LightKind, Scene, View};

/// One still view or camera path of a comparison.
#[derive(Clone, Debug)]
pub enum ViewOrPath {
    /// A still view.
    Still(View),
    /// A camera path, of which every frame is judged.
    Path(CameraPath),
}

impl ViewOrPath {
    /// Returns the name of the view or path in results.
    pub fn name(&self) -> &str {
        &self.view().name
    }

    /// Returns the view, or the one before a path moves it.
    pub(crate) fn view(&self) -> &View {
        let (Self::Still(view) | Self::Path(CameraPath { view, .. })) = self;
        view
    }

    /// Returns the light under which the view or path is drawn: its own light, or else the scene's
    /// default light.
    pub fn light(&self, scene: &Scene) -> LightKind {
        scene.light_of(self.view())
    }

    /// Returns the name of the view's or path's own light, if this is one of several views or paths
    /// that differ only in their light: [`under_lights`] and [`paths`](Self::paths) name these
    /// `NAME@LIGHT`. Returns `None` for any other.
    pub fn one_of_lights(&self) -> Option<&str> {
        let view = self.view();
        let light = &view.light.as_ref()?.name;
        let view = view.name.strip_suffix(light.as_str())?;
        view.ends_with('@').then_some(light)
    }

    /// Returns `hash` extended by all fields of the view or path.
    pub fn fingerprint(&self, hash: Fingerprint) -> Fingerprint {
        match self {
            Self::Still(view) => hash.with_text(&format!("{view:?}")),
            Self::Path(path) => hash.with_text(&format!("{path:?}")),
        }
    }

    /// Returns the path of `paths` that is named `name`, or all of `paths` if the name is `all`.
    /// With `light`, each path is put under the light of that name; the light `all` gives one path
    /// for each light that [`Scene::lights_of`] lists for its view, named `PATH@LIGHT` if there are
    /// several.
    ///
    /// # Errors
    /// The scene has no path of this name, no light of this name, or no paths at all; a path is not
    /// valid under the light ([`CameraPath::check`]).
    pub fn paths(
        scene: &Scene,
        paths: Vec<CameraPath>,
        name: &str,
        light: Option<&str>,
    ) -> Result<Vec<Self>> {
        let names: Vec<&str> = paths.iter().map(|path| path.view.name.as_str()).collect();
        if names.is_empty() {
            return Err(CompareError::Input(format!(
                "the scene `{}` has no camera paths\n  a scene file lists them as `paths: \
                 [(name: …, fov_y_degrees: …, near: …, far: …, keys: [(at: SECONDS, eye: …, \
                 direction: …), …])]`",
                scene.name
            )));
        }
        if name != "all" && !names.contains(&name) {
            let what = format!("the scene `{}` has no path `{name}`", scene.name);
            let text = unknown(&what, name, "paths", &names) + ", or all of them: all";
            return Err(CompareError::Input(text));
        }
        let mut views_or_paths = Vec::new();
        let is_named = |path: &&CameraPath| name == "all" || path.view.name == name;
        for path in paths.iter().filter(is_named) {
            for view in under_lights(scene, vec![path.view.clone()], light)? {
                views_or_paths.push(Self::Path(lit(scene, path, view)?));
            }
        }
        Ok(views_or_paths)
    }
}

/// The path under the light of a view; one that moves becomes the view's own.
fn lit(scene: &Scene, path: &CameraPath, mut view: View) -> Result<CameraPath> {
    if !path.light_keys.is_empty() {
        view.light = scene.lights_of(&view).into_iter().next();
    }
    let path = CameraPath {
        view,
        ..path.clone()
    };
    path.check().map_err(CompareError::Input)?;
    Ok(path)
}

/// Returns the views under the light named `name`. The name `all` gives one view for each light
/// that [`Scene::lights_of`] lists for a view; these views are named `VIEW@LIGHT` if there are
/// several. With `None` the views are returned unchanged.
///
/// # Errors
/// The scene has no such light.
pub fn under_lights(scene: &Scene, views: Vec<View>, name: Option<&str>) -> Result<Vec<View>> {
    let Some(name) = name else {
        return Ok(views);
    };
    let mut lit = Vec::new();
    for view in views {
        let lights = scene.lights_of(&view);
        let several = lights.len() > 1 && name == "all";
        let chosen = lights.iter();
        let chosen = chosen.filter(|light| name == "all" || light.name == name);
        let chosen: Vec<_> = chosen.collect();
        if chosen.is_empty() {
            let names = lights.iter().map(|light| &light.name);
            let (view, scene) = (&view.name, &scene.name);
            let what = format!("view `{view}` of the scene `{scene}` has no light `{name}`");
            let text = unknown(&what, name, "lights", names) + ", or all of them: all";
            return Err(CompareError::Input(text));
        }
        lit.extend(chosen.into_iter().map(|light| View {
            name: if several {
                format!("{}@{}", view.name, light.name)
            } else {
                view.name.clone()
            },
            light: Some(light.clone()),
            ..view.clone()
        }));
    }
    Ok(lit)
}
