//! Views and lights of a document: its cameras and those of KHR_lights_punctual, where nodes place
//! them.

use super::clips::{self, Clip};
use super::names::{Names, titled};
use super::nodes::Nodes;
use super::placements::Placements;
use crate::camera::View;
use crate::error::plural;
use crate::light::DirectionalLight;
use crate::light_kind::{Light, LightKind, PointLight, SpotLight};
use glam::{DMat3, DMat4, DVec3, Vec3};
use serde_json::Value;

/// Views, lights and animations of a glTF file. Views and lights are in the order of the nodes of
/// the file's scene, depth first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GltfScene {
    /// One view for each perspective camera that a node of the scene places. Its name is the
    /// node's, or else the camera's, in small letters, digits and `_`, or else `camera_N` with the
    /// number of the node; no two views have the same name.
    pub views: Vec<View>,
    /// One light for each light that a visible node of the scene places, except black lights and
    /// those without power. Names are formed like those of `views` (`light_N`).
    pub lights: Vec<Light>,
    /// Animations of the file's nodes, in file order.
    pub clips: Vec<Clip>,
    /// The node of each view, and of each light.
    nodes_of_views: Vec<usize>,
    nodes_of_lights: Vec<usize>,
    /// One sentence for each camera, light or animation that was left out, and for each missing
    /// value that was replaced by a default.
    pub remarks: Vec<String>,
}

/// Widest cone of a spot, in degrees.
const WIDEST_CONE: f64 = 179.9;

/// Reads cameras and lights one after the other.
struct Reader<'a> {
    placements: &'a Placements,
    bounds: Option<(Vec3, Vec3)>,
    names_of_views: Names,
    names_of_lights: Names,
    /// Lights that say how far they reach.
    with_range: usize,
    scene: GltfScene,
}

impl GltfScene {
    /// Those of a document with a mesh of these bounds.
    pub(super) fn new(
        placements: &Placements,
        nodes: Option<&Nodes<'_>>,
        bounds: Option<(Vec3, Vec3)>,
    ) -> Self {
        let mut reader = Reader {
            placements,
            bounds,
            names_of_views: Names::default(),
            names_of_lights: Names::default(),
            with_range: 0,
            scene: Self::default(),
        };
        let in_scene = nodes.map_or(&[][..], |nodes| &nodes.in_scene);
        let (mut cameras, mut lights) = (Vec::new(), Vec::new());
        for (node, is_seen) in in_scene {
            let Some(placement) = placements.nodes.get(node) else {
                continue;
            };
            let world = nodes.and_then(|nodes| nodes.worlds.get(node));
            let placed = Placed {
                place: titled("node", *node, placement.name.as_deref()),
                node: *node,
                world: world.copied().unwrap_or_default(),
                name: placement.name.as_deref(),
            };
            if let Some(camera) = placement.camera {
                cameras.push(camera);
                reader.add_camera(camera, &placed);
            }
            if let Some(light) = placement.light {
                lights.push(light);
                reader.add_light(light, *is_seen, &placed);
            }
        }
        reader.tell_unplaced("camera", &placements.cameras, &cameras);
        reader.tell_unplaced("light", &placements.lights, &lights);
        if reader.with_range > 0 {
            let lights = plural(reader.with_range, "light", "lights");
            reader.remark(format!(
                "the range of {lights} bears on nothing: a shadow counts at any distance"
            ));
        }
        reader.scene
    }

    /// Adds the animations of the document.
    pub(super) fn add_clips(&mut self, source: &clips::Source<'_>) {
        let placed = clips::Placed {
            views: &self.nodes_of_views,
            lights: &self.nodes_of_lights,
            kinds: self.lights.iter().map(|light| light.kind).collect(),
        };
        let (clips, remarks) = clips::clips(source, &placed);
        self.clips = clips;
        self.remarks.extend(remarks);
    }
}

/// Where a camera or a light is.
struct Placed<'a> {
    /// The node, for messages.
    place: String,
    node: usize,
    world: DMat4,
    name: Option<&'a str>,
}

