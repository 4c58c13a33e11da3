//! Animations of a document and their keys, read from the JSON by themselves: no mistake in them
//! keeps a mesh from being read.

use super::beside::{index, items};
use super::buffers::{Buffers, load};
use super::nodes::unit;
use super::{accessor, extensions};
use crate::error::{beginning, plural};
use glam::{DQuat, DVec3};
use gltf::accessor::DataType;
use serde_json::Value;
use std::collections::{BTreeMap, HashSet};
use std::path::Path;
use std::sync::Arc;

/// Animations as a document says them, with the accessors, views and buffers of their keys.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Animations {
    pub list: Vec<Value>,
    accessors: BTreeMap<usize, Value>,
    views: BTreeMap<usize, Value>,
    buffers: BTreeMap<usize, Value>,
}

/// The movement of a node.
pub(super) struct Track {
    pub node: usize,
    /// Seconds, at least one, each later than the one before.
    pub times: Vec<f64>,
    pub values: Values,
    /// True if a value holds until the next key.
    pub is_step: bool,
}

/// A value for each time.
pub(super) enum Values {
    Translation(Vec<DVec3>),
    Rotation(Vec<DQuat>),
    Scale(Vec<DVec3>),
}

/// Where the bytes of buffers are.
#[derive(Clone, Copy)]
pub(super) struct Bytes<'a> {
    pub read: &'a Buffers,
    pub folder: &'a Path,
}

impl Animations {
    pub fn read(root: &Value) -> Self {
        let list: Vec<Value> = items(root, "animations").cloned().collect();
        let samplers = list.iter().flat_map(|clip| items(clip, "samplers"));
        let named = samplers
            .flat_map(|sampler| [index(sampler.get("input")), index(sampler.get("output"))]);
        let picked = |list: &str, numbers: Vec<usize>| -> BTreeMap<usize, Value> {
            let entries = root.get(list).and_then(Value::as_array);
            let item = |number: usize| Some((number, entries?.get(number)?.clone()));
            numbers.into_iter().filter_map(item).collect()
        };
        let accessors = picked("accessors", named.flatten().collect());
        let views = accessors.values();
        let views = views.filter_map(|accessor| index(accessor.get("bufferView")));
        let views = picked("bufferViews", views.collect());
        let buffers = views.values().filter_map(|view| index(view.get("buffer")));
        let buffers = picked("buffers", buffers.collect());
        Self {
            list,
            accessors,
            views,
            buffers,
        }
    }

    /// Nodes that any of them moves.
    pub fn nodes(&self) -> HashSet<usize> {
        let channels = self.list.iter().flat_map(|clip| items(clip, "channels"));
        let nodes = channels.map(|channel| channel.pointer("/target/node"));
        nodes.filter_map(index).collect()
    }

    /// The tracks of an animation, and what of it is not followed; `name` names nodes.
    ///
    /// # Errors
    /// Why it cannot be followed, with the node or the accessor.
    pub fn tracks(
        &self,
        animation: &Value,
        bytes: Bytes<'_>,
        name: &dyn Fn(usize) -> String,
    ) -> Result<(Vec<Track>, Vec<String>), String> {
        let samplers = animation.get("samplers").and_then(Value::as_array);
        let (mut tracks, mut remarks) = (Vec::new(), Vec::new());
        for channel in items(animation, "channels") {
            let path = channel.pointer("/target/path").and_then(Value::as_str);
            let path = path.unwrap_or_default();
            let Some(node) = index(channel.pointer("/target/node")) else {
                remarks.push(format!("a channel of {path:?} has no node: passed over"));
                continue;
            };
            if !["translation", "rotation", "scale"].contains(&path) {
                let path = beginning(path);
                remarks.push(format!(
                    "{}: its {path} stand still: nodes are moved, nothing else",
                    name(node)
                ));
                continue;
            }
            let place = |why: String| format!("{}, {path}: {why}", name(node));
            let sampler = index(channel.get("sampler"));
            let sampler = sampler.and_then(|at| samplers?.get(at));
            let sampler = sampler.ok_or_else(|| place("it has no sampler".to_owned()))?;
            let track = self.track(node, path, sampler, bytes);
            tracks.push(track.map_err(place)?);
        }
        Ok((tracks, remarks))
    }

    fn track(
        &self,
        node: usize,
        path: &str,
        sampler: &Value,
        bytes: Bytes<'_>,
    ) -> Result<Track, String> {
        let is_step = match sampler.get("interpolation").and_then(Value::as_str) {
            None | Some("LINEAR") => false,
            Some("STEP") => true,
            Some("CUBICSPLINE") => {
                return Err(
                    "its keys are cubic (CUBICSPLINE), which are not followed: export \
                            them sampled, with linear keys"
                        .to_owned(),
                );
            }
            Some(other) => {
                let other = beginning(other);
                return Err(format!(
                    "its interpolation is {other:?}, expected LINEAR or STEP"
                ));
            }
        };
        let times = self.numbers(sampler, "input", 1, bytes)?;
        let mut pairs = times.windows(2);
        if times.is_empty() || !pairs.all(|pair| pair[0] < pair[1]) {
            return Err("its times do not grow from key to key".to_owned());
        }
        let width = if path == "rotation" { 4 } else { 3 };
        let values = self.numbers(sampler, "output", width, bytes)?;
        if values.len() != width * times.len() {
            let keys = plural(times.len(), "time", "times");
            return Err(format!("{} values for {keys}", values.len() / width));
        }
        let vectors = || values.chunks_exact(3).map(DVec3::from_slice).collect();
        let values = match path {
            "translation" => Values::Translation(vectors()),
            "scale" => Values::Scale(vectors()),
            _ => {
                let turns = values.chunks_exact(4);
                let turns = turns.map(|turn| unit(DQuat::from_slice(turn)));
                let turns: Option<_> = turns.collect();
                Values::Rotation(turns.ok_or("a rotation is 0, 0, 0, 0")?)
            }
        };
        Ok(Track {
            node,
            times,
            values,
            is_step,
        })
    }

