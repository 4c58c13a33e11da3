//! A mesh file as a scene: with the views and lights that it holds, and those that are chosen where
//! it holds none.

use crate::{args::shared::SceneArgs, terminal::console::note};
use glam::DVec3;
use itertools::Itertools;
use skiagraph_scene::{
    DirectionalLight, ImportReport, Light, Mesh, MeshFile, Scene, SceneError, View,
};
use std::path::Path;

/// Parts of a scene that its file does not hold.
#[derive(Clone, Copy, Debug, Default)]
pub struct Chosen {
    /// True if its only view was chosen here.
    pub view: bool,
    /// True if its only light was chosen here, or is that of the arguments.
    pub light: bool,
}

/// The direction in which light travels over a mesh by default: a high sun, from the side.
const FALLBACK_LIGHT: DVec3 = DVec3::new(-0.4, -1.0, -0.55);

/// Name of a view that is chosen.
const CHOSEN_VIEW: &str = "main";

/// Loads a mesh file, and says which views and lights it holds and which were chosen.
///
/// # Errors
/// A file that cannot be read, a sun that is none.
pub fn load(args: &SceneArgs) -> Result<(Scene, ImportReport, Chosen), SceneError> {
    let path = Path::new(&args.scene);
    let MeshFile {
        name,
        mesh,
        mut views,
        mut lights,
        report,
    } = MeshFile::load(path, &args.mesh_file_options())?;
    if let Some(text) = held(&views, &lights) {
        note(&format!("{}: {text}", args.scene));
    }
    let chosen = Chosen {
        view: views.is_empty(),
        light: lights.is_empty(),
    };
    let mut said = Vec::new();
    if chosen.view {
        let view = outside(&mesh, args);
        if args.eye.is_none() {
            said.push(format!("--eye {}", three(view.eye)));
        }
        if args.look.is_none() {
            said.push(format!("--look {}", three(view.direction.normalize())));
        }
        views.push(view);
    }
    if chosen.light {
        if args.own_light().is_none() {
            said.push(format!("--light {}", three(FALLBACK_LIGHT)));
        }
        let direction = args.own_light().unwrap_or(FALLBACK_LIGHT);
        let light = Light::from(DirectionalLight::new(direction));
        light.check().map_err(|reason| SceneError::BadView {
            path: path.to_owned(),
            reason,
        })?;
        lights.push(light);
    }
    if !said.is_empty() {
        let lacks = match (chosen.view, chosen.light) {
            (true, true) => "no camera and no light",
            (true, false) => "no camera",
            (false, _) => "no light",
        };
        let said = said.join(" ");
        note(&format!("{}: it holds {lacks}; chosen: {said}", args.scene));
    }
    let scene = Scene {
        name,
        mesh,
        views,
        lights,
    };
    Ok((scene, report, chosen))
}

fn three(v: DVec3) -> String {
    format!("{:.4},{:.4},{:.4}", v.x, v.y, v.z)
}

/// The views and lights that a file holds.
fn held(views: &[View], lights: &[Light]) -> Option<String> {
    let views = views.iter().map(|view| view.name.as_str()).join(", ");
    let lights = lights.iter().map(|light| light.name.as_str()).join(", ");
    match (views.is_empty(), lights.is_empty()) {
        (true, true) => None,
        (false, true) => Some(format!("its cameras, for --view: {views}")),
        (true, false) => Some(format!("its lights, for --light: {lights}")),
        (false, false) => Some(format!(
            "its cameras, for --view: {views}; its lights, for --light: {lights}"
        )),
    }
}

/// A view from where all of a mesh is seen, as far as no argument says otherwise. Its clip planes
/// are not fitted yet.
fn outside(mesh: &Mesh, args: &SceneArgs) -> View {
    let mut view = View {
        name: CHOSEN_VIEW.into(),
        eye: DVec3::ZERO,
        direction: DVec3::NEG_Z,
        up: DVec3::Y,
        fov_y_degrees: 60.0,
        near: 1.0,
        far: 2.0,
        light: None,
    };
    let Some((min, max)) = mesh.bounds() else {
        return view;
    };
    let (min, max) = (min.as_dvec3(), max.as_dvec3());
    let centre = (min + max) * 0.5;
    let radius = ((max - min).length() * 0.5).max(f64::MIN_POSITIVE);
    let fov = args.fov.unwrap_or(view.fov_y_degrees).to_radians();
    let distance = radius / (fov * 0.5).sin();
    view.eye = centre + DVec3::new(0.5, 0.6, 1.0).normalize() * distance;
    if let Some(eye) = args.eye {
        view.eye = eye;
    }
    let towards = centre - view.eye;
    view.direction = if towards == DVec3::ZERO {
        DVec3::NEG_Z
    } else {
        towards
    };
    view
}
