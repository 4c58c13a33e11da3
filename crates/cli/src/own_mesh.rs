//! Loads a mesh file as a scene: with the views and lights of the file, and default ones where it
//! has none.

use crate::{args::shared::SceneArgs, terminal::console::note};
use glam::DVec3;
use itertools::Itertools;
use skiagraph_compare::{default_view::default_view, wording::thousands};
use skiagraph_scene::gltf::Clip;
use skiagraph_scene::{
    CameraPath, DirectionalLight, ImportReport, Light, Mesh, MeshFile, PointLight, Scene,
    SceneError, View, add_ground, has_ground,
};
use std::path::Path;

/// Parts of a scene that the mesh file lacked and the program chose.
#[derive(Clone, Copy, Debug, Default)]
pub struct Chosen {
    /// True if the file had no camera and the only view was chosen.
    pub view: bool,
    /// True if the file had no light and the only light was chosen or given as an argument.
    pub light: bool,
    /// Up direction of the added ground; `None` if no ground was added.
    pub ground: Option<DVec3>,
}

/// A loaded scene, usually from a mesh file, with the parts that were chosen for it.
#[derive(Debug)]
pub struct OwnMesh {
    /// The loaded scene.
    pub scene: Scene,
    /// Changes that the import made, and parts that it left out.
    pub report: ImportReport,
    /// Parts of the scene that the file lacked.
    pub chosen: Chosen,
    /// Animations of the mesh file.
    pub clips: Vec<Clip>,
}

impl From<(Scene, ImportReport)> for OwnMesh {
    /// Wraps a scene whose file holds all parts.
    fn from((scene, report): (Scene, ImportReport)) -> Self {
        Self {
            scene,
            report,
            chosen: Chosen::default(),
            clips: Vec::new(),
        }
    }
}

impl OwnMesh {
    /// Returns the camera paths of the scene's animations. A path without a moving camera is seen
    /// from `standing`. Prints the names of the paths, and the animations that cannot be used.
    pub fn paths(&self, args: &SceneArgs, standing: &View) -> Vec<CameraPath> {
        let Scene { views, lights, .. } = &self.scene;
        let clips = self.clips.iter();
        let paths = clips.flat_map(|clip| clip.paths(views, lights, standing));
        let (paths, failed): (Vec<CameraPath>, Vec<String>) = paths.partition_result();
        for text in failed {
            note(&format!("{}: {text}: left out", args.scene));
        }
        if !paths.is_empty() {
            let names = paths.iter().map(|path| path.view.name.as_str());
            let names = names.collect::<Vec<_>>().join(", ");
            note(&format!(
                "{}: its animations, for --path: {names}",
                args.scene
            ));
        }
        paths
    }
}

/// The direction in which light travels over a mesh by default: a high sun, from the side.
const FALLBACK_LIGHT: DVec3 = DVec3::new(-0.4, -1.0, -0.55);

/// Vertical field of view of a view that is chosen, degrees.
const DEFAULT_FOV: f64 = 60.0;

/// Loads a mesh file as a scene. Prints which views and lights it holds and which were chosen.
///
/// # Errors
/// If the file cannot be read, or the light of the arguments is invalid.
pub fn load(args: &SceneArgs) -> Result<OwnMesh, SceneError> {
    let path = Path::new(&args.scene);
    let MeshFile {
        name,
        mut mesh,
        mut views,
        mut lights,
        clips,
        report,
    } = MeshFile::load(path, &args.mesh_file_options())?;
    if let Some(text) = held(&views, &lights) {
        note(&format!("{}: {text}", args.scene));
    }
    let mut chosen = Chosen {
        view: views.is_empty(),
        light: lights.is_empty(),
        ground: None,
    };
    if let Some(text) = extent(&mesh, args) {
        note(&format!("{}: {text}", args.scene));
    }
    if chosen.light {
        lights.push(sun(args)?);
    }
    let mut is_inside = false;
    if chosen.view {
        let up = args.up.unwrap_or(DVec3::Y);
        let fov = args.fov.unwrap_or(DEFAULT_FOV);
        let found = match (args.eye, lights.first()) {
            (None, Some(light)) => default_view(&mesh, &light.kind, up, fov),
            _ => None,
        };
        if let Some(found) = &found {
            is_inside = found.is_inside;
            if found.is_dark && chosen.light && args.own_light().is_none() {
                let position = found.lamp;
                lights = vec![Light::only(PointLight {
                    position,
                    radius: 0.0,
                })];
            }
        }
        views.push(found.map_or_else(|| towards(&mesh, args), |found| found.view));
    }
    tell_chosen(args, chosen, (&views, &lights), is_inside);
    let up = args.up.unwrap_or(DVec3::Y);
    if args.ground {
        chosen.ground = ground(&mut mesh, up, args);
    } else if chosen.view && !is_inside && !has_ground(&mesh, up) {
        note(&format!(
            "{}: it has no floor for its shadow to fall on; --ground adds one",
            args.scene
        ));
    }
    let scene = Scene {
        name,
        mesh,
        views,
        lights,
    };
    Ok(OwnMesh {
        scene,
        report,
        chosen,
        clips,
    })
}

