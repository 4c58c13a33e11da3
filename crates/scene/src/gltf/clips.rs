//! Animations as camera paths: where cameras, lights and meshes are in each frame.

use super::animations::{Bytes, Track, Values};
use super::names::{Names, titled};
use super::nodes::{Nodes, local, part, parts};
use super::placements::Placements;
use crate::camera::View;
use crate::light_kind::{Light, LightKind};
use crate::mesh::Mesh;
use crate::motion::{Motion, PoseKey};
use crate::path::{CameraKey, CameraPath, LightKey};
use glam::{DMat3, DMat4, DQuat, DVec3};
use gltf::{Document, Node};
use serde_json::Value;
use std::collections::HashMap;

/// Frames in a second of an animation's time: each is a key.
const RATE: f64 = 30.0;

/// Most keys of all moving nodes of an animation together.
const MOST_KEYS: f64 = 1e6;

/// How far a map may be from a rigid one, and a camera from upright (in degrees).
const NEARLY_RIGID: f64 = 1e-3;
const NEARLY_UPRIGHT: f64 = 1.0;

/// Animation of a glTF file: positions of cameras, lights and parts of the mesh, sampled 30 times
/// per second.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// Name of small letters, digits and `_`, unique among the clips of the file.
    pub name: String,
    frames: u32,
    /// The view that moves, and its direction up.
    cameras: Vec<(usize, DVec3, Vec<CameraKey>)>,
    lights: Vec<(usize, Vec<LightKey>)>,
    moves: Vec<Motion>,
}

impl Clip {
    /// Returns the camera paths of this animation: one for each camera that moves, or one for the
    /// view `standing` if no camera moves. If any light moves, there is a path under each light of
    /// `lights` instead, even under lights that stand still. `views` and `lights` are those of the
    /// [`GltfScene`](super::GltfScene) or [`MeshFile`](crate::MeshFile) that holds the animation. A
    /// path has the animation's name, followed by the names of view and light if there are several.
    ///
    /// # Errors
    /// An entry of the list is an error if its path is not valid; the text says why.
    pub fn paths(
        &self,
        views: &[View],
        lights: &[Light],
        standing: &View,
    ) -> Vec<Result<CameraPath, String>> {
        let last = f64::from(self.frames.saturating_sub(1)) / RATE;
        let stand = |at| CameraKey {
            at,
            eye: standing.eye,
            direction: standing.direction,
        };
        let cameras = self.cameras.iter().filter_map(|(view, up, keys)| {
            let mut view = views.get(*view)?.clone();
            view.up = *up;
            Some((view, keys.clone()))
        });
        let mut cameras: Vec<(View, Vec<CameraKey>)> = cameras.collect();
        if cameras.is_empty() {
            cameras.push((standing.clone(), vec![stand(0.0), stand(last)]));
        }
        let of_lights: Vec<Option<usize>> = if self.lights.is_empty() {
            vec![None]
        } else {
            (0..lights.len()).map(Some).collect()
        };
        let (several_cameras, several_lights) = (cameras.len() > 1, lights.len() > 1);
        let mut paths = Vec::new();
        for (view, keys) in &cameras {
            for &number in &of_lights {
                let light = number.and_then(|number| lights.get(number));
                let moved = self.lights.iter().find(|(index, _)| Some(*index) == number);
                let mut name = self.name.clone();
                if several_cameras {
                    name += &format!("_{}", view.name);
                }
                if let Some(light) = light.filter(|_| several_lights) {
                    name += &format!("_{}", light.name);
                }
                let view = View {
                    name,
                    light: light.cloned(),
                    ..view.clone()
                };
                let path = CameraPath {
                    frames_per_second: RATE,
                    light_keys: moved.map_or_else(Vec::new, |(_, keys)| keys.clone()),
                    moves: self.moves.clone(),
                    ..CameraPath::new(view, keys.clone())
                };
                paths.push(path.check().map(|()| path));
            }
        }
        paths
    }
}

/// A document with what its nodes became.
pub(super) struct Source<'a> {
    pub document: &'a Document,
    pub placements: &'a Placements,
    pub nodes: &'a Nodes<'a>,
    pub bytes: Bytes<'a>,
    pub mesh: &'a Mesh,
}

impl Source<'_> {
    /// A node, for messages.
    fn place(&self, node: usize) -> String {
        let named = self.document.nodes().nth(node);
        titled("node", node, named.as_ref().and_then(Node::name))
    }
}

/// The nodes of views and lights.
pub(super) struct Placed<'a> {
    pub views: &'a [usize],
    pub lights: &'a [usize],
    /// The kind of each light.
    pub kinds: Vec<LightKind>,
}

