//! Takes out of a document what this program has no use for, before the `gltf` crate validates it:
//! what cannot move or cut a triangle cannot refuse a file then. What the crate does not know of,
//! but is followed, is read here.

use super::{
    extensions::{self, Kind},
    fault::Fault,
};
use crate::{error::beginning, material_use::MaterialUse};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// What was read of a document beside what the `gltf` crate reads.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Beside {
    /// Nodes that are hidden with all below them (KHR_node_visibility).
    pub hidden: HashSet<usize>,
    /// Nodes whose mesh is there several times (EXT_mesh_gpu_instancing).
    pub instances: HashMap<usize, Instances>,
    /// Textures whose picture cannot be read, and why.
    pub unread: HashMap<usize, String>,
    /// Distances of a buffer view's items, bytes, which the `gltf` crate refuses.
    pub strides: HashMap<usize, usize>,
    /// Buffers that are needed.
    pub buffers: HashSet<usize>,
    /// What was passed over.
    pub remarks: BTreeSet<String>,
}

/// Accessors of the transforms of instances.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Instances {
    pub translation: Option<usize>,
    pub rotation: Option<usize>,
    pub scale: Option<usize>,
}

type Fields = Map<String, Value>;

/// Takes out what has no use.
///
/// # Errors
/// The place of what cannot be read without an extension, and the way out.
pub(super) fn prepare(root: &mut Value, materials: MaterialUse) -> Result<Beside, Fault> {
    let mut beside = Beside::default();
    required(root, &mut beside)?;
    remark_lights(root, &mut beside);
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
    nodes(root, &mut beside);
    meshes(root, &mut beside, materials)?;
    each(root, "skins", |_, skin| {
        skin.retain(|field, _| matches!(field.as_str(), "inverseBindMatrices" | "joints" | "name"));
    });
    self::materials(root, &mut beside);
    textures(root, &mut beside);
    let accessors = used_accessors(root, &beside);
    let mut views = accessor_list(root, &mut beside, &accessors);
    views.extend(used_images(root));
    buffer_views(root, &mut beside, &views)?;
    Ok(beside)
}

/// The objects of one of the document's lists, with their numbers.
fn each(root: &mut Value, list: &str, mut with: impl FnMut(usize, &mut Fields)) {
    let items = root.get_mut(list).and_then(Value::as_array_mut);
    for (index, item) in items.into_iter().flatten().enumerate() {
        if let Some(fields) = item.as_object_mut() {
            with(index, fields);
        }
    }
}

fn index(value: Option<&Value>) -> Option<usize> {
    usize::try_from(value?.as_u64()?).ok()
}