impl Placed<'_> {
    fn position(&self) -> DVec3 {
        self.world.w_axis.truncate()
    }

    /// Cameras look and lights shine along −z of their node.
    fn direction(&self) -> DVec3 {
        (-self.world.z_axis.truncate()).normalize_or_zero()
    }

    /// Its name, else that of the camera or light, else a number.
    fn name(&self, what: &str, object: &Value) -> String {
        let own = object.get("name").and_then(Value::as_str);
        let name = self.name.or(own).unwrap_or_default();
        Names::plain(name, &format!("{what}_{}", self.node))
    }
}

/// A number of the file; `None` if it is not there or is none.
fn number(object: &Value, field: &str) -> Option<f64> {
    object.get(field).and_then(Value::as_f64)
}

impl Reader<'_> {
    fn remark(&mut self, text: String) {
        self.scene.remarks.push(text);
    }

    fn tell_unplaced(&mut self, what: &str, entries: &[Value], placed: &[usize]) {
        for (number, entry) in entries.iter().enumerate() {
            if !placed.contains(&number) {
                let entry = titled(what, number, entry.get("name").and_then(Value::as_str));
                self.remark(format!(
                    "{entry} is left out: no node of the scene places it"
                ));
            }
        }
    }

    fn add_camera(&mut self, number: usize, placed: &Placed<'_>) {
        let place = &placed.place;
        match self.view(number, placed) {
            Ok((view, remarks)) => {
                let names = &mut self.names_of_views;
                let (name, note) = names.noted(&view.name, "camera", "its view is");
                for remark in note.into_iter().chain(remarks) {
                    self.remark(format!("{place}: {remark}"));
                }
                self.scene.nodes_of_views.push(placed.node);
                self.scene.views.push(View { name, ..view });
            }
            Err(why) => self.remark(format!("{place}: its camera is left out: {why}")),
        }
    }

    /// The view of a camera, with what was chosen.
    fn view(&self, index: usize, placed: &Placed<'_>) -> Result<(View, Vec<String>), String> {
        let camera = entry(&self.placements.cameras, index, ["camera", "cameras"])?;
        match camera.get("type").and_then(Value::as_str) {
            Some("perspective") => {}
            Some("orthographic") => {
                return Err("it is orthographic, and views are perspective (make it \
                            perspective, or give --eye and --look)"
                    .to_owned());
            }
            other => return Err(of_type(other, "perspective")),
        }
        let lens = camera.get("perspective").unwrap_or(&Value::Null);
        let needed = |field| number(lens, field).ok_or_else(|| format!("it has no {field}"));
        let mut remarks = Vec::new();
        let (eye, near) = (placed.position(), needed("znear")?);
        let far = match lens.get("zfar") {
            Some(far) => far.as_f64().ok_or("its zfar has no number")?,
            None => {
                let far = self.farthest(eye).max(near * 2.0);
                remarks.push(format!(
                    "its camera has no zfar: far is {far:.6}, just behind the mesh"
                ));
                far
            }
        };
        if DMat3::from_mat4(placed.world).determinant() < 0.0 {
            remarks.push("it mirrors its camera, whose picture is not mirrored".to_owned());
        }
        let view = View {
            name: placed.name("camera", camera),
            eye,
            direction: placed.direction(),
            up: placed.world.y_axis.truncate().normalize_or_zero(),
            fov_y_degrees: needed("yfov")?.to_degrees(),
            near,
            far,
            ..View::default()
        };
        let mend = |why| format!("{why} (mend camera {index})");
        view.check_parts().map_err(mend)?;
        Ok((view, remarks))
    }

    /// Just behind the mesh, as seen from a place.
    fn farthest(&self, eye: DVec3) -> f64 {
        self.bounds.map_or(1.0, |(min, max)| {
            let (min, max) = (min.as_dvec3(), max.as_dvec3());
            (max - eye).abs().max((eye - min).abs()).length() * 1.01
        })
    }

    fn add_light(&mut self, number: usize, is_seen: bool, placed: &Placed<'_>) {
        let place = &placed.place;
        let read = match self.light(number, placed) {
            Ok(_) if !is_seen => Err("the node is hidden".to_owned()),
            read => read,
        };
        match read {
            Ok((light, remarks)) => {
                let names = &mut self.names_of_lights;
                let (name, note) = names.noted(&light.name, "light", "it is");
                for remark in note.into_iter().chain(remarks) {
                    self.remark(format!("{place}: {remark}"));
                }
                let has_range = self.placements.lights[number].get("range").is_some();
                let is_lamp = light.kind.directional().is_none();
                self.with_range += usize::from(has_range && is_lamp);
                self.scene.nodes_of_lights.push(placed.node);
                self.scene.lights.push(Light { name, ..light });
            }
            Err(why) => self.remark(format!("{place}: its light is left out: {why}")),
        }
    }

    /// The light, with what was chosen.
    fn light(&self, index: usize, placed: &Placed<'_>) -> Result<(Light, Vec<String>), String> {
        let light = entry(&self.placements.lights, index, ["light", "lights"])?;
        check_power(light)?;
        let (position, direction) = (placed.position(), placed.direction());
        let mut remarks = Vec::new();
        let kind: LightKind = match light.get("type").and_then(Value::as_str) {
            Some("directional") => DirectionalLight::new(direction).into(),
            Some("spot") => {
                let spot = light.get("spot");
                let cone = spot.and_then(|spot| number(spot, "outerConeAngle"));
                let cone = cone.unwrap_or(std::f64::consts::FRAC_PI_4);
                // A right angle that was rounded to f32 is one.
                if !(cone > 0.0 && cone < std::f64::consts::FRAC_PI_2 + 1e-6) {
                    return Err(format!(
                        "its outerConeAngle is {cone}, expected more than 0 and at most a right \
                         angle, 1.5708"
                    ));
                }
                let mut cone_degrees = 2.0 * cone.to_degrees();
                if cone_degrees > WIDEST_CONE {
                    remarks.push(format!(
                        "its cone of {cone_degrees:.2} degrees counts as one of {WIDEST_CONE}: \
                         no shadow map covers half of the space"
                    ));
                    cone_degrees = WIDEST_CONE;
                }
                SpotLight {
                    position,
                    direction,
                    cone_degrees,
                    radius: 0.0,
                }
                .into()
            }
            Some("point") => PointLight {
                position,
                radius: 0.0,
            }
            .into(),
            other => return Err(of_type(other, "directional, spot or point")),
        };
        let mend = |why| format!("{why} (mend light {index})");
        kind.check().map_err(mend)?;
        let name = placed.name("light", light);
        Ok((Light { name, kind }, remarks))
    }
}

