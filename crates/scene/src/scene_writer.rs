//! Writes scene files, as [`SceneFile::parse`] reads them.

use crate::{
    camera::View,
    light::DirectionalLight,
    light_kind::{Light, LightKind, PointLight, SpotLight},
    motion::Motion,
    path::{CameraPath, LightKey},
    scene_file::{MeshSource, SceneFile},
};
use glam::DVec3;
use std::fmt::Debug;

/// Writes a scene as the text of a scene file, which [`SceneFile::parse`] reads again, with one
/// view or key in a line.
///
/// # Errors
/// A sentence, if a view or path has a spot or point light of its own, which scene files cannot
/// express. A path may have one that is among the scene's lights: a comment in the text then names
/// the light.
pub fn scene_text(scene: &SceneFile) -> Result<String, String> {
    let mut text = format!("(\n    format: 1,\n    name: {:?},\n", scene.name);
    if !scene.description.is_empty() {
        text += &format!("    description: {:?},\n", scene.description);
    }
    text += &format!("    mesh: {},\n", mesh(&scene.mesh));
    if let Some(up) = scene.ground {
        text += &format!("    ground: {},\n", vector(up));
    }
    let lights: Vec<String> = scene.lights.iter().map(light).collect();
    let views = scene.views.iter().map(view);
    let views: Vec<String> = views.collect::<Result<_, _>>()?;
    let paths = scene.paths.iter().map(|it| path(it, &scene.lights));
    let paths: Vec<String> = paths.collect::<Result<_, _>>()?;
    for (name, items) in [("lights", lights), ("views", views), ("paths", paths)] {
        text += &list(1, name, &items);
    }
    Ok(text + ")\n")
}

/// A field that is a list, so many levels deep; nothing for an empty one.
fn list(depth: usize, name: &str, items: &[String]) -> String {
    if items.is_empty() {
        return String::new();
    }
    let indent = "    ".repeat(depth);
    let line = |item: &String| format!("{indent}    {item},\n");
    let lines: String = items.iter().map(line).collect();
    format!("{indent}{name}: [\n{lines}{indent}],\n")
}

