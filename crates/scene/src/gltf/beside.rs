//! The part of a document's JSON that the `gltf` crate does not read, and how it is read.

use super::extensions::{self, Kind};
use crate::{error::beginning, shadows::Shadows};
use serde_json::{Map, Value};
use std::collections::{BTreeSet, HashMap, HashSet};

/// The part of a document that the `gltf` crate does not read.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Beside {
    /// Nodes that are hidden with all below them (KHR_node_visibility).
    pub hidden: HashSet<usize>,
    /// Nodes whose mesh is there several times (EXT_mesh_gpu_instancing).
    pub instances: HashMap<usize, Instances>,
    /// Roles in shadows that the `extras` of nodes give.
    pub roles: HashMap<usize, Shadows>,
    /// The same of meshes.
    pub mesh_roles: HashMap<usize, Shadows>,
    /// Textures whose picture cannot be read, and why.
    pub unread: HashMap<usize, String>,
    /// Distances of a buffer view's items, bytes, which the `gltf` crate refuses.
    pub strides: HashMap<usize, usize>,
    /// Buffers that are needed.
    pub buffers: HashSet<usize>,
    /// Parts that were passed over.
    pub remarks: BTreeSet<String>,
}

/// Accessors of the translations, rotations and scales of instances.
pub(super) type Instances = [Option<usize>; 3];

pub(super) type Fields = Map<String, Value>;

/// The objects of one of the document's lists, with their numbers.
pub(super) fn each(root: &mut Value, list: &str, mut with: impl FnMut(usize, &mut Fields)) {
    let items = root.get_mut(list).and_then(Value::as_array_mut);
    for (index, item) in items.into_iter().flatten().enumerate() {
        if let Some(fields) = item.as_object_mut() {
            with(index, fields);
        }
    }
}

/// The items of a list, if it is there.
pub(super) fn items<'v>(owner: &'v Value, list: &str) -> impl Iterator<Item = &'v Value> + use<'v> {
    let items = owner.get(list).and_then(Value::as_array);
    items.into_iter().flatten()
}

pub(super) fn index(value: Option<&Value>) -> Option<usize> {
    usize::try_from(value?.as_u64()?).ok()
}

/// The role in shadows that the `extras` of an object give, if they do: `casts` and `receives`,
/// true without a word. Some exporters write 0 and 1.
pub(super) fn role(fields: &Fields, place: &str, beside: &mut Beside) -> Option<Shadows> {
    let extras = fields.get("extras")?;
    let mut is_said = false;
    let mut flag = |name: &str| match extras.get(name) {
        None => true,
        Some(value) => {
            let flag = value.as_bool().or(value.as_u64().map(|number| number != 0));
            if flag.is_none() {
                let value = value.to_string();
                let value = beginning(&value);
                let text =
                    format!("{place}: its extras say {name}: {value}, expected true or false");
                beside.remarks.insert(text);
            }
            is_said |= flag.is_some();
            flag.unwrap_or(true)
        }
    };
    let role = Shadows::new(flag("casts"), flag("receives"));
    is_said.then_some(role)
}

/// Takes the extensions off an object, and says which are not followed.
pub(super) fn taken(fields: &mut Fields, owners: &str, beside: &mut Beside) -> Fields {
    fields.remove("extras");
    let Some(Value::Object(taken)) = fields.remove("extensions") else {
        return Fields::new();
    };
    for name in taken.keys() {
        if extensions::kind(name) == Kind::Unknown {
            let text = format!("{} of {owners} is not followed", beginning(name));
            beside.remarks.insert(text);
        }
    }
    taken
}