/// The clips of a document, and what is said of its animations.
pub(super) fn clips(source: &Source<'_>, placed: &Placed<'_>) -> (Vec<Clip>, Vec<String>) {
    let (mut clips, mut remarks, mut names) = (Vec::new(), Vec::new(), Names::default());
    let animations = &source.placements.animations;
    for (number, animation) in animations.list.iter().enumerate() {
        let name = animation.get("name").and_then(Value::as_str);
        let place = titled("animation", number, name);
        let fallback = format!("animation_{number}");
        let plain = Names::plain(name.unwrap_or_default(), &fallback);
        let mut notes = Vec::new();
        let clip = animations
            .tracks(animation, source.bytes, &|node| source.place(node))
            .and_then(|(tracks, more)| {
                notes.extend(more);
                Poses::new(source, &tracks).clip(source, placed, &mut notes)
            });
        let notes = notes.into_iter().map(|text| format!("{place}: {text}"));
        remarks.extend(notes);
        match clip {
            Ok(clip) => {
                let (name, note) = names.noted(&plain, "animation", "its path is");
                remarks.extend(note.map(|note| format!("{place}: {note}")));
                clips.push(Clip { name, ..clip });
            }
            Err(why) => remarks.push(format!("{place} is left out: {why}")),
        }
    }
    (clips, remarks)
}

/// Where nodes are at a time.
struct Poses<'a> {
    tracks: HashMap<usize, Vec<&'a Track>>,
    end: f64,
    /// Nodes from the root to each node that is moved, itself or by one above it.
    ways: HashMap<usize, Vec<usize>>,
    nodes: Vec<Node<'a>>,
}

impl<'a> Poses<'a> {
    fn new(source: &Source<'a>, tracks: &'a [Track]) -> Self {
        let mut poses = Self {
            tracks: HashMap::new(),
            end: tracks.iter().map(Track::end).fold(0.0, f64::max),
            ways: HashMap::new(),
            nodes: source.document.nodes().collect(),
        };
        for track in tracks {
            poses.tracks.entry(track.node).or_default().push(track);
        }
        let mut parents = HashMap::new();
        for node in &poses.nodes {
            parents.extend(node.children().map(|child| (child.index(), node.index())));
        }
        // Nodes that stand somewhere have one parent each, and no circles.
        for &node in source.nodes.worlds.keys() {
            let way = std::iter::successors(Some(node), |node| parents.get(node).copied());
            let mut way: Vec<usize> = way.collect();
            way.reverse();
            if way.iter().any(|node| poses.tracks.contains_key(node)) {
                poses.ways.insert(node, way);
            }
        }
        poses
    }

    fn local(&self, node: usize, at: f64) -> DMat4 {
        let Some(tracks) = self.tracks.get(&node) else {
            return local(&self.nodes[node]);
        };
        let (mut shift, mut turn, mut scale) = parts(&self.nodes[node]);
        for track in tracks {
            let (from, to, share) = track.around(at);
            match &track.values {
                Values::Translation(values) => shift = values[from].lerp(values[to], share),
                Values::Scale(values) => scale = values[from].lerp(values[to], share),
                Values::Rotation(values) => turn = values[from].slerp(values[to], share),
            }
        }
        DMat4::from_scale_rotation_translation(scale, turn, shift)
    }

    /// The transforms of a node in each frame; `None` of one that stands.
    fn frames(&self, node: usize, frames: u32) -> Option<Vec<DMat4>> {
        let way = self.ways.get(&node)?;
        let world = |frame: u32| {
            let at = f64::from(frame) / RATE;
            way.iter()
                .fold(DMat4::IDENTITY, |above, &node| above * self.local(node, at))
        };
        Some((0..frames).map(world).collect())
    }

    fn clip(
        &self,
        source: &Source<'_>,
        placed: &Placed<'_>,
        notes: &mut Vec<String>,
    ) -> Result<Clip, String> {
        if self.ways.is_empty() {
            return Err("it moves no node of the scene".to_owned());
        }
        let frames = (self.end * RATE + 1e-6).floor() + 1.0;
        if frames < 2.0 {
            return Err(format!(
                "it lasts {} s, less than a frame, which is a thirtieth",
                self.end
            ));
        }
        if frames * self.ways.len() as f64 > MOST_KEYS {
            return Err(format!(
                "{frames} frames of {} moving nodes are too many: shorten it",
                self.ways.len()
            ));
        }
        let frames = frames as u32;
        let mut clip = Clip {
            name: String::new(),
            frames,
            cameras: Vec::new(),
            lights: Vec::new(),
            moves: Vec::new(),
        };
        for (view, &node) in placed.views.iter().enumerate() {
            if let Some(worlds) = self.frames(node, frames) {
                let (up, keys) = camera_keys(&worlds, &source.place(node), notes);
                clip.cameras.push((view, up, keys));
            }
        }
        for (light, &node) in placed.lights.iter().enumerate() {
            if let Some(worlds) = self.frames(node, frames) {
                let keys = light_keys(&worlds, placed.kinds[light]);
                clip.lights.push((light, keys));
            }
        }
        self.moves(source, frames, &mut clip, notes);
        if clip.cameras.is_empty() && clip.lights.is_empty() && clip.moves.is_empty() {
            return Err("it moves no camera, no light and no mesh".to_owned());
        }
        Ok(clip)
    }