/// The camera or light of a number that a node names.
///
/// # Errors
/// There is none of that number.
fn entry<'v>(list: &'v [Value], index: usize, [one, many]: [&str; 2]) -> Result<&'v Value, String> {
    let there = plural(list.len(), one, many);
    list.get(index).ok_or_else(|| match index {
        usize::MAX => format!("its number is none, and the file has {there}"),
        _ => format!("the node names {one} {index}, and the file has {there}, numbered from 0"),
    })
}

/// Why a camera or light of a type is not taken.
fn of_type(ty: Option<&str>, expected: &str) -> String {
    let ty = ty.map_or_else(|| "no type".to_owned(), |ty| format!("type {ty:?}"));
    format!("it has {ty}, expected {expected}")
}

/// That a light lights anything.
fn check_power(light: &Value) -> Result<(), String> {
    let positive = |field: &str, way_out: &str| match light.get(field).map(Value::as_f64) {
        None => Ok(()),
        Some(Some(value)) if value > 0.0 => Ok(()),
        Some(Some(value)) => Err(format!("its {field} is {value}: {way_out}")),
        Some(None) => Err(format!("its {field} has no number")),
    };
    positive("intensity", "it lights nothing, give it more than 0")?;
    // The extension has it ignored of a directional light.
    if light.get("type").and_then(Value::as_str) != Some("directional") {
        positive(
            "range",
            "it reaches nothing, give it more than 0 or leave it out",
        )?;
    }
    let channels = light.get("color").and_then(Value::as_array);
    let is_black = |channels: &Vec<Value>| channels.iter().all(|part| part.as_f64() == Some(0.0));
    if channels.is_some_and(is_black) {
        return Err("its color is black, it lights nothing".to_owned());
    }
    Ok(())
}
