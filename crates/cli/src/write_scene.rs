//! `--write-scene`: writes the selected scene to a scene file that the user can edit.

use crate::{args::shared::SceneArgs, error::CliError, own_mesh::Chosen, terminal::console::note};
use skiagraph_scene::{
    CameraPath, MeshFileOptions, MeshSource, Scene, SceneFile, View, scene_text,
};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Returns the scene file for a scene that was loaded from a mesh file.
pub fn of_mesh(args: &SceneArgs, scene: &Scene, chosen: Chosen, paths: &[CameraPath]) -> SceneFile {
    let MeshFileOptions {
        quads,
        concave,
        materials,
    } = args.mesh_file_options();
    let file = args.scene.clone();
    let is_obj = Path::new(&file)
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("obj"));
    let mesh = if is_obj {
        MeshSource::Obj {
            file,
            leave_out: Vec::new(),
            quads,
            concave,
            materials: materials.into(),
            source: None,
        }
    } else {
        MeshSource::Gltf {
            file,
            materials,
            source: None,
        }
    };
    SceneFile {
        format: 1,
        name: scene.name.clone(),
        description: String::new(),
        mesh,
        ground: chosen.ground,
        lights: scene.lights.clone(),
        views: scene.views.clone(),
        paths: paths.to_vec(),
    }
}

/// Writes a scene file, with the selected views before the others, and prints its path. An existing
/// file with other content is kept, because the user may have changed it.
///
/// # Errors
/// If the path does not end with `.ron`, a file of other content exists there, or it cannot be
/// written.
pub fn write(path: &Path, mut scene: SceneFile, views: &[View]) -> Result<(), CliError> {
    let is_scene = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("ron"));
    let usage = |text: String| CliError::Usage(format!("--write-scene {}: {text}", path.display()));
    if !is_scene {
        return Err(usage("a scene file is called NAME.ron".into()));
    }
    let others = std::mem::take(&mut scene.views).into_iter();
    let others = others.filter(|view| views.iter().all(|chosen| chosen.name != view.name));
    scene.views = views.iter().cloned().chain(others).collect();
    if let MeshSource::Obj { file, .. } | MeshSource::Gltf { file, .. } = &mut scene.mesh {
        *file = mesh_beside(path, file).map_err(usage)?;
    }
    let text = scene_text(&scene).map_err(usage)?;
    match fs::read_to_string(path) {
        Ok(there) if there == text => return Ok(()),
        Ok(_) => {
            return Err(usage(
                "it is there already and says something else; name another file, or delete it"
                    .into(),
            ));
        }
        Err(_) => {}
    }
    fs::write(path, text).map_err(|why| usage(format!("cannot write it: {why}")))?;
    let path = path.display();
    note(&format!(
        "wrote {path}, to be edited (docs/scenes.md); use it with --scene {path}"
    ));
    Ok(())
}

/// The path of a mesh as a scene file says it: from its own folder if the mesh is below that, else
/// from the root.
fn mesh_beside(scene: &Path, mesh: &str) -> Result<String, String> {
    let absolute = |path: &Path| {
        let found = path.canonicalize();
        found.map_err(|why| format!("{}: {why}", path.display()))
    };
    let folder = match scene.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let (folder, mesh) = (absolute(folder)?, absolute(Path::new(mesh))?);
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
