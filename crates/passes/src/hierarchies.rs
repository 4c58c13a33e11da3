//! The hierarchies over a mesh in light spaces: built, and fitted again when the mesh is deformed;
//! over a mesh in parts, those of its parts, of which those are fitted that have moved.

use crate::{built::How, error::Error, names::remember};
use glam::Vec3;
use skiagraph_scene::{Bvh, LightSpace, LightSpaceNode, Mesh, TwoLevelBvh};
use std::{ops::Range, sync::Arc};

/// A tree is built anew when a deformation has made rays this many times as dear as they were.
const WORSE: f64 = 1.5;

/// Number of directions of light whose trees are kept: those of the suns that take turns with one
/// provider.
const DIRECTIONS: usize = 4;

/// Coordinate beyond all scenes and rays.
pub(crate) const FAR_AWAY: f32 = 1e30;

/// Leaf of an empty tree, where no ray is: its triangle may be one that casts nothing.
const NOTHING: LightSpaceNode = LightSpaceNode {
    low: [FAR_AWAY; 2],
    high: [FAR_AWAY; 2],
    farthest: [0.0; 3],
    link: 1,
};

/// Trees that are worth keeping, as the mesh is deformed from time to time.
#[derive(Clone, Default)]
pub(crate) struct Hierarchies {
    /// By the directions of rays; the last one was asked for last.
    light_spaces: Vec<(Vec3, Kept)>,
    /// Likewise, of a mesh in parts.
    of_parts: Vec<OfParts>,
}

/// The hierarchy as shaders read it.
pub(crate) struct Fitted {
    pub tree: Arc<TwoLevelBvh>,
    /// Pieces whose nodes are others than those of a version.
    pub pieces: Vec<usize>,
    /// Ranges of the nodes that are others than those of a version.
    pub nodes: Vec<Range<usize>>,
    /// Ranges of the primitives that are others than those of that version.
    pub primitives: Vec<Range<usize>>,
    pub how: How,
}

/// Nodes in a light space over the trees of parts.
#[derive(Clone)]
pub(crate) struct OfParts {
    space: LightSpace,
    /// The last one is the centre.
    nodes: Arc<Vec<LightSpaceNode>>,
    /// Version of the shape that they are fitted to.
    pub shape: u64,
    /// Version of the resource.
    version: u64,
}

/// Nodes and primitives of a mesh in parts as shaders read them, and their ranges that are others
/// than in a version of the resource.
pub(crate) struct Parted {
    pub nodes: Arc<Vec<LightSpaceNode>>,
    pub tree: Arc<TwoLevelBvh>,
    pub since: u64,
    pub changed: [Vec<Range<usize>>; 2],
    /// Number of nodes that were fitted.
    pub fitted: usize,
}

#[derive(Clone)]
struct Kept {
    bvh: Bvh,
    /// Its cost when it was built.
    cost: f64,
}

/// A hierarchy as shaders read it.
pub(crate) struct Tree {
    pub nodes: Vec<LightSpaceNode>,
    /// `None` where they are those of the last time.
    pub primitives: Option<Vec<u32>>,
    pub how: How,
}

impl Hierarchies {
    /// Takes the nodes over parts for a direction.
    pub fn take(&mut self, direction: Vec3) -> Option<OfParts> {
        let mut kept = self.of_parts.iter();
        let at = kept.position(|nodes| nodes.space.direction == direction)?;
        Some(self.of_parts.remove(at))
    }

