//! Writes notes on a scene of one's own: the parts that its mesh file holds, and those chosen for
//! it.
//!
//! ```
//! use skiagraph_compare::own_scene::{MeshSceneOptions, OwnScene};
//! use skiagraph_compare::own_scene_notes::{chosen_for_it, notes};
//!
//! let folder = tempfile::tempdir()?;
//! let file = folder.path().join("tile.obj");
//! std::fs::write(&file, "v 0 0 0\nv 0 0 1\nv 1 0 0\nf 1 2 3\n")?;
//! let options = MeshSceneOptions::default();
//! let own = OwnScene::of_mesh(&file, &options)?;
//! let notes = notes(&options, &own);
//! assert!(notes[1].starts_with("it holds no camera and no light"));
//! let sentence = chosen_for_it(&notes).ok_or("both are chosen")?;
//! assert!(sentence.starts_with("The camera and the light are not the file's: it holds no"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::default_view::Place;
use crate::own_scene::{Chosen, MeshSceneOptions, OwnScene};
use crate::wording::length;
use glam::DVec3;
use itertools::Itertools;
use skiagraph_scene::{Scene, View};

/// Begins the note on the parts that a file lacks.
const LACKS: &str = "it holds ";

/// Comes between these parts and the chosen ones.
const CHOSEN: &str = "; chosen ";

/// Returns lines on a mesh file that was loaded with `options`: its views and lights, its size, and
/// the options of the program `skiagraph` (`--eye`, `--light`) that choose others.
pub fn notes(options: &MeshSceneOptions, own: &OwnScene) -> Vec<String> {
    let chosen = &own.chosen;
    let notes = [
        held(&own.scene, chosen),
        chosen.size.map(|size| extent(size, options.camera.up)),
        choices(options, &own.scene, chosen),
        floor(options, chosen),
    ];
    notes.into_iter().flatten().collect()
}

/// Returns a sentence if `notes`, those of [`notes()`], tell of a camera or light that was chosen
/// for the file.
pub fn chosen_for_it(notes: &[String]) -> Option<String> {
    notes.iter().find_map(|note| {
        let (lacks, _) = note.strip_prefix(LACKS)?.split_once(CHOSEN)?;
        let (parts, are) = match lacks {
            "no camera and no light" => ("camera and the light", "are"),
            "no camera" => ("camera", "is"),
            _ => ("light", "is"),
        };
        Some(format!("The {parts} {are} not the file's: {note}."))
    })
}

/// The views and lights that a file holds.
fn held(scene: &Scene, chosen: &Chosen) -> Option<String> {
    let views = scene.views.iter().map(|view| view.name.as_str()).join(", ");
    let mut lights = scene.lights.iter().map(|light| light.name.as_str());
    let lights = lights.join(", ");
    let views = (!chosen.view).then(|| format!("its cameras, for --view: {views}"));
    let lights = (!chosen.light).then(|| format!("its lights, for --light: {lights}"));
    let held = [views, lights].into_iter().flatten().join("; ");
    (!held.is_empty()).then_some(held)
}

/// How large a mesh is, and which way it stands.
fn extent(size: DVec3, up: Option<DVec3>) -> String {
    let [x, y, z] = size.to_array().map(length);
    match up {
        None => format!(
            "the mesh is {x} units wide (x), {y} high (y) and {z} deep (z), right-handed; if z is \
             up, give --up 0,0,1"
        ),
        Some(up) => format!(
            "the mesh is {x} × {y} × {z} units (x, y, z), right-handed, with {},{},{} up",
            up.x, up.y, up.z
        ),
    }
}

/// Which options would choose what was chosen.
fn choices(options: &MeshSceneOptions, scene: &Scene, chosen: &Chosen) -> Option<String> {
    let mut views = Vec::new();
    if chosen.view {
        let places = chosen.places.iter().map(Some).chain([None]);
        views.extend(scene.views.iter().zip(places).map(|(view, place)| {
            let eye = || format!("--eye {}", three(view.eye));
            let look = || format!("--look {}", three(view.direction.normalize()));
            let light = view.light.as_ref();
            let own = light.and_then(|light| light.kind.directional());
            let parts = [
                options.camera.eye.is_none().then(eye),
                options.camera.direction.is_none().then(look),
                own.map(|sun| format!("--light {}", three(sun.direction))),
            ];
            let parts = parts.into_iter().flatten().join(" ");
            match place.filter(|_| !parts.is_empty()) {
                Some(place) => format!("`{}`, {}: {parts}", view.name, why(*place)),
                None => parts,
            }
        }));
        views.retain(|view| !view.is_empty());
    }
    let light = scene.lights.first().filter(|_| chosen.light);
    let light = light.filter(|_| options.sun.is_none()).and_then(|light| {
        let sun = light.kind.directional();
        let sun = sun.map(|sun| format!("--light {}", three(sun.direction)));
        let lamp = |lamp| format!("and a lamp at {}, for no sun comes in", three(lamp));
        sun.or_else(|| light.kind.position().map(lamp))
    });
    let lacks = match (chosen.view, chosen.light) {
        _ if views.is_empty() && light.is_none() => return None,
        (true, true) => "no camera and no light",
        (true, false) => "no camera",
        (false, _) => "no light",
    };
    if let (Some(light), first) = (light, views.first_mut()) {
        match first {
            Some(first) => *first += &format!(" {light}"),
            None => views.push(light),
        }
    }
    let several = match views.len() {
        0 | 1 => "",
        _ => "; `compare` takes all of them, --view one",
    };
    let views = views.join("; ");
    Some(format!("{LACKS}{lacks}{CHOSEN}{views}{several}"))
}

/// Why a view looks from its place.
fn why(place: Place) -> String {
    match place {
        Place::Outside => "from outside".into(),
        Place::Inside => "from inside, for there is a place to stand".into(),
        Place::Street(height) => format!(
            "in a street, {} units above the floor, for the mesh looks like a town",
            length(height)
        ),
    }
}

/// A ground that was added, or that is missing.
fn floor(options: &MeshSceneOptions, chosen: &Chosen) -> Option<String> {
    let is_outside = chosen.places.iter().all(|it| *it != Place::Inside);
    match &chosen.ground {
        Some(ground) => Some(format!(
            "a ground was added, a square of {} units at the height {}, just below the lowest \
             point",
            length(ground.edge),
            ground.height as f32
        )),
        None if options.ground && chosen.has_floor => Some(
            "--ground adds none, for the mesh has a floor: half of its outline from above, near \
             its lowest point"
                .into(),
        ),
        None if !options.ground && chosen.view && !chosen.has_floor && is_outside => {
            Some("it has no floor for its shadow to fall on; --ground adds one".into())
        }
        None => None,
    }
}

/// Returns a warning if `sun`, the direction in which the light of the user's own sun travels,
/// points upwards in the first view, as it may be reversed.
pub fn from_below(views: &[View], sun: Option<DVec3>) -> Option<String> {
    let direction = sun?;
    let up = views.first()?.up;
    let three = |v: DVec3| format!("{},{},{}", v.x, v.y, v.z);
    (direction.dot(up) > 0.0).then(|| {
        format!(
            "warning: --light {} shines from below: it is the direction in which the light \
             travels; --light {} shines from above",
            three(direction),
            three(-direction + DVec3::ZERO)
        )
    })
}

fn three(v: DVec3) -> String {
    format!("{:.4},{:.4},{:.4}", v.x, v.y, v.z)
}