    fn moves(&self, source: &Source<'_>, frames: u32, clip: &mut Clip, notes: &mut Vec<String>) {
        let names: Vec<String> = source.nodes.seen.iter().filter_map(part).collect();
        for node in &source.nodes.seen {
            let (number, Some(part)) = (node.index(), part(node)) else {
                continue;
            };
            let place = source.place(number);
            if let Some(skin) = node.skin() {
                let mut joints = skin.joints().map(|joint| joint.index());
                if joints.any(|joint| self.ways.contains_key(&joint)) {
                    notes.push(format!(
                        "{place}: its skin moves, which is not followed: it keeps its pose"
                    ));
                }
                continue;
            }
            let Some(worlds) = self.frames(number, frames) else {
                continue;
            };
            // One of points and lines only has nothing that casts a shadow.
            if !source.mesh.groups.iter().any(|group| group.name == part) {
                continue;
            }
            let rest = source.nodes.worlds.get(&number).copied();
            let from_rest = rest.unwrap_or_default().inverse();
            let maps = worlds.iter().map(|world| *world * from_rest);
            let Some(keys) = maps.enumerate().map(pose_key).collect::<Option<Vec<_>>>() else {
                notes.push(format!(
                    "{place}: its size or shape changes, and only rigid motions are followed: it \
                     stands still"
                ));
                continue;
            };
            if names.iter().filter(|name| **name == part).count() > 1 {
                notes.push(format!(
                    "{place}: another node has that name, so that it cannot move by itself: it \
                     stands still, rename it"
                ));
                continue;
            }
            clip.moves.push(Motion::Posed { part, keys });
        }
    }
}

/// The key of a frame of a part; `None` if its map is not rigid.
fn pose_key((frame, map): (usize, DMat4)) -> Option<PoseKey> {
    let linear = DMat3::from_mat4(map);
    let error = linear.transpose() * linear - DMat3::IDENTITY;
    let entries = error.to_cols_array().into_iter();
    let error = entries.fold(0.0, |most: f64, entry| most.max(entry.abs()));
    (error < NEARLY_RIGID && linear.determinant() > 0.0).then(|| PoseKey {
        at: at(frame),
        translation: map.w_axis.truncate(),
        rotation: DQuat::from_mat3(&linear).normalize(),
    })
}

fn at(frame: usize) -> f64 {
    frame as f64 / RATE
}

/// The way of a camera, with the direction up that suits all of it best.
fn camera_keys(worlds: &[DMat4], place: &str, notes: &mut Vec<String>) -> (DVec3, Vec<CameraKey>) {
    let keys = worlds.iter().enumerate().map(|(frame, world)| CameraKey {
        at: at(frame),
        eye: world.w_axis.truncate(),
        direction: (-world.z_axis.truncate()).normalize_or_zero(),
    });
    let keys: Vec<CameraKey> = keys.collect();
    let own_up = |world: &DMat4| world.y_axis.truncate().normalize_or_zero();
    let ups: Vec<DVec3> = worlds.iter().map(own_up).collect();
    // How far the pictures are rolled with a constant direction up.
    let roll = |up: DVec3| {
        let rolls = keys.iter().zip(&ups).map(|(key, own)| {
            let up = up - key.direction * up.dot(key.direction);
            if up.length() < 1e-6 {
                180.0
            } else {
                up.angle_between(*own).to_degrees()
            }
        });
        rolls.fold(0.0, f64::max)
    };
    let first = ups.first().copied().unwrap_or(DVec3::Y);
    let up = if roll(DVec3::Y) <= roll(first) + 1e-3 {
        DVec3::Y
    } else {
        first
    };
    if roll(up) > NEARLY_UPRIGHT {
        notes.push(format!(
            "{place}: its camera rolls by up to {:.0} degrees, which paths do not: up stays \
             {}",
            roll(up),
            up
        ));
    }
    (up, keys)
}

fn light_keys(worlds: &[DMat4], kind: LightKind) -> Vec<LightKey> {
    let keys = worlds.iter().enumerate().map(|(frame, world)| {
        let direction = (-world.z_axis.truncate()).normalize_or_zero();
        let position = world.w_axis.truncate();
        LightKey {
            at: at(frame),
            direction: kind.direction().map(|_| direction),
            position: kind.position().map(|_| position),
        }
    });
    keys.collect()
}
