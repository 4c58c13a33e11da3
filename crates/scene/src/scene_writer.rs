//! Writes scene files, as [`SceneFile::parse`] reads them.

use crate::{camera::View, light_kind::Light, scene_file::SceneFile};
use skiagraph_located_ron::writer::to_text;

/// Writes a scene as the text of a scene file, which [`SceneFile::parse`] reads again, with one
/// view or key in a line.
///
/// # Errors
/// A sentence, if a view or path has a spot or point light of its own, which scene files cannot
/// express. A path may have one that is among the scene's lights: a comment in the text then names
/// the light.
pub fn scene_text(scene: &SceneFile) -> Result<String, String> {
    let mut scene = scene.clone();
    let is_lamp = |light: &Light| light.kind.directional().is_none();
    let mut comments = Vec::new();
    for path in &mut scene.paths {
        let light = &mut path.view.light;
        let lamp = light.take_if(|light| is_lamp(light) && scene.lights.contains(light));
        comments
            .push(lamp.map(|lamp| format!("        // Under its light: --light {}\n", lamp.name)));
    }
    let paths = scene.paths.iter().map(|path| &path.view);
    for View { name, light, .. } in scene.views.iter().chain(paths) {
        if let Some(lamp) = light.as_ref().filter(|light| is_lamp(light)) {
            return Err(format!(
                "{name:?} has a {} light of its own, and a scene file has such lights for all \
                 views only",
                lamp.kind.word()
            ));
        }
    }
    let written = to_text(&scene).map_err(|error| error.to_string())?;
    let (mut text, mut comments) = (String::new(), comments.into_iter());
    for line in written.lines() {
        if line == "        (" {
            text += &comments.next().flatten().unwrap_or_default();
        }
        text += &format!("{line}\n");
    }
    Ok(text)
}

/// Writes a view as an entry of a scene file's `views`, in one line. A light of its own is written
/// only if it is directional; views in scene files cannot have others.
pub fn view_text(view: &View) -> String {
    let mut view = view.clone();
    view.light
        .take_if(|light| light.kind.directional().is_none());
    to_text(&view).unwrap_or_default()
}
