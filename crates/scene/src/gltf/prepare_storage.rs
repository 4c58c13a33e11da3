//! Reduces accessors, buffer views and buffers to those in use.

use super::beside::{Beside, each, index, items, taken};
use super::extensions;
use super::fault::Fault;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashSet};

/// Reduces them; materials and meshes are reduced before.
///
/// # Errors
/// A buffer view in use is packed, and nothing stands in for it.
pub(super) fn storage(root: &mut Value, beside: &mut Beside) -> Result<(), Fault> {
    let accessors = used_accessors(root, beside);
    let mut views = accessor_list(root, beside, &accessors);
    views.extend(used_images(root));
    buffer_views(root, beside, &views)
}

/// The buffer views of pictures that are read.
fn used_images(root: &Value) -> Vec<usize> {
    let views = items(root, "images").map(|image| image.get("bufferView"));
    views.filter_map(index).collect()
}

fn used_accessors(root: &Value, beside: &Beside) -> HashSet<usize> {
    let mut used = HashSet::new();

    for primitive in items(root, "meshes").flat_map(|mesh| items(mesh, "primitives")) {
        let fields = |object: Option<&Value>| -> Vec<usize> {
            let fields = object.and_then(Value::as_object).into_iter().flatten();
            fields.filter_map(|(_, value)| index(Some(value))).collect()
        };
        used.extend(index(primitive.get("indices")));
        used.extend(fields(primitive.get("attributes")));
        for target in items(primitive, "targets") {
            used.extend(fields(Some(target)));
        }
    }
    used.extend(items(root, "skins").filter_map(|skin| index(skin.get("inverseBindMatrices"))));
    used.extend(beside.instances.values().flatten().flatten());
    used
}

/// Bounds that no reader needs are there, unused accessors are plain, and those without a buffer
/// view are zeros that the `gltf` crate accepts. Returns the buffer views in use.
fn accessor_list(root: &mut Value, beside: &mut Beside, used: &HashSet<usize>) -> HashSet<usize> {
    let mut views = HashSet::new();
    let nothing = items(root, "bufferViews").count();
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
        for pointer in ["/indices/bufferView", "/values/bufferView"] {
            views.extend(sparse.and_then(|sparse| index(sparse.pointer(pointer))));
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
        let buffer = items(root, "buffers").count();
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
        let stands_in = buffer.remove("extensions").is_some_and(|extensions| {
            let marked = |extension: &Value| extension.get("fallback") == Some(&true.into());
            extensions
                .as_object()
                .is_some_and(|fields| fields.values().any(marked))
        });
        empty.insert(number, stands_in || !has_bytes);
    });
    let mut fault = None;
    each(root, "bufferViews", |number, view| {
        let extensions = taken(view, "buffer views", beside);
        view.remove("target");
        if let Some(stride) =
            index(view.get("byteStride")).filter(|stride| !(4..=252).contains(stride))
        {
            view.remove("byteStride");
            if stride > 0 {
                beside.strides.insert(number, stride);
            }
        }
        let Some(buffer) = index(view.get("buffer")).filter(|_| used.contains(&number)) else {
            return;
        };
        match extensions::packed(&extensions) {
            Some(why) if empty.get(&buffer) == Some(&true) => {
                fault.get_or_insert((format!("buffer view {number}"), why));
            }
            _ => {
                beside.buffers.insert(buffer);
            }
        }
    });
    fault.map_or(Ok(()), Err)
}
