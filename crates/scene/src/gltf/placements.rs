//! Cameras, lights and animations of a document, and the nodes that place them, read before
//! `prepare` takes them out.

use super::animations::Animations;
use super::beside::{index, items};
use serde_json::Value;
use std::collections::BTreeMap;

/// Cameras and lights as a document says them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Placements {
    /// `cameras` as they are in the file.
    pub cameras: Vec<Value>,
    /// Those of KHR_lights_punctual.
    pub lights: Vec<Value>,
    pub animations: Animations,
    /// By the number of the node.
    pub nodes: BTreeMap<usize, Placement>,
}

/// A node that places a camera, a light or both. A number that is none names nothing that there is.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Placement {
    pub name: Option<String>,
    pub camera: Option<usize>,
    pub light: Option<usize>,
}

impl Placements {
    pub fn read(root: &Value) -> Self {
        let named = |value: &Value| index(Some(value)).unwrap_or(usize::MAX);
        let mut nodes = BTreeMap::new();
        for (number, node) in items(root, "nodes").enumerate() {
            let light = node.pointer("/extensions/KHR_lights_punctual/light");
            let placement = Placement {
                name: node.get("name").and_then(Value::as_str).map(str::to_owned),
                camera: node.get("camera").map(named),
                light: light.map(named),
            };
            if placement.camera.is_some() || placement.light.is_some() {
                nodes.insert(number, placement);
            }
        }
        let lights = root.pointer("/extensions/KHR_lights_punctual");
        Self {
            animations: Animations::read(root),
            cameras: items(root, "cameras").cloned().collect(),
            lights: lights.map_or_else(Vec::new, |ext| items(ext, "lights").cloned().collect()),
            nodes,
        }
    }
}