    /// The numbers of an accessor, `width` in an item, all finite.
    fn numbers(
        &self,
        sampler: &Value,
        field: &str,
        width: usize,
        bytes: Bytes<'_>,
    ) -> Result<Vec<f64>, String> {
        let number = index(sampler.get(field));
        let number = number.ok_or_else(|| format!("its sampler has no {field}"))?;
        let numbers = self.items(number, width, bytes);
        let numbers = numbers.map_err(|why| format!("accessor {number}: {why}"))?;
        match numbers.iter().find(|number| !number.is_finite()) {
            Some(odd) => Err(format!("accessor {number}: a key is {odd}")),
            None => Ok(numbers),
        }
    }

    fn items(&self, number: usize, width: usize, bytes: Bytes<'_>) -> Result<Vec<f64>, String> {
        let accessor = self.accessors.get(&number).ok_or("it is not there")?;
        if accessor.get("sparse").is_some() {
            return Err("it is sparse, which keys are not".to_owned());
        }
        let widths = [("SCALAR", 1), ("VEC3", 3), ("VEC4", 4)];
        let kind = accessor.get("type").and_then(Value::as_str);
        if !widths.contains(&(kind.unwrap_or_default(), width)) {
            let kind = kind.unwrap_or("nothing");
            return Err(format!("its items are {kind}, expected {width} numbers"));
        }
        let ty = match index(accessor.get("componentType")) {
            Some(5126) => DataType::F32,
            Some(5120) => DataType::I8,
            Some(5121) => DataType::U8,
            Some(5122) => DataType::I16,
            Some(5123) => DataType::U16,
            _ => return Err("its numbers are of a kind that keys do not have".to_owned()),
        };
        let view = index(accessor.get("bufferView")).ok_or("it has no buffer view")?;
        let view = self.views.get(&view);
        let view = view.ok_or("its buffer view is not there")?;
        let packed = view.get("extensions").and_then(Value::as_object);
        if let Some(why) = packed.and_then(extensions::packed) {
            return Err(why);
        }
        let buffer = index(view.get("buffer")).ok_or("its buffer view has no buffer")?;
        let data = self.bytes(buffer, bytes)?;
        let field = |object: &Value, name: &str| index(object.get(name)).unwrap_or(0);
        let item = width * ty.size();
        let stride = Some(field(view, "byteStride")).filter(|&stride| stride >= item);
        let stride = stride.unwrap_or(item);
        let offset = field(view, "byteOffset").saturating_add(field(accessor, "byteOffset"));
        let count = field(accessor, "count");
        let end = accessor::end_of(count, stride, item, offset);
        if end.is_none_or(|end| end > data.len()) {
            return Err(format!("it reaches beyond buffer {buffer}"));
        }
        let items = (0..count).map(|item| offset + item * stride);
        let places = items.flat_map(|at| (0..width).map(move |axis| at + axis * ty.size()));
        // Whole numbers are normalised ones, which is what keys may be.
        let numbers = places.map(|at| accessor::number(&data[at..], ty, true));
        Ok(numbers.collect())
    }

    /// The bytes of a buffer: those that the mesh needs are there, others are read.
    fn bytes(&self, buffer: usize, bytes: Bytes<'_>) -> Result<Arc<[u8]>, String> {
        if let Some(read) = bytes.read.bytes.get(buffer).filter(|data| !data.is_empty()) {
            return Ok(read.clone());
        }
        let uri = self.buffers.get(&buffer).and_then(|entry| entry.get("uri"));
        let uri = uri.and_then(Value::as_str);
        let uri = uri.ok_or_else(|| format!("buffer {buffer} holds no bytes"))?;
        load(bytes.folder, uri).map(Arc::from)
    }
}

impl Track {
    pub fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// The keys around a time, and how far it is from the first to the second.
    pub fn around(&self, at: f64) -> (usize, usize, f64) {
        // The times of a file are rounded to f32: a step is not to be a frame late by that.
        let at = if self.is_step { at + 1e-6 } else { at };
        let passed = self.times.partition_point(|&time| time <= at);
        let from = passed.saturating_sub(1);
        let to = passed.min(self.times.len() - 1);
        let (begin, end) = (self.times[from], self.times[to]);
        if self.is_step || end <= begin || at <= begin {
            (from, from, 0.0)
        } else {
            (from, to, ((at - begin) / (end - begin)).min(1.0))
        }
    }
}
