//! Walks the nodes of a document: where each stands, and which are seen.

use super::{beside::Beside, fault::Fault};
use glam::{DMat4, DQuat, DVec3, Mat4};
use gltf::{Document, Node, scene::Transform};
use std::collections::{HashMap, HashSet};

/// The nodes of a document's scene.
#[derive(Default)]
pub(super) struct Nodes<'a> {
    /// Those that have a mesh and are not hidden, in the order of the file, depth first.
    pub seen: Vec<Node<'a>>,
    /// All of the scene in that order, and whether they are seen.
    pub in_scene: Vec<(usize, bool)>,
    /// Nodes of the scene that an animation moves, themselves or with one above them.
    pub moved: HashSet<usize>,
    /// Where nodes stand: those of the scene, and joints that are in none.
    pub worlds: HashMap<usize, DMat4>,
}

impl<'a> Nodes<'a> {
    /// Those of the default scene, else of the first; `None` in a document without scenes. `moved`:
    /// nodes that an animation names.
    ///
    /// # Errors
    /// A scene without nodes, a node with two parents, or a transform that is not finite.
    pub fn new(
        document: &'a Document,
        beside: &Beside,
        moved: HashSet<usize>,
    ) -> Result<Option<Self>, Fault> {
        let mut scenes = document.scenes();
        let Some(scene) = document.default_scene().or_else(|| scenes.next()) else {
            return Ok(None);
        };
        let mut nodes = Self {
            moved,
            ..Self::default()
        };
        if scene.nodes().len() == 0 {
            let why = "it has no nodes, so that nothing is in it: add some, or let the file's \
                       `scene` name another";
            return Err((format!("scene {}", scene.index()), why.to_owned()));
        }
        nodes.walk(scene.nodes().collect(), beside, true)?;
        // A joint may stand outside of the scene.
        let skins = document.skins();
        let mut joints = skins.flat_map(|skin| skin.joints().map(|joint| joint.index()));
        if joints.any(|joint| !nodes.worlds.contains_key(&joint)) {
            let mut has_parent = vec![false; document.nodes().len()];
            for child in document.nodes().flat_map(|node| node.children()) {
                has_parent[child.index()] = true;
            }
            let roots = document.nodes().filter(|node| {
                !has_parent[node.index()] && !nodes.worlds.contains_key(&node.index())
            });
            let roots = roots.collect();
            nodes.walk(roots, beside, false)?;
        }
        Ok(Some(nodes))
    }

    fn walk(&mut self, roots: Vec<Node<'a>>, beside: &Beside, is_scene: bool) -> Result<(), Fault> {
        let mut open: Vec<(Node<'a>, DMat4, bool)> = Vec::new();
        let begin = |node| (node, DMat4::IDENTITY, is_scene);
        open.extend(roots.into_iter().rev().map(begin));
        while let Some((node, above, seen)) = open.pop() {
            let place = || format!("node {}", node.index());
            let transform = above * local(&node);
            if !transform.is_finite() {
                return Err((place(), "its transform is not finite".to_owned()));
            }
            if self.worlds.insert(node.index(), transform).is_some() {
                let why = "two nodes have it as a child, or it is its own";
                return Err((place(), why.to_owned()));
            }
            let seen = seen && !beside.hidden.contains(&node.index());
            if is_scene {
                self.in_scene.push((node.index(), seen));
            }
            let children: Vec<_> = node.children().collect();
            if self.moved.contains(&node.index()) {
                self.moved.extend(children.iter().map(Node::index));
            }
            let children = children.into_iter().rev();
            open.extend(children.map(|child| (child, transform, seen)));
            if seen && node.mesh().is_some() {
                self.seen.push(node);
            }
        }
        Ok(())
    }
}

/// The transform of a node, beside that of its parent.
pub(super) fn local(node: &Node<'_>) -> DMat4 {
    match node.transform() {
        Transform::Matrix { matrix } => Mat4::from_cols_array_2d(&matrix).as_dmat4(),
        Transform::Decomposed { .. } => {
            let (shift, turn, scale) = parts(node);
            DMat4::from_scale_rotation_translation(scale, turn, shift)
        }
    }
}

/// Translation, rotation and scale of a node.
pub(super) fn parts(node: &Node<'_>) -> (DVec3, DQuat, DVec3) {
    let (shift, turn, scale) = node.transform().decomposed();
    let [shift, scale] = [shift, scale].map(|vector| DVec3::from(vector.map(f64::from)));
    let turn = DQuat::from_array(turn.map(f64::from));
    (shift, unit(turn).unwrap_or_default(), scale)
}

/// A rotation that turns nothing, for messages.
pub(super) const NO_TURN: &str = "rotation is 0, 0, 0, 0, which turns nothing: mend it if that is \
                                  not meant";

/// The rotation of a quaternion of any length but 0: exporters write others than 1.
pub(super) fn unit(turn: DQuat) -> Option<DQuat> {
    (turn.length_squared() != 0.0).then(|| turn.normalize())
}

/// Name of the group that the triangles of a node are in, if it has any.
pub(super) fn part(node: &gltf::Node<'_>) -> Option<String> {
    node.mesh().map(|mesh| group(&mesh, node.name()))
}

/// Name of the group that a mesh's triangles are in.
pub(super) fn group(mesh: &gltf::Mesh<'_>, node: Option<&str>) -> String {
    let name = node.or(mesh.name());
    name.map_or_else(|| format!("mesh {}", mesh.index()), str::to_owned)
}
