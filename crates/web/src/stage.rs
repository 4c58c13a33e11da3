//! The scene of a worker: a built-in one, or a mesh file that was dropped on the page.

use crate::answer::{Answer, fault, json};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use serde_json::json;
use skiagraph_compare::own_scene::{MeshSceneOptions, OwnScene};
use skiagraph_compare::own_scene_notes;
use skiagraph_scene::{MeshFile, Scene, SceneLibrary, View, forget_handed, hand_over};
use std::{cell::RefCell, path::Path, sync::Arc};
use wasm_bindgen::prelude::*;

thread_local! {
    static SCENE: RefCell<Option<Arc<Scene>>> = const { RefCell::new(None) };
}

/// Camera of a view, in scene units and degrees.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Camera {
    /// Name of the view.
    #[serde(default)]
    pub name: String,
    eye: [f64; 3],
    direction: [f64; 3],
    #[serde(default = "upwards")]
    up: [f64; 3],
    fov: f64,
    near: f64,
    far: f64,
}

fn upwards() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

impl From<&View> for Camera {
    fn from(view: &View) -> Self {
        Self {
            name: view.name.clone(),
            eye: view.eye.into(),
            direction: view.direction.into(),
            up: view.up.into(),
            fov: view.fov_y_degrees,
            near: view.near,
            far: view.far,
        }
    }
}

impl Camera {
    /// Returns the view of this camera, under the scene's light with this index. A view of the
    /// scene that has a light of its own keeps it.
    pub fn view(&self, scene: &Scene, light: Option<usize>) -> View {
        let named = scene.views.iter().find(|view| view.name == self.name);
        let own = named.and_then(|view| view.light.clone());
        let chosen = light.and_then(|index| scene.lights.get(index));
        View {
            name: self.name.clone(),
            eye: self.eye.into(),
            direction: self.direction.into(),
            up: self.up.into(),
            fov_y_degrees: self.fov,
            near: self.near,
            far: self.far,
            light: own.or_else(|| chosen.cloned()),
        }
    }
}

/// Hands over a file that was dropped on the page; scenes read it under this path.
#[wasm_bindgen]
pub fn put_file(path: &str, bytes: Vec<u8>) {
    hand_over(path, bytes);
}

/// Forgets the files that were handed over.
#[wasm_bindgen]
pub fn forget_files() {
    forget_handed();
}

/// Loads the scene that `argument` names, a built-in one or the path of a mesh file that was handed
/// over, and makes it the worker's. Returns JSON with its `name`, `triangles`, `views`, `lights`,
/// `centre`, `radius`, and `notes` on what was chosen for it.
///
/// # Errors
/// A scene that cannot be loaded.
#[wasm_bindgen]
pub fn scene(argument: &str) -> Answer<String> {
    let (path, options) = (Path::new(argument), MeshSceneOptions::default());
    let mut notes = Vec::new();
    let own: OwnScene = if MeshFile::is_one(path) {
        let mut own = OwnScene::of_mesh(path, &options).map_err(fault)?;
        let views = own.views(Some("all"), &options.camera, None);
        own.scene.views = views.map_err(fault)?;
        notes = own_scene_notes::notes(&options, &own);
        own
    } else {
        let loaded = SceneLibrary::default().load(argument);
        loaded.map_err(fault)?.into()
    };
    if own.report.has_warnings() {
        notes.extend(own.report.to_string().lines().map(str::to_owned));
    }
    // Others name options that a page has not.
    notes.retain(|note| !note.contains("--"));
    let scene = own.scene;
    let views: Vec<Camera> = scene.views.iter().map(Camera::from).collect();
    let (least, greatest) = scene.mesh.bounds().unwrap_or_default();
    let (least, greatest) = (least.as_dvec3(), greatest.as_dvec3());
    let centre: DVec3 = 0.5 * (least + greatest);
    let described = json(&json!({
        "name": scene.name,
        "triangles": scene.mesh.triangles.len(),
        "views": views,
        "lights": scene.lights.iter().map(|light| light.name.as_str()).collect::<Vec<_>>(),
        "centre": <[f64; 3]>::from(centre),
        "radius": 0.5 * least.distance(greatest),
        "notes": notes,
    }))?;
    SCENE.set(Some(Arc::new(scene)));
    Ok(described)
}

/// Returns the worker's scene.
///
/// # Errors
/// None was loaded.
pub fn loaded() -> Answer<Arc<Scene>> {
    SCENE
        .with_borrow(Clone::clone)
        .ok_or_else(|| fault("no scene is loaded"))
}