    /// Returns the nodes over parts in the light space of `space`. `former` are those for its
    /// direction, if there are any, since when the pieces of `fitted` have changed. They keep their
    /// centre as long as it is nearer than `near`, so that parts that stand still keep their nodes.
    ///
    /// # Errors
    /// More triangles than its links can name.
    pub fn of_parts(
        &mut self,
        former: Option<OfParts>,
        (space, near): (LightSpace, f32),
        fitted: &Fitted,
        mesh: &Mesh,
        [shape, version]: [u64; 2],
    ) -> Result<Parted, Error> {
        let tree = &fitted.tree;
        let former = former.filter(|nodes| nodes.space.centre.distance(space.centre) <= near);
        let (mut kept, since, pieces, mut changed) = match former {
            Some(former) => {
                let changed = [fitted.nodes.clone(), fitted.primitives.clone()];
                let since = former.version;
                (former, since, fitted.pieces.clone(), changed)
            }
            None => {
                let kept = OfParts {
                    space,
                    nodes: Arc::default(),
                    shape,
                    version,
                };
                let changed = [all(tree.nodes.len()), all(tree.primitives.len())];
                (kept, 0, (0..tree.pieces()).collect(), changed)
            }
        };
        let nodes = Arc::make_mut(&mut kept.nodes);
        nodes.pop();
        let refit = kept.space.refit_pieces(nodes, tree, mesh, pieces);
        let fitted = refit.ok_or_else(|| too_large(mesh))?;
        if nodes.is_empty() {
            nodes.push(NOTHING);
        }
        changed[0].push(nodes.len()..nodes.len() + 1);
        nodes.push(LightSpaceNode::centre(kept.space.centre));
        (kept.shape, kept.version) = (shape, version);
        let nodes = Arc::clone(&kept.nodes);
        remember(&mut self.of_parts, kept, DIRECTIONS);
        Ok(Parted {
            nodes,
            tree: Arc::clone(tree),
            since,
            changed,
            fitted,
        })
    }

    /// Returns the tree of a mesh in the light space of `space`. Trees are kept for the directions
    /// that were asked for last.
    ///
    /// # Errors
    /// More triangles than its links can name.
    pub fn light_space(
        &mut self,
        space: LightSpace,
        mesh: &Mesh,
        most: usize,
        keep: bool,
    ) -> Result<Tree, Error> {
        let mut trees = self.light_spaces.iter();
        if let Some(at) = trees.position(|(direction, _)| *direction == space.direction) {
            let is_last = at + 1 == self.light_spaces.len();
            let (direction, mut kept) = self.light_spaces.remove(at);
            if kept.refit(mesh) {
                let nodes = space.refit(&kept.bvh, mesh);
                let mut nodes = nodes.ok_or_else(|| too_large(mesh))?;
                nodes.push(LightSpaceNode::centre(space.centre));
                // If the last direction was another, so are its primitives.
                let primitives = (!is_last).then(|| kept.bvh.primitives.clone());
                self.light_spaces.push((direction, kept));
                return Ok(Tree {
                    nodes,
                    primitives,
                    how: How::Refitted,
                });
            }
        }
        let built = space.build(mesh, most);
        let (mut nodes, mut bvh) = built.ok_or_else(|| too_large(mesh))?;
        if nodes.is_empty() {
            nodes.push(NOTHING);
        }
        nodes.push(LightSpaceNode::centre(space.centre));
        let primitives = std::mem::take(&mut bvh.primitives);
        if keep && !bvh.nodes.is_empty() {
            bvh.primitives.clone_from(&primitives);
            // Its boxes are of the light's space; those of the world tell when it has become bad.
            bvh.refit(mesh);
            let cost = bvh.cost();
            let kept = (space.direction, Kept { bvh, cost });
            remember(&mut self.light_spaces, kept, DIRECTIONS);
        }
        Ok(Tree {
            nodes,
            primitives: Some(primitives),
            how: How::Made,
        })
    }
}

/// The range of a whole list.
pub(crate) fn all(count: usize) -> Vec<Range<usize>> {
    std::iter::once(0..count).collect()
}

fn too_large(mesh: &Mesh) -> Error {
    let triangles = mesh.triangles.len();
    Error::LightSpace { triangles }
}

impl Kept {
    /// Fits the boxes to the mesh; whether the tree is as good as it was.
    fn refit(&mut self, mesh: &Mesh) -> bool {
        self.bvh.refit(mesh);
        self.bvh.cost() <= WORSE * self.cost
    }
}
