//! Reduces materials, textures, pictures and samplers to what colours a triangle or cuts it out.

use super::beside::{Beside, Fields, each, index, items, taken};
use crate::error::beginning;
use serde_json::{Value, json};
use std::collections::{HashMap, HashSet};

pub(super) fn materials(root: &mut Value, beside: &mut Beside) {
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
        if mode.is_some_and(|mode| !["BLEND", "MASK", "OPAQUE"].iter().any(|name| mode == *name)) {
            let mode = material.remove("alphaMode").unwrap_or_default();
            let text = format!("alphaMode {mode} passed over: glTF has no such one; opaque");
            beside.remarks.insert(text);
        }
        let mut base = Fields::new();
        if let Some(factor) = pbr.get("baseColorFactor").filter(|rgba| rgba.is_array()) {
            base.insert("baseColorFactor".into(), factor.clone());
        }
        if let Some(Value::Object(texture)) = pbr.get("baseColorTexture") {
            let mut texture = texture.clone();
            texture.remove("extras");
            if let Some(Value::Object(extensions)) = texture.get_mut("extensions") {
                extensions.retain(|name, _| name == "KHR_texture_transform");
            }
            base.insert("baseColorTexture".into(), texture.into());
        }
        material.insert("pbrMetallicRoughness".into(), base.into());
    });
}

/// Numbers of the textures that materials take.
fn used_textures(root: &Value) -> HashSet<usize> {
    let texture = "/pbrMetallicRoughness/baseColorTexture/index";
    let textures = items(root, "materials").map(|it| it.pointer(texture));
    textures.filter_map(index).collect()
}

/// The `gltf` crate wants a picture of every texture, and a kind of every picture.
pub(super) fn textures(root: &mut Value, beside: &mut Beside) {
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