/// A number as short as it can be read again.
fn number(value: f64) -> String {
    let value = value + 0.0; // No −0.
    if value != 0.0 && !(1e-6..1e16).contains(&value.abs()) {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

fn vector(xyz: DVec3) -> String {
    format!("({}, {}, {})", number(xyz.x), number(xyz.y), number(xyz.z))
}

fn mesh(mesh: &MeshSource) -> String {
    let (kind, file, setup, source) = match mesh {
        MeshSource::Generated(generator) => return format!("Generated(\"{generator}\")"),
        MeshSource::Obj {
            file,
            leave_out,
            quads,
            concave,
            materials,
            source,
        } => {
            let setup = vec![
                changed("leave_out", leave_out),
                changed("quads", quads),
                changed("concave", concave),
                changed("materials", materials),
            ];
            ("Obj", file, setup, source)
        }
        MeshSource::Gltf {
            file,
            materials,
            source,
        } => ("Gltf", file, vec![changed("materials", materials)], source),
    };
    let source = source.as_ref().map(|source| format!("source: {source:?}"));
    let fields = [Some(format!("file: {file:?}"))].into_iter();
    let fields = fields.chain(setup).chain([source]).flatten();
    format!("{kind}({})", fields.collect::<Vec<_>>().join(", "))
}

/// A field, unless it has the value that it has by default; `Debug` writes these values as in RON.
fn changed<T: Debug + Default + PartialEq>(name: &str, value: &T) -> Option<String> {
    (*value != T::default()).then(|| format!("{name}: {value:?}"))
}

fn light(light: &Light) -> String {
    let name = &light.name;
    match light.kind {
        LightKind::Directional(distant) => format!("Directional(name: {name:?}, {})", sun(distant)),
        LightKind::Spot(SpotLight {
            position,
            direction,
            cone_degrees,
            radius,
        }) => format!(
            "Spot(name: {name:?}, position: {}, direction: {}, cone_degrees: {}{})",
            vector(position),
            vector(direction),
            number(cone_degrees),
            not_0("radius", radius)
        ),
        LightKind::Point(PointLight { position, radius }) => {
            let (position, radius) = (vector(position), not_0("radius", radius));
            format!("Point(name: {name:?}, position: {position}{radius})")
        }
    }
}

fn sun(light: DirectionalLight) -> String {
    let angle = not_0("angle_degrees", light.angle_degrees);
    format!("direction: {}{angle}", vector(light.direction))
}

/// A field behind others, unless it is 0.
fn not_0(name: &str, value: f64) -> String {
    match value {
        0.0 => String::new(),
        value => format!(", {name}: {}", number(value)),
    }
}

fn view(view: &View) -> Result<String, String> {
    let (eye, direction) = (vector(view.eye), vector(view.direction));
    Ok(format!(
        "(name: {:?}, eye: {eye}, direction: {direction}, {})",
        view.name,
        lens(view)?.join(", ")
    ))
}

/// Fields that views and paths have in common.
fn lens(view: &View) -> Result<Vec<String>, String> {
    let mut fields = vec![
        format!("fov_y_degrees: {}", number(view.fov_y_degrees)),
        format!("near: {}", number(view.near)),
        format!("far: {}", number(view.far)),
    ];
    if view.up != DVec3::Y {
        fields.insert(0, format!("up: {}", vector(view.up)));
    }
    match view.light.as_ref().map(|light| light.kind) {
        None => {}
        Some(LightKind::Directional(light)) => fields.push(format!("light: ({})", sun(light))),
        Some(lamp) => {
            return Err(format!(
                "{:?} has a {} light of its own, and a scene file has such lights for all views \
                 only",
                view.name,
                lamp.word()
            ));
        }
    }
    Ok(fields)
}

/// A path under a lamp of the scene is drawn under it with `--light`, as a comment says.
fn path(path: &CameraPath, lights: &[Light]) -> Result<String, String> {
    const INDENT: &str = "            ";
    let mut view = path.view.clone();
    let is_lamp = |light: &Light| light.kind.directional().is_none() && lights.contains(light);
    let mut text = match view.light.take_if(|light| is_lamp(light)) {
        Some(lamp) => format!("// Under its light: --light {}\n        (\n", lamp.name),
        None => "(\n".to_owned(),
    };
    text += &format!("{INDENT}name: {:?},\n", view.name);
    for field in lens(&view)? {
        text += &format!("{INDENT}{field},\n");
    }
    let rate = number(path.frames_per_second);
    text += &format!("{INDENT}frames_per_second: {rate},\n");
    let keys = path.keys.iter().map(|key| {
        let (at, eye) = (number(key.at), vector(key.eye));
        format!(
            "(at: {at}, eye: {eye}, direction: {})",
            vector(key.direction)
        )
    });
    let light_keys = path.light_keys.iter().map(light_key);
    let moves = path.moves.iter().map(moves);
    for (name, items) in [
        ("keys", keys.collect::<Vec<String>>()),
        ("light_keys", light_keys.collect()),
        ("moves", moves.collect()),
    ] {
        text += &list(3, name, &items);
    }
    Ok(text + "        )")
}

fn light_key(key: &LightKey) -> String {
    let mut text = format!("(at: {}", number(key.at));
    for (field, coordinates) in [("direction", key.direction), ("position", key.position)] {
        if let Some(coordinates) = coordinates {
            text += &format!(", {field}: {}", vector(coordinates));
        }
    }
    text + ")"
}

fn moves(moved: &Motion) -> String {
    match moved {
        Motion::Rigid {
            part,
            pivot,
            axis,
            keys,
        } => {
            let keys = keys.iter().map(|key| {
                let (at, shift) = (number(key.at), vector(key.translation));
                let degrees = number(key.degrees);
                format!("(at: {at}, translation: {shift}, degrees: {degrees})")
            });
            let keys: Vec<String> = keys.collect();
            let (pivot, axis, keys) = (vector(*pivot), vector(*axis), keys.join(", "));
            format!("Rigid(part: {part:?}, pivot: {pivot}, axis: {axis}, keys: [{keys}])")
        }
        Motion::Posed { part, keys } => {
            let keys = keys.iter().map(|key| {
                let (at, shift) = (number(key.at), vector(key.translation));
                let turn = key.rotation.to_array().map(number).join(", ");
                format!("(at: {at}, translation: {shift}, rotation: ({turn}))")
            });
            let keys: Vec<String> = keys.collect();
            let keys = keys.join(",\n                    ");
            format!(
                "Posed(part: {part:?}, keys: [\n                    {keys},\n                ])"
            )
        }
        Motion::Sway {
            part,
            axis,
            degrees,
            seconds,
            ..
        } => format!(
            "Sway(part: {part:?}, axis: {}, degrees: {}, seconds: {})",
            vector(*axis),
            number(*degrees),
            number(*seconds)
        ),
    }
}
