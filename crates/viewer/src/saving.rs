//! Saves the current view: as text to paste into a scene file, or as a new scene file.

use skiagraph_compare::error::CompareError;
use skiagraph_compare::files::write::write_new;
use skiagraph_scene::{SceneFile, SceneLibrary, View, view_text};
use std::fs;
use std::path::{Path, PathBuf};

/// Writes a copy of the file of the scene named `scene`, with the view added. The copy is beside
/// the original, or in the working directory for a built-in scene, under a name that is free.
/// Returns the path of the copy and the view's name in it.
///
/// # Errors
/// If the scene has no file, its file has no list of views, or the copy cannot be written.
pub fn save(
    library: &SceneLibrary,
    scene: &str,
    view: &View,
) -> Result<(PathBuf, String), CompareError> {
    let by_hand = |why: String| {
        CompareError::Input(format!(
            "{scene}: {why}; copy the view and paste it into a scene file's `views`"
        ))
    };
    let located = library.locate(scene);
    let (file, text) = located.map_err(|error| by_hand(error.to_string()))?;
    let parsed = SceneFile::parse(&text, scene).map_err(|error| by_hand(error.to_string()))?;
    let taken = |name: &str| parsed.views.iter().any(|view| view.name == name);
    let name = first_free("seen", |name| !taken(name));
    let named = View {
        name: name.clone(),
        ..view.clone()
    };
    let text =
        with_view(&text, &named).ok_or_else(|| by_hand("its views were not found".into()))?;
    let folder = file.as_deref().and_then(Path::parent);
    let folder = folder.unwrap_or(Path::new(""));
    let stem = file.as_deref().and_then(Path::file_stem);
    let stem = stem.map_or(scene.into(), |stem| stem.to_string_lossy().into_owned());
    let path = |name: &str| folder.join(format!("{name}.ron"));
    let is_free = |name: &str| fs::symlink_metadata(path(name)).is_err();
    loop {
        let path = path(&first_free(&format!("{stem}_seen"), is_free));
        // Another process may take the name just now.
        if write_new(&path, text.as_bytes())? {
            return Ok((path, name));
        }
    }
}

/// `name`, `name_2`, `name_3` …: the first that is free.
fn first_free(name: &str, is_free: impl Fn(&str) -> bool) -> String {
    let numbered = (2u32..).map(|number| format!("{name}_{number}"));
    let mut names = [name.to_owned()].into_iter().chain(numbered);
    names.find(|name| is_free(name)).unwrap_or_default()
}

/// A scene file's text with one more view; `None` if it does not read as that.
fn with_view(text: &str, view: &View) -> Option<String> {
    let mut places = text.match_indices("views:").filter_map(|(at, word)| {
        let behind = &text[at + word.len()..];
        let bracket = behind.find(|c: char| !c.is_whitespace())?;
        behind[bracket..]
            .starts_with('[')
            .then_some(at + word.len() + bracket + 1)
    });
    // One of them may stand in a comment; then the view is not read.
    places.find_map(|at| {
        let (before, behind) = text.split_at(at);
        let text = format!("{before}\n        {},{behind}", view_text(view));
        let read = SceneFile::parse(&text, "").ok()?;
        let is_read = read.views.iter().any(|read| read.name == view.name);
        is_read.then_some(text)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use skiagraph_scene::{DirectionalLight, Light};

    fn view() -> View {
        View {
            name: "evening".into(),
            eye: DVec3::new(0.1, -2.5e-9, 1e17),
            direction: DVec3::new(1.0 / 3.0, -1.0, 0.0),
            up: DVec3::Z,
            fov_y_degrees: 47.5,
            far: 1e18,
            light: Some(Light::only(DirectionalLight {
                direction: DVec3::new(0.1, -0.7, 0.2),
                angle_degrees: 0.53,
            })),
            ..View::default()
        }
    }

    #[test]
    fn a_saved_view_reads_as_it_was_and_overwrites_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let original = folder.path().join("garden.ron");
        let text = "(format: 1, name: \"garden\", // views: [\n mesh: Generated(\"park\"),\n \
            light: (direction: (0, -1, 0)), views : [(name: \"seen\", eye: (0, 5, 9), \
            direction: (0, 0, -1), fov_y_degrees: 60, near: 1, far: 99)])";
        let text = text.replace("views : [", "views: [");
        std::fs::write(&original, &text).unwrap();
        let library = SceneLibrary::default();
        let scene = original.to_str().unwrap();
        let (first, name) = save(&library, scene, &view()).unwrap();
        let (second, _) = save(&library, scene, &view()).unwrap();
        assert_eq!(name, "seen_2");
        assert_eq!(first, folder.path().join("garden_seen.ron"));
        assert_eq!(second, folder.path().join("garden_seen_2.ron"));
        assert_eq!(std::fs::read_to_string(&original).unwrap(), text);
        let (scene, _) = library.load(first.to_str().unwrap()).unwrap();
        let expected = View { name, ..view() };
        assert_eq!(scene.view("seen_2"), Some(&expected));
        assert_eq!(scene.views.len(), 2);
    }

    #[test]
    fn a_scene_without_a_file_says_what_to_do() {
        let error = save(&SceneLibrary::default(), "house.glb", &view()).unwrap_err();
        assert!(error.to_string().contains("copy the view"), "{error}");
    }
}
