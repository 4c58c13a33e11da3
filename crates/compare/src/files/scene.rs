//! Writes scene files that a user may change afterwards.
//!
//! ```
//! use skiagraph_compare::files::scene::write_scene;
//! use skiagraph_scene::SceneLibrary;
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("my_park.ron");
//! let park = SceneLibrary::default().scene_file("park")?;
//! assert!(write_scene(&path, park.clone(), &[])?);
//! assert!(!write_scene(&path, park.clone(), &[])?, "it says the same");
//! let other = skiagraph_scene::SceneFile { name: "mine".into(), ..park };
//! assert!(write_scene(&path, other, &[]).is_err(), "it may have been changed");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::files::write::{folder_of, write_new};
use skiagraph_scene::{MeshSource, SceneFile, View, scene_text};
use std::fs;
use std::path::{Path, PathBuf};

/// Writes a scene file to `path`, whole or not at all. Its views are `first`, then the views of
/// `scene` whose names are not among these. The path of its mesh is written relative to the file's
/// folder if the mesh is below that folder, otherwise as an absolute path. Returns false, and
/// writes nothing, if the file exists already with this content.
///
/// # Errors
/// The path does not end with `.ron`, a file of other content exists there (the user may have
/// changed it), or the file cannot be written.
pub fn write_scene(path: &Path, mut scene: SceneFile, first: &[View]) -> Result<bool> {
    let refused = |text: String| CompareError::Request(format!("{}: {text}", path.display()));
    let extension = path.extension();
    if extension.is_none_or(|extension| !extension.eq_ignore_ascii_case("ron")) {
        return Err(refused("a scene file is called NAME.ron".into()));
    }
    let own_views = std::mem::take(&mut scene.views).into_iter();
    let own_views = own_views.filter(|view| first.iter().all(|chosen| chosen.name != view.name));
    scene.views = first.iter().cloned().chain(own_views).collect();
    if let MeshSource::Obj { file, .. } | MeshSource::Gltf { file, .. } = &mut scene.mesh {
        *file = mesh_beside(path, file).map_err(refused)?;
    }
    let text = scene_text(&scene).map_err(refused)?;
    if write_new(path, text.as_bytes())? {
        return Ok(true);
    }
    match fs::read(path) {
        Ok(there) if there == text.as_bytes() => Ok(false),
        _ => Err(refused(
            "it is there already and says something else; name another file, or delete it".into(),
        )),
    }
}

/// The path of a mesh as a scene file says it: from its own folder if the mesh is below that, else
/// from the root.
fn mesh_beside(scene: &Path, mesh: &str) -> Result<String, String> {
    let absolute = |path: &Path| {
        let canonical = path.canonicalize();
        canonical.map_err(|why| format!("{}: {why}", path.display()))
    };
    let (folder, mesh) = (absolute(folder_of(scene))?, absolute(Path::new(mesh))?);
    let below = mesh.strip_prefix(&folder).map(PathBuf::from);
    let path = below.unwrap_or(mesh);
    let text = path.to_str().ok_or_else(|| {
        format!(
            "the path of the mesh has bytes that are not UTF-8: {}",
            path.display()
        )
    })?;
    Ok(if cfg!(windows) {
        text.replace('\\', "/")
    } else {
        text.to_owned()
    })
}
