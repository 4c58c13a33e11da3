//! Takes out of a document what this program has no use for, before the `gltf` crate validates it:
//! what cannot move or cut a triangle cannot refuse a file then. Extensions that are followed but
//! unknown to the crate are read here.

use super::beside::{Beside, Instances, each, index, items, role, taken};
use super::extensions::{self, Kind};
use super::fault::Fault;
use super::names::titled;
use super::nodes::NO_TURN;
use super::{prepare_looks, prepare_storage};
use crate::{error::beginning, material_use::MaterialUse};
use serde_json::Value;

/// Takes out what has no use.
///
/// # Errors
/// The place of what cannot be read without an extension, and the way out.
pub(super) fn prepare(root: &mut Value, materials: MaterialUse) -> Result<Beside, Fault> {
    let mut beside = Beside::default();
    required(root, &mut beside)?;
    if let Some(fields) = root.as_object_mut() {
        for unused in [
            "animations",
            "cameras",
            "extensions",
            "extensionsRequired",
            "extensionsUsed",
            "extras",
        ] {
            fields.remove(unused);
        }
        if materials == MaterialUse::Ignore {
            for list in ["images", "materials", "samplers", "textures"] {
                fields.remove(list);
            }
        }
    }
    each(root, "scenes", |_, scene| {
        scene.entry("nodes").or_insert(Value::Array(Vec::new()));
    });
    nodes(root, &mut beside);
    meshes(root, &mut beside, materials)?;
    each(root, "skins", |_, skin| {
        skin.retain(|field, _| matches!(field.as_str(), "inverseBindMatrices" | "joints" | "name"));
    });
    prepare_looks::materials(root, &mut beside);
    prepare_looks::textures(root, &mut beside);
    prepare_storage::storage(root, &mut beside)?;
    Ok(beside)
}

/// Refuses what the file cannot be read without; says what is passed over of it.
fn required(root: &Value, beside: &mut Beside) -> Result<(), Fault> {
    let mut looks = Vec::new();
    for (index, name) in items(root, "extensionsRequired").enumerate() {
        let name = name.as_str().unwrap_or_default();
        match extensions::kind(name) {
            Kind::Followed | Kind::Packed => {}
            Kind::Looks => looks.push(name),
            Kind::Unknown if extensions::is_of_looks(root, name) => looks.push(name),
            Kind::Unknown => {
                let place = format!("extensionsRequired[{index}] = {:?}", beginning(name));
                let why = "the file cannot be read without an extension that this program does \
                           not know; export it without";
                return Err((place, why.to_owned()));
            }
        }
    }
    if !looks.is_empty() {
        let names = looks.join(", ");
        let text = format!("required for looks only, passed over: {names}");
        beside.remarks.insert(text);
    }
    Ok(())
}

fn nodes(root: &mut Value, beside: &mut Beside) {
    each(root, "nodes", |number, node| {
        node.remove("camera");
        let is_none = |turn: &Vec<Value>| turn.iter().all(|part| part.as_f64() == Some(0.0));
        let turn = node.get("rotation").and_then(Value::as_array);
        if turn.is_some_and(is_none) {
            let place = titled("node", number, node.get("name").and_then(Value::as_str));
            beside.remarks.insert(format!("{place}: its {NO_TURN}"));
        }
        if let Some(role) = role(node, &format!("node {number}"), beside) {
            beside.roles.insert(number, role);
        }
        let extensions = taken(node, "nodes", beside);
        let visible = |extension: &Value| extension.get("visible").and_then(Value::as_bool);
        if extensions.get("KHR_node_visibility").and_then(visible) == Some(false) {
            beside.hidden.insert(number);
        }
        let instancing = extensions.get("EXT_mesh_gpu_instancing");
        if let Some(attributes) = instancing.and_then(|it| it.get("attributes")) {
            let accessor = |name| index(attributes.get(name));
            let instances: Instances = ["TRANSLATION", "ROTATION", "SCALE"].map(accessor);
            // Without any there is no number of instances.
            if instances.iter().any(Option::is_some) {
                beside.instances.insert(number, instances);
            }
        }
    });
}

/// True for attributes that move a vertex, or by which a mask is looked up.
fn is_read(attribute: &str) -> bool {
    let mut numbered = ["TEXCOORD_", "JOINTS_", "WEIGHTS_"].iter();
    let number = numbered.find_map(|name| attribute.strip_prefix(name));
    matches!(attribute, "POSITION" | "NORMAL" | "COLOR_0")
        || number.is_some_and(|number| number.parse::<u32>().is_ok())
}

/// True for attributes of glTF that are not read, and for those of the application's own.
fn is_known(attribute: &str) -> bool {
    let mut beginnings = ["_", "TANGENT", "COLOR_"].iter();
    beginnings.any(|name| attribute.starts_with(name))
}

fn meshes(root: &mut Value, beside: &mut Beside, materials: MaterialUse) -> Result<(), Fault> {
    let packed_away: Vec<bool> = items(root, "accessors")
        .map(|accessor| accessor.get("bufferView").is_none() && accessor.get("sparse").is_none())
        .collect();
    let is_away = |accessor: &Value| {
        index(Some(accessor)).is_some_and(|at| packed_away.get(at).copied().unwrap_or(false))
    };
    let mut fault = None;
    each(root, "meshes", |number, mesh| {
        if let Some(role) = role(mesh, &format!("mesh {number}"), beside) {
            beside.mesh_roles.insert(number, role);
        }
        taken(mesh, "meshes", beside);
        let primitives = mesh.get_mut("primitives").and_then(Value::as_array_mut);
        for (which, primitive) in primitives.into_iter().flatten().enumerate() {
            let Some(primitive) = primitive.as_object_mut() else {
                continue;
            };
            let extensions = taken(primitive, "primitives", beside);
            if materials == MaterialUse::Ignore {
                primitive.remove("material");
            }
            if let Some(Value::Object(attributes)) = primitive.get_mut("attributes") {
                attributes.retain(|name, _| {
                    if !is_read(name) && !is_known(name) {
                        let name = beginning(name);
                        let text = format!("attribute {name} passed over: glTF has no such one");
                        beside.remarks.insert(text);
                    }
                    is_read(name)
                });
            }
            let targets = primitive.get_mut("targets").and_then(Value::as_array_mut);
            for target in targets.into_iter().flatten() {
                if let Some(target) = target.as_object_mut() {
                    target.retain(|name, _| matches!(name.as_str(), "POSITION" | "NORMAL"));
                }
            }
            let attributes = primitive.get("attributes").and_then(Value::as_object);
            let attributes = attributes.into_iter().flat_map(|fields| fields.values());
            let mut accessors = attributes.chain(primitive.get("indices"));
            if let Some(why) = extensions::packed(&extensions)
                && accessors.any(is_away)
            {
                fault.get_or_insert((format!("mesh {number}, primitive {which}"), why));
            }
        }
    });
    fault.map_or(Ok(()), Err)
}