/// The sun of the arguments, or one that is chosen.
fn sun(args: &SceneArgs) -> Result<Light, SceneError> {
    let direction = args.own_light().unwrap_or(FALLBACK_LIGHT);
    let light = Light::from(DirectionalLight::new(direction));
    light.check().map_err(|reason| SceneError::BadView {
        path: Path::new(&args.scene).to_owned(),
        reason,
    })?;
    Ok(light)
}

/// Adds a ground, and says where; `None` if the mesh has one.
fn ground(mesh: &mut Mesh, up: DVec3, args: &SceneArgs) -> Option<DVec3> {
    if has_ground(mesh, up) {
        note(&format!(
            "{}: --ground adds none, for the mesh has a floor: half of its outline from above, in \
             the lowest twentieth",
            args.scene
        ));
        return None;
    }
    let ground = add_ground(mesh, up)?;
    note(&format!(
        "{}: a ground was added, a square of {} units at the height {}, just below the lowest \
         point",
        args.scene,
        length(ground.edge),
        ground.height as f32
    ));
    Some(up)
}

/// Says which options would choose what was chosen.
fn tell_chosen(
    args: &SceneArgs,
    chosen: Chosen,
    (views, lights): (&[View], &[Light]),
    is_inside: bool,
) {
    let mut said = Vec::new();
    if let Some(view) = views.first().filter(|_| chosen.view) {
        if args.eye.is_none() {
            said.push(format!("--eye {}", three(view.eye)));
        }
        if args.look.is_none() {
            said.push(format!("--look {}", three(view.direction.normalize())));
        }
    }
    if chosen.light && args.own_light().is_none() {
        let lamp = lights.first().and_then(|light| light.kind.position());
        said.push(lamp.map_or_else(
            || format!("--light {}", three(FALLBACK_LIGHT)),
            |lamp| format!("and a lamp at {}, for no sun comes in", three(lamp)),
        ));
    }
    if said.is_empty() {
        return;
    }
    let lacks = match (chosen.view, chosen.light) {
        (true, true) => "no camera and no light",
        (true, false) => "no camera",
        (false, _) => "no light",
    };
    let inside = if is_inside {
        ", from inside, for the mesh surrounds the camera"
    } else {
        ""
    };
    let (scene, said) = (&args.scene, said.join(" "));
    note(&format!(
        "{scene}: it holds {lacks}; chosen{inside}: {said}"
    ));
}

/// How large a mesh is, and which way it stands.
fn extent(mesh: &Mesh, args: &SceneArgs) -> Option<String> {
    let (min, max) = mesh.bounds()?;
    let size = (max.as_dvec3() - min.as_dvec3()).to_array().map(length);
    let [x, y, z] = size;
    let stands = match args.up {
        None => format!(
            "{x} units wide (x), {y} high (y) and {z} deep (z), right-handed; if z is up, give \
             --up 0,0,1"
        ),
        Some(up) => format!(
            "{x} × {y} × {z} units (x, y, z), right-handed, with {},{},{} up",
            up.x, up.y, up.z
        ),
    };
    Some(format!("the mesh is {stands}"))
}

/// A length as one says it: whole above 100, three digits below.
fn length(length: f64) -> String {
    if length >= 100.0 {
        return thousands(length.round() as u64);
    }
    let digits = if length > 0.0 {
        (2 - length.log10().floor() as i32).clamp(0, 15)
    } else {
        0
    };
    let text = format!("{length:.*}", digits as usize);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
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

/// A view from the eye of the arguments to the middle of a mesh. Its clip planes are not fitted.
fn towards(mesh: &Mesh, args: &SceneArgs) -> View {
    let eye = args.eye.unwrap_or_default();
    let bounds = mesh.bounds();
    let middle = bounds.map(|(min, max)| (min.as_dvec3() + max.as_dvec3()) * 0.5);
    let direction = middle.unwrap_or_default() - eye;
    View {
        name: "main".into(),
        eye,
        direction: if direction == DVec3::ZERO {
            DVec3::NEG_Z
        } else {
            direction
        },
        up: DVec3::Y,
        fov_y_degrees: DEFAULT_FOV,
        near: 1.0,
        far: 2.0,
        light: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_said_with_three_digits() {
        for (number, text) in [
            (3199.7, "3,200"),
            (8.0, "8"),
            (0.012345, "0.0123"),
            (12.34, "12.3"),
            (99.96, "100"),
            (0.0, "0"),
            (1e12, "1,000,000,000,000"),
        ] {
            assert_eq!(length(number), text);
        }
    }
}
