//! The hierarchies over a mesh in light spaces: built, and fitted again when the mesh is deformed.

use crate::{built::How, error::Error};
use glam::Vec3;
use skiagraph_scene::{Bvh, LightSpace, LightSpaceNode, Mesh};

/// A tree is built anew when a deformation has made rays this many times as dear as they were.
const WORSE: f64 = 1.5;

/// Number of directions of light whose trees are kept: those of the suns that take turns with one
/// provider.
const DIRECTIONS: usize = 4;

/// Trees that are worth keeping, as the mesh is deformed from time to time.
#[derive(Clone, Default)]
pub(crate) struct Hierarchies {
    /// By the directions of rays; the last one was asked for last.
    light_spaces: Vec<(Vec3, Kept)>,
}

#[derive(Clone)]
struct Kept {
    bvh: Bvh,
    /// Its cost when it was built.
    cost: f64,
}

/// A hierarchy as shaders read it.
pub(crate) struct Tree<N> {
    pub nodes: Vec<N>,
    /// `None` where they are those of the last time.
    pub primitives: Option<Vec<u32>>,
    pub how: How,
}

impl Hierarchies {
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
    ) -> Result<Tree<LightSpaceNode>, Error> {
        let too_large = || Error::LightSpace {
            triangles: mesh.triangles.len(),
        };
        let mut trees = self.light_spaces.iter();
        if let Some(at) = trees.position(|(direction, _)| *direction == space.direction) {
            let is_last = at + 1 == self.light_spaces.len();
            let (direction, mut kept) = self.light_spaces.remove(at);
            if kept.refit(mesh) {
                let nodes = space.refit(&kept.bvh, mesh).ok_or_else(too_large)?;
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
        let (mut nodes, mut bvh) = space.build(mesh, most).ok_or_else(too_large)?;
        if nodes.is_empty() {
            nodes.push(LightSpaceNode {
                link: 1,
                ..LightSpaceNode::default()
            });
        }
        let primitives = Some(primitives_of(&mut bvh, keep));
        if keep && !bvh.nodes.is_empty() {
            // Its boxes are of the light's space; those of the world tell when it has become bad.
            bvh.refit(mesh);
            if self.light_spaces.len() == DIRECTIONS {
                self.light_spaces.remove(0);
            }
            self.light_spaces.push((space.direction, Kept::new(bvh)));
        }
        Ok(Tree {
            nodes,
            primitives,
            how: How::Made,
        })
    }
}

/// A copy where the tree is kept.
fn primitives_of(bvh: &mut Bvh, keep: bool) -> Vec<u32> {
    if keep {
        bvh.primitives.clone()
    } else {
        std::mem::take(&mut bvh.primitives)
    }
}

impl Kept {
    fn new(bvh: Bvh) -> Self {
        let cost = bvh.cost();
        Self { bvh, cost }
    }

    /// Fits the boxes to the mesh; whether the tree is as good as it was.
    fn refit(&mut self, mesh: &Mesh) -> bool {
        self.bvh.refit(mesh);
        self.bvh.cost() <= WORSE * self.cost
    }
}