/// Refuses what the file cannot be read without; says what is passed over of it.
fn required(root: &Value, beside: &mut Beside) -> Result<(), Fault> {
    let names = root.get("extensionsRequired").and_then(Value::as_array);
    let mut looks = Vec::new();
    for (index, name) in names.into_iter().flatten().enumerate() {
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

fn remark_lights(root: &Value, beside: &mut Beside) {
    let lights = root.pointer("/extensions/KHR_lights_punctual/lights");
    let count = lights.and_then(Value::as_array).map_or(0, Vec::len);
    if count > 0 {
        let lights = crate::error::plural(count, "light", "lights");
        let text = format!("{lights} of the file (KHR_lights_punctual) not taken: give --light");
        beside.remarks.insert(text);
    }
}

/// Takes the extensions off an object, and says which are not followed.
fn taken(fields: &mut Fields, of: &str, beside: &mut Beside) -> Fields {
    fields.remove("extras");
    let Some(Value::Object(taken)) = fields.remove("extensions") else {
        return Fields::new();
    };
    for name in taken.keys() {
        if extensions::kind(name) == Kind::Unknown {
            let text = format!("{} of {of} is not followed", beginning(name));
            beside.remarks.insert(text);
        }
    }
    taken
}

fn nodes(root: &mut Value, beside: &mut Beside) {
    each(root, "nodes", |number, node| {
        node.remove("camera");
        let extensions = taken(node, "nodes", beside);
        let visible = |of: &Value| of.get("visible").and_then(Value::as_bool);
        if extensions.get("KHR_node_visibility").and_then(visible) == Some(false) {
            beside.hidden.insert(number);
        }
        let attributes = extensions
            .get("EXT_mesh_gpu_instancing")
            .and_then(|of| of.get("attributes"));
        if let Some(attributes) = attributes {
            let accessor = |name| index(attributes.get(name));
            let instances = Instances {
                translation: accessor("TRANSLATION"),
                rotation: accessor("ROTATION"),
                scale: accessor("SCALE"),
            };
            // Without any there is no number of instances.
            if instances != Instances::default() {
                beside.instances.insert(number, instances);
            }
        }
    });
}

/// True for attributes that move a vertex, or by which a mask is looked up.
fn is_read(attribute: &str) -> bool {
    let numbered = ["TEXCOORD_", "JOINTS_", "WEIGHTS_"];
    let number = numbered
        .iter()
        .find_map(|name| attribute.strip_prefix(name));
    matches!(attribute, "POSITION" | "NORMAL" | "COLOR_0")
        || number.is_some_and(|number| number.parse::<u32>().is_ok())
}

/// True for attributes of glTF that are not read, and for those of the application's own.
fn is_known(attribute: &str) -> bool {
    ["_", "TANGENT", "COLOR_"]
        .iter()
        .any(|name| attribute.starts_with(name))
}

fn meshes(root: &mut Value, beside: &mut Beside, materials: MaterialUse) -> Result<(), Fault> {
    let packed_away: Vec<bool> = root
        .get("accessors")
        .and_then(Value::as_array)
        .into_iter()
        .flatten()
        .map(|accessor| accessor.get("bufferView").is_none() && accessor.get("sparse").is_none())
        .collect();
    let is_away = |accessor: &Value| {
        index(Some(accessor)).is_some_and(|at| packed_away.get(at).copied().unwrap_or(false))
    };
    let mut fault = None;
    each(root, "meshes", |number, mesh| {
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
            let attributes = attributes.into_iter().flat_map(|of| of.values());
            let mut accessors = attributes.chain(primitive.get("indices"));
            for name in extensions.keys() {
                let is_packed = extensions::kind(name) == Kind::Packed;
                if is_packed && accessors.any(is_away) && fault.is_none() {
                    let place = format!("mesh {number}, primitive {which}");
                    fault = Some((place, extensions::packed(name)));
                }
            }
        }
    });
    fault.map_or(Ok(()), Err)
}

fn materials(root: &mut Value, beside: &mut Beside) {
    each(root, "materials", |_, material| {
        let extensions = taken(material, "materials", beside);
        let pbr = match extensions.get("KHR_materials_pbrSpecularGlossiness") {
            Some(other) => json!({
                "baseColorFactor": other.get("diffuseFactor"),
                "baseColorTexture": other.get("diffuseTexture"),
            }),
            None => material.remove("pbrMetallicRoughness").unwrap_or_default(),
        };
        material.retain(|field, _| {
            let read = ["alphaCutoff", "alphaMode", "doubleSided", "name"];
            read.contains(&field.as_str())
        });
        let mode = material.get("alphaMode").cloned();
        if mode.is_some_and(|mode| !["BLEND", "MASK", "OPAQUE"].iter().any(|of| mode == *of)) {
            let mode = material.remove("alphaMode").unwrap_or_default();
            let text = format!("alphaMode {mode} passed over: glTF has no such one; opaque");
            beside.remarks.insert(text);
        }
        let mut base = Fields::new();
        if let Some(factor) = pbr.get("baseColorFactor").filter(|of| of.is_array()) {
            base.insert("baseColorFactor".into(), factor.clone());
        }
        if let Some(Value::Object(texture)) = pbr.get("baseColorTexture") {
            let mut texture = texture.clone();
            texture.remove("extras");
            if let Some(Value::Object(of)) = texture.get_mut("extensions") {
                of.retain(|name, _| name == "KHR_texture_transform");
            }
            base.insert("baseColorTexture".into(), texture.into());
        }
        material.insert("pbrMetallicRoughness".into(), base.into());
    });
}

/// Numbers of the textures that materials take.
fn used_textures(root: &Value) -> HashSet<usize> {
    let materials = root.get("materials").and_then(Value::as_array);
    let texture = "/pbrMetallicRoughness/baseColorTexture/index";
    let textures = materials.into_iter().flatten();
    textures
        .filter_map(|of| index(of.pointer(texture)))
        .collect()
}

/// The `gltf` crate wants a picture of every texture, and a kind of every picture.
fn textures(root: &mut Value, beside: &mut Beside) {
    let used = used_textures(root);
    let mut used_images = HashSet::new();
    let mut unread = HashMap::new();
    each(root, "textures", |number, texture| {
        texture.remove("extras");
        let extensions = match texture.remove("extensions") {
            Some(Value::Object(extensions)) => extensions,
            _ => Fields::new(),
        };
        match index(texture.get("source")) {
            Some(image) if used.contains(&number) => {
                used_images.insert(image);
            }
            Some(_) => {}
            None => {
                let name = extensions.keys().next();
                unread.insert(number, match name {
                    Some(name) => format!(
                        "its picture is in {}, which this program does not read: save it as PNG \
                         or JPEG",
                        beginning(name)
                    ),
                    None => "it has no picture".to_owned(),
                });
                texture.insert("source".into(), 0.into());
            }
        }
    });
    if !unread.is_empty() && root.pointer("/images/0").is_none() {
        root["images"] = json!([{"uri": ""}]);
    }
    each(root, "images", |number, image| {
        image.remove("extensions");
        image.remove("extras");
        if image.contains_key("bufferView") && used_images.contains(&number) {
            // Its first bytes tell what it is.
            image.entry("mimeType").or_insert("image/png".into());
        } else if !used_images.contains(&number) || !image.contains_key("uri") {
            image.clear();
            image.insert("uri".into(), "".into());
        }
    });
    beside.unread = unread;
    each(root, "samplers", |_, sampler| {
        let wraps = |value: &Value| matches!(value.as_u64(), Some(10497 | 33071 | 33648));
        sampler.retain(|field, value| match field.as_str() {
            "wrapS" | "wrapT" => {
                let is_known = wraps(value);
                if !is_known {
                    let text = format!("{field} {value} passed over: glTF has no such one");
                    beside.remarks.insert(text);
                }
                is_known
            }
            _ => false,
        });
    });
}

/// The buffer views of pictures that are read.
fn used_images(root: &Value) -> Vec<usize> {
    let images = root.get("images").and_then(Value::as_array);
    let views = images.into_iter().flatten();
    views
        .filter_map(|image| index(image.get("bufferView")))
        .collect()
}

fn used_accessors(root: &Value, beside: &Beside) -> HashSet<usize> {
    let mut used = HashSet::new();
    let list = |name| {
        root.get(name)
            .and_then(Value::as_array)
            .into_iter()
            .flatten()
    };
    for primitive in list("meshes").flat_map(|mesh| {
        let primitives = mesh.get("primitives").and_then(Value::as_array);
        primitives.into_iter().flatten()
    }) {
        let fields = |of: Option<&Value>| -> Vec<usize> {
            let fields = of.and_then(Value::as_object).into_iter().flatten();
            fields.filter_map(|(_, value)| index(Some(value))).collect()
        };
        used.extend(index(primitive.get("indices")));
        used.extend(fields(primitive.get("attributes")));
        let targets = primitive.get("targets").and_then(Value::as_array);
        for target in targets.into_iter().flatten() {
            used.extend(fields(Some(target)));
        }
    }
    used.extend(list("skins").filter_map(|skin| index(skin.get("inverseBindMatrices"))));
    for of in beside.instances.values() {
        used.extend(
            [of.translation, of.rotation, of.scale]
                .into_iter()
                .flatten(),
        );
    }
    used
}

/// Bounds that nobody reads are there, unused accessors are plain, and those without a buffer view
/// are zeros that the `gltf` crate accepts. Returns the buffer views in use.
fn accessor_list(root: &mut Value, beside: &mut Beside, used: &HashSet<usize>) -> HashSet<usize> {
    let mut views = HashSet::new();
    let nothing = root
        .get("bufferViews")
        .and_then(Value::as_array)
        .map_or(0, Vec::len);
    let mut needs_nothing = false;
    each(root, "accessors", |number, accessor| {
        taken(accessor, "accessors", beside);
        if !used.contains(&number) {
            accessor.clear();
            accessor.insert("componentType".into(), 5126.into());
            accessor.insert("count".into(), 1.into());
            accessor.insert("type".into(), "SCALAR".into());
        }
        accessor.insert("min".into(), json!([0, 0, 0]));
        accessor.insert("max".into(), json!([0, 0, 0]));
        views.extend(index(accessor.get("bufferView")));
        let sparse = accessor.get("sparse");
        for of in ["/indices/bufferView", "/values/bufferView"] {
            views.extend(sparse.and_then(|sparse| index(sparse.pointer(of))));
        }
        if sparse.is_none() && !accessor.contains_key("bufferView") {
            needs_nothing = true;
            let none = json!({
                "count": 0,
                "indices": {"bufferView": nothing, "componentType": 5123},
                "values": {"bufferView": nothing},
            });
            accessor.insert("sparse".into(), none);
        }
    });
    if needs_nothing {
        let buffer = root
            .get("buffers")
            .and_then(Value::as_array)
            .map_or(0, Vec::len);
        for (list, item) in [
            ("bufferViews", json!({"buffer": buffer, "byteLength": 0})),
            ("buffers", json!({"byteLength": 0})),
        ] {
            match root.get_mut(list).and_then(Value::as_array_mut) {
                Some(items) => items.push(item),
                None => root[list] = json!([item]),
            }
        }
    }
    views
}

/// # Errors
/// A buffer view in use is packed, and nothing stands in for it.
fn buffer_views(root: &mut Value, beside: &mut Beside, used: &HashSet<usize>) -> Result<(), Fault> {
    let mut empty = BTreeMap::new();
    each(root, "buffers", |number, buffer| {
        buffer.remove("extras");
        let has_bytes = buffer.contains_key("uri") || number == 0;
        let stands_in = buffer.remove("extensions").is_some_and(|of| {
            let marked = |of: &Value| of.get("fallback") == Some(&true.into());
            of.as_object().is_some_and(|of| of.values().any(marked))
        });
        empty.insert(number, stands_in || !has_bytes);
    });
    let mut fault = None;
    each(root, "bufferViews", |number, view| {
        let extensions = taken(view, "buffer views", beside);
        view.remove("target");
        if let Some(stride) = index(view.get("byteStride")).filter(|of| !(4..=252).contains(of)) {
            view.remove("byteStride");
            if stride > 0 {
                beside.strides.insert(number, stride);
            }
        }
        let Some(buffer) = index(view.get("buffer")).filter(|_| used.contains(&number)) else {
            return;
        };
        let mut names = extensions.keys();
        let packed = names.find(|name| extensions::kind(name) == Kind::Packed);
        match packed {
            Some(name) if empty.get(&buffer) == Some(&true) => {
                let place = format!("buffer view {number}");
                fault.get_or_insert((place, extensions::packed(name)));
            }
            _ => {
                beside.buffers.insert(buffer);
            }
        }
    });
    fault.map_or(Ok(()), Err)
}
